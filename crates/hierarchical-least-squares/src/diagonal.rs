//! A last level that asks many unknowns for values, all with the same weight, as a rest posture does.
//!
//! With `P` the projection on what is free, the step is `p = P s`, where `s` is what is wanted of each unknown. Unknowns
//! that are asked for nothing (`f`) must want what they get, `s_f = p_f`, so `(1 - P_ff) s_f = (P s)_f` with `s_f = 0` on the
//! right. `1 - P_ff = G G^T`, where `L G^T` holds the columns `f` of the rows in the factor: a few small products instead of
//! a factorisation of the whole level. Where `G G^T` is close to singular, the general way is taken.

use crate::factor::Entry;
use crate::linalg::dot;
use crate::problem::Problem;
use crate::solver::{Role, Side, Solver, value};

/// Smallest pivot of `G G^T`, whose eigenvalues lie between 0 and 1.
const SINGULAR: f64 = 1e-6;

/// Space of [`Solver::diagonal_level`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Diagonal {
    /// The row that asks each unknown, by unknown.
    pub(crate) asked: Vec<Option<usize>>,
    /// Columns of the factor whose unknowns are not asked.
    pub(crate) unasked: Vec<usize>,
    /// `G`, one row a column of `unasked`.
    pub(crate) half: Vec<f64>,
    /// `G G^T`, then its Cholesky factor.
    pub(crate) square: Vec<f64>,
    pub(crate) columns: Vec<f64>,
    /// What is wanted of the unknowns, turned, as far as the rows above reach.
    pub(crate) wanted: Vec<f64>,
}

impl Solver {
    /// Solves the last level if it is of that kind: `None` if it is not (nothing was done then), otherwise whether it came
    /// to an end.
    pub(crate) fn diagonal_level(&mut self, problem: &Problem, k: usize) -> Option<bool> {
        let weight = self.asks_single_unknowns(problem, k)?;
        let mut arrived = false;
        let mut fresh = true;
        loop {
            if fresh && !self.factorise_unasked(problem) {
                return None;
            }
            fresh = false;
            let base = self.factor.len();
            let start = self.offsets[k];
            let moves = !arrived && {
                self.diagonal_step(problem, k);
                self.step
                    .iter()
                    .zip(&self.diagonal.asked)
                    .any(|(step, asked)| asked.is_some_and(|i| step.abs() * weight > self.rounding(start + i)))
            };
            if moves {
                let (share, block) = self.first_block(problem, k);
                self.advance(problem, share);
                let Some((entry, side)) = block else {
                    arrived = true;
                    continue;
                };
                if !share.is_finite() {
                    return Some(false);
                }
                self.activate(problem, k, entry, side);
            } else {
                self.gradient.fill(0.0);
                let mut size = 0.0;
                for (i, asked) in self.diagonal.asked.iter().enumerate() {
                    let Some(row) = *asked else { continue };
                    let residual = self.x[i] - Diagonal::value(problem, k, row, i);
                    if residual.abs() * weight > self.rounding(start + row) {
                        self.gradient[i] = weight * weight * residual;
                        size += self.gradient[i].abs();
                    }
                }
                // What is left is what was wanted less the step, which is orthogonal to what is above.
                for (work, wanted) in self.work.iter_mut().zip(&self.diagonal.wanted) {
                    *work = -weight * weight * wanted;
                }
                let Some(entry) = self.multiply(problem, k, base, size, false) else { return Some(true) };
                self.leave(problem, entry);
            }
            arrived = false;
            fresh = true;
            if !self.may_change() {
                return Some(false);
            }
        }
    }

    /// The common weight, if the level is equations for single unknowns with one weight.
    fn asks_single_unknowns(&mut self, problem: &Problem, k: usize) -> Option<f64> {
        let n = problem.unknowns();
        let level = &problem.levels[k];
        if level.rows() < 2 || level.damping > 0.0 {
            return None;
        }
        self.diagonal.asked.clear();
        self.diagonal.asked.resize(n, None);
        let mut weight = 0.0;
        for i in 0..level.rows() {
            let row = self.offsets[k] + i;
            let (column, size) = (self.single[row]?, self.norms[row]);
            if level.lower[i] != level.upper[i] || self.diagonal.asked[column].is_some() {
                return None;
            }
            if i == 0 {
                weight = size;
            } else if size != weight {
                return None;
            }
            self.diagonal.asked[column] = Some(i);
        }
        for row in self.offsets[k]..self.offsets[k + 1] {
            (self.roles[row], self.sides[row]) = (Role::Soft, Side::Both);
        }
        Some(weight)
    }

