//! Solves one level: least squares over its rows in the null space of all levels above, by an active-set method.
//!
//! With the rows of the working set above factorised as `L Q1^T` and `Q = [Q1 Z]`, the step is `p = Z z`, and `z` minimises
//! `|A Z z - (b - A x)|^2 + mu^2 |x + Z z|^2` over the residual rows `A` of the level: its equations, its violated
//! inequalities, and those that earlier steps met. The rows of `A Z` that are linearly independent are appended to the
//! factor, which leaves a triangular system, or a small least-squares problem where rows contradict each other or the level
//! is damped (Escande, Mansard & Wieber 2014; Dimitrov, Sherikov & Wieber 2015).

use crate::active_set::ActiveSet;
use crate::linalg::{LeastSquares, add_scaled, dot, norm};
use crate::problem::Problem;
use crate::residual_rows::{ResidualRows, choose_residual_rows, drop_residual_row, target};
use crate::tolerances::{INDEPENDENT, LAST_DIGITS, LIGHT_ROW, MULTIPLIER, NORM_UPDATE, REACHED, REFINEMENTS};
use crate::working_set::{Blocking, Constraint, RowState, Side};

/// Workspace of a level.
#[derive(Clone, Debug, Default)]
pub(crate) struct LevelSolver {
    /// Number of rows of the factor that belong to the levels and bounds above.
    above: usize,
    /// Number of independent residual rows: they are the first of `residual_rows`, and behind `above` in the factor.
    rank: usize,
    residual_rows: Vec<usize>,
    /// `Q^T` times each residual row, one after the other, [`Factor::stride`](crate::factor::Factor::stride) long. An
    /// independent row is as it was before its own reflection: its first entries are its row of `L`.
    transformed: Vec<f64>,
    /// The residual rows as they are before any of them is in the factor.
    by_constraints_above: ResidualRows,
    /// Share of each residual row outside the span of the factor, squared: now, and when it was last computed anew.
    remainders: Vec<(f64, f64)>,
    /// `b - A x` of each residual row.
    right: Vec<f64>,
    /// Residual of each residual row at the minimum.
    residuals: Vec<f64>,
    /// Sum of the absolute contributions to the gradient at the minimum; 0 where all of it is rounding.
    gradient_size: f64,
    /// Number of columns behind `above` in which the level moves: `rank`, or all of them where the residual rows determine
    /// every column. Then no row needs to be in the factor, but at the end those of a level that others follow.
    columns: usize,
    overdetermined: bool,
    /// The residual rows did not determine every column, or the factor is needed for the levels below.
    needs_factor: bool,
    /// The step in these columns.
    y: Vec<f64>,
    /// `Q^T x` of a damped level.
    transformed_x: Vec<f64>,
    least_squares: LeastSquares,
}

impl LevelSolver {
    pub(crate) fn with_capacity(unknowns: usize, rows: usize) -> Self {
        let n = unknowns.next_multiple_of(8);
        Self {
            residual_rows: Vec::with_capacity(rows),
            transformed: Vec::with_capacity(rows * n),
            by_constraints_above: ResidualRows::with_capacity(unknowns, rows),
            remainders: Vec::with_capacity(rows),
            right: Vec::with_capacity(rows),
            residuals: Vec::with_capacity(rows),
            y: Vec::with_capacity(n),
            transformed_x: Vec::with_capacity(n),
            least_squares: LeastSquares::with_capacity(rows + n, n),
            ..Self::default()
        }
    }

    /// Minimises level `k` and fixes its result for the levels below. Returns `false` after too many changes of the working
    /// set.
    pub(crate) fn solve(&mut self, problem: &Problem, set: &mut ActiveSet, k: usize) -> bool {
        choose_residual_rows(problem, set, k);
        self.y.resize(problem.unknowns(), 0.0);
        self.by_constraints_above.clear();
        let is_last = k + 1 == problem.levels.len();
        let changes = set.changes();
        self.needs_factor = problem.levels[k].damping > 0.0;
        loop {
            self.above = set.factor.len();
            // Most often nothing changes, and then the factor comes at once.
            self.overdetermined = !self.needs_factor && (is_last || set.changes() > changes);
            self.factorise(problem, set, k);
            if let Some(Blocking { constraint, side, .. }) = self.minimise(problem, set, k) {
                if !set.count_change() {
                    return false;
                }
                set.factor.truncate(self.above);
                set.activate(problem, k, constraint, side);
                continue;
            }
            self.ignore_rounding_of_levels_above(set);
            self.gradient_size = self.gradient_size(problem, set, k);
            let Some(constraint) = self.constraint_to_drop(problem, set, k) else {
                if is_last || !self.overdetermined {
                    break;
                }
                self.needs_factor = true;
                continue;
            };
            if !set.count_change() {
                return false;
            }
            set.factor.truncate(self.above);
            match constraint {
                Constraint::Row(row) if set.working_set.states[row] == RowState::Residual => {
                    drop_residual_row(problem, set, row);
                }
                _ => set.drop_constraint(problem, constraint),
            }
        }
        self.fix(set);
        true
    }

