//! What is wrong with an input file, where, and what would be right?

use miette::{Diagnostic, NamedSource, SourceSpan};

/// A refused input. Prints with file, line, column and a caret when shown through `miette`.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{message}")]
pub struct InputError {
    message: String,
    #[source_code]
    source_code: NamedSource<String>,
    #[label("{label}")]
    span: Option<SourceSpan>,
    label: String,
    #[help]
    help: Option<String>,
}

/// An input text and its name, to complain about.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    pub(crate) name: &'a str,
    pub(crate) text: &'a str,
}

impl Source<'_> {
    /// A complaint about `span` (bytes), or about the whole file.
    pub(crate) fn error(
        &self,
        span: Option<std::ops::Range<usize>>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: Option<String>,
    ) -> InputError {
        InputError {
            message: message.into(),
            source_code: NamedSource::new(self.name, self.text.to_owned()),
            span: span.map(|range| SourceSpan::from((range.start, range.end - range.start))),
            label: label.into(),
            help,
        }
    }
}

/// UTF-8 text of an input file.
///
/// # Errors
/// [`InputError`] with line and column of the first byte that is not UTF-8.
pub fn utf8<'a>(name: &str, bytes: &'a [u8]) -> Result<&'a str, InputError> {
    std::str::from_utf8(bytes).map_err(|error| {
        let good = String::from_utf8_lossy(&bytes[..error.valid_up_to()]).into_owned();
        let byte = bytes[error.valid_up_to()];
        let at = good.len();
        let text = good + "?";
        let help = Some("save the file as UTF-8".to_owned());
        Source { name, text: &text }.error(Some(at..at + 1), "the file is not UTF-8", format!("byte 0x{byte:02x}"), help)
    })
}

/// The one of `names` that `given` was probably meant to be.
pub fn nearest<'a>(given: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    names
        .into_iter()
        .map(|name| (strsim::damerau_levenshtein(given, name), name))
        .filter(|(distance, name)| *distance <= 1 + name.len() / 4)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// "did you mean ..." or the list of what there is.
pub(crate) fn suggestion<'a>(given: &str, names: impl IntoIterator<Item = &'a str> + Clone) -> Option<String> {
    match nearest(given, names.clone()) {
        Some(name) => Some(format!("did you mean `{name}`?")),
        None => {
            let all: Vec<&str> = names.into_iter().collect();
            let shown = all.iter().take(40).copied().collect::<Vec<_>>().join(", ");
            let more = if all.len() > 40 { ", ..." } else { "" };
            (!all.is_empty()).then(|| format!("there are: {shown}{more}"))
        }
    }
}
