//! Names the reasons for which speeds and accelerations of a motion are not known.

use crate::math::SplineError;
use crate::posture::PostureError;

/// The reason for which speeds and accelerations of a motion are not known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// Too few postures.
    #[error("{found} frames; accelerations need at least {needed}")]
    TooFew {
        /// Number of frames.
        found: usize,
        /// Least number of frames.
        needed: usize,
    },
    /// Times do not rise.
    #[error("frame {index} is at {time} s, not after the one before; accelerations need times that rise")]
    Order {
        /// Number of the frame, counted from 0.
        index: usize,
        /// Time of the frame, s.
        time: f64,
    },
    /// Two frames are much nearer than the others.
    #[error("two frames are {shortest} s apart, and {average} s on average; a filter needs frames about as far apart")]
    Uneven {
        /// Shortest step, s.
        shortest: f64,
        /// Average step, s.
        average: f64,
    },
    /// The cut-off is no frequency that the samples have.
    #[error("a cut-off of {cutoff} Hz: it must be above 0 and below half of the {sampling:.6} frames a second")]
    Cutoff {
        /// The cut-off, Hz.
        cutoff: f64,
        /// Frames a second.
        sampling: f64,
    },
    /// A rotation turns too far between two frames.
    #[error(
        "the rotation that begins with `{coordinate}` turns too far between frames near {time} s to be differentiated"
    )]
    Turn {
        /// First component of its quaternion.
        coordinate: String,
        /// Time, s.
        time: f64,
    },
    /// A posture does not fit the model.
    #[error("frame {index}: {error}")]
    Posture {
        /// Number of the frame, counted from 0.
        index: usize,
        /// The reason.
        error: PostureError,
    },
    /// No rotation moves, or there are too few cut-offs below half of the frame rate.
    #[error("residual analysis suggests no cut-off: it needs rotations that move, and 12 frames a second or more")]
    NoCutoff,
    /// No spline.
    #[error(transparent)]
    Spline(#[from] SplineError),
}
