//! Checks that tasks share, and the error of a task that does not fit the model.

use nalgebra::Vector3;

use crate::model::{LARGEST, Model};
use crate::posture::PostureError;

/// Why a task was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TaskError {
    /// There is no such segment or coordinate.
    #[error("{task} task: {what} number {index}; the model has {count}")]
    Index {
        /// Kind of the task.
        task: &'static str,
        /// Segment or coordinate.
        what: &'static str,
        /// The index given.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A number without meaning.
    #[error("{task} task: {what} is {value}; it must be {accepted}")]
    Number {
        /// Kind of the task.
        task: &'static str,
        /// The quantity with its unit.
        what: &'static str,
        /// The value.
        value: f64,
        /// Accepted values.
        accepted: &'static str,
    },
    /// The task asks for nothing.
    #[error("{task} task: it asks for no {what}; it must ask for one at least")]
    Empty {
        /// Kind of the task.
        task: &'static str,
        /// The thing of which there should be one.
        what: &'static str,
    },
    /// A list has another length than the model needs.
    #[error("{task} task: {given} {what}; the model needs {needed}")]
    Length {
        /// Kind of the task.
        task: &'static str,
        /// The contents of the list.
        what: &'static str,
        /// Its length.
        given: usize,
        /// The length it must have.
        needed: usize,
    },
    /// The wanted posture does not fit the model.
    #[error("posture task: {0}")]
    Posture(#[from] PostureError),
    /// The body cannot carry out the task.
    #[error("{task} task: `{name}` {problem}")]
    Unable {
        /// Kind of the task.
        task: &'static str,
        /// Coordinate, rate or model.
        name: String,
        /// Why not.
        problem: &'static str,
    },
}

/// A task of this kind is checked against this model.
pub(super) struct Check<'a> {
    pub(super) task: &'static str,
    pub(super) model: &'a Model,
}

impl Check<'_> {
    pub(super) fn segment(&self, index: usize) -> Result<(), TaskError> {
        let count = self.model.segments().len();
        if index < count { Ok(()) } else { Err(TaskError::Index { task: self.task, what: "segment", index, count }) }
    }

    pub(super) fn number(&self, what: &'static str, value: f64) -> Result<(), TaskError> {
        if value.abs() <= LARGEST { Ok(()) } else { self.refuse(what, value, "finite and at most 1e9 in size") }
    }

    pub(super) fn vector(&self, what: &'static str, v: &Vector3<f64>) -> Result<(), TaskError> {
        v.iter().try_for_each(|&value| self.number(what, value))
    }

    /// Lengths that must be one.
    pub(super) fn unit(&self, what: &'static str, length: f64) -> Result<(), TaskError> {
        if (length - 1.0).abs() <= 1e-6 { Ok(()) } else { self.refuse(what, length, "1") }
    }

    pub(super) fn some(&self, what: &'static str, any: bool) -> Result<(), TaskError> {
        if any { Ok(()) } else { Err(TaskError::Empty { task: self.task, what }) }
    }

    pub(super) fn refuse(&self, what: &'static str, value: f64, accepted: &'static str) -> Result<(), TaskError> {
        Err(TaskError::Number { task: self.task, what, value, accepted })
    }

    pub(super) fn unable(&self, name: &str, problem: &'static str) -> Result<(), TaskError> {
        Err(TaskError::Unable { task: self.task, name: name.to_owned(), problem })
    }
}
