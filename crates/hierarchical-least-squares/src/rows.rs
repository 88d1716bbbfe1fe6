//! Measures every row of a problem once: its norm, its limits and its only unknown, if it has but one.
//!
//! Rows are counted through all levels. The size of rounding errors in the value of row `a` at `x` is
//! `ROUNDING (max(|lower|, |upper|) + |a| |x|)`, infinite limits left out.

use std::ops::Range;

use crate::linalg::{dot, norm_and_nonzeros};
use crate::problem::{Problem, ProblemError};
use crate::tolerances::{LARGEST_NUMBER, ROUNDING, ZERO_ROW};

/// Measured data of all rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    /// First row of each level, and the number of all rows.
    offsets: Vec<usize>,
    /// Level of each row, and its index there.
    positions: Vec<(usize, usize)>,
    norms: Vec<f64>,
    /// The only unknown with a coefficient other than zero.
    single: Vec<Option<usize>>,
    /// Unknowns, in whole groups of eight, outside of which the coefficients are zero.
    spans: Vec<Range<usize>>,
    /// Larger absolute value of the finite limits.
    limits: Vec<f64>,
}

impl Rows {
    pub(crate) fn with_capacity(levels: usize, rows: usize) -> Self {
        Self {
            offsets: Vec::with_capacity(levels + 1),
            positions: Vec::with_capacity(rows),
            norms: Vec::with_capacity(rows),
            single: Vec::with_capacity(rows),
            spans: Vec::with_capacity(rows),
            limits: Vec::with_capacity(rows),
        }
    }

    /// Measures all rows in one pass and checks the problem.
    pub(crate) fn measure(&mut self, problem: &Problem) -> Result<(), ProblemError> {
        problem.check_limits()?;
        let n = problem.unknowns();
        self.norms.clear();
        self.limits.clear();
        self.single.clear();
        self.spans.clear();
        let size = |limit: f64| if limit.is_finite() { limit.abs() } else { 0.0 };
        let mut accepted = true;
        for level in &problem.levels {
            for i in 0..level.rows() {
                let row = &level.matrix[i * n..(i + 1) * n];
                let (norm, nonzeros) = norm_and_nonzeros(row);
                // Most often the unknown behind that of the row before.
                let next = self.single.last().copied().flatten().map_or(0, |column| column + 1);
                let is_nonzero = |column: &usize| row.get(*column).is_some_and(|a| *a != 0.0);
                let single = if nonzeros == 1 { [next].into_iter().chain(0..n).find(is_nonzero) } else { None };
                self.norms.push(single.map_or(norm, |column| row[column].abs()));
                self.single.push(single);
                self.spans.push(span(row));
                self.limits.push(size(level.lower[i]).max(size(level.upper[i])));
                accepted &= norm <= LARGEST_NUMBER;
            }
        }
        if !accepted {
            // A coefficient that is too large, infinite or NaN shows in the norm of its row.
            problem.check()?;
        }
        self.offsets.clear();
        self.positions.clear();
        self.offsets.push(0);
        for (k, level) in problem.levels.iter().enumerate() {
            self.positions.extend((0..level.rows()).map(|i| (k, i)));
            self.offsets.push(self.positions.len());
        }
        Ok(())
    }

    /// Number of rows of all levels.
    pub(crate) fn count(&self) -> usize {
        self.positions.len()
    }

    /// First row of each level, and the number of all rows.
    pub(crate) fn offsets(&self) -> &[usize] {
        &self.offsets
    }

    /// The rows of level `k`.
    #[inline]
    pub(crate) fn of_level(&self, k: usize) -> Range<usize> {
        self.offsets[k]..self.offsets[k + 1]
    }

    /// Euclidean norm of a row.
    #[inline]
    pub(crate) fn norm(&self, row: usize) -> f64 {
        self.norms[row]
    }

    /// The only unknown of a row that has but one.
    pub(crate) fn single(&self, row: usize) -> Option<usize> {
        self.single[row]
    }

    /// Coefficients of a row.
    #[inline]
    pub(crate) fn coefficients<'a>(&self, problem: &'a Problem, row: usize) -> &'a [f64] {
        let (n, (k, i)) = (problem.unknowns(), self.positions[row]);
        &problem.levels[k].matrix[i * n..(i + 1) * n]
    }

    /// Lower and upper limit of a row.
    #[inline]
    pub(crate) fn limits(&self, problem: &Problem, row: usize) -> (f64, f64) {
        let (k, i) = self.positions[row];
        (problem.levels[k].lower[i], problem.levels[k].upper[i])
    }

    /// `a^T x` of a row.
    #[inline]
    pub(crate) fn value(&self, problem: &Problem, row: usize, x: &[f64]) -> f64 {
        let a = self.coefficients(problem, row);
        let Range { start, end } = self.spans[row];
        self.single[row].map_or_else(|| dot(&a[start..end], &x[start..end]), |column| a[column] * x[column])
    }

    /// Residual of a row at `x`, computed from the problem.
    pub(crate) fn residual(&self, problem: &Problem, row: usize, x: &[f64]) -> f64 {
        let value = self.value(problem, row, x);
        let (lower, upper) = self.limits(problem, row);
        (value - upper).max(0.0) + (value - lower).min(0.0)
    }

    /// Size of rounding errors in the value of a row at an `x` of this norm.
    #[inline]
    pub(crate) fn rounding(&self, row: usize, x_norm: f64) -> f64 {
        ROUNDING * (self.limits[row] + self.norms[row] * x_norm) + f64::MIN_POSITIVE
    }

    /// True for a row with a coefficient other than zero.
    #[inline]
    pub(crate) fn is_nonzero(&self, row: usize) -> bool {
        self.norms[row] > ZERO_ROW
    }
}

/// The groups of eight coefficients from the first to the last that is not zero: sums over them have the bits of sums over all.
fn span(row: &[f64]) -> Range<usize> {
    let (eights, rest) = row.as_chunks::<8>();
    let is_nonzero = |eight: &[f64; 8]| *eight != [0.0; 8];
    let start = 8 * eights.iter().position(is_nonzero).unwrap_or(eights.len());
    if rest.iter().any(|a| *a != 0.0) {
        return start..row.len();
    }
    start..eights.iter().rposition(is_nonzero).map_or(start, |last| 8 * (last + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_holds_all_coefficients_in_whole_eights() {
        let mut row = [0.0; 27];
        assert_eq!(span(&row), 24..24);
        row[11] = 1.0;
        assert_eq!(span(&row), 8..16);
        row[16] = -2.0;
        assert_eq!(span(&row), 8..24);
        row[26] = 1.0;
        assert_eq!(span(&row), 8..27);
        assert_eq!(span(&[0.0, 3.0]), 0..2);
    }
}
