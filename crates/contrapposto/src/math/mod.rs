//! Numerical ground floor: root finding and monotone curves. Knows nothing of bodies.

mod dichotomy;
mod monotone_cubic;

pub use dichotomy::{dichotomy, dichotomy_between};
pub use monotone_cubic::{MonotoneCubic, Piece};
