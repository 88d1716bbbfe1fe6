//! Errors of input files: the reason, the place, and the accepted alternative.

use miette::{Diagnostic, LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

/// A refused input. Prints with file, line, column and a caret when shown through `miette`.
#[derive(Debug)]
pub struct InputError(Box<Report>);

/// The reason, the place, and the accepted alternative.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
struct Report {
    message: String,
    source_code: Excerpt,
    span: Option<SourceSpan>,
    label: String,
    help: Option<String>,
}

impl std::fmt::Display for InputError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

impl std::error::Error for InputError {}

impl Diagnostic for InputError {
    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        self.0.help.as_ref().map(|help| Box::new(help) as _)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.0.source_code)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = |span| LabeledSpan::new_with_span(Some(self.0.label.clone()), span);
        self.0.span.map(|span| Box::new(std::iter::once(label(span))) as _)
    }
}

/// An input text and its name, from which errors take their excerpts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    pub(crate) name: &'a str,
    pub(crate) text: &'a str,
}

impl Source<'_> {
    /// An error at `span` (bytes), or in the whole file.
    pub(crate) fn error(
        &self,
        span: Option<std::ops::Range<usize>>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: Option<String>,
    ) -> InputError {
        let text = printable(self.text);
        // A long or many-lined value is underlined at its beginning.
        let span = span.map(|range| {
            let line_end = text[range.start..].find('\n').map_or(text.len(), |at| range.start + at);
            let end = range.end.min(line_end).min(boundary(&text, range.start + MOST_UNDERLINED));
            SourceSpan::from((range.start, end.saturating_sub(range.start)))
        });
        InputError(Box::new(Report {
            message: printable(&shortened(message.into())),
            source_code: Excerpt { name: printable(self.name), text },
            span,
            label: printable(&shortened(label.into())),
            help: help.map(|help| printable(&help)),
        }))
    }
}

/// Longest underlined piece, bytes.
const MOST_UNDERLINED: usize = 100;

/// Longest excerpt, bytes: of longer lines only the neighbourhood of the place is shown.
const MOST_SHOWN: usize = 1000;

/// Longest message, bytes.
const MOST_SAID: usize = 400;

/// A text that shows only the neighbourhood of a place when its lines are very long.
#[derive(Debug)]
struct Excerpt {
    name: String,
    text: String,
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let whole = self.text.read_span(span, before, after)?;
        let mut shown = *whole.span();
        let (mut line, mut column) = (whole.line(), whole.column());
        if shown.len() > MOST_SHOWN {
            let (start, end) = (span.offset(), span.offset() + span.len());
            let line_start = self.text[..start].rfind('\n').map_or(0, |at| at + 1);
            let line_end = self.text[end..].find('\n').map_or(self.text.len(), |at| end + at);
            let from = line_start.max(boundary(&self.text, start.saturating_sub(MOST_UNDERLINED)));
            let to = line_end.min(boundary(&self.text, end + MOST_UNDERLINED));
            shown = (from, to.saturating_sub(from)).into();
            line = self.text[..start].matches('\n').count();
            column = self.text[line_start..from].chars().count();
        }
        let data = &self.text.as_bytes()[shown.offset()..shown.offset() + shown.len()];
        let lines = whole.line_count();
        Ok(Box::new(MietteSpanContents::new_named(self.name.clone(), data, shown, line, column, lines)))
    }
}

/// The nearest place at or before `at` where the text may be cut.
fn boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// The text without the characters that a terminal obeys (escapes, turned reading directions); every byte keeps its place.
fn printable(text: &str) -> String {
    let shown = |c: char| match c {
        '\n' | '\t' | '\r' => c,
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => '\u{fffd}',
        c if c.is_control() && c.len_utf8() == 1 => '?',
        c if c.is_control() => '\u{bf}',
        c => c,
    };
    text.chars().map(shown).collect()
}

/// The message, or its beginning.
pub(crate) fn shortened(mut message: String) -> String {
    if message.len() > MOST_SAID {
        message.truncate(boundary(&message, MOST_SAID));
        message.push_str(" ...");
    }
    message
}

/// UTF-8 text of an input file.
///
/// # Errors
/// [`InputError`] with line and column of the first byte that is not UTF-8.
pub(crate) fn utf8<'a>(name: &str, bytes: &'a [u8]) -> Result<&'a str, InputError> {
    std::str::from_utf8(bytes).map_err(|error| {
        let good = String::from_utf8_lossy(&bytes[..error.valid_up_to()]).into_owned();
        let byte = bytes[error.valid_up_to()];
        let at = good.len();
        let text = good + "?";
        let help = Some("save the file as UTF-8".to_owned());
        Source { name, text: &text }.error(
            Some(at..at + 1),
            "the file is not UTF-8",
            format!("byte 0x{byte:02x}"),
            help,
        )
    })
}

/// Longest name that is compared with others, letters: the work grows with the product of two lengths.
const MOST_COMPARED: usize = 64;

/// The one of `names` that `given` was probably meant to be.
pub fn nearest<'a>(given: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = given.chars().count();
    let tolerable = |name: &str| 1 + name.len() / 4;
    if length > MOST_COMPARED {
        return None;
    }
    names
        .into_iter()
        .filter(|name| name.len() <= 4 * MOST_COMPARED)
        // The distance is at least the difference of lengths.
        .filter(|name| length.abs_diff(name.chars().count()) <= tolerable(name))
        .map(|name| (strsim::damerau_levenshtein(given, name), name))
        .filter(|(distance, name)| *distance <= tolerable(name))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// The one of `names` with the same words in any order, `right` and `left` being `r` and `l`: `hand_r` for `right_hand`.
fn same_words<'a>(given: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    fn words(name: &str) -> Vec<String> {
        let mut words: Vec<String> = name
            .split(|c: char| !c.is_alphanumeric())
            .filter(|word| !word.is_empty())
            .map(|word| match word.to_lowercase().as_str() {
                "right" => "r".to_owned(),
                "left" => "l".to_owned(),
                "foot" => "calcn".to_owned(),
                word => word.to_owned(),
            })
            .collect();
        words.sort_unstable();
        words
    }
    let given = words(given);
    names.into_iter().find(|name| words(name) == given)
}

/// "did you mean ..." or the list of all names.
pub(crate) fn suggestion<'a>(given: &str, names: impl IntoIterator<Item = &'a str> + Clone) -> Option<String> {
    match same_words(given, names.clone()).or_else(|| nearest(given, names.clone())) {
        Some(name) => Some(format!("did you mean `{name}`?")),
        None => {
            let all: Vec<&str> = names.into_iter().collect();
            let shown = all.iter().take(40).copied().collect::<Vec<_>>().join(", ");
            let more = if all.len() > 40 { ", ..." } else { "" };
            (!all.is_empty()).then(|| format!("there are: {shown}{more}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::suggestion;

    #[test]
    fn names_with_the_same_words_are_suggested() {
        let names = ["hand_l", "hand_r", "calcn_r", "torso"];
        let suggested = |given| suggestion(given, names);
        assert_eq!(suggested("right_hand").as_deref(), Some("did you mean `hand_r`?"));
        assert_eq!(suggested("Left Hand").as_deref(), Some("did you mean `hand_l`?"));
        assert_eq!(suggested("right_foot").as_deref(), Some("did you mean `calcn_r`?"));
        assert_eq!(suggested("tosro").as_deref(), Some("did you mean `torso`?"));
        assert!(suggested("pelvis").is_some_and(|help| help.starts_with("there are: hand_l")));
    }
}
