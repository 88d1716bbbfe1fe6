//! Is the last answer still the best? Its residuals and multipliers are put into the optimality conditions of every level of
//! the problem as it is now; where all hold, there is nothing to solve.
//!
//! For level `k`: `A_k^T residual_k + sum_{j<k} A_j^T rows_j + bounds = 0`; a multiplier presses on the side where its row or
//! unknown stands, in the right direction. Either direction is right for an equation, for a row that keeps a residual, and
//! for a side that a level above presses on: to leave it would cost that level something. Residuals must be what they were,
//! to their rounding, and the sum zero to that rounding times the rows: where rows of one level weigh 1e-16 to 1 against each
//! other, the sum alone would not notice the light ones.

use crate::linalg::add_scaled;
use crate::problem::Problem;
use crate::solver::{MULTIPLIER, Role, Side, Solver};

/// The last digits of a sum, as a share of it.
const LAST_DIGITS: f64 = 4.0 * f64::EPSILON;

impl Solver {
    /// Do the conditions of all levels hold at the last answer? Damped levels have more to them: `false` for those.
    pub(crate) fn is_still_best(&mut self, problem: &Problem) -> bool {
        let mut end = 0;
        let starts = problem.levels.iter().map(|level| {
            end += level.rows();
            end
        });
        if !self.came_to_an_end || self.x.len() != problem.unknowns() || !self.offsets[1..].iter().copied().eq(starts) {
            return false;
        }
        let stands = |i: usize| {
            let (x, lower, upper) = (self.x[i], problem.lower[i], problem.upper[i]);
            match self.bounds[i] {
                Side::None => lower <= x && x <= upper,
                Side::Lower => x == lower && x <= upper,
                Side::Upper => x == upper && x >= lower,
                Side::Both => x == lower && x == upper,
            }
        };
        if !(0..self.x.len()).all(stands) {
            return false;
        }
        self.held.fill(false);
        self.roles.fill(Role::Active);
        (0..problem.levels.len()).all(|k| self.level_is_still_best(problem, k))
    }

    /// The conditions of one level. Notes in `held` and `roles` which sides the levels below find pressed on.
    fn level_is_still_best(&mut self, problem: &Problem, k: usize) -> bool {
        let n = problem.unknowns();
        let level = &problem.levels[k];
        // What is summed, and the sizes of all parts.
        self.gradient.fill(0.0);
        self.step.fill(0.0);
        let (mut size, mut blur, mut keeps) = (0.0, 0.0, false);
        for row in self.offsets[k]..self.offsets[k + 1] {
            let (residual, rounding) = (self.row_residual(problem, row), self.rounding(row));
            if level.damping > 0.0 || (residual - self.residuals[row]).abs() > rounding {
                return false;
            }
            size += residual.abs() * self.norms[row];
            blur += rounding * self.norms[row];
            keeps |= residual.abs() > rounding && self.is_something(row);
        }
        size = if keeps { size } else { 0.0 };
        // Multipliers were judged by what the least squares left, which is the residual up to rounding: with some room.
        let nothing = 2.0 * MULTIPLIER * size;
        let needed = 0.5 * MULTIPLIER * size;
        for i in 0..level.rows() {
            let row = self.offsets[k] + i;
            let (residual, rounding) = (self.residuals[row], self.rounding(row));
            if keeps {
                self.add(&level.matrix[i * n..(i + 1) * n], residual);
            }
            // Beside light rows that keep a residual, a heavy one may keep what is below its rounding.
            let value = self.value(problem, row, &self.x);
            let off = (value - level.lower[i]).abs().min((value - level.upper[i]).abs());
            let unseen = keeps && off <= 10.0 * rounding && rounding * self.norms[row] > nothing;
            // Beside heavy rows that keep a residual, a light one is only as near to its side as their last digits let it.
            let light = keeps && off > 10.0 * rounding && off * self.norms[row] <= LAST_DIGITS * size;
            if residual.abs() > rounding || level.lower[i] == level.upper[i] || unseen || light {
                self.roles[row] = Role::Fixed;
            }
        }
        for row in 0..self.offsets[k] {
            let multiplier = self.table.level(k).rows[row];
            if multiplier == 0.0 {
                continue;
            }
            let (j, i) = self.place(row);
            let above = &problem.levels[j];
            self.add(&above.matrix[i * n..(i + 1) * n], multiplier);
            let pressure = multiplier.abs() * self.norms[row];
            if self.roles[row] == Role::Fixed {
                continue;
            }
            let side = if multiplier > 0.0 { above.upper[i] } else { above.lower[i] };
            let off = (self.value(problem, row, &self.x) - side).abs();
            if off.is_nan() || off > 10.0 * self.rounding(row) {
                if pressure > nothing {
                    return false;
                }
            } else if pressure > needed {
                self.roles[row] = Role::Fixed;
            }
        }
        for (i, multiplier) in self.table.level(k).bounds.iter().enumerate() {
            self.gradient[i] += multiplier;
            self.step[i] += multiplier.abs();
            let side = if *multiplier > 0.0 { problem.upper[i] } else { problem.lower[i] };
            let free = !self.held[i] && problem.lower[i] != problem.upper[i];
            if free && self.x[i] != side && multiplier.abs() > nothing {
                return false;
            }
            self.held[i] |= self.x[i] == side && multiplier.abs() > needed;
        }
        let largest = |v: &[f64]| v.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        largest(&self.gradient) <= MULTIPLIER * largest(&self.step) + blur
    }

    /// Adds `factor a` to the sum, and its size to the sizes.
    fn add(&mut self, a: &[f64], factor: f64) {
        add_scaled(&mut self.gradient, factor, a);
        for (size, a) in self.step.iter_mut().zip(a) {
            *size += (factor * a).abs();
        }
    }
}
