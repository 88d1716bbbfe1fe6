//! Moves an iterate along its working set: constraints enter and leave, and the factor of the working set follows.
//!
//! The primal active-set method (Nocedal & Wright 2006, "Numerical Optimization", section 16.5): a step ends at the first
//! limit it meets, which enters the working set; a constraint whose multiplier has the wrong sign leaves it.

use crate::dropped::Dropped;
use crate::factor::Factor;
use crate::linalg::{add_scaled, norm};
use crate::multipliers::MultiplierTable;
use crate::problem::Problem;
use crate::rows::Rows;
use crate::tolerances::{CHANGES, CHANGES_PER_ROW, CYCLING, INDEPENDENT, MANY_UNKNOWNS, MULTIPLIER, ROUNDING};
use crate::working_set::{Constraint, RowState, Side, WorkingSet};

/// The iterate, its working set and the factor of the working set.
#[derive(Clone, Debug, Default)]
pub(crate) struct ActiveSet {
    pub(crate) rows: Rows,
    /// The iterate, and its norm.
    pub(crate) x: Vec<f64>,
    pub(crate) x_norm: f64,
    /// The step from the iterate, by unknown.
    pub(crate) step: Vec<f64>,
    /// Length of the way of the iterate since the first level began.
    pub(crate) way: f64,
    /// By row: the length of way up to which the iterate cannot meet a limit of the row.
    pub(crate) free_until: Vec<f64>,
    pub(crate) working_set: WorkingSet,
    pub(crate) factor: Factor,
    pub(crate) multipliers: MultiplierTable,
    /// Workspace: a vector by column of the factor, and a vector by unknown.
    pub(crate) work: Vec<f64>,
    pub(crate) gradient: Vec<f64>,
    /// The unknowns in the order of the factor's columns.
    order: Vec<usize>,
    /// Workspace of [`ActiveSet::refactorise`].
    constraints: Vec<Constraint>,
    /// Constraints that the level has dropped.
    pub(crate) dropped: Dropped,
    changes: usize,
    most_changes: usize,
}

impl ActiveSet {
    pub(crate) fn with_capacity(unknowns: usize, levels: usize, rows: usize) -> Self {
        let n = unknowns.next_multiple_of(8);
        Self {
            rows: Rows::with_capacity(levels, rows),
            x: Vec::with_capacity(n),
            step: Vec::with_capacity(n),
            free_until: Vec::with_capacity(rows),
            working_set: WorkingSet::with_capacity(n, rows),
            factor: Factor::with_capacity(n),
            multipliers: MultiplierTable::with_capacity(unknowns, levels, rows),
            work: Vec::with_capacity(n),
            gradient: Vec::with_capacity(n),
            order: Vec::with_capacity(n),
            constraints: Vec::with_capacity(n),
            dropped: Dropped::with_capacity(),
            ..Self::default()
        }
    }

    /// Forgets the iterate and the working set.
    pub(crate) fn clear(&mut self) {
        self.x.clear();
        self.working_set.clear();
        self.multipliers.clear();
    }

    /// Prepares the first level: the iterate at the bounds that are active, or else between its bounds.
    pub(crate) fn prepare(&mut self, problem: &Problem) {
        let (n, rows) = (problem.unknowns(), self.rows.count());
        if self.x.len() != n {
            self.x.clear();
            self.x.resize(n, 0.0);
        }
        self.working_set.prepare(problem, rows);
        for i in 0..n {
            let (lower, upper) = (problem.lower[i], problem.upper[i]);
            self.x[i] = match self.working_set.bounds[i] {
                Side::Lower | Side::Equality => lower,
                Side::Upper => upper,
                Side::Inactive => self.x[i].max(lower).min(upper),
            };
        }
        for (vector, len) in [(&mut self.step, n), (&mut self.gradient, n), (&mut self.work, n.next_multiple_of(8))] {
            vector.clear();
            vector.resize(len, 0.0);
        }
        self.way = 0.0;
        self.free_until.clear();
        self.free_until.resize(rows, 0.0);
        self.order_unknowns(problem);
        self.x_norm = norm(&self.x);
        self.multipliers.reset(n, self.rows.offsets());
        self.factor.reset(&self.order, &self.working_set.bounds);
        self.changes = 0;
        self.most_changes = CHANGES + CHANGES_PER_ROW * (n + rows);
    }

    /// Puts the unknowns of the first level first, where there are many unknowns and the level has less than half of them.
    fn order_unknowns(&mut self, problem: &Problem) {
        let n = problem.unknowns();
        self.gradient.fill(0.0);
        for row in problem.levels.first().map_or(&[][..], |level| &level.matrix).chunks_exact(n.max(1)) {
            self.gradient.iter_mut().zip(row).for_each(|(sum, a)| *sum += a.abs());
        }
        let in_first = |i: &usize| self.gradient[*i] > 0.0;
        let few = n >= MANY_UNKNOWNS && 2 * (0..n).filter(in_first).count() < n;
        self.order.clear();
        self.order.extend((0..n).filter(|i| few && in_first(i)));
        self.order.extend((0..n).filter(|i| !(few && in_first(i))));
    }

