//! Holds the residual rows of a level, each multiplied by `Q^T` of the constraints above, and carries them along when these
//! change.

use crate::active_set::ActiveSet;
use crate::factor::Position;
use crate::problem::Problem;
use crate::working_set::{Constraint, RowState, Side};

/// Residual rows in the order in which they joined.
#[derive(Clone, Debug, Default)]
pub(crate) struct ResidualRows {
    rows: Vec<usize>,
    /// `Q^T` times each row, one after the other, [`Factor::stride`](crate::factor::Factor::stride) long; up to `position`.
    transformed: Vec<f64>,
    position: Position,
    /// Workspace, by row of the level.
    is_joined: Vec<bool>,
}

impl ResidualRows {
    pub(crate) fn with_capacity(unknowns: usize, rows: usize) -> Self {
        Self {
            rows: Vec::with_capacity(rows),
            transformed: Vec::with_capacity(rows * unknowns.next_multiple_of(8)),
            is_joined: Vec::with_capacity(rows),
            ..Self::default()
        }
    }

    /// The rows.
    pub(crate) fn rows(&self) -> &Vec<usize> {
        &self.rows
    }

    /// The transformed rows, one after the other.
    pub(crate) fn transformed(&self) -> &Vec<f64> {
        &self.transformed
    }

    /// Removes all rows.
    pub(crate) fn clear(&mut self) {
        self.rows.clear();
    }

    /// Drops the rows of level `k` that are residual rows no longer, transforms those that joined, and continues the
    /// transformation of the others by what changed of the constraints above, which are all rows of the factor.
    pub(crate) fn update(&mut self, problem: &Problem, set: &ActiveSet, k: usize) {
        let kept = self.keep_residual_rows(set);
        let of_level = set.rows.of_level(k);
        self.is_joined.clear();
        self.is_joined.resize(of_level.len(), false);
        self.rows.iter().for_each(|row| self.is_joined[row - of_level.start] = true);
        let states = &set.working_set.states;
        let is_new = |(row, is_joined): &(usize, &bool)| states[*row] == RowState::Residual && !**is_joined;
        self.rows.extend(of_level.zip(&self.is_joined).filter(is_new).map(|(row, _)| row));
        let stride = set.factor.stride();
        self.transformed.resize(self.rows.len() * stride, 0.0);
        for (s, (t, &row)) in self.transformed.chunks_exact_mut(stride.max(1)).zip(&self.rows).enumerate() {
            let coefficients = set.rows.coefficients(problem, row);
            if s >= kept || !set.factor.continue_transform(coefficients, t, self.position) {
                set.factor.gather(coefficients, t);
                set.factor.transform(t, set.factor.len());
            }
        }
        self.position = set.factor.position();
    }

    /// Removes rows that are residual rows no longer; the number of the others.
    fn keep_residual_rows(&mut self, set: &ActiveSet) -> usize {
        let stride = set.factor.stride();
        let mut kept = 0;
        for s in 0..self.rows.len() {
            if set.working_set.states[self.rows[s]] == RowState::Residual {
                self.rows[kept] = self.rows[s];
                self.transformed.copy_within(s * stride..(s + 1) * stride, kept * stride);
                kept += 1;
            }
        }
        self.rows.truncate(kept);
        kept
    }
}

/// Chooses the residual rows to begin with: equations, violated inequalities, and inequalities that were active before.
pub(crate) fn choose_residual_rows(problem: &Problem, set: &mut ActiveSet, k: usize) {
    for row in set.rows.of_level(k) {
        let (lower, upper) = set.rows.limits(problem, row);
        let (value, rounding) = (set.value(problem, row), set.rounding(row));
        let side = match set.working_set.sides[row] {
            _ if lower == upper => Side::Equality,
            _ if value > upper + rounding => Side::Upper,
            _ if value < lower - rounding => Side::Lower,
            before => before.where_finite(lower, upper),
        };
        let state = if side == Side::Inactive { RowState::Inactive } else { RowState::Residual };
        set.working_set.set_row(row, state, side);
    }
}

/// The limit that a residual row is to reach.
pub(crate) fn target(problem: &Problem, set: &ActiveSet, row: usize) -> f64 {
    let (lower, upper) = set.rows.limits(problem, row);
    if set.working_set.sides[row] == Side::Lower { lower } else { upper }
}

/// Drops a residual row whose multiplier has the wrong sign: it is satisfied, or violates its other limit.
pub(crate) fn drop_residual_row(problem: &Problem, set: &mut ActiveSet, row: usize) {
    set.dropped.drop(Constraint::Row(row), set.working_set.sides[row]);
    let (lower, upper) = set.rows.limits(problem, row);
    let (value, rounding) = (set.value(problem, row), set.rounding(row));
    let (state, side) = match set.working_set.sides[row] {
        Side::Lower if value > upper + rounding => (RowState::Residual, Side::Upper),
        Side::Upper if value < lower - rounding => (RowState::Residual, Side::Lower),
        _ => (RowState::Inactive, Side::Inactive),
    };
    set.working_set.set_row(row, state, side);
}
