//! Describes why a batch was refused.

use crate::joint_torques::JointTorquesError;
use crate::statics::LoadError;

/// The reason for which a batch was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// There is no segment whose placement could be computed.
    #[error("placement of segment number {segment}; the model has {count} segments")]
    Segment {
        /// The index given.
        segment: usize,
        /// Number of segments.
        count: usize,
    },
    /// The table of postures belongs to another model.
    #[error("the table of postures has {given} rows; the model has {needed} coordinates")]
    Rows {
        /// Rows given.
        given: usize,
        /// Coordinates of the model.
        needed: usize,
    },
    /// A load does not fit the model.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A posture does not fit the model, or a passive law gives no torque in it.
    #[error("posture number {posture}: {problem}")]
    Posture {
        /// Number of the posture, counted from 0.
        posture: usize,
        /// The problem.
        problem: JointTorquesError,
    },
}
