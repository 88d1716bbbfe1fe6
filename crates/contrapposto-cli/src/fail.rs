//! Failures, as the user reads them and as the exit code tells them to the shell.

use std::fmt::Display;
use std::io::Write;

use contrapposto_formats::markers::MarkerFileError;
use contrapposto_formats::{InputError, escaped_lines};

/// The reason for which the program stops.
pub(crate) enum Fail {
    /// The input is at fault: exit code 2, with file, line and column.
    Input(Box<InputError>),
    /// The input is at fault, no place to point at: exit code 2.
    Refused(String),
    /// The job failed: exit code 1.
    Job(String),
    /// The answer, already printed, is that the job cannot be done: exit code 1.
    Answered,
    /// Complaints were already printed: exit code 2.
    Told,
    /// The reader of our output went away: no failure.
    BrokenPipe,
}

impl Fail {
    /// A failure of the job at `what`.
    pub(crate) fn job(what: impl Display, error: impl Display) -> Self {
        Self::Job(format!("{what}: {error}"))
    }

    /// Tells standard error, and the shell by the exit code.
    pub(crate) fn report(self) -> u8 {
        let (text, code) = match self {
            Self::Input(error) => (format!("{:?}", miette::Report::new(*error)), 2),
            Self::Refused(message) => (format!("error: {}\n", escaped_lines(&message)), 2),
            Self::Job(message) => (format!("error: {}\n", escaped_lines(&message)), 1),
            Self::Answered => (String::new(), 1),
            Self::Told => (String::new(), 2),
            Self::BrokenPipe => return 0,
        };
        // Nothing is left to try when standard error is closed, too.
        let _ = std::io::stderr().write_all(text.as_bytes());
        code
    }
}

impl From<MarkerFileError> for Fail {
    fn from(error: MarkerFileError) -> Self {
        match error {
            MarkerFileError::Trc(error) => error.into(),
            MarkerFileError::C3d(error) => Self::Refused(error.to_string()),
        }
    }
}

impl From<InputError> for Fail {
    fn from(error: InputError) -> Self {
        Self::Input(Box::new(error))
    }
}
