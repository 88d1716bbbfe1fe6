//! Says why a C3D file cannot be read, and where.

/// The reason for which a C3D file cannot be read, its place, and the accepted alternative.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}: byte {byte}: {message}; {accepted}")]
pub struct C3dError {
    file: String,
    /// Place in the file, counted from 0.
    byte: usize,
    message: String,
    accepted: String,
}

impl C3dError {
    /// The reason `message` at a byte; `accepted` says what is right there.
    pub(super) fn at(byte: usize, message: impl Into<String>, accepted: impl Into<String>) -> Self {
        Self { file: String::new(), byte, message: message.into(), accepted: accepted.into() }
    }

    /// The same reason with the name of its file.
    pub(super) fn of(self, file: &str) -> Self {
        Self { file: file.to_owned(), ..self }
    }
}
