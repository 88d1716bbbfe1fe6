//! Estimates the width of texts, and cuts or wraps texts to a width.

/// Estimated width of a text, px: the advances of DejaVu Sans, rounded up by kinds of letters.
pub(crate) fn text_width(text: &str, size: u32) -> f64 {
    let ems: f64 = text.chars().map(advance).sum();
    ems * f64::from(size)
}

fn advance(c: char) -> f64 {
    match c {
        ' ' | 'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' => 0.34,
        'f' | 'r' | 't' | 'I' | '(' | ')' | '[' | ']' | '!' | '-' | '/' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 1.0,
        'A'..='Z' | '&' => 0.76,
        '\u{1100}'.. => 1.0,
        _ => 0.65,
    }
}

/// The text, or as much of its beginning as fits into `width` px, ended by an ellipsis.
pub(crate) fn fit(text: &str, size: u32, width: f64) -> String {
    // No glyph is narrower than 0.34 em, so texts of megabytes need not be measured to their end.
    let longest = (width / (0.34 * f64::from(size))) as usize + 1;
    let beginning: String = text.chars().take(longest + 1).collect();
    if text_width(&beginning, size) <= width {
        return beginning;
    }
    let room = width - text_width("…", size);
    let mut used = 0.0;
    let mut kept: String = beginning
        .chars()
        .take_while(|&c| {
            used += advance(c) * f64::from(size);
            used <= room
        })
        .collect();
    kept.truncate(kept.trim_end().len());
    kept.push('…');
    kept
}

/// The text in at most `max_lines` lines of `width` px each; what does not fit ends in an ellipsis.
pub(crate) fn wrap(text: &str, size: u32, width: f64, max_lines: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let last_line = lines.len() == max_lines;
        match lines.last_mut() {
            Some(line) if last_line || text_width(&format!("{line} {word}"), size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| fit(line, size, width)).collect()
}