    /// Appends the independent residual rows to the factor, the largest remainder first.
    fn factorise(&mut self, problem: &Problem, set: &mut ActiveSet, k: usize) {
        self.by_constraints_above.update(problem, set, k);
        let (width, padded) = (set.factor.width(), set.factor.stride());
        self.residual_rows.clone_from(self.by_constraints_above.rows());
        self.transformed.clone_from(self.by_constraints_above.transformed());
        self.rank = 0;
        self.columns = width - self.above;
        self.overdetermined &= self.columns > 0 && self.residual_rows.len() >= self.columns;
        if self.overdetermined {
            return;
        }
        self.remainders.clear();
        for (s, &row) in self.residual_rows.iter().enumerate() {
            let length = norm(&self.transformed[s * padded + self.above..s * padded + width]);
            let share = if set.rows.is_nonzero(row) { (length / set.rows.norm(row)).powi(2) } else { 0.0 };
            self.remainders.push((share, share));
        }
        while self.rank < self.residual_rows.len() {
            let p = self.rank;
            let larger = |best: usize, s: usize| if self.remainders[s].0 > self.remainders[best].0 { s } else { best };
            let best = (p..self.residual_rows.len()).fold(p, larger);
            if set.factor.len() == width || self.remainders[best].0 <= INDEPENDENT * INDEPENDENT {
                break;
            }
            self.residual_rows.swap(p, best);
            self.remainders.swap(p, best);
            let (head, tail) = self.transformed.split_at_mut((p + 1) * padded);
            if best > p {
                head[p * padded..].swap_with_slice(&mut tail[(best - p - 1) * padded..(best - p) * padded]);
            }
            set.factor.append(&head[p * padded..], Constraint::Row(self.residual_rows[p]));
            self.rank += 1;
            self.transform_rows_behind_pivot(set);
        }
        self.columns = self.rank;
    }

    /// Applies the last reflection to the residual rows that are not in the factor, and updates their remainders.
    #[inline]
    fn transform_rows_behind_pivot(&mut self, set: &ActiveSet) {
        let (r, width, padded) = (set.factor.len() - 1, set.factor.width(), set.factor.stride());
        let tail = self.transformed[self.rank * padded..].chunks_exact_mut(padded);
        let rows = self.residual_rows[self.rank..].iter().zip(&mut self.remainders[self.rank..]);
        for (t, (&row, (share, computed))) in tail.zip(rows) {
            if *computed == 0.0 {
                continue;
            }
            set.factor.transform_by_last(t);
            *share -= (t[r] / set.rows.norm(row)).powi(2);
            if *share < NORM_UPDATE * *computed {
                *share = (norm(&t[r + 1..width]) / set.rows.norm(row)).powi(2);
                *computed = *share;
            }
        }
    }

    /// Steps to the minimum over the residual rows, computing the residual anew after each step. Returns the limit that
    /// blocks a step.
    fn minimise(&mut self, problem: &Problem, set: &mut ActiveSet, k: usize) -> Option<Blocking> {
        let damped = problem.levels[k].damping > 0.0;
        for attempt in 0..=REFINEMENTS {
            self.solve_least_squares(problem, set, k);
            if self.overdetermined && !self.determines_all_columns(set) {
                (self.overdetermined, self.needs_factor) = (false, true);
                self.factorise(problem, set, k);
                self.solve_least_squares(problem, set, k);
            }
            if attempt == REFINEMENTS || !self.step_is_noticeable(set, damped) {
                break;
            }
            self.compute_step(set, damped);
            let blocking = set.first_blocking(problem, k);
            set.advance(problem, blocking);
            if blocking.is_some() || self.has_reached_predicted_residuals(problem, set) {
                return blocking;
            }
        }
        None
    }

