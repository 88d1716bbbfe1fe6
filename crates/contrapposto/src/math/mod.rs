//! Numerical ground floor: root finding, monotone curves, functions of one variable, angles of a rotation, closest
//! points, linear programs. Knows nothing of bodies.

mod closest_points;
mod dichotomy;
pub mod expression;
mod function;
mod jet;
mod linear_program;
mod monotone_cubic;
mod swing_twist;

pub use closest_points::{closest_on_segments, closest_to_block};
pub use dichotomy::{dichotomy, dichotomy_between};
pub use function::{Function, Spline, SplineError};
pub(crate) use linear_program::{LinearProgram, Optimum};
pub use monotone_cubic::{MonotoneCubic, Piece};
pub use swing_twist::{Angles, SwingTwist};
