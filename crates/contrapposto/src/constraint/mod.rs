//! How does a goal angle become a rule that a posture must keep? Eqs. 4-6 and 9 of Rodriguez & Boulic 2007.

mod half_space;
mod relief;

pub use half_space::HalfSpace;
pub use relief::relief_step;
