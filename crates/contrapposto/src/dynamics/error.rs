//! Names the reasons for which speeds and accelerations of a motion are not known.

use crate::math::SplineError;
use crate::posture::PostureError;

/// The reason for which speeds and accelerations of a motion are not known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// Too few postures.
    #[error("{found} instants; accelerations need at least {needed}")]
    TooFew {
        /// Number of instants.
        found: usize,
        /// Least number of instants.
        needed: usize,
    },
    /// Times do not rise.
    #[error("instant {index} is at {time} s, not after the one before; accelerations need times that rise")]
    Order {
        /// Number of the instant, counted from 0.
        index: usize,
        /// Time of the instant, s.
        time: f64,
    },
    /// Two instants are much nearer than the others.
    #[error(
        "two instants are {shortest} s apart, and {average} s on average; a filter needs instants about as far apart"
    )]
    Uneven {
        /// Shortest step, s.
        shortest: f64,
        /// Average step, s.
        average: f64,
    },
    /// The cut-off is no frequency that the samples have.
    #[error("a cut-off of {cutoff} Hz: it must be above 0 and below half of the {sampling:.6} instants a second")]
    Cutoff {
        /// The cut-off, Hz.
        cutoff: f64,
        /// Instants a second.
        sampling: f64,
    },
    /// A rotation turns too far between two instants.
    #[error(
        "the rotation that begins with `{coordinate}` turns too far between instants near {time} s to be differentiated"
    )]
    Turn {
        /// First component of its quaternion.
        coordinate: String,
        /// Time, s.
        time: f64,
    },
    /// A posture does not fit the model.
    #[error("instant {index}: {error}")]
    Posture {
        /// Number of the instant, counted from 0.
        index: usize,
        /// The reason.
        error: PostureError,
    },
    /// No rotation moves, or there are too few cut-offs below half of the sampling rate.
    #[error("residual analysis suggests no cut-off: it needs rotations that move, and 12 instants a second or more")]
    NoCutoff,
    /// No spline.
    #[error(transparent)]
    Spline(#[from] SplineError),
}