    /// Computes `y` and the residual of each residual row at the minimum.
    fn solve_least_squares(&mut self, problem: &Problem, set: &ActiveSet, k: usize) {
        let (above, rank, columns, rows) = (self.above, self.rank, self.columns, self.residual_rows.len());
        let (padded, damping) = (set.factor.stride(), problem.levels[k].damping);
        self.right.clear();
        self.right.extend(self.residual_rows.iter().map(|&row| target(problem, set, row) - set.value(problem, row)));
        self.residuals.clear();
        if rows == rank && damping == 0.0 {
            set.factor.solve_lower(above, &self.right, &mut self.y);
            self.residuals.resize(rows, 0.0);
            return;
        }
        let damped_rows = if damping > 0.0 { columns } else { 0 };
        self.least_squares.begin(rows + damped_rows, columns);
        for s in 0..rank {
            self.least_squares.set(s, &self.transformed[s * padded + above..][..s], self.right[s]);
            self.least_squares.set_entry(s, s, set.factor.diagonal(above + s));
        }
        for s in rank..rows {
            let own = &self.transformed[s * padded + above..s * padded + above + columns];
            self.least_squares.set(s, own, self.right[s]);
        }
        if damping > 0.0 {
            self.transformed_x.resize(padded, 0.0);
            set.factor.gather(&set.x, &mut self.transformed_x);
            set.factor.transform(&mut self.transformed_x, above + rank);
        }
        for r in 0..damped_rows {
            self.least_squares.set(rows + r, &[], -damping * self.transformed_x[above + r]);
            self.least_squares.set_entry(rows + r, r, damping);
        }
        self.least_squares.solve(&mut self.y);
        self.residuals.extend(self.least_squares.residual()[..rows].iter().map(|r| -r));
    }

    /// True where the residual rows are independent in all columns, beside the largest of them.
    fn determines_all_columns(&self, set: &ActiveSet) -> bool {
        let largest = self.residual_rows.iter().fold(0.0, |most: f64, &row| most.max(set.rows.norm(row)));
        self.least_squares.least_pivot() > INDEPENDENT * largest
    }

    /// Computes the step by unknown. Damping alone moves the directions that no row of the level contains.
    fn compute_step(&self, set: &mut ActiveSet, damped: bool) {
        let (above, end, width) = (self.above, self.above + self.columns, set.factor.width());
        set.work.fill(0.0);
        set.work[above..end].copy_from_slice(&self.y[..self.columns]);
        if damped {
            for (work, x) in set.work[end..width].iter_mut().zip(&self.transformed_x[end..width]) {
                *work = -x;
            }
        }
        set.factor.transform_back(&mut set.work);
        set.scatter_step();
    }

    /// True where the step changes the value of a residual row by more than [`REACHED`] of its rounding (of a damped level by
    /// more than its rounding), or the directions that only damping moves by more than rounding.
    fn step_is_noticeable(&self, set: &ActiveSet, damped: bool) -> bool {
        let (above, padded) = (self.above, set.factor.stride());
        if damped && set.exceeds_rounding_of_x(&self.transformed_x[above + self.columns..set.factor.width()]) {
            return true;
        }
        let share = if damped { 1.0 } else { REACHED };
        self.residual_rows.iter().enumerate().any(|(s, &row)| {
            let own = &self.transformed[s * padded + above..];
            let independent = s < self.rank;
            let end = if independent { s } else { self.columns };
            let diagonal = if independent { set.factor.diagonal(above + s) * self.y[s] } else { 0.0 };
            let change = dot(&own[..end], &self.y[..end]) + diagonal;
            change.abs() > share * set.rounding(row)
        })
    }

    /// True where a full step has left the residual that the least squares predict, up to rounding.
    fn has_reached_predicted_residuals(&self, problem: &Problem, set: &ActiveSet) -> bool {
        self.residual_rows.iter().zip(&self.residuals).all(|(&row, predicted)| {
            let residual = set.value(problem, row) - target(problem, set, row);
            (residual - predicted).abs() <= REACHED * set.rounding(row)
        })
    }

