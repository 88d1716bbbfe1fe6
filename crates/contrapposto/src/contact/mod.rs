//! Defines the supports that carry the body, and computes their forces.
//!
//! A [`Support`] is a patch of a segment on a plane: its corners can push, and resist sliding up to the friction limit.
//! [`ContactForces`] finds the forces at all corners that keep the root in equilibrium and, of these, those of least muscular effort.

mod edge;
mod forces;
mod missing;
mod rows;
mod slip;
mod support;

pub use forces::{Balance, ContactForces};
pub use missing::{Condition, Missing};
pub(crate) use rows::{Unknowns, bounds, friction_rows, share_row};
pub use slip::Slip;
pub(crate) use support::rates_that_move;
pub use support::{FACES, Place, Region, Support, SupportError, root_rates};
