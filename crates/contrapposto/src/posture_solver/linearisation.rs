//! Writes the problem of one step: rows of all levels, and bounds of the step.
//!
//! Unknown are the changes of all rates and, on supports, of all contact forces. In strict order of priority: friction
//! and equilibrium of the root, places of the supports, limits, greatest shares of the supports, then the caller's levels. A
//! row is `lower - value <= J step <= upper - value` ([`crate::tasks`]).

use super::iterate::Iterate;
use super::settings::Settings;
use crate::contact::{Unknowns, bounds, friction_rows, share_row};
use crate::effort::problem::fill_force_columns;
use crate::tasks::{PriorityLevel, Task};
use hierarchical_least_squares::{Level, Problem, Solver};

/// Level of the supports' shares.
pub(super) const SHARES: usize = 3;

/// The linearised problem at the iterate, with space that is kept.
#[derive(Clone, Debug)]
pub(super) struct Linearisation {
    pub(super) problem: Problem,
    /// Length of the error of each of the caller's levels.
    pub(super) lengths: Vec<f64>,
    /// Rows over the rates only.
    by_rates: Level,
    row: Vec<f64>,
}

impl Linearisation {
    /// Space for the levels of `settings` and as many contact forces; a Newton level has a row for each unknown.
    pub(super) fn new(settings: &Settings<'_>, forces: usize) -> Self {
        let unknowns = settings.model.rates().len() + forces;
        let mut problem = Problem::new(unknowns);
        problem.levels.resize(settings.first_level(), Level::default());
        let space = |level: &PriorityLevel| Level::with_capacity(level.rows().max(unknowns) + 3, unknowns);
        problem.levels.extend(settings.levels.iter().map(space));
        let lengths = vec![f64::INFINITY; settings.levels.len()];
        Self { problem, lengths, by_rates: Level::default(), row: vec![0.0; unknowns] }
    }

    /// A solver with space for this problem.
    pub(super) fn new_solver(&self) -> Solver {
        let unknowns = self.problem.unknowns();
        let rows = self.problem.levels.iter().map(|level| level.lower.capacity());
        let most = rows.clone().max().unwrap_or(unknowns);
        Solver::with_capacity(unknowns, self.problem.levels.len(), most, rows.sum())
    }

    /// Writes the rows of all levels.
    pub(super) fn write(&mut self, settings: &Settings<'_>, iterate: &Iterate) {
        self.write_above(settings, iterate, settings.levels.len());
    }

    /// Writes the rows of the caller's first `count` levels and of all before them; the others have none.
    pub(super) fn write_above(&mut self, settings: &Settings<'_>, iterate: &Iterate, count: usize) {
        self.problem.levels.iter_mut().for_each(Level::clear);
        let first = settings.first_level();
        if let Some(placements) = &settings.placements {
            self.write_contact_rows(settings, iterate);
            self.write_level(settings, iterate, placements, 1);
            self.write_level(settings, iterate, &settings.limits, 2);
        }
        for (k, level) in settings.levels[..count].iter().enumerate() {
            self.write_level(settings, iterate, level, first + k);
            let missing = missing(&self.problem.levels[first + k]);
            self.lengths[k] = missing.map(|m| m * m).sum::<f64>().sqrt();
        }
    }

    fn write_level(&mut self, settings: &Settings<'_>, iterate: &Iterate, level: &PriorityLevel, k: usize) {
        let model = &settings.model;
        let to = &mut self.problem.levels[k];
        to.hard = level.hard;
        for task in &level.tasks {
            if iterate.contact.forces().is_empty() {
                task.evaluate(model, &iterate.torques, to);
            } else {
                self.by_rates.clear();
                task.evaluate(model, &iterate.torques, &mut self.by_rates);
                append_forces(settings, iterate, task, &self.by_rates, &mut self.row, to);
            }
        }
        for space in &level.half_spaces {
            self.row.fill(0.0);
            for (rate, entry) in model.rates().iter().zip(&mut self.row) {
                *entry = rate.coordinate.map_or(0.0, |c| space.normal[c]);
            }
            let excess = space.violation(iterate.torques.posture().values());
            to.push(&self.row, f64::NEG_INFINITY, -excess);
        }
    }

