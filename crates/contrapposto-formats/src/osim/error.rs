//! Errors of `.osim` files.

use super::expression::ExpressionError;
use crate::model_ir::SplineError;
use crate::numbers::NumberError;
use crate::xml::{Place, XmlError, shorten, shorten_to};

/// Characters of what is not supported in a message: some words and a name.
const MOST_WHAT: usize = 160;

/// A refused file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct OsimError {
    /// Name of the file.
    pub file: String,
    /// The reason and the place.
    pub problem: Box<OsimProblem>,
}

/// The reason for which a file was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OsimProblem {
    /// No XML, or beyond a cap.
    #[error(transparent)]
    Xml(#[from] XmlError),
    /// A number.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// Something is not there.
    #[error("{place}: {what} is missing")]
    Missing {
        /// Place in the file.
        place: Place,
        /// The kind.
        what: String,
    },
    /// A part of the file matters to torque, and is not supported.
    #[error("{place}: {what} is not supported; accepted: {accepted}")]
    Unsupported {
        /// Place in the file.
        place: Place,
        /// The kind.
        what: String,
        /// The accepted alternatives.
        accepted: &'static str,
    },
    /// A value that has no meaning.
    #[error("{place}: `{value}`: {problem}")]
    Invalid {
        /// Place in the file.
        place: Place,
        /// As written, shortened.
        value: String,
        /// The accepted alternatives.
        problem: String,
    },
    /// A name of something that is not there.
    #[error("{place}: there is no {what} `{name}`{}", did_you_mean(near))]
    Unknown {
        /// Place in the file.
        place: Place,
        /// Kind of thing.
        what: &'static str,
        /// The name, shortened.
        name: String,
        /// A similar name that is there.
        near: Option<String>,
    },
    /// Two things of one name.
    #[error("{place}: a second {what} `{name}`; names must be unique")]
    Twice {
        /// Place in the file.
        place: Place,
        /// Kind of thing.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// Points of a function.
    #[error("{place}: {problem}")]
    Spline {
        /// Place in the file.
        place: Place,
        /// The reason.
        problem: SplineError,
    },
    /// A formula; its columns count inside the formula.
    #[error("{place}, in the expression, {problem}")]
    Expression {
        /// Place in the file.
        place: Place,
        /// The reason.
        problem: ExpressionError,
    },
    /// Too many of something.
    #[error("{place}: more than {cap} {what}")]
    TooMany {
        /// Place in the file.
        place: Place,
        /// Kind of thing.
        what: &'static str,
        /// The cap.
        cap: usize,
    },
}

fn did_you_mean(near: &Option<String>) -> String {
    near.as_ref().map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

impl OsimProblem {
    pub(super) fn unsupported(place: Place, what: &str, accepted: &'static str) -> Self {
        Self::Unsupported { place, what: shorten_to(what, MOST_WHAT), accepted }
    }

    pub(super) fn invalid(place: Place, value: &str, problem: impl Into<String>) -> Self {
        Self::Invalid { place, value: shorten(value), problem: problem.into() }
    }
}
