//! Tries changes of a job, and computes how long each lets the job go on.
//!
//! A change ([`Change`]) is one that a person can make: a target 10 cm higher, lower or nearer, a fifth less load, the other foot ahead,
//! the other strategy, a break of a minute every ten minutes; two at once where no single one suffices. A changed scenario is run like any other, from its start until a muscle
//! group fails or the asked time is over (`trial.rs`), so that its run on its own gives the same time; a changed search of postures of
//! least effort is searched like any other. A break is not run: while it lasts no group has a load, and the loads between breaks are
//! those of the run without them.
//!
//! Trials end with a budget of solver steps (`budget.rs`), which every machine and any number of threads use up alike; the changes of most
//! promise come first (`promise.rs`), and those that were not tried are named ([`Advice`]).
//!
//! The largest load of a job is searched for on request ([`LargestLoad`]).

mod advice;
mod breaks;
mod budget;
mod change;
mod gain;
mod job;
mod largest;
mod promise;
mod resting_hand;
mod trial;
mod words;

pub use advice::Advice;
pub use breaks::{BREAK, BREAK_EVERY, Worked, with_breaks, with_breaks_in_repeats};
pub use budget::{BUDGET_FACTOR, Budget, LEAST_BUDGET, Trial};
pub use change::{Change, JointAngle, changes};
pub use gain::Gains;
pub use job::Job;
pub use largest::LargestLoad;
pub use promise::{by_promise, by_promise_of_search};
pub use resting_hand::RestingHand;
pub use trial::{Suggestion, try_run, try_search};
