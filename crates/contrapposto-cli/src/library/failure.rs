//! Holds the reason why a job was refused or failed, and the notes about it, as values.

use contrapposto_formats::InputError;
use miette::Diagnostic;

use crate::fail::Fail;
use crate::output::keep_notes;

/// A place in an input file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Name of the file.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column, counted from 1.
    pub column: usize,
}

/// The reason for which a job has no result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// The reason, with the thing, its value, unit and limit.
    pub message: String,
    /// The input is at fault; otherwise the job failed.
    pub refused: bool,
    /// Place of the error in a file, where it has one.
    pub place: Option<Place>,
    /// The accepted alternative, where there is one.
    pub help: Option<String>,
}

impl Failure {
    /// A refused input without a place.
    pub fn refused(message: impl Into<String>) -> Self {
        Self { message: message.into(), refused: true, place: None, help: None }
    }

    /// A job that failed.
    pub fn failed(message: impl Into<String>) -> Self {
        Self { refused: false, ..Self::refused(message) }
    }
}

impl From<Fail> for Failure {
    fn from(fail: Fail) -> Self {
        match fail {
            Fail::Input(error) => Self::from(*error),
            Fail::Refused(message) => Self::refused(message),
            Fail::Job(message) => Self::failed(message),
            Fail::Answered | Fail::Told | Fail::BrokenPipe => Self::failed("the job has no result"),
        }
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        let label = error.labels().and_then(|mut labels| labels.next());
        let place = label.as_ref().zip(error.source_code()).and_then(|(label, source)| {
            let contents = source.read_span(label.inner(), 0, 0).ok()?;
            let file = contents.name().unwrap_or_default().to_owned();
            Some(Place { file, line: contents.line() + 1, column: contents.column() + 1 })
        });
        let label = label.as_ref().and_then(|label| label.label()).filter(|label| !label.is_empty());
        let message = label.map_or_else(|| error.to_string(), |label| format!("{error}: {label}"));
        let help = error.help().map(|help| help.to_string());
        Self { place, help, ..Self::refused(message) }
    }
}

/// A message that is no failure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// `note` or `warning`.
    pub kind: String,
    /// A sentence.
    pub text: String,
}

/// Carries out a job of the program and keeps its notes instead of printing them.
pub(super) fn with_notes<T>(job: impl FnOnce() -> Result<T, Fail>) -> Result<(T, Vec<Note>), Failure> {
    let (result, notes) = keep_notes(job);
    Ok((result?, notes.into_iter().map(|(kind, text)| Note { kind, text }).collect()))
}
