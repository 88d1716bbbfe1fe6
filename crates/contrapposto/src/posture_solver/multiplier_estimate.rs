//! Estimates the Lagrange multipliers of all rows above a level, in the present posture.
//!
//! ```text
//! lambda = argmin |J^T r + A^T lambda|     over all unknowns that are not at a bound, A the rows above that are active
//! ```
//!
//! This is the first-order estimate of Gill, Murray & Wright 1981, "Practical Optimization", section 6.6. The
//! multipliers of the last step belong to the posture before it, and to a step that was cut short where it was longest;
//! a second derivative built with them leads to steps that are rejected again and again.

use super::tolerances::{DEPENDENT_ROW, NO_ROOM};
use hierarchical_least_squares::linalg::{dot, semidefinite_cholesky, solve_lower_transposed};
use hierarchical_least_squares::{Level, Multipliers, Problem};

/// The estimate, with space that is kept.
#[derive(Clone, Debug)]
pub(super) struct MultiplierEstimate {
    /// By row of the levels above; 0 where a row is inactive.
    multipliers: Vec<f64>,
    /// Active rows, 0 at unknowns at a bound, and their indices.
    rows: Vec<f64>,
    indices: Vec<usize>,
    /// Cholesky factor of the products of these rows.
    factor: Vec<f64>,
    solution: Vec<f64>,
}

/// Whether a bound or row that had this multiplier in the last step has no room now.
pub(super) fn is_active(multiplier: f64, lower: f64, upper: f64) -> bool {
    multiplier != 0.0 && (if multiplier > 0.0 { upper } else { -lower }) <= NO_ROOM
}

impl MultiplierEstimate {
    /// Space for so many `rows` above.
    pub(super) fn new(rows: usize, unknowns: usize) -> Self {
        Self {
            multipliers: Vec::with_capacity(rows),
            rows: Vec::with_capacity(rows * unknowns),
            indices: Vec::with_capacity(rows),
            factor: Vec::with_capacity(rows * rows),
            solution: Vec::with_capacity(rows),
        }
    }

    /// By row of the levels above; 0 where a row is inactive.
    pub(super) fn multipliers(&self) -> &[f64] {
        &self.multipliers
    }

    /// Estimates the multipliers of `above` for a level with this `gradient`, `J^T r`. A row or bound is active if it
    /// is an equation, or had a multiplier in the `last` step and has no room now.
    pub(super) fn estimate(&mut self, problem: &Problem, above: &[Level], last: Multipliers<'_>, gradient: &[f64]) {
        let n = problem.unknowns();
        let active = |multiplier: Option<&f64>, lower: f64, upper: f64| {
            lower == upper || multiplier.is_some_and(|m| is_active(*m, lower, upper))
        };
        // Multipliers of other rows say nothing of these.
        let same = last.rows.len() == above.iter().map(Level::rows).sum::<usize>();
        self.multipliers.clear();
        self.rows.clear();
        self.indices.clear();
        for level in above {
            for (i, row) in level.matrix.chunks_exact(n).enumerate() {
                let index = self.multipliers.len();
                self.multipliers.push(0.0);
                if active(last.rows.get(index).filter(|_| same), level.lower[i], level.upper[i]) {
                    self.indices.push(index);
                    let free = |i: usize| !active(last.bounds.get(i), problem.lower[i], problem.upper[i]);
                    self.rows.extend(row.iter().enumerate().map(|(i, a)| if free(i) { *a } else { 0.0 }));
                }
            }
        }
        self.solve(n, gradient);
        for (index, multiplier) in self.indices.iter().zip(&self.solution) {
            self.multipliers[*index] = *multiplier;
        }
    }

    /// Takes the multipliers of the last step instead where it had the same number of rows `above`, else zeros.
    pub(super) fn take_last(&mut self, above: &[Level], last: Multipliers<'_>) {
        let rows = above.iter().map(Level::rows).sum();
        self.multipliers.clear();
        if last.rows.len() == rows {
            self.multipliers.extend_from_slice(last.rows);
        } else {
            self.multipliers.resize(rows, 0.0);
        }
    }

    /// `A A^T solution = -A gradient`; a row that depends on the rows before it gets zero.
    fn solve(&mut self, n: usize, gradient: &[f64]) {
        let m = self.indices.len();
        let Self { rows, factor, solution, .. } = self;
        let row = |r: usize| &rows[r * n..(r + 1) * n];
        factor.clear();
        factor.resize(m * m, 0.0);
        for r in 0..m {
            for c in 0..=r {
                factor[r * m + c] = dot(row(r), row(c));
            }
        }
        semidefinite_cholesky(factor, m, |square| DEPENDENT_ROW * square);
        // Forward substitution, with the right-hand side of each row when its turn comes.
        solution.clear();
        for r in 0..m {
            let own = &factor[r * m..=r * m + r];
            let right = (0..r).fold(-dot(row(r), gradient), |right, c| right - own[c] * solution[c]);
            solution.push(if own[r] == 0.0 { 0.0 } else { right / own[r] });
        }
        solve_lower_transposed(factor, m, solution);
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use hierarchical_least_squares::Solver;

    /// Three rows above, one of them twice, two active bounds, and a level that cannot be reached: in the solution the
    /// estimate equals the multipliers of the solver.
    #[test]
    fn estimate_in_the_solution_of_an_unreachable_level_equals_the_multipliers_of_the_solver() {
        let mut random = Pcg64Mcg::new(5);
        let mut worst = 0f64;
        for _ in 0..200 {
            let n = 8;
            let mut problem = Problem::new(n);
            let mut above = Level::default();
            let mut row = || (0..n).map(|_| random.random_range(-1.0..1.0)).collect::<Vec<f64>>();
            for _ in 0..3 {
                above.push(&row(), 0.0, 0.0);
            }
            let twice = above.matrix[..n].to_vec();
            above.push(&twice, 0.0, 0.0);
            let mut level = Level::default();
            (0..7).for_each(|_| level.push(&row(), 1.0, 1.0));
            problem.levels = vec![above, level];
            problem.upper[0] = 0.0;
            problem.lower[1] = 0.0;
            let mut solver = Solver::new();
            solver.solve(&problem).unwrap();
            let mut gradient = vec![0.0; n];
            for (row, r) in problem.levels[1].matrix.chunks_exact(n).zip(solver.residual(1)) {
                gradient.iter_mut().zip(row).for_each(|(g, a)| *g += r * a);
            }
            // The problem of a step that begins in the solution.
            let x = solver.solution().to_vec();
            let mut here = problem.clone();
            here.lower.iter_mut().zip(&x).for_each(|(limit, x)| *limit -= x);
            here.upper.iter_mut().zip(&x).for_each(|(limit, x)| *limit -= x);
            let last = solver.multipliers(1);
            let mut estimate = MultiplierEstimate::new(4, n);
            estimate.estimate(&here, &here.levels[..1], last, &gradient);
            // The two equal rows may share their multiplier.
            let sum = |m: &[f64]| [m[0] + m[3], m[1], m[2]];
            for (a, b) in sum(&estimate.multipliers).iter().zip(sum(last.rows)) {
                worst = worst.max((a - b).abs());
            }
        }
        println!("worst {worst:.1e}");
        assert!(worst < 1e-9, "{worst:.1e}");
    }
}
