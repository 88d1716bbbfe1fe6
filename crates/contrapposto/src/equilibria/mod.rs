//! Searches for the different postures of least effort under supports and tasks, and computes their stability.

mod equilibria;
mod finder;
mod mirror;
mod stability;

pub use equilibria::{
    Carried, Equilibria, Hanging, ROUNDS, RelaxedPosture, SAME, SCOUT, SINGLE, Search, SearchError, Work, equilibria,
};
pub use mirror::Mirror;
pub use stability::{Direction, LEAST_MASS, Stability, stability, stiffness};
