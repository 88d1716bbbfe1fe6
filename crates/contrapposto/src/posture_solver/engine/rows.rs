//! What does the problem of one step look like? Rows of all levels, and how far a step may go.

use super::{BEFORE, Engine};
use crate::contact::{Unknowns, bounds, friction_rows, share_row};
use crate::effort::problem::fill_force_columns;
use crate::posture::Posture;
use crate::posture_solver::inverse_kinematics::bound_rates;
use crate::tasks::Task;
use hierarchical_least_squares::Level;

/// Largest error of a level above effort that one step takes on, in its units: on the way to a far goal the body stays where
/// effort is little, and so comes into the valleys that lead on.
const PACE: f64 = 0.15;

impl Engine<'_> {
    /// Rows of all levels.
    pub(super) fn build(&mut self) {
        self.errors.swap(0, 1);
        self.effort[1] = self.effort[0];
        self.effort[0] = 0.0;
        self.problem.levels.iter_mut().for_each(Level::clear);
        self.contact_rows();
        let rates = self.model.rates().len();
        for k in 0..=self.goals.len() {
            let level = if k == 0 { 1 } else { BEFORE + k - 1 };
            let goal = if k == 0 { &self.places } else { &self.goals[k - 1] };
            for task in &goal.tasks {
                self.narrow.clear();
                task.evaluate(self.model, &self.body, &mut self.narrow);
                let effort = if let Task::Effort(effort) = task { Some(effort) } else { None };
                widen(&self.narrow, &mut self.problem.levels[level], &mut self.row, |row, i| {
                    if let Some(effort) = effort {
                        let (coordinate, columns) = (effort.coordinates[i], self.contact.columns());
                        let error = -self.narrow.upper[i];
                        fill_force_columns(self.model, &self.body, columns, coordinate, error, &mut row[rates..]);
                    }
                });
            }
            for space in &goal.half_spaces {
                self.row.fill(0.0);
                for (rate, entry) in self.model.rates().iter().zip(&mut self.row) {
                    *entry = rate.coordinate.map_or(0.0, |c| space.normal[c]);
                }
                let value = space.violation(self.body.posture().values());
                self.problem.levels[level].push(&self.row, f64::NEG_INFINITY, -value);
            }
            self.problem.levels[level].hard = k == 0 || goal.hard;
        }
        for (k, level) in self.problem.levels.iter().enumerate() {
            let missing = level.lower.iter().zip(&level.upper).map(|(lower, upper)| lower.max(0.0) + upper.min(0.0));
            if self.effort_goal.is_some_and(|goal| k == BEFORE + goal) {
                self.effort[0] = 0.5 * missing.map(|m| m * m).sum::<f64>();
                self.errors[0][k] = 0.0;
            } else {
                self.errors[0][k] = missing.map(f64::abs).sum();
            }
        }
        self.damp();
    }

    /// Friction and equilibrium of the root; shares.
    fn contact_rows(&mut self) {
        let rates = self.model.rates().len();
        let unknowns = Unknowns { first: rates, now: Some(self.contact.forces()) };
        for (i, support) in self.contact.supports().iter().enumerate() {
            let corners = self.contact.corners(i);
            friction_rows(&mut self.problem.levels[0], &mut self.row, support, corners.clone(), unknowns);
            share_row(&mut self.problem.levels[2], &mut self.row, support, corners, unknowns);
        }
        let weight = self.contact.weight();
        for &rate in self.contact.root() {
            let (by_rates, by_forces) = self.row.split_at_mut(rates);
            for (entry, slope) in by_rates.iter_mut().zip(self.body.gradient().row(rate)) {
                *entry = slope / weight;
            }
            for (entry, column) in by_forces.iter_mut().zip(self.contact.columns().chunks_exact(rates)) {
                *entry = column[rate] / weight;
            }
            let rest = self.body.active_torque()[rate] / weight;
            self.problem.levels[0].push(&self.row, rest, rest);
        }
        self.problem.levels[0].hard = true;
    }

    /// Ranges, largest step, and forces that only push.
    pub(super) fn bound(&mut self, posture: &Posture) {
        let (lower, upper) = (&mut self.problem.lower, &mut self.problem.upper);
        bound_rates(self.model, &self.locked, posture, self.reach, lower, upper);
        let rates = self.model.rates().len();
        for (i, force) in self.contact.forces().iter().enumerate() {
            let (lower, upper) = bounds(i);
            self.problem.lower[rates + i] = (lower - force).min(0.0);
            self.problem.upper[rates + i] = (upper - force).max(0.0);
        }
    }

    /// Levels above effort that cannot be reached, as far as the last step showed, are damped.
    fn damp(&mut self) {
        let last = self.effort_goal.map_or(self.problem.levels.len(), |goal| BEFORE + goal);
        for k in BEFORE..last {
            let unreached = self.unreached.get(k).copied().unwrap_or(0.0);
            let level = &mut self.problem.levels[k];
            level.damping = if level.hard { 0.0 } else { 2.0 * unreached.min(1.0) };
        }
    }

    /// No level above effort takes on more than [`PACE`].
    pub(super) fn pace(&mut self) {
        let Some(goal) = self.effort_goal else { return };
        for level in &mut self.problem.levels[BEFORE..BEFORE + goal] {
            let missing = level.lower.iter().zip(&level.upper).map(|(lower, upper)| lower.max(0.0) + upper.min(0.0));
            let length = missing.map(|m| m * m).sum::<f64>().sqrt();
            if length > PACE {
                level.lower.iter_mut().chain(&mut level.upper).for_each(|limit| *limit *= PACE / length);
            }
        }
    }
}

/// Copies rows over the rates into a level over all unknowns; `fill` completes them.
fn widen(narrow: &Level, wide: &mut Level, row: &mut [f64], fill: impl Fn(&mut [f64], usize)) {
    let Some(n) = narrow.matrix.len().checked_div(narrow.rows()) else { return };
    for i in 0..narrow.rows() {
        row.fill(0.0);
        row[..n].copy_from_slice(&narrow.matrix[i * n..(i + 1) * n]);
        fill(row, i);
        wide.push(row, narrow.lower[i], narrow.upper[i]);
    }
}
