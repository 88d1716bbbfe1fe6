//! Gives a level the rows of its whole second derivative: Newton's method on one level of a hierarchy.
//!
//! Rows of a level are first derivatives. Where a level keeps a residual `r`, its best point is that of
//!
//! ```text
//! L = |r|^2 / 2 + sum_i lambda_i c_i                 c the errors of the levels above, lambda their multipliers
//! H = J^T J + sum_i r_i r_i'' + sum_i lambda_i c_i''
//! ```
//!
//! and steps that use `J^T J` alone approach that point slowly or oscillate around it. A Newton level has the rows `R p
//! = -R^-T g` with `R^T R = H` and `g` the gradient of `L` (Pfeiffer, Escande & Rapoport 2018, "Singularity resolution
//! in equality and inequality constrained hierarchical task-space control by adaptive nonlinear least squares", with
//! another approximation of `H`). Along directions that the levels above fix, `H` may be made larger: no step goes
//! there.
//!
//! `H` may be indefinite. Two ways make it positive: [`NewtonLevel::write_with_absolute_curvature`] turns negative
//! curvature round and leaves flat directions to the levels below; [`NewtonLevel::write_regularised`] adds to the
//! diagonal.

use super::linearisation::missing;
use super::multiplier_estimate::{MultiplierEstimate, is_active};
use super::tolerances::{
    FLAT_CURVATURE, FLAT_EFFORT, LARGEST_NEWTON_REGULARISATION, LEAST_GAIN, REGULARISATION_GROWTH,
    REGULARISATION_START, WEAK_CURVATURE,
};
use hierarchical_least_squares::linalg::{SymmetricEigen, add_outer_product, add_scaled, cholesky, pivoted_cholesky};
use hierarchical_least_squares::{Level, Multipliers, Problem};

/// Workspace of a Newton level.
#[derive(Clone, Debug)]
pub(super) struct NewtonLevel {
    /// The level with its first derivatives.
    pub(super) level: Level,
    pub(super) residual: Vec<f64>,
    pub(super) estimate: MultiplierEstimate,
    /// `H`, row after row; on and above the diagonal, or whole.
    pub(super) matrix: Vec<f64>,
    gradient: Vec<f64>,
    factor: Vec<f64>,
    /// Unknowns in the order of the pivots.
    order: Vec<usize>,
    eigen: SymmetricEigen,
    row: Vec<f64>,
}

impl NewtonLevel {
    /// Space for levels of at most so many `rows`, with so many rows above.
    pub(super) fn new(unknowns: usize, rows: usize, rows_above: usize) -> Self {
        Self {
            level: Level::with_capacity(rows.max(unknowns) + 3, unknowns),
            residual: Vec::with_capacity(rows),
            estimate: MultiplierEstimate::new(rows_above, unknowns),
            matrix: vec![0.0; unknowns * unknowns],
            gradient: vec![0.0; unknowns],
            factor: vec![0.0; unknowns * unknowns],
            order: Vec::with_capacity(unknowns),
            eigen: SymmetricEigen::new(unknowns),
            row: vec![0.0; unknowns],
        }
    }

    /// Takes level `k` out of `problem`: its residual, its gradient `J^T r`, and a matrix of zeros.
    pub(super) fn take(&mut self, problem: &mut Problem, k: usize) {
        std::mem::swap(&mut self.level, &mut problem.levels[k]);
        self.residual.clear();
        self.residual.extend(missing(&self.level).map(|m| -m));
        self.gradient.fill(0.0);
        for (row, r) in self.level.matrix.chunks_exact(problem.unknowns()).zip(&self.residual) {
            add_scaled(&mut self.gradient, *r, row);
        }
        self.matrix.fill(0.0);
    }

    /// Estimates the multipliers of the levels above `k`.
    pub(super) fn estimate(&mut self, problem: &Problem, k: usize, last: Multipliers<'_>) {
        self.estimate.estimate(problem, &problem.levels[..k], last, &self.gradient);
    }

    /// Adds `J^T J`, and returns the largest diagonal entry of the matrix.
    pub(super) fn add_first_derivatives(&mut self) -> f64 {
        let n = self.row.len();
        for row in self.level.matrix.chunks_exact(n) {
            add_outer_product(&mut self.matrix, row, 1.0);
        }
        (0..n).fold(0.0, |size: f64, i| size.max(self.matrix[i * n + i].abs()))
    }

    /// Makes the matrix larger along rows of the levels `above`: `weight` times a row of unit length. `share` is given
    /// the multiplier of a row, its limits and its weight; it returns the row's part in the gradient, or `None` to
    /// leave the row out.
    pub(super) fn weigh_rows(
        &mut self,
        above: &[Level],
        weight: f64,
        share: impl Fn(f64, (f64, f64), f64) -> Option<f64>,
    ) {
        let mut multipliers = self.estimate.multipliers().iter();
        for level in above {
            for (i, row) in level.matrix.chunks_exact(self.row.len()).enumerate() {
                let multiplier = multipliers.next().copied().unwrap_or(0.0);
                let square: f64 = row.iter().map(|a| a * a).sum();
                let weight = weight / square;
                if square > 0.0
                    && let Some(share) = share(multiplier, (level.lower[i], level.upper[i]), weight)
                {
                    add_outer_product(&mut self.matrix, row, weight);
                    add_scaled(&mut self.gradient, share, row);
                }
            }
        }
    }