    /// Number of changes of the working set.
    pub(crate) fn changes(&self) -> usize {
        self.changes
    }

    /// Counts one more change of the working set; `false` when there were too many.
    pub(crate) fn count_change(&mut self) -> bool {
        self.changes += 1;
        self.changes <= self.most_changes
    }

    /// True after so many changes that the method is likely to cycle between rows that only rounding tells apart.
    pub(crate) fn is_cycling(&self) -> bool {
        self.changes > self.most_changes / CYCLING
    }

    /// `a^T x` of a row at the iterate.
    pub(crate) fn value(&self, problem: &Problem, row: usize) -> f64 {
        self.rows.value(problem, row, &self.x)
    }

    /// Size of rounding errors in the value of a row.
    pub(crate) fn rounding(&self, row: usize) -> f64 {
        self.rows.rounding(row, self.x_norm)
    }

    /// Adds the constraint that blocked a step of level `k`.
    pub(crate) fn activate(&mut self, problem: &Problem, k: usize, constraint: Constraint, side: Side) {
        self.dropped.block(constraint, side);
        match constraint {
            Constraint::Bound(i) => self.activate_bound(problem, i, side),
            Constraint::Row(row) if self.rows.of_level(k).contains(&row) => {
                self.working_set.set_row(row, RowState::Residual, side);
            }
            Constraint::Row(row) => {
                self.working_set.set_row(row, RowState::Active, side);
                if !self.append_row(problem, row) {
                    self.working_set.set_aside(row);
                }
            }
        }
    }

    /// Puts an unknown at its bound and appends the bound to the factor. A bound that is linearly dependent on the rows of the factor (rounding
    /// moved an unknown that these rows hold) cannot be appended: the column of the unknown is left out, so that the bound also holds once one of
    /// these rows is dropped.
    fn activate_bound(&mut self, problem: &Problem, i: usize, side: Side) {
        self.move_to_bound(problem, i, side);
        self.work.fill(0.0);
        if let Some(column) = self.factor.columns().iter().position(|&unknown| unknown == i) {
            self.work[column] = 1.0;
            if !self.append(Constraint::Bound(i), 1.0) {
                self.refactorise(problem);
            }
        }
    }

    /// Moves an unknown to a bound that it has reached but for rounding, and makes the bound active.
    pub(crate) fn move_to_bound(&mut self, problem: &Problem, i: usize, side: Side) {
        self.working_set.bounds[i] = side;
        let bound = if side == Side::Lower { problem.lower[i] } else { problem.upper[i] };
        self.way += (bound - self.x[i]).abs();
        self.x[i] = bound;
    }

    /// Appends a row to the factor; `false` if it is linearly dependent.
    fn append_row(&mut self, problem: &Problem, row: usize) -> bool {
        self.factor.gather(self.rows.coefficients(problem, row), &mut self.work);
        self.append(Constraint::Row(row), self.rows.norm(row))
    }

    /// Appends the row in `work`, not yet transformed, to the factor; `false` if it is linearly dependent.
    fn append(&mut self, constraint: Constraint, row_norm: f64) -> bool {
        let (r, width) = (self.factor.len(), self.factor.width());
        self.factor.transform(&mut self.work, r);
        let independent = r < width && norm(&self.work[r..width]) > INDEPENDENT * row_norm;
        if independent {
            self.factor.append(&self.work, constraint);
        }
        independent
    }

    /// Drops a constraint from the working set; the factor stays.
    pub(crate) fn drop_from_working_set(&mut self, dropped: Constraint) {
        self.dropped.drop(dropped, self.working_set.side(dropped));
        match dropped {
            Constraint::Bound(i) => self.working_set.bounds[i] = Side::Inactive,
            Constraint::Row(row) => self.working_set.set_row(row, RowState::Inactive, Side::Inactive),
        }
        // Rows that depended on the factor may now block a step.
        for state in self.working_set.states.iter_mut().filter(|state| **state == RowState::Dependent) {
            *state = RowState::Inactive;
        }
    }

    /// Drops a constraint and updates the factor.
    pub(crate) fn drop_constraint(&mut self, problem: &Problem, dropped: Constraint) {
        self.drop_from_working_set(dropped);
        let row = self.factor.constraints().iter().position(|constraint| *constraint == dropped);
        let updated = match (row, dropped) {
            (Some(row), _) => self.factor.remove(row),
            (None, Constraint::Bound(i)) => self.factor.join(i, |constraint| match constraint {
                Constraint::Bound(_) => 0.0,
                Constraint::Row(row) => self.rows.coefficients(problem, row)[i],
            }),
            (None, Constraint::Row(_)) => false,
        };
        if updated {
            self.append_dependents(problem);
        } else {
            self.refactorise(problem);
        }
    }

