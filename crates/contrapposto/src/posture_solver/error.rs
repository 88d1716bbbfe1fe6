//! Names the reasons for which the posture solver refuses its input.

use crate::contact::SupportError;
use crate::joint_torques::JointTorquesError;
use crate::tasks::TaskError;
use hierarchical_least_squares::ProblemError;

/// The reason for which levels, supports, options, posture or loads were refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EngineError {
    /// A task does not fit the model.
    #[error("priority {}: {error}", level + 1)]
    Task {
        /// Level, the first is 0.
        level: usize,
        /// The reason.
        error: TaskError,
    },
    /// A limit does not fit the model.
    #[error("limit: {0}")]
    Limit(TaskError),
    /// A half-space does not fit the model.
    #[error("priority {}: a half-space {problem}", level + 1)]
    HalfSpace {
        /// Level, the first is 0.
        level: usize,
        /// The reason.
        problem: String,
    },
    /// An option without meaning.
    #[error("{what} is {value}; it must be {accepted}")]
    Option {
        /// Name of the option.
        what: &'static str,
        /// Value of the option.
        value: f64,
        /// The accepted values.
        accepted: &'static str,
    },
    /// A support does not fit the model.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// The posture or a load does not fit the model.
    #[error(transparent)]
    Body(#[from] JointTorquesError),
    /// Numbers so large that the rows of a task are not finite.
    #[error("the levels have no finite rows in this posture: {0}")]
    Rows(#[from] ProblemError),
}
