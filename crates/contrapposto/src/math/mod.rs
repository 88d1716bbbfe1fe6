//! Numerical ground floor: root finding, monotone curves, functions of one variable, filters and splines of samples,
//! angles of a rotation, closest points, linear programs, the normal
//! distribution, a sequence of random numbers. Knows nothing of bodies.

mod closest_points;
mod dichotomy;
pub mod expression;
mod function;
mod jet;
mod linear_program;
mod lowpass;
mod monotone_cubic;
pub mod normal;
mod quintic_spline;
mod random;
mod swing_twist;

pub use closest_points::{closest_on_segments, closest_to_block};
pub use dichotomy::{dichotomy, dichotomy_between};
pub use function::{Function, Spline, SplineError};
pub(crate) use linear_program::{LinearProgram, Optimum};
pub use lowpass::{Lowpass, reflected};
pub use monotone_cubic::{MonotoneCubic, Piece};
pub use quintic_spline::{LEAST_POINTS, QuinticBasis, QuinticSpline};
pub(crate) use random::next_number;
pub use swing_twist::{Angles, SwingTwist};