    /// `G` and the Cholesky factor of `G G^T`. `false` if that is close to singular.
    fn factorise_unasked(&mut self, problem: &Problem) -> bool {
        let n = problem.unknowns();
        let base = self.factor.len();
        let Diagonal { asked, unasked, half, square, columns, .. } = &mut self.diagonal;
        unasked.clear();
        unasked.extend((0..self.factor.width()).filter(|&c| asked[self.factor.free[c]].is_none()));
        let m = unasked.len();
        if m > base {
            return false;
        }
        half.clear();
        half.resize(m * base, 0.0);
        columns.clear();
        columns.resize(base, 0.0);
        for (f, &column) in unasked.iter().enumerate() {
            let i = self.factor.free[column];
            for (e, entry) in self.factor.entries.iter().enumerate() {
                columns[e] = match *entry {
                    Entry::Bound(other) => f64::from(other == i),
                    Entry::Row(row) => {
                        let (j, place) = self.places[row];
                        problem.levels[j].matrix[place * n + i]
                    }
                };
            }
            self.factor.solve_lower(0, columns, &mut half[f * base..(f + 1) * base]);
        }
        square.clear();
        square.resize(m * m, 0.0);
        for a in 0..m {
            for b in 0..=a {
                let mut entry = dot(&half[a * base..(a + 1) * base], &half[b * base..(b + 1) * base]);
                entry -= dot(&square[a * m..a * m + b], &square[b * m..b * m + b]);
                if a > b {
                    square[a * m + b] = entry / square[b * m + b];
                } else if entry > SINGULAR {
                    square[a * m + a] = entry.sqrt();
                } else {
                    return false;
                }
            }
        }
        true
    }

    /// The step to the best point that what is active allows.
    fn diagonal_step(&mut self, problem: &Problem, k: usize) {
        let base = self.factor.len();
        let Diagonal { asked, unasked, half, square, columns, wanted } = &mut self.diagonal;
        // What is wanted of each unknown, by unknown (`gradient`) and by column (`work`).
        // Bounds in the factor count: the step cannot move them, but their multipliers are what is wanted there.
        self.gradient.fill(0.0);
        for &i in &self.factor.free {
            self.gradient[i] = asked[i].map_or(0.0, |row| Diagonal::value(problem, k, row, i) - self.x[i]);
        }
        self.factor.gather(&self.gradient, &mut self.work);
        let m = unasked.len();
        if m > 0 {
            // (P s)_f = -G L^-1 C s, as s_f is zero.
            columns.clear();
            columns.extend(self.factor.entries.iter().map(|entry| match *entry {
                Entry::Bound(i) => self.gradient[i],
                Entry::Row(row) => value(problem, self.places[row], self.single[row], &self.gradient),
            }));
            self.y.resize(base.max(self.y.len()), 0.0);
            self.factor.solve_lower(0, columns, &mut self.y);
            columns.resize(base.max(m), 0.0);
            for a in 0..m {
                let rest = dot(&square[a * m..a * m + a], &columns[..a]);
                let right = -dot(&half[a * base..(a + 1) * base], &self.y[..base]);
                columns[a] = (right - rest) / square[a * m + a];
            }
            for a in (0..m).rev() {
                let rest: f64 = (a + 1..m).map(|b| square[b * m + a] * columns[b]).sum();
                columns[a] = (columns[a] - rest) / square[a * m + a];
            }
            for (a, &column) in unasked.iter().enumerate() {
                self.work[column] = columns[a];
            }
        }
        self.factor.turn(&mut self.work, 0, base);
        wanted.clear();
        wanted.extend_from_slice(&self.work[..base]);
        self.work[..base].fill(0.0);
        self.factor.turn_back(&mut self.work);
        self.scatter_step();
    }
}

impl Diagonal {
    /// What a row asks of its unknown.
    fn value(problem: &Problem, k: usize, row: usize, i: usize) -> f64 {
        let level = &problem.levels[k];
        level.upper[row] / level.matrix[row * problem.unknowns() + i]
    }
}
