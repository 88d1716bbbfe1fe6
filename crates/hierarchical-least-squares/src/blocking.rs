//! Moves the iterate along its step, up to the first limit that the step meets.

use crate::active_set::ActiveSet;
use crate::linalg::norm;
use crate::problem::Problem;
use crate::tolerances::{NEARLY_ALL, NO_MOTION, ROUNDING, TIE};
use crate::working_set::{Blocking, Constraint, RowState, Side};

impl ActiveSet {
    /// The first limit of a bound, or of a row of the levels up to `k`, that the step meets before its end.
    ///
    /// Of limits that the step meets at once, as those of a symmetric problem, the first in the order of unknowns and rows
    /// is taken: the last digits, which differ between machines, do not choose. A row whose limits are farther away than the
    /// iterate moves, times the norm of the row, is passed over.
    pub(crate) fn first_blocking(&mut self, problem: &Problem, k: usize) -> Option<Blocking> {
        let length = norm(&self.step);
        let mut first: Option<Blocking> = None;
        for (i, &change) in self.step.iter().enumerate() {
            if self.working_set.bounds[i] == Side::Inactive && change.abs() > NO_MOTION * length {
                let limits = (problem.lower[i], problem.upper[i]);
                first = earlier(first, change, self.x[i], limits, Constraint::Bound(i));
            }
        }
        for row in 0..self.rows.of_level(k).end {
            let end = self.way + first.map_or(1.0, |first| first.share) * length;
            if self.free_until[row] > end || self.working_set.states[row] != RowState::Inactive {
                continue;
            }
            let limits = self.rows.limits(problem, row);
            let value = self.value(problem, row);
            let room = (limits.1 - value).min(value - limits.0) - self.rounding(row);
            self.free_until[row] = self.way + NEARLY_ALL * room / self.rows.norm(row);
            if self.free_until[row] > end || !self.rows.is_nonzero(row) {
                continue;
            }
            let change = self.rows.value(problem, row, &self.step);
            if change.abs() > NO_MOTION * length * self.rows.norm(row) {
                first = earlier(first, change, value, limits, Constraint::Row(row));
            }
        }
        first
    }

    /// Moves the iterate along the step, up to the limit that blocks it. Bounds hold exactly.
    pub(crate) fn advance(&mut self, problem: &Problem, blocking: Option<Blocking>) {
        let share = blocking.map_or(1.0, |blocking| blocking.share);
        if share * norm(&self.step) > ROUNDING * self.x_norm {
            self.dropped.iterate_moves(blocking);
        }
        let bounds = problem.lower.iter().zip(&problem.upper);
        for ((x, step), (lower, upper)) in self.x.iter_mut().zip(&self.step).zip(bounds) {
            let end = *x + share * step;
            let end = if end < *lower { *lower } else { end };
            *x = if end > *upper { *upper } else { end };
        }
        self.way += share * norm(&self.step);
        self.x_norm = norm(&self.x);
    }
}

/// The limit that a change of a value meets, where it does so before `first` and before its end; else `first`.
fn earlier(
    first: Option<Blocking>,
    change: f64,
    value: f64,
    (lower, upper): (f64, f64),
    constraint: Constraint,
) -> Option<Blocking> {
    let (room, side) = if change > 0.0 { (upper - value, Side::Upper) } else { (lower - value, Side::Lower) };
    let share = (room / change).max(0.0);
    let is_earlier = share < first.map_or(1.0, |first| first.share * (1.0 - TIE));
    if is_earlier { Some(Blocking { share, constraint, side }) } else { first }
}