    /// Friction and equilibrium of the root; shares.
    fn write_contact_rows(&mut self, settings: &Settings<'_>, iterate: &Iterate) {
        let rates = settings.model.rates().len();
        let Iterate { contact, torques, .. } = iterate;
        let unknowns = Unknowns { first: rates, now: Some(contact.forces()) };
        for (i, support) in contact.supports().iter().enumerate() {
            let corners = contact.corners(i);
            friction_rows(&mut self.problem.levels[0], &mut self.row, support, corners.clone(), unknowns);
            share_row(&mut self.problem.levels[SHARES], &mut self.row, support, corners, unknowns);
        }
        let weight = contact.weight();
        for &rate in contact.root() {
            let (by_rates, by_forces) = self.row.split_at_mut(rates);
            for (entry, slope) in by_rates.iter_mut().zip(torques.gradient().row(rate)) {
                *entry = slope / weight;
            }
            for (entry, column) in by_forces.iter_mut().zip(contact.columns().chunks_exact(rates)) {
                *entry = column[rate] / weight;
            }
            let rest = torques.active_torque()[rate] / weight;
            self.problem.levels[0].push(&self.row, rest, rest);
        }
        self.problem.levels[0].hard = true;
    }

    /// Bounds of the step: ranges, `trust_radius` (rad or m), and contact forces that only push. Locked rates do not
    /// change; a coordinate outside its range comes back by at most the trust radius.
    pub(super) fn bound(&mut self, settings: &Settings<'_>, iterate: &Iterate, trust_radius: f64) {
        let (model, posture) = (&settings.model, iterate.torques.posture());
        let Problem { lower, upper, .. } = &mut self.problem;
        for (i, rate) in model.rates().iter().enumerate() {
            let (least, greatest) = match rate.coordinate {
                _ if settings.locked()[i] => (0.0, 0.0),
                Some(c) => {
                    let ((lower, upper), value) = (model.coordinates()[c].range, posture.values()[c]);
                    let within = |room: f64| room.clamp(-trust_radius, trust_radius);
                    (within(lower - value), within(upper - value))
                }
                None => (-trust_radius, trust_radius),
            };
            (lower[i], upper[i]) = (least.min(greatest), greatest);
        }
        let rates = model.rates().len();
        for (i, force) in iterate.contact.forces().iter().enumerate() {
            let (least, greatest) = bounds(i);
            lower[rates + i] = (least - force).min(0.0);
            upper[rates + i] = (greatest - force).max(0.0);
        }
    }

    /// Replaces the rows of the caller's levels from `first` on by rows of the last one that ask for the least motion.
    pub(super) fn ask_for_least_motion(&mut self, first: usize) {
        self.problem.levels[first..].iter_mut().for_each(Level::clear);
        if let Some(last) = self.problem.levels.last_mut() {
            for i in 0..self.row.len() {
                self.row.fill(0.0);
                self.row[i] = 1.0;
                last.push(&self.row, 0.0, 0.0);
            }
        }
    }
}

/// By row of a level: the change that it asks for beyond a step of zero, in its unit.
pub(super) fn missing(level: &Level) -> impl Iterator<Item = f64> {
    level.lower.iter().zip(&level.upper).map(|(lower, upper)| lower.max(0.0) + upper.min(0.0))
}

/// Adds rows over the rates to a level over rates and forces; effort depends on both.
fn append_forces(
    settings: &Settings<'_>,
    iterate: &Iterate,
    task: &Task,
    by_rates: &Level,
    row: &mut [f64],
    to: &mut Level,
) {
    let rates = settings.model.rates().len();
    for (i, entries) in by_rates.matrix.chunks_exact(rates).enumerate() {
        row[..rates].copy_from_slice(entries);
        row[rates..].fill(0.0);
        if let Task::Effort(effort) = task {
            let (columns, error) = (iterate.contact.columns(), -by_rates.upper[i]);
            let coordinate = effort.coordinates[i];
            fill_force_columns(&settings.model, &iterate.torques, columns, coordinate, error, &mut row[rates..]);
        }
        to.push(row, by_rates.lower[i], by_rates.upper[i]);
    }
}
