//! Searches for the different postures of least effort under supports and tasks, and computes their stability.
//!
//! Effort has many local minima; the one that [`Engine`](crate::posture_solver::Engine) finds depends on its start. The starts are
//! given by the body, the tables of the paper, and a fixed sequence of numbers (`finder.rs`):
//!
//! 1. the start of the scenario, moved to its tasks first,
//!    the same with the limbs that carry nothing hanging, and with each free support put elsewhere in its region;
//! 2. from the posture found there: [`minimise`](crate::hybrid::minimise) gives every coordinate its active and its passive goal
//!    angle, with the slope along the motion that supports and tasks leave it. All active goals together, all passive goals
//!    together, and those of the coordinates with the largest relative loads one by one, are half-spaces below the tasks and above
//!    effort; exploratory steps follow with and then without them. Active goals lie where passive curves are flat, passive ones
//!    near the ends of ranges, where ligaments carry;
//! 3. the same from the posture of least effort so far, if that is a new one;
//! 4. postures scattered over the ranges of the joints (`scattered.rs`), moved to the tasks likewise;
//! 5. the mirror image of every posture found, where the body has one ([`Mirror`]), moved to the tasks likewise; limbs that have other roles than
//!    their partners, as a hand that works beside one that rests, keep their angles in it (`mirror_starts.rs`).
//!
//! The posture to which a start leads depends on nothing that was solved before (`solvers.rs`). So several threads may solve starts
//! ([`Search::threads`]); their postures are taken in the order of the starts.
//!
//! A search for the posture of least effort alone ([`Aim::Least`]) may be given local minima of an earlier search of the same body; they stand
//! in for 3 to 5 and for single goals.
//!
//! From every different posture that does not need far more effort than the easiest one a descent leads near its local minimum; from those of
//! least effort basin hopping seeks lower ones, and of the others, where all ways to stand are wanted, each is followed to its end, that of least
//! effort first, until as many ways to stand as an answer has take no more effort than the next one. Two postures count as one if at no joint the torque of loads or of
//! passive tissue differs by more than a twentieth of the strength there and no segment is elsewhere: minima can be flat, a forearm
//! may rotate without load on a muscle. Of those the one of least effort is kept. A limb without a task that hangs in the start is not held up: postures
//! with fewer such limbs come first, whatever their efforts (`raised_limbs.rs`). Postures whose tasks are farther away than in the best one, that slipped or
//! fell, are counted and left out, and so are those that are the same way to stand as a better one (`different_ways.rs`), or need more than
//! twice the least effort and 0.05 besides.

mod candidate;
mod described_anew;
mod description;
mod different_ways;
mod finder;
mod goal_starts;
mod hanging_limbs;
mod mirror;
mod mirror_starts;
mod other_places;
mod outcome;
mod raised_limbs;
mod scattered;
mod search;
mod settle;
mod solvers;
mod stability;
mod way_to_stand;

pub use described_anew::described_anew;
pub use finder::equilibria_watched;
pub use mirror::Mirror;
pub use outcome::{Carried, Equilibria, Hanging, RelaxedPosture, Work};
pub use scattered::SCATTERED_STARTS;
pub use search::{Aim, Search, SearchError};
pub use stability::{Direction, LEAST_MASS, Stability, stability, stiffness};

use crate::posture_solver::Options;

/// Finds the different postures of least effort. `options` are those of the converging solves.
///
/// # Errors
/// [`SearchError`] when something does not fit the model, or the body cannot stand.
pub fn equilibria(search: &Search<'_>, options: Options) -> Result<Equilibria, SearchError> {
    equilibria_watched(search, options, &mut |_| ())
}