    /// Sets residuals of the size of rounding to zero for rows in the span of the levels above: rounding there causes them,
    /// and they have no multiplier.
    fn ignore_rounding_of_levels_above(&mut self, set: &ActiveSet) {
        let (above, padded) = (self.above, set.factor.stride());
        for s in self.rank..self.residual_rows.len() {
            let row = self.residual_rows[s];
            let own = &self.transformed[s * padded + above..s * padded + above + self.columns];
            if self.residuals[s].abs() <= set.rounding(row) && norm(own) <= INDEPENDENT * set.rows.norm(row) {
                self.residuals[s] = 0.0;
            }
        }
    }

    /// Sum of the absolute contributions to the gradient `A^T r + mu^2 x`; 0 where all residuals are rounding.
    fn gradient_size(&self, problem: &Problem, set: &ActiveSet, k: usize) -> f64 {
        let rows = self.residuals.iter().zip(&self.residual_rows);
        let size: f64 = rows.clone().map(|(residual, &row)| residual.abs() * set.rows.norm(row)).sum();
        let damping = problem.levels[k].damping;
        if damping > 0.0 {
            // A damped level has small residuals everywhere: those above the last digits of the values count.
            let digits = self.residual_rows.iter().map(|&row| LAST_DIGITS * set.rounding(row) * set.rows.norm(row));
            return size + (damping * damping * norm(&set.x) + digits.sum::<f64>() / MULTIPLIER);
        }
        // The residual of a row of zeros cannot change.
        let mut rows = rows;
        let counts = rows.any(|(residual, &row)| residual.abs() > set.rounding(row) && set.rows.is_nonzero(row));
        if counts { size } else { 0.0 }
    }

    /// The constraint whose multiplier has the wrong sign: a residual row, else a bound or a row above. Where there is none,
    /// fixes the constraints above that have a multiplier.
    fn constraint_to_drop(&self, problem: &Problem, set: &mut ActiveSet, k: usize) -> Option<Constraint> {
        let damped = problem.levels[k].damping > 0.0;
        if let Some(row) = self.most_dual_infeasible_row(set) {
            return Some(Constraint::Row(row));
        }
        self.compute_gradient(problem, set, k);
        set.compute_multipliers(problem, k, self.above, self.gradient_size);
        let dropped = set.most_dual_infeasible(k, &set.factor.constraints()[..self.above], self.gradient_size);
        if dropped.is_none() && !damped {
            set.fix_constraints_with_multipliers(k, self.above, self.gradient_size);
        }
        dropped
    }

    /// The residual inequality whose residual, which is its multiplier, violates its sign most. The residual that the least
    /// squares predict is also right for rows that are small beside others.
    fn most_dual_infeasible_row(&self, set: &ActiveSet) -> Option<usize> {
        if self.gradient_size == 0.0 {
            return None;
        }
        let mut worst: Option<(f64, usize)> = None;
        for (residual, &row) in self.residuals.iter().zip(&self.residual_rows) {
            let infeasibility = set.rows.norm(row) * set.working_set.sides[row].dual_infeasibility(*residual);
            let zero = if set.is_cycling() { MULTIPLIER * self.gradient_size } else { self.zero(set, row) };
            let is_worse = infeasibility > zero && worst.is_none_or(|(most, _)| infeasibility > most);
            if is_worse && !set.dropped.is_held(Constraint::Row(row)) {
                worst = Some((infeasibility, row));
            }
        }
        worst.map(|(_, row)| row)
    }

    /// Multiplier of a residual row, times its norm, that counts as zero. A light row beside heavy ones is judged by its own
    /// rounding.
    fn zero(&self, set: &ActiveSet, row: usize) -> f64 {
        (MULTIPLIER * self.gradient_size).min(LIGHT_ROW * set.rounding(row) * set.rows.norm(row))
    }

    /// Computes the gradient of the level, transformed, in `work`; and by unknown, in `gradient`, where the factor has columns
    /// left out.
    fn compute_gradient(&self, problem: &Problem, set: &mut ActiveSet, k: usize) {
        if self.gradient_size == 0.0 {
            return;
        }
        let (above, padded) = (self.above, set.factor.stride());
        let by_unknown = !set.factor.columns_left_out().is_empty();
        set.work.fill(0.0);
        set.gradient.fill(0.0);
        for (s, (residual, &row)) in self.residuals.iter().zip(&self.residual_rows).enumerate() {
            add_scaled(&mut set.work[..above], *residual, &self.transformed[s * padded..][..above]);
            if by_unknown {
                add_scaled(&mut set.gradient, *residual, set.rows.coefficients(problem, row));
            }
        }
        let damping = problem.levels[k].damping;
        if damping > 0.0 {
            add_scaled(&mut set.work[..above], damping * damping, &self.transformed_x[..above]);
            add_scaled(&mut set.gradient, damping * damping, &set.x);
        }
    }

