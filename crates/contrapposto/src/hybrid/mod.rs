//! Finds the angle at which a tired joint carries its load with less active torque.
//!
//! The hybrid minimisation of Rodriguez & Boulic 2007: the passive curve is known over the whole range, the external torque
//! only by its present value and slope, so it is extrapolated as a straight line. [`minimise`] is total: every problem has
//! an outcome. [`minimise_literal`] follows the printed Tables 1 and 2 to the letter, gaps included. `minimise.rs` is meant
//! to be read beside the paper.

mod case;
mod explain;
mod extrapolation;
mod interval;
mod minimise;
mod problem;

pub use case::{Carrier, Case, Decision, Equilibrium, Outcome, Strategy};
pub use explain::{explain, goal_in_words};
pub use extrapolation::Extrapolation;
pub use minimise::{minimise, minimise_literal};
pub use problem::{Problem, ProblemError};
