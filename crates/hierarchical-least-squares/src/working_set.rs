//! Holds the working set: which bounds and rows are active, and which are fixed for all levels below.

use crate::problem::Problem;

/// A bound or a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Constraint {
    /// The bound of an unknown.
    Bound(usize),
    /// A row, counted through all levels.
    Row(usize),
}

/// The limit of a bound or row at which the working set holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Inactive,
    Lower,
    Upper,
    /// Lower and upper limit are equal.
    Equality,
}

impl Side {
    /// This side where its limit is finite, else inactive.
    pub(crate) fn where_finite(self, lower: f64, upper: f64) -> Self {
        match self {
            Side::Lower if lower.is_finite() => Side::Lower,
            Side::Upper if upper.is_finite() => Side::Upper,
            _ => Side::Inactive,
        }
    }

    /// By how much a multiplier has the wrong sign for this side, where it is positive; an equality may have either sign.
    pub(crate) fn dual_infeasibility(self, multiplier: f64) -> f64 {
        match self {
            Side::Upper => -multiplier,
            Side::Lower => multiplier,
            Side::Equality | Side::Inactive => 0.0,
        }
    }
}

/// The limit that ends a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocking {
    /// Share of the step up to the limit, from 0 to 1.
    pub(crate) share: f64,
    pub(crate) constraint: Constraint,
    pub(crate) side: Side,
}

/// The part a row plays in the level that is being solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RowState {
    /// Satisfied, and not in the working set.
    Inactive,
    /// Of this level: its residual is minimised.
    Residual,
    /// In the working set; a level below may drop it.
    Active,
    /// Satisfied, and linearly dependent on the working set: steps do not change its value.
    Dependent,
    /// In the working set for all levels below.
    Fixed,
}

/// Bounds and rows of all levels.
#[derive(Clone, Debug, Default)]
pub(crate) struct WorkingSet {
    /// By unknown.
    pub(crate) bounds: Vec<Side>,
    /// Bounds with a multiplier at a level above: no level below drops them.
    pub(crate) fixed_bounds: Vec<bool>,
    /// By row.
    pub(crate) sides: Vec<Side>,
    pub(crate) states: Vec<RowState>,
    /// Fixed rows that are linearly dependent on the rows in the factor.
    pub(crate) dependents: Vec<usize>,
}

impl WorkingSet {
    pub(crate) fn with_capacity(unknowns: usize, rows: usize) -> Self {
        Self {
            bounds: Vec::with_capacity(unknowns),
            fixed_bounds: Vec::with_capacity(unknowns),
            sides: Vec::with_capacity(rows),
            states: Vec::with_capacity(rows),
            dependents: Vec::with_capacity(rows),
        }
    }

    /// Drops everything.
    pub(crate) fn clear(&mut self) {
        self.bounds.clear();
        self.sides.clear();
    }

    /// Prepares the first level: bounds that were active stay so where they still exist; all rows are inactive, with the side
    /// at which they were active remembered.
    pub(crate) fn prepare(&mut self, problem: &Problem, rows: usize) {
        let n = problem.unknowns();
        if self.bounds.len() != n {
            self.bounds.clear();
            self.bounds.resize(n, Side::Inactive);
        }
        if self.sides.len() != rows {
            self.sides.clear();
            self.sides.resize(rows, Side::Inactive);
        }
        for (side, (lower, upper)) in self.bounds.iter_mut().zip(problem.lower.iter().zip(&problem.upper)) {
            *side = if lower == upper { Side::Equality } else { side.where_finite(*lower, *upper) };
        }
        self.fixed_bounds.clear();
        self.fixed_bounds.resize(n, false);
        self.states.clear();
        self.states.resize(rows, RowState::Inactive);
        self.dependents.clear();
    }

    /// The side at which a constraint is active.
    pub(crate) fn side(&self, constraint: Constraint) -> Side {
        match constraint {
            Constraint::Bound(i) => self.bounds[i],
            Constraint::Row(row) => self.sides[row],
        }
    }

    /// Sets state and side of a row.
    pub(crate) fn set_row(&mut self, row: usize, state: RowState, side: Side) {
        (self.states[row], self.sides[row]) = (state, side);
    }

    /// Takes a linearly dependent row out of the factor: a fixed one is remembered, any other becomes [`RowState::Dependent`].
    pub(crate) fn set_aside(&mut self, row: usize) {
        if self.states[row] == RowState::Fixed {
            self.dependents.push(row);
        } else {
            self.set_row(row, RowState::Dependent, Side::Inactive);
        }
    }
}
