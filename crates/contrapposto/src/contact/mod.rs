//! What carries the body, and with which forces?
//!
//! A [`Support`] is a patch of a segment on a plane: corners that can push, and rub as far as friction goes. [`ContactForces`]
//! finds the forces at all corners that keep the root in equilibrium and, of these, the ones that spare the muscles most.

mod forces;
mod missing;
mod support;

pub use forces::{Balance, ContactForces};
pub(crate) use forces::{Unknowns, bounds, friction_rows, share_row};
pub use missing::{Condition, Missing};
pub use support::{FACES, Support, SupportError, root_rates};
