//! Turns refusals into sentences with file, line and column.

use contrapposto_formats::InputError;
use miette::Diagnostic;

/// The reason for which a request was refused: a sentence for the reader of the page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refusal(pub(crate) String);

impl Refusal {
    /// Of anything that explains itself.
    pub(crate) fn of(error: impl std::fmt::Display) -> Self {
        Self(error.to_string())
    }
}

impl From<InputError> for Refusal {
    fn from(error: InputError) -> Self {
        let label = error.labels().and_then(|mut labels| labels.next());
        let place = label.as_ref().zip(error.source_code()).and_then(|(label, source)| {
            let contents = source.read_span(label.inner(), 0, 0).ok()?;
            let file = contents.name().unwrap_or_default();
            Some(format!("{file}, line {}, column {}: ", contents.line() + 1, contents.column() + 1))
        });
        let told = label.as_ref().and_then(|label| label.label()).filter(|label| !label.is_empty());
        let message = told.map_or_else(|| error.to_string(), |told| format!("{error}: {told}"));
        let help = error.help().map_or(String::new(), |help| format!(" ({help})"));
        Self(format!("{}{message}{help}", place.unwrap_or_default()))
    }
}
