//! Solves a last level of equations `w x_i = b_i` for single unknowns with one common weight, by projection.
//!
//! With `P` the projection on the null space of the working set, and `s_i = b_i / w - x_i`, the step is `p = P s`. Unknowns
//! `f` without an equation of their own must have `s_f = p_f`, so that `(1 - P_ff) s_f = (P s)_f` with `s_f = 0` on the right.
//! `1 - P_ff = G G^T`, where `L G^T` holds the columns `f` of the rows in the factor: a few small products instead of a
//! factorisation of the whole level. Where `G G^T` is close to singular, the level is left to [`crate::level_solver`].

use crate::active_set::ActiveSet;
use crate::linalg::{dot, semidefinite_cholesky, solve_lower, solve_lower_transposed};
use crate::problem::Problem;
use crate::tolerances::SINGULAR;
use crate::working_set::{Constraint, RowState, Side};

/// The end of the solution of a last level of a special kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The level is of another kind, or close to singular.
    NotApplicable,
    /// The level is as small as the levels above allow.
    Solved,
    /// The working set changed too often.
    Stopped,
}

/// Workspace of such a level.
#[derive(Clone, Debug, Default)]
pub(crate) struct IdentityLevel {
    /// `w`, and the first row of the level.
    weight: f64,
    first_row: usize,
    /// The index of the row of each unknown, by unknown.
    row_of: Vec<Option<usize>>,
    /// Columns of the factor whose unknowns have no row.
    free_columns: Vec<usize>,
    /// `G`, one row for each of `free_columns`; and the Cholesky factor of `G G^T`.
    g: Vec<f64>,
    gram: Vec<f64>,
    /// Right-hand sides by row of the factor, and solutions.
    right: Vec<f64>,
    y: Vec<f64>,
    free_values: Vec<f64>,
    /// The first entries of `Q^T s`, one for each row of the factor.
    transformed: Vec<f64>,
}

impl IdentityLevel {
    pub(crate) fn with_capacity(unknowns: usize) -> Self {
        let n = unknowns.next_multiple_of(8);
        Self {
            row_of: Vec::with_capacity(n),
            free_columns: Vec::with_capacity(n),
            g: Vec::with_capacity(n * n),
            gram: Vec::with_capacity(n * n),
            right: Vec::with_capacity(n),
            y: Vec::with_capacity(n),
            free_values: Vec::with_capacity(n),
            transformed: Vec::with_capacity(n),
            ..Self::default()
        }
    }

    /// Minimises level `k`, the last one, by an active-set method, if all its rows are equations for single unknowns with one weight. After
    /// [`Outcome::NotApplicable`] the general solver goes on from the iterate and the working set.
    pub(crate) fn solve(&mut self, problem: &Problem, set: &mut ActiveSet, k: usize) -> Outcome {
        if !self.recognise(problem, set, k) {
            return Outcome::NotApplicable;
        }
        for row in set.rows.of_level(k) {
            set.working_set.set_row(row, RowState::Residual, Side::Equality);
        }
        loop {
            if !self.factorise(problem, set) {
                return Outcome::NotApplicable;
            }
            self.compute_step(problem, set);
            let blocking = if self.step_is_noticeable(set) {
                let blocking = set.first_blocking(problem, k);
                set.advance(problem, blocking);
                blocking
            } else {
                None
            };
            if let Some(blocking) = blocking {
                set.activate(problem, k, blocking.constraint, blocking.side);
            } else {
                let Some(constraint) = self.constraint_to_drop(problem, set, k) else { return Outcome::Solved };
                set.drop_constraint(problem, constraint);
            }
            if !set.count_change() {
                return Outcome::Stopped;
            }
        }
    }

    /// True for a level of two or more equations for single unknowns, each once and all with one weight, without damping.
    fn recognise(&mut self, problem: &Problem, set: &ActiveSet, k: usize) -> bool {
        let level = &problem.levels[k];
        if level.rows() < 2 || level.damping > 0.0 {
            return false;
        }
        self.row_of.clear();
        self.row_of.resize(problem.unknowns(), None);
        self.first_row = set.rows.of_level(k).start;
        self.weight = set.rows.norm(self.first_row);
        for (i, row) in set.rows.of_level(k).enumerate() {
            let Some(unknown) = set.rows.single(row) else { return false };
            let is_equation = level.lower[i] == level.upper[i];
            if !is_equation || self.row_of[unknown].is_some() || set.rows.norm(row) != self.weight {
                return false;
            }
            self.row_of[unknown] = Some(i);
        }
        true
    }

