//! How hard do the levels above hold a level back, in the posture of now?
//!
//! The multipliers of the last step belong to the posture before it, and to a step that was cut short where it was longest: a
//! second derivative built with them is that of something else, and the steps it proposes are taken back again and again. Here
//! they are estimated anew: the `lambda` that leaves the shortest `J^T r + A^T lambda` over all rates that are not at the end of
//! their range (the first-order estimate of Gill, Murray & Wright 1981, "Practical Optimization", section 6.6).

use hierarchical_least_squares::linalg::dot;
use hierarchical_least_squares::{Level, Multipliers, Problem};

/// A rate or row with less room than this, in its units, is at the end of its range.
const NO_ROOM: f64 = 1e-9;
/// Share of a row's square below which it says nothing that the rows before it have not said.
const DEPENDENT: f64 = 1e-10;

/// The multipliers of all rows above a level. Keeps its space.
#[derive(Clone, Debug)]
pub(crate) struct Hold {
    /// By row of the levels above; zero where a row does not hold.
    pub(crate) multipliers: Vec<f64>,
    /// Rows that hold, at the rates that can move, and which rows they are.
    rows: Vec<f64>,
    places: Vec<usize>,
    /// Cholesky factor of the products of these rows.
    factor: Vec<f64>,
    solution: Vec<f64>,
}

impl Hold {
    /// Space for so many `rows` above.
    pub(crate) fn new(rows: usize, unknowns: usize) -> Self {
        Self {
            multipliers: Vec::with_capacity(rows),
            rows: Vec::with_capacity(rows * unknowns),
            places: Vec::with_capacity(rows),
            factor: Vec::with_capacity(rows * rows),
            solution: Vec::with_capacity(rows),
        }
    }

    /// Estimates the multipliers of `above` for a level with this `gradient`, `J^T r`. What was pressed on in the `last` step,
    /// and has no room now, holds.
    pub(crate) fn estimate(&mut self, problem: &Problem, above: &[Level], last: Multipliers<'_>, gradient: &[f64]) {
        let n = problem.unknowns();
        let holds = |multiplier: Option<&f64>, lower: f64, upper: f64| {
            lower == upper
                || multiplier.is_some_and(|m| *m != 0.0 && (if *m > 0.0 { upper } else { -lower }) <= NO_ROOM)
        };
        // Of other rows it says nothing.
        let same = last.rows.len() == above.iter().map(Level::rows).sum::<usize>();
        self.multipliers.clear();
        self.rows.clear();
        self.places.clear();
        for level in above {
            for (i, row) in level.matrix.chunks_exact(n).enumerate() {
                let place = self.multipliers.len();
                self.multipliers.push(0.0);
                let (lower, upper) = (level.lower[i], level.upper[i]);
                if holds(last.rows.get(place).filter(|_| same), lower, upper) {
                    self.places.push(place);
                    let moves = |i: usize| !holds(last.bounds.get(i), problem.lower[i], problem.upper[i]);
                    self.rows.extend(row.iter().enumerate().map(|(i, a)| if moves(i) { *a } else { 0.0 }));
                }
            }
        }
        self.solve(n, gradient);
        for (place, multiplier) in self.places.iter().zip(&self.solution) {
            self.multipliers[*place] = *multiplier;
        }
    }

    /// Takes those of the last step instead, where it had the same rows; else none.
    pub(crate) fn keep(&mut self, last: Multipliers<'_>) {
        if last.rows.len() == self.multipliers.len() {
            self.multipliers.copy_from_slice(last.rows);
        } else {
            self.multipliers.fill(0.0);
        }
    }

    /// `A A^T solution = -A gradient`; rows that say nothing new get zero.
    fn solve(&mut self, n: usize, gradient: &[f64]) {
        let m = self.places.len();
        let Self { rows, factor, solution, .. } = self;
        let row = |r: usize| &rows[r * n..(r + 1) * n];
        factor.clear();
        factor.resize(m * m, 0.0);
        solution.clear();
        for r in 0..m {
            let mut right = -dot(row(r), gradient);
            for c in 0..r {
                let pivot = factor[c * m + c];
                if pivot > 0.0 {
                    let rest = dot(row(r), row(c)) - dot(&factor[r * m..r * m + c], &factor[c * m..c * m + c]);
                    factor[r * m + c] = rest / pivot;
                    right -= factor[r * m + c] * solution[c];
                }
            }
            let whole = dot(row(r), row(r));
            let new = whole - dot(&factor[r * m..r * m + r], &factor[r * m..r * m + r]);
            if new > DEPENDENT * whole {
                factor[r * m + r] = new.sqrt();
                solution.push(right / new.sqrt());
            } else {
                solution.push(0.0);
            }
        }
        for r in (0..m).rev() {
            let pivot = factor[r * m + r];
            if pivot > 0.0 {
                let below: f64 = (r + 1..m).map(|s| factor[s * m + r] * solution[s]).sum();
                solution[r] = (solution[r] - below) / pivot;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use hierarchical_least_squares::Solver;

    /// Where a level cannot be met, the estimate in the solution is what the solver says; and it is orthogonal to what holds,
    /// though some rows are said twice.
    #[test]
    fn estimates_are_the_multipliers_of_the_solution() {
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
            // Seen from the solution, as a step sees its problem.
            let x = solver.solution().to_vec();
            let mut here = problem.clone();
            here.lower.iter_mut().zip(&x).for_each(|(limit, x)| *limit -= x);
            here.upper.iter_mut().zip(&x).for_each(|(limit, x)| *limit -= x);
            let last = solver.multipliers(1);
            let mut hold = Hold::new(4, n);
            hold.estimate(&here, &here.levels[..1], last, &gradient);
            // The row that is there twice may share its multiplier with the other.
            let sum = |m: &[f64]| [m[0] + m[3], m[1], m[2]];
            for (a, b) in sum(&hold.multipliers).iter().zip(sum(last.rows)) {
                worst = worst.max((a - b).abs());
            }
        }
        println!("worst {worst:.1e}");
        assert!(worst < 1e-9, "{worst:.1e}");
    }
}
