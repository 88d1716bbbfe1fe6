//! Tries changes of a job, and tells for how long each lets the job go on.
//!
//! A change ([`Change`]) is one that a person can make: a target 10 cm higher, lower or nearer, a fifth less load, the other foot ahead,
//! the other strategy, a break of a minute every ten minutes. A changed scenario is run like any other, from its start until a muscle
//! group fails or the asked time is over (`trial.rs`), so that its run on its own gives the same time. A break is not run: while it
//! lasts no group has a load, and the loads between breaks are those of the run without them.

mod breaks;
mod change;
mod trial;

pub use breaks::{BREAK, BREAK_EVERY, with_breaks};
pub use change::{Change, changes};
pub use trial::{Suggestion, suggestion};
