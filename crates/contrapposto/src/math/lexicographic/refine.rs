//! A level that keeps residuals, once more with all sums in twice the digits.
//!
//! Least squares in plain numbers leave light rows beside heavy ones to the rounding of the heavy ones: what a row of weight
//! 1e-4 keeps is wrong by 1e8 times the rounding of a row of weight 1 that keeps something too. Iterative refinement mends it
//! (Björck 1967, "Iterative refinement of linear least squares solutions I"): what is off in `residual = A x - b`, in
//! `A^T residual + C^T multipliers = 0` and in the rows `C` above is summed exactly and solved for again, with the factors
//! that are there.

use super::dense::{add_scaled_twice, dot, dot_twice, norm};
use super::factor::Entry;
use super::level::DIGITS;
use super::problem::Problem;
use super::solver::{ROUNDING, Side, Solver, coefficients};

/// Rows whose lengths differ by more than this are unlike.
const UNLIKE: f64 = 256.0;
/// From here on the pull of light rows, which goes with the square, is below the digits of the heavy ones.
const TOO_UNLIKE: f64 = 1e4;
/// A value is made of numbers so many times larger than any limit: most of their digits cancel.
const CANCELLED: f64 = 1e3;
/// So many corrections at most.
const ROUNDS: usize = 5;

impl Solver {
    /// Corrects `x` and what the rows of level `k` keep. Answers what a correction ran into.
    pub(super) fn refine(&mut self, problem: &Problem, k: usize, base: usize) -> Option<(Entry, Side)> {
        if problem.levels[k].damping > 0.0 || !self.needs_refinement() {
            return None;
        }
        for _ in 0..ROUNDS {
            self.right_above(problem, base);
            self.right_of_level(problem, base);
            self.pull_along_level(problem, base);
            self.least.correct(&self.right[base..], &self.work[base..], &mut self.y);
            let rank = self.factor.len() - base;
            self.work.fill(0.0);
            self.work[..base].copy_from_slice(&self.above[..base]);
            self.work[base..base + rank].copy_from_slice(&self.y[..rank]);
            self.factor.turn_back(&mut self.work);
            self.scatter_step();
            if !self.step.iter().all(|step| step.is_finite()) {
                break;
            }
            // A step of the size of rounding passes no limit by more than that.
            if norm(&self.step) > ROUNDING * self.length {
                let (share, block) = self.first_block(problem, k);
                self.advance(problem, share);
                if block.is_some() {
                    return block;
                }
            } else {
                self.advance(problem, 1.0);
            }
            let mut settled = true;
            for s in 0..self.soft.len() {
                let change = self.least.residual()[s];
                self.kept[s] += change;
                settled &= change.abs() <= DIGITS * self.rounding(self.soft[s]);
            }
            if settled {
                break;
            }
        }
        None
    }

    /// Does the level keep something, in rows of which rounding would make the most?
    fn needs_refinement(&mut self) -> bool {
        let (mut least, mut most, mut limit, mut keeps) = (f64::INFINITY, 0.0_f64, 0.0_f64, false);
        for (kept, &row) in self.kept.iter().zip(&self.soft).filter(|(_, row)| self.is_something(**row)) {
            (least, most) = (least.min(self.norms[row]), most.max(self.norms[row]));
            limit = limit.max(self.limits[row]);
            keeps |= kept.abs() > self.rounding(row);
        }
        let needs = keeps && (most > UNLIKE * least || most * self.length > CANCELLED * limit);
        self.refined = needs && most < TOO_UNLIKE * least;
        needs
    }

    /// The step, turned, that brings what is fixed or active above back to its values: into `above`; by how much, into `right`.
    fn right_above(&mut self, problem: &Problem, base: usize) {
        self.right.clear();
        for entry in &self.factor.entries[..base] {
            self.right.push(match *entry {
                Entry::Bound(_) => 0.0,
                Entry::Row(row) => {
                    let terms = [-self.aim(problem, row), -self.residuals[row]];
                    -dot_twice(coefficients(problem, &self.offsets, row), &self.x, terms)
                }
            });
        }
        self.above.resize(base, 0.0);
        self.factor.solve_lower(0, &self.right, &mut self.above);
    }

    /// By how much `A x - b` is off what the rows keep, after the step in `above`: behind `base` in `right`.
    fn right_of_level(&mut self, problem: &Problem, base: usize) {
        for (s, &row) in self.soft.iter().enumerate() {
            let off =
                dot_twice(coefficients(problem, &self.offsets, row), &self.x, [-self.aim(problem, row), -self.kept[s]]);
            self.right.push(off + dot(self.turned_above(s, base), &self.above[..base]));
        }
    }

    /// What is left of `A^T kept + C^T multipliers`, turned: along the level behind `base` in `work`.
    fn pull_along_level(&mut self, problem: &Problem, base: usize) {
        self.work.fill(0.0);
        self.pull_above(base);
        self.factor.solve_upper(base, &mut self.work);
        self.gradient.fill(0.0);
        self.step.fill(0.0);
        for (kept, &row) in self.kept.iter().zip(&self.soft) {
            add_scaled_twice(&mut self.gradient, &mut self.step, *kept, coefficients(problem, &self.offsets, row));
        }
        for (e, entry) in self.factor.entries[..base].iter().enumerate() {
            let multiplier = -self.work[e];
            match *entry {
                Entry::Bound(i) => {
                    add_scaled_twice(&mut self.gradient[i..=i], &mut self.step[i..=i], multiplier, &[1.0])
                }
                Entry::Row(row) => {
                    add_scaled_twice(
                        &mut self.gradient,
                        &mut self.step,
                        multiplier,
                        coefficients(problem, &self.offsets, row),
                    );
                }
            }
        }
        for (sum, low) in self.gradient.iter_mut().zip(&self.step) {
            *sum += low;
        }
        self.factor.gather(&self.gradient, &mut self.work);
        self.factor.turn(&mut self.work, 0, self.factor.len());
    }
}
