//! Which posture needs little effort, with feet on the ground and hands where they should be?
//!
//! Posture and contact forces are found together. Each step of the [`Engine`] is one lexicographic problem in the changes of
//! both: friction and equilibrium of the root first, then supports stay where they are, then no support carries more than it
//! should, then the goals in their order, of which one may be effort. After every step the contact forces are found anew for
//! the posture reached ([`crate::contact`]), so that what is reported is in equilibrium exactly.

mod descent;
mod engine;
mod equilibria;
mod finder;
#[cfg(test)]
mod ground;
mod hessian;
mod limbs;
mod mirror;
mod outcome;
mod probe;
mod quadratic;
mod site;
mod stability;
mod symmetric;
mod valleys;
mod weld;

pub use engine::Engine;
pub use equilibria::{
    Carried, Equilibria, Hanging, ROUNDS, RelaxedPosture, SAME, SCOUT, SINGLE, Search, SearchError, Work, equilibria,
};
pub use mirror::Mirror;
pub use outcome::{Options, Reason, RelaxError, Relaxed, Step};
pub use stability::{Direction, LEAST_MASS, Stability, stability, stiffness};
