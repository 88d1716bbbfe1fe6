//! Numerical ground floor: root finding, monotone curves, functions of one variable. Knows nothing of bodies.

mod dichotomy;
pub mod expression;
mod function;
mod monotone_cubic;

pub use dichotomy::{dichotomy, dichotomy_between};
pub use function::{Function, Spline, SplineError};
pub use monotone_cubic::{MonotoneCubic, Piece};
