//! Shows characters that a terminal or a reader obeys, such as line breaks and turned reading directions, as escapes.

use std::borrow::Cow;
use std::fmt::Write;

/// The text with every control character but tab, and every character that turns the reading direction, written `\u` and four
/// hexadecimal digits, as JSON does.
///
/// ```
/// assert_eq!(contrapposto_formats::escaped("a\u{202e}b\n"), r"a\u202eb\u000a");
/// assert_eq!(contrapposto_formats::escaped("plain"), "plain");
/// ```
pub fn escaped(text: &str) -> Cow<'_, str> {
    if !text.contains(is_obeyed) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::new();
    for c in text.chars() {
        if is_obeyed(c) {
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// As [`escaped`], line by line: line ends stay.
pub fn escaped_lines(text: &str) -> String {
    text.split('\n').map(escaped).collect::<Vec<_>>().join("\n")
}

/// Whether [`escaped`] writes a character as an escape.
fn is_obeyed(c: char) -> bool {
    (c.is_control() && c != '\t') || turns_direction(c)
}

/// Whether a character turns the reading direction of what follows.
pub(crate) fn turns_direction(c: char) -> bool {
    matches!(c, '\u{200e}' | '\u{200f}' | '\u{061c}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::escaped_lines;

    #[test]
    fn line_ends_stay_and_all_else_that_a_terminal_obeys_is_written_out() {
        assert_eq!(escaped_lines("a\u{202e}b\n\tc\r\n\u{1b}[1m\n"), "a\\u202eb\n\tc\\u000d\n\\u001b[1m\n");
        assert_eq!(escaped_lines(""), "");
    }
}