    /// Puts the residual rows into the working set: equations and rows with a residual for all levels below, the others as
    /// active rows. No level is below an overdetermined one.
    fn fix(&self, set: &mut ActiveSet) {
        if self.overdetermined {
            return;
        }
        for (s, &row) in self.residual_rows.iter().enumerate() {
            let has_residual = self.residuals[s].abs() * set.rows.norm(row) > self.zero(set, row);
            let fixed = set.working_set.sides[row] == Side::Equality || (self.gradient_size > 0.0 && has_residual);
            set.working_set.states[row] = if fixed { RowState::Fixed } else { RowState::Active };
            if s >= self.rank {
                set.working_set.set_aside(row);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use crate::linalg::{add_scaled, norm};
    use crate::{Level, Problem, Solver, Status};

    /// Bounds, equations, inequalities, a level that determines all unknowns, and a level below it.
    fn random_problem(random: &mut Pcg64Mcg, n: usize) -> Problem {
        let mut problem = Problem::new(n);
        for i in 0..n {
            (problem.lower[i], problem.upper[i]) = (-random.random_range(0.0..0.5), random.random_range(0.0..0.5));
        }
        for (rows, width) in [(n / 6, 0.0), (n / 2, 0.4), (n + 2, 0.0), (3, 0.0)] {
            let mut level = Level::default();
            for _ in 0..rows {
                let row: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
                let right = random.random_range(-1.0..1.0);
                level.push(&row, right, right + width);
            }
            problem.levels.push(level);
        }
        problem
    }

    /// Damping whose square is zero changes no answer, and keeps the rows of a level in the factor all the time.
    #[test]
    fn a_level_factorised_by_columns_has_the_answers_and_multipliers_of_one_in_the_factor() {
        let seed = 20_261_202;
        println!("seed {seed}");
        let mut random = Pcg64Mcg::new(seed);
        let (mut worst, mut changes) = (0f64, 0);
        for case in 0..1000 {
            let problem = {
                let n = random.random_range(6..30);
                random_problem(&mut random, n)
            };
            let mut other = problem.clone();
            other.levels[2].damping = 1e-200;
            let (mut solver, mut in_factor) = (Solver::new(), Solver::new());
            for step in 0..2 {
                let solve = |solver: &mut Solver, problem| {
                    if step == 0 { solver.solve(problem) } else { solver.solve_next(problem) }
                };
                assert_eq!(solve(&mut solver, &problem), Ok(Status::Solved), "case {case}");
                assert_eq!(solve(&mut in_factor, &other), Ok(Status::Solved), "case {case}");
                changes += solver.changes();
                let off = solver.solution().iter().zip(in_factor.solution()).map(|(a, b)| (a - b).abs());
                worst = off.fold(worst, f64::max);
                assert!(worst < 1e-9, "case {case}, step {step}: off by {worst}");
                let (ours, theirs) = (solver.multipliers(2), in_factor.multipliers(2));
                let both = ours.bounds.iter().zip(theirs.bounds).chain(ours.rows.iter().zip(theirs.rows));
                let size = norm(theirs.bounds) + norm(theirs.rows) + 1.0;
                let off = both.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs() / size));
                assert!(off < 1e-8, "case {case}, step {step}: multipliers off by {off}");
                // More rows than unknowns are fixed for the level below: its multipliers are not the only ones, but they balance its gradient.
                let below = solver.multipliers(3);
                let mut left = below.bounds.to_vec();
                let levels = problem.levels[..3].iter().flat_map(|level| level.matrix.chunks_exact(left.len()));
                let rows: Vec<&[f64]> = levels.chain(problem.levels[3].matrix.chunks_exact(left.len())).collect();
                let weights = below.rows[..rows.len() - 3].iter().chain(solver.residual(3));
                rows.iter().zip(weights).for_each(|(row, weight)| add_scaled(&mut left, *weight, row));
                let size = norm(below.bounds) + norm(below.rows) + 1.0;
                assert!(norm(&left) < 1e-8 * size, "case {case}, step {step}: {left:?} is left of the gradient");
            }
        }
        println!("off by {worst:.1e} at most; {changes} changes");
        assert!(changes > 5000, "{changes}");
    }
}
