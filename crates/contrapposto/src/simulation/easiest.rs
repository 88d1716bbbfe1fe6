//! Finds the posture of least effort that a body under way can take without a step: what carries it stays as it is.
//!
//! The search is that of [`crate::equilibria`], with every joint locked that moves a support. Its steps count against a budget of
//! the run, so that every machine finds the same.

use serde::{Deserialize, Serialize};

use crate::contact::{Support, rates_that_move};
use crate::equilibria::{Aim, RelaxedPosture, Search, SearchError, equilibria};
use crate::model::Model;
use crate::posture::Posture;
use crate::posture_solver::{self, Options, SolvedPosture};
use crate::statics::Load;
use crate::tasks::{PriorityLevel, Task};

use super::Scenario;

/// Largest change of a rate in a step of the search, rad or m.
const SEARCH_STEP: f64 = 0.1;
/// Most steps of a solve.
const SEARCH_SOLVE_STEPS: usize = 300;
/// Work of the solver ([`crate::posture_solver::Engine::work`]) that all searches of a run may do together: about 25 seconds on one core. Assumed.
pub(super) const SEARCH_BUDGET: usize = 200_000;
/// Work that the searches of one time step, or of the start, may do together, with the ways that they plan: about 5 seconds on one core;
/// twice as much for a start that misses a task. Searches for two feet that may be put elsewhere fit in; with a hand on a counter they end at it,
/// after the step was found.
pub(super) const SEARCH_BUDGET_OF_STEP: usize = 36_000;
/// A posture is worth a motion if its effort is less than this share of the present one.
const WORTH_A_MOTION: f64 = 0.98;
/// A task whose error is greater is out of reach, and a posture in which it is nearer by more is another one, m or rad. Assumed: a tenth of
/// the distance from which on a verdict calls a target missed.
pub(super) const UNREACHED: f64 = 5e-4;
/// A posture that is nearer to a task by more is worth a motion, m or rad. Assumed: the distance from which on a verdict calls a target missed.
pub(super) const WORTH_NEARING: f64 = 5e-3;
/// A posture whose supports are farther off their places is none, m and rad together.
pub(super) const MOST_SLIP: f64 = 1e-5;

/// Change of every rate up to which a posture counts as searched when the one before was, rad or m. Assumed.
const SEARCHED_NEARBY: f64 = 0.02;

/// A posture from which a search has found none that is easier.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Eased {
    pub(super) posture: Posture,
    /// By coordinate: whether a relief was in force.
    pub(super) asked: Vec<bool>,
}

impl Eased {
    /// Whether a search from another posture would be the same one again.
    pub(super) fn is_like(&self, other: &Self, model: &Model) -> bool {
        let mut change = vec![0.0; model.rates().len()];
        self.posture.difference(model, &other.posture, &mut change);
        self.asked == other.asked && change.iter().all(|by| by.abs() <= SEARCHED_NEARBY)
    }
}

/// State of the body at which a search during a run begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Now<'a> {
    pub(super) posture: &'a Posture,
    /// The body, with the strength of its present posture.
    pub(super) model: &'a Model,
    /// All levels, tasks and reliefs.
    pub(super) levels: &'a [PriorityLevel],
    pub(super) loads: &'a [Load],
    pub(super) effort: f64,
    /// The postures that the search is for.
    pub(super) aim: Aim<'a>,
}

/// Amount of work that a search may do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    /// Number of starts that are scattered over the ranges of the joints.
    pub(super) scattered: usize,
    /// Work of the solver ([`Search::most_work`]).
    pub(super) work: usize,
    /// The joints that move a support are locked.
    pub(super) carriers_stay: bool,
}

/// Result of a search, with its work.
#[derive(Clone, Debug, Default)]
pub(super) struct Searched<T> {
    pub(super) found: T,
    /// Local minima that it passed, for later searches of the same body.
    pub(super) minima: Vec<Posture>,
    pub(super) work: usize,
    /// The search ended at its budget.
    pub(super) cut: bool,
}

/// A posture that is nearer to the tasks above effort, whose `errors` are those now, or of less effort and as near, if `budget` shows one.
pub(super) fn easiest(
    scenario: &Scenario,
    now: Now<'_>,
    errors: &[f64],
    (supports, limits): (&[Support], &[Task]),
    budget: Budget,
) -> Result<Searched<Option<Posture>>, SearchError> {
    let mut locked = vec![false; scenario.model.rates().len()];
    if budget.carriers_stay {
        locked = rates_that_move(&scenario.model, supports);
    }
    scenario.locked_rates().for_each(|rate| locked[rate] = true);
    let locked: Vec<usize> = (0..locked.len()).filter(|&rate| locked[rate]).collect();
    let Searched { found, minima, work, cut } = search(scenario, now, (supports, limits), &locked, budget)?;
    let best = found.into_iter().next().map(|best| best.relaxed);
    let better = best.filter(|best| is_better(best, now.effort, errors));
    Ok(Searched { found: better.map(|best| best.posture), minima, work, cut })
}

/// Whether a posture is worth a motion from one with that effort and those errors of the tasks above effort.
pub(super) fn is_better(solved: &SolvedPosture, effort: f64, errors: &[f64]) -> bool {
    let farther = first_difference(solved.levels.iter().map(|level| level.length), errors);
    let easier = solved.effort < WORTH_A_MOTION * effort;
    solved.slip.length() <= MOST_SLIP && (farther < -WORTH_NEARING || easier && farther <= 0.0)
}

/// Difference of the errors of the first task that differ by more than [`UNREACHED`], greater than 0 where it is farther; 0 where none does.
pub(super) fn first_difference(levels: impl Iterator<Item = f64>, errors: &[f64]) -> f64 {
    posture_solver::first_difference(levels, errors.iter().copied(), UNREACHED)
}

/// The postures that a search finds while some rates are `locked`, that of least effort first.
pub(super) fn search(
    scenario: &Scenario,
    now: Now<'_>,
    (supports, limits): (&[Support], &[Task]),
    locked: &[usize],
    budget: Budget,
) -> Result<Searched<Vec<RelaxedPosture>>, SearchError> {
    let goals: Vec<PriorityLevel> = now.levels.iter().filter(|level| level.asks()).cloned().collect();
    let search = Search {
        model: now.model,
        start: now.posture,
        supports,
        limits,
        goals: &goals,
        loads: now.loads,
        locked,
        most_work: budget.work,
        scattered: budget.scattered,
        aim: now.aim,
        threads: scenario.run.threads,
    };
    let options = Options { max_step: SEARCH_STEP, max_steps: SEARCH_SOLVE_STEPS, ..Options::least_effort() };
    let found = equilibria(&search, options)?;
    Ok(Searched { found: found.postures, minima: found.minima, work: found.work, cut: found.cut })
}
