//! Names the reasons for which a motion is not assessed.

use crate::contact::SupportError;
use crate::dynamics::InertiaError;
use crate::joint_torques::JointTorquesError;

/// The reason for which a motion was not assessed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AssessError {
    /// A support does not fit the model.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// A posture or a load does not fit the model, or a passive law gives no torque.
    #[error("instant {index}: {error}")]
    Torques {
        /// Number of the instant, counted from 0.
        index: usize,
        /// The reason.
        error: JointTorquesError,
    },
    /// Speeds or accelerations do not fit the model.
    #[error("instant {index}: {error}")]
    Inertia {
        /// Number of the instant, counted from 0.
        index: usize,
        /// The reason.
        error: InertiaError,
    },
    /// There are not as many rates as postures.
    #[error("speeds and accelerations of {given} instants are given; the motion has {needed}")]
    Rates {
        /// Number given.
        given: usize,
        /// Number of postures.
        needed: usize,
    },
    /// Times fall, or are no numbers.
    #[error("instant {index} is at {time} s; times must be finite and not fall")]
    Order {
        /// Number of the instant.
        index: usize,
        /// Time of the instant, s.
        time: f64,
    },
    /// The motion lasts for days.
    #[error("the motion lasts {0} s; 1e5 s at most")]
    TooLong(f64),
    /// A cycle is repeated faster than it lasts, or not once in the time of the job or between two breaks; or times are no numbers.
    #[error(
        "a cycle of {cycle} s every {every} s does not fit into {room} s: a cycle lasts more than 0 s, as long as `every` at most, and that as long as the job and the work between breaks at most"
    )]
    Repetition {
        /// Length of the motion, s.
        cycle: f64,
        /// Time from one start to the next, s.
        every: f64,
        /// Length of the job, or of the work between breaks where that is shorter, s.
        room: f64,
    },
}