    /// Appends the fixed rows that were linearly dependent on the factor before, where they no longer are.
    fn append_dependents(&mut self, problem: &Problem) {
        for _ in 0..self.working_set.dependents.len() {
            let row = self.working_set.dependents.remove(0);
            if !self.append_row(problem, row) {
                self.working_set.set_aside(row);
            }
        }
    }

    /// Factorises the rows of the working set anew. Unknowns at a bound become columns left out.
    fn refactorise(&mut self, problem: &Problem) {
        self.constraints.clear();
        self.constraints.extend_from_slice(self.factor.constraints());
        self.factor.reset(&self.order, &self.working_set.bounds);
        for c in 0..self.constraints.len() {
            let Constraint::Row(row) = self.constraints[c] else { continue };
            if self.working_set.states[row] != RowState::Inactive && !self.append_row(problem, row) {
                self.working_set.set_aside(row);
            }
        }
        self.append_dependents(problem);
    }

    /// Writes `work`, by column of the factor, to `step`, by unknown.
    pub(crate) fn scatter_step(&mut self) {
        self.step.fill(0.0);
        for (column, &i) in self.factor.columns().iter().enumerate() {
            if self.working_set.bounds[i] == Side::Inactive {
                self.step[i] = self.work[column];
            }
        }
    }

    /// Computes the multipliers of level `k` for the first `above` constraints of the factor and all bounds.
    ///
    /// The gradient of the level's objective is given twice: transformed, in `work`, and by unknown, in `gradient`, which is
    /// read for the unknowns left out of the factor only. All multipliers are zero where `size`, the sum of the absolute
    /// contributions to the gradient, is zero.
    pub(crate) fn compute_multipliers(&mut self, problem: &Problem, k: usize, above: usize, size: f64) {
        let (bounds, rows) = self.multipliers.level_mut(k);
        bounds.fill(0.0);
        rows.fill(0.0);
        if size == 0.0 {
            return;
        }
        self.factor.solve_lower_transposed(above, &mut self.work);
        let has_columns_left_out = !self.factor.columns_left_out().is_empty();
        for (c, constraint) in self.factor.constraints()[..above].iter().enumerate() {
            let multiplier = -self.work[c];
            match *constraint {
                Constraint::Bound(i) => bounds[i] = multiplier,
                Constraint::Row(row) => {
                    rows[row] = multiplier;
                    if has_columns_left_out {
                        add_scaled(&mut self.gradient, multiplier, self.rows.coefficients(problem, row));
                    }
                }
            }
        }
        for &i in self.factor.columns_left_out() {
            bounds[i] = -self.gradient[i];
        }
    }

    /// The active bound, or row among `constraints`, whose multiplier at level `k` violates its sign most; none where all signs are right.
    pub(crate) fn most_dual_infeasible(&self, k: usize, constraints: &[Constraint], size: f64) -> Option<Constraint> {
        if size == 0.0 {
            return None;
        }
        let multipliers = self.multipliers.level(k);
        let set = &self.working_set;
        let zero = MULTIPLIER * size;
        let mut worst: Option<(f64, Constraint)> = None;
        let mut consider = |infeasibility: f64, constraint: Constraint| {
            let is_worse = infeasibility > zero && worst.is_none_or(|(most, _)| infeasibility > most);
            if is_worse && !self.dropped.is_held(constraint) {
                worst = Some((infeasibility, constraint));
            }
        };
        for (i, (side, multiplier)) in set.bounds.iter().zip(multipliers.bounds).enumerate() {
            if *side != Side::Inactive && !set.fixed_bounds[i] {
                consider(side.dual_infeasibility(*multiplier), Constraint::Bound(i));
            }
        }
        for constraint in constraints {
            if let Constraint::Row(row) = *constraint
                && set.states[row] == RowState::Active
            {
                consider(set.sides[row].dual_infeasibility(multipliers.rows[row]) * self.rows.norm(row), *constraint);
            }
        }
        worst.map(|(_, constraint)| constraint)
    }

    /// Fixes, for all levels below, the bounds and rows that have a multiplier at level `k`.
    pub(crate) fn fix_constraints_with_multipliers(&mut self, k: usize, above: usize, size: f64) {
        if size == 0.0 {
            return;
        }
        let multipliers = self.multipliers.level(k);
        let zero = MULTIPLIER * size;
        for (fixed, multiplier) in self.working_set.fixed_bounds.iter_mut().zip(multipliers.bounds) {
            *fixed |= multiplier.abs() > zero;
        }
        for constraint in &self.factor.constraints()[..above] {
            if let Constraint::Row(row) = *constraint
                && multipliers.rows[row].abs() * self.rows.norm(row) > zero
            {
                self.working_set.states[row] = RowState::Fixed;
            }
        }
    }

    /// True where a vector by column is more than rounding beside the iterate.
    pub(crate) fn exceeds_rounding_of_x(&self, vector: &[f64]) -> bool {
        norm(vector) > ROUNDING * self.x_norm
    }
}
