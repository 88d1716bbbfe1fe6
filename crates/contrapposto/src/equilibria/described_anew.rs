//! Describes a posture anew by the strength and the passive torque that its body has now.

use super::description::describe;
use super::outcome::RelaxedPosture;
use super::search::{Search, SearchError, Stage};
use super::solvers::Solvers;
use crate::posture_solver::{Options, Reason, SolvedPosture};

/// Describes a posture that a search has found anew, on the body of another search: its strength or passive torque may have changed since. The body does
/// not move; tasks and supports count from the start of `search`.
///
/// # Errors
/// [`SearchError`] when something does not fit the model.
pub fn described_anew(
    search: &Search<'_>,
    options: Options,
    known: &RelaxedPosture,
) -> Result<RelaxedPosture, SearchError> {
    let mut solvers = Solvers::new(search, options)?;
    let slot = solvers.slot;
    let engine = solvers.engine(Stage::Converged);
    let SolvedPosture { posture, reason, steps, .. } = &known.relaxed;
    let mut relaxed = engine.describe(posture.clone(), *reason != Reason::StepLimit, *steps)?;
    relaxed.levels.remove(slot);
    describe(search, engine, relaxed, known.starts.clone())
}
