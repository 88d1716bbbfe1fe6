//! Turns a goal angle into a constraint on the posture: Eqs. 4-6 and 9 of Rodriguez & Boulic 2007.

mod half_space;
mod relief;

pub use half_space::HalfSpace;
pub use relief::relief_step;