    /// Makes the matrix larger along the unknowns that pressed against a bound in the `last` step and have no room now: one
    /// at the edge of the last trust region is free again.
    pub(super) fn weigh_bounds(&mut self, problem: &Problem, last: &[f64], weight: f64) {
        let n = self.row.len();
        for (i, multiplier) in last.iter().enumerate() {
            if is_active(*multiplier, problem.lower[i], problem.upper[i]) {
                self.matrix[i * n + i] += weight;
            }
        }
    }

    /// Writes the rows, negative curvature turned round. Pivots of a Cholesky factor as far as they are positive, then
    /// eigenvectors of the rest; flat directions get no row and are left to the levels below. `size` is that of the
    /// largest diagonal entry.
    pub(super) fn write_with_absolute_curvature(&mut self, level: &mut Level, size: f64) {
        let n = self.row.len();
        let flat = FLAT_CURVATURE * size;
        self.factor.copy_from_slice(&self.matrix);
        let pivots = pivoted_cholesky(&mut self.factor, n, &mut self.order, flat);
        let error: f64 = self.residual.iter().map(|r| r * r).sum();
        // Long motions that gain next to nothing would never come to rest.
        let worth = |c: f64, curvature: f64| {
            if curvature < WEAK_CURVATURE * size && c * c < 2.0 * LEAST_GAIN * error { 0.0 } else { c }
        };
        level.clear();
        level.hard = self.level.hard;
        for r in 0..pivots {
            let p = self.order[r];
            self.row.fill(0.0);
            for &j in &self.order[r..] {
                self.row[j] = self.factor[p * n + j];
            }
            let c = -self.gradient[p] / self.row[p];
            add_scaled(&mut self.gradient, c, &self.row);
            let c = worth(c, self.row[p] * self.row[p]);
            level.push(&self.row, c, c);
        }
        let rest = &self.order[pivots..];
        if rest.is_empty() {
            return;
        }
        self.eigen.decompose(rest.len(), |i, j| self.factor[rest[i] * n + rest[j]]);
        for (curvature, vector) in self.eigen.iter().filter(|(curvature, _)| curvature.abs() > 10.0 * flat) {
            self.row.fill(0.0);
            let (mut along, mut square) = (0.0, 0.0);
            for (&j, x) in rest.iter().zip(vector) {
                let x = x * curvature.abs().sqrt();
                self.row[j] = x;
                along += x * self.gradient[j];
                square += x * x;
            }
            // |row|^2 is the curvature; half the right-hand side squared is the gain.
            let c = worth(-along / square, square);
            level.push(&self.row, c, c);
        }
    }

    /// Writes the rows, with `regularisation` on the diagonal of the first `rates` unknowns: at least the given one,
    /// and as large as makes the matrix positive. A level that no regularisation makes positive keeps its first
    /// derivatives.
    pub(super) fn write_regularised(&mut self, level: &mut Level, rates: usize, regularisation: &mut f64) {
        let n = self.row.len();
        if !self.factor_regularised(rates, regularisation) {
            std::mem::swap(&mut self.level, level);
            return;
        }
        level.clear();
        level.hard = self.level.hard;
        for (r, row) in self.factor.chunks_exact(n).enumerate() {
            if row[r] <= 0.0 {
                continue;
            }
            self.row[..r].fill(0.0);
            self.row[r..].copy_from_slice(&row[r..]);
            let c = -self.gradient[r] / row[r];
            add_scaled(&mut self.gradient[r..], c, &row[r..]);
            level.push(&self.row, c, c);
        }
    }

    fn factor_regularised(&mut self, rates: usize, regularisation: &mut f64) -> bool {
        let n = self.row.len();
        let largest =
            |range: std::ops::Range<usize>| range.fold(0.0, |most: f64, i| most.max(self.matrix[i * n + i].abs()));
        let (by_rates, by_forces) = (largest(0..rates), largest(rates..n));
        let most = LARGEST_NEWTON_REGULARISATION * by_rates.max(1e-12);
        if !most.is_finite() {
            return false;
        }
        loop {
            self.factor.copy_from_slice(&self.matrix);
            for i in 0..n {
                let added = if i < rates { *regularisation + FLAT_EFFORT * by_rates } else { FLAT_EFFORT * by_forces };
                self.factor[i * n + i] += added;
            }
            if cholesky(&mut self.factor, n) {
                return true;
            }
            if *regularisation > most {
                return false;
            }
            *regularisation = (REGULARISATION_GROWTH * *regularisation).max(REGULARISATION_START * by_rates);
        }
    }
}