    /// Computes `G` and the Cholesky factor of `G G^T`; `false` if that is close to singular.
    fn factorise(&mut self, problem: &Problem, set: &ActiveSet) -> bool {
        let rank = set.factor.len();
        let columns = set.factor.columns();
        self.free_columns.clear();
        self.free_columns.extend((0..columns.len()).filter(|&c| self.row_of[columns[c]].is_none()));
        let m = self.free_columns.len();
        if m > rank {
            return false;
        }
        self.g.clear();
        self.g.resize(m * rank, 0.0);
        for (f, &column) in self.free_columns.iter().enumerate() {
            let i = columns[column];
            self.right.clear();
            self.right.extend(set.factor.constraints().iter().map(|constraint| match *constraint {
                Constraint::Bound(other) => f64::from(other == i),
                Constraint::Row(row) => set.rows.coefficients(problem, row)[i],
            }));
            set.factor.solve_lower(0, &self.right, &mut self.g[f * rank..(f + 1) * rank]);
        }
        self.gram.clear();
        self.gram.resize(m * m, 0.0);
        let g = |row: usize| &self.g[row * rank..(row + 1) * rank];
        for a in 0..m {
            for b in 0..=a {
                self.gram[a * m + b] = dot(g(a), g(b));
            }
        }
        semidefinite_cholesky(&mut self.gram, m, |_| SINGULAR) == m
    }

    /// Computes the step to the minimum within the null space of the working set.
    fn compute_step(&mut self, problem: &Problem, set: &mut ActiveSet) {
        let (rank, m) = (set.factor.len(), self.free_columns.len());
        // `s` by unknown (`gradient`) and by column (`work`). Bounds in the factor count: the step cannot move their unknowns,
        // but `s` determines their multipliers.
        set.gradient.fill(0.0);
        for &i in set.factor.columns() {
            set.gradient[i] = self.row_of[i].map_or(0.0, |row| self.target(problem, row, i) - set.x[i]);
        }
        set.factor.gather(&set.gradient, &mut set.work);
        if m > 0 {
            // (P s)_f = -G L^-1 C s, as s_f is zero.
            self.right.clear();
            self.right.extend(set.factor.constraints().iter().map(|constraint| match *constraint {
                Constraint::Bound(i) => set.gradient[i],
                Constraint::Row(row) => set.rows.value(problem, row, &set.gradient),
            }));
            self.y.clear();
            self.y.resize(rank, 0.0);
            set.factor.solve_lower(0, &self.right, &mut self.y);
            self.free_values.clear();
            self.free_values.extend(self.g.chunks_exact(rank).map(|row| -dot(row, &self.y)));
            solve_lower(&self.gram, m, &mut self.free_values);
            solve_lower_transposed(&self.gram, m, &mut self.free_values);
            for (&column, value) in self.free_columns.iter().zip(&self.free_values) {
                set.work[column] = *value;
            }
        }
        set.factor.transform(&mut set.work, rank);
        self.transformed.clear();
        self.transformed.extend_from_slice(&set.work[..rank]);
        set.work[..rank].fill(0.0);
        set.factor.transform_back(&mut set.work);
        set.scatter_step();
    }

    /// True where the step changes the value of a row by more than its rounding.
    fn step_is_noticeable(&self, set: &ActiveSet) -> bool {
        let mut steps = set.step.iter().zip(&self.row_of);
        steps.any(|(step, row)| row.is_some_and(|i| step.abs() * self.weight > set.rounding(self.first_row + i)))
    }

    /// The bound or row above whose multiplier has the wrong sign.
    fn constraint_to_drop(&self, problem: &Problem, set: &mut ActiveSet, k: usize) -> Option<Constraint> {
        let square = self.weight * self.weight;
        let mut size = 0.0;
        set.gradient.fill(0.0);
        for (i, row) in self.row_of.iter().enumerate() {
            let Some(row) = *row else { continue };
            let residual = set.x[i] - self.target(problem, row, i);
            if residual.abs() * self.weight > set.rounding(self.first_row + row) {
                set.gradient[i] = square * residual;
                size += set.gradient[i].abs();
            }
        }
        // The residual is the step minus s, and the step is orthogonal to the rows of the factor.
        for (work, transformed) in set.work.iter_mut().zip(&self.transformed) {
            *work = -square * transformed;
        }
        let above = set.factor.len();
        set.compute_multipliers(problem, k, above, size);
        set.most_dual_infeasible(k, set.factor.constraints(), size)
    }

    /// `b_i / w` of row `row` of the level, for unknown `i`; a negative coefficient counts with its sign.
    fn target(&self, problem: &Problem, row: usize, i: usize) -> f64 {
        let level = problem.levels.last();
        level.map_or(0.0, |level| level.upper[row] / level.matrix[row * problem.unknowns() + i])
    }
}
