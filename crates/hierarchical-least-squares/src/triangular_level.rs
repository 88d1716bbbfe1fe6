//! Solves a last level of equations `R x = b` with an upper triangular `R`, as a Newton step has it, in the range space of the working set.
//!
//! In the unknowns `u = R x` the level is `min |u - b|^2`, and a constraint `c` of the working set is the row `w = R^-T c`. With these rows
//! factorised as `L Q1^T`, and `s = b - R x`, the step is `R^-1 (s - Q1 Q1^T s)`, and the multipliers are `L^-T Q1^T s` (Nocedal & Wright 2006,
//! "Numerical Optimization", section 16.2, the Schur-complement method). A constraint that enters or leaves costs a triangular solution and an
//! update of the factor, where the null space asks for a factorisation of all rows of the level.

use crate::active_set::ActiveSet;
use crate::factor::Factor;
use crate::identity_level::Outcome;
use crate::linalg::{dot, norm, solve_upper, solve_upper_transposed};
use crate::problem::Problem;
use crate::tolerances::{ILL_CONDITIONED, INDEPENDENT, REACHED, REFINEMENTS};
use crate::working_set::{Constraint, RowState, Side};

/// Workspace of such a level.
#[derive(Clone, Debug, Default)]
pub(crate) struct TriangularLevel {
    /// The rows `w` of the working set; its columns are those of `u`.
    factor: Factor,
    columns: Vec<usize>,
    /// Constraints of the working set whose rows depend on those of the factor.
    dependent: Vec<Constraint>,
    /// Constraints that enter when the level begins.
    entering: Vec<Constraint>,
    /// `s`, by row of the level.
    missing: Vec<f64>,
    /// `Q^T s`; its first entries stay while the step is taken back to `u`.
    transformed: Vec<f64>,
    /// A vector by column.
    work: Vec<f64>,
}

impl TriangularLevel {
    pub(crate) fn with_capacity(unknowns: usize) -> Self {
        let n = unknowns.next_multiple_of(8);
        Self {
            factor: Factor::with_capacity(n),
            columns: Vec::with_capacity(n),
            dependent: Vec::with_capacity(2 * n),
            entering: Vec::with_capacity(2 * n),
            missing: Vec::with_capacity(n),
            transformed: Vec::with_capacity(n),
            work: Vec::with_capacity(n),
        }
    }

    /// Minimises level `k`, the last one, by an active-set method, if it is an upper triangular system of equations that is not
    /// ill-conditioned. After [`Outcome::NotApplicable`] the general solver goes on.
    pub(crate) fn solve(&mut self, problem: &Problem, set: &mut ActiveSet, k: usize) -> Outcome {
        if !is_triangular(problem, k) {
            return Outcome::NotApplicable;
        }
        for row in set.rows.of_level(k) {
            set.working_set.set_row(row, RowState::Residual, Side::Equality);
        }
        self.begin(problem, set, k);
        loop {
            match self.minimise(problem, set, k) {
                Some((constraint, side)) => self.activate(problem, set, k, constraint, side),
                None => {
                    let Some(constraint) = self.constraint_to_drop(set, k) else { return Outcome::Solved };
                    self.drop_constraint(problem, set, k, constraint);
                }
            }
            if !set.count_change() {
                return Outcome::Stopped;
            }
        }
    }

    /// Factorises the rows of the working set: those of the factor that the levels above have left, bounds whose columns it leaves out, and rows
    /// that it has set aside.
    fn begin(&mut self, problem: &Problem, set: &ActiveSet, k: usize) {
        let n = problem.unknowns();
        self.columns.clear();
        self.columns.extend(0..n);
        self.transformed.clear();
        self.transformed.resize(n.next_multiple_of(8), 0.0);
        self.work.clear();
        self.work.resize(n.next_multiple_of(8), 0.0);
        self.entering.clear();
        self.entering.extend(set.factor.columns_left_out().iter().map(|&i| Constraint::Bound(i)));
        self.entering.extend_from_slice(set.factor.constraints());
        self.entering.extend(set.working_set.dependents.iter().map(|&row| Constraint::Row(row)));
        self.dependent.clear();
        self.factorise(problem, set, k);
    }

    /// Factorises the rows of the constraints in `entering` anew.
    fn factorise(&mut self, problem: &Problem, set: &ActiveSet, k: usize) {
        self.factor.reset(&self.columns, &[]);
        for c in 0..self.entering.len() {
            let constraint = self.entering[c];
            if !self.append(problem, set, k, constraint) {
                self.dependent.push(constraint);
            }
        }
    }

    /// Appends the row of a constraint to the factor; `false` if it depends on the rows there.
    fn append(&mut self, problem: &Problem, set: &ActiveSet, k: usize, constraint: Constraint) -> bool {
        let n = problem.unknowns();
        self.work.fill(0.0);
        match constraint {
            Constraint::Bound(i) => self.work[i] = 1.0,
            Constraint::Row(row) => self.work[..n].copy_from_slice(set.rows.coefficients(problem, row)),
        }
        let first = self.work[..n].iter().position(|entry| *entry != 0.0).unwrap_or(0);
        solve_upper_transposed(&problem.levels[k].matrix[first * n + first..], n, &mut self.work[first..n]);
        let length = norm(&self.work[..n]);
        let rank = self.factor.len();
        self.factor.transform(&mut self.work, rank);
        let independent = rank < n && norm(&self.work[rank..n]) > INDEPENDENT * length;
        if independent {
            self.factor.append(&self.work, constraint);
        }
        independent
    }

    /// Steps to the minimum within the working set, computing the residual anew after each step. Returns the limit that blocks a step, and its side.
    fn minimise(&mut self, problem: &Problem, set: &mut ActiveSet, k: usize) -> Option<(Constraint, Side)> {
        for attempt in 0..=REFINEMENTS {
            self.compute_step(problem, set, k);
            if attempt == REFINEMENTS || !self.step_is_noticeable(set, k) {
                break;
            }
            let blocking = set.first_blocking(problem, k);
            set.advance(problem, blocking);
            if let Some(blocking) = blocking {
                return Some((blocking.constraint, blocking.side));
            }
        }
        None
    }

    /// Computes `s`, `Q^T s`, and the step in `u` (in `work`) and by unknown.
    fn compute_step(&mut self, problem: &Problem, set: &mut ActiveSet, k: usize) {
        let (n, rank, level) = (problem.unknowns(), self.factor.len(), &problem.levels[k]);
        self.missing.clear();
        let rows = level.matrix.chunks_exact(n).zip(&level.upper).enumerate();
        self.missing.extend(rows.map(|(i, (row, right))| right - dot(&row[i..], &set.x[i..])));
        self.transformed[..n].copy_from_slice(&self.missing);
        self.transformed[n..].fill(0.0);
        self.factor.transform(&mut self.transformed, rank);
        self.work.copy_from_slice(&self.transformed);
        self.work[..rank].fill(0.0);
        self.factor.transform_back(&mut self.work);
        set.step.copy_from_slice(&self.work[..n]);
        solve_upper(&level.matrix, n, &mut set.step);
        for (step, side) in set.step.iter_mut().zip(&set.working_set.bounds) {
            if *side != Side::Inactive {
                *step = 0.0;
            }
        }
    }

    /// True where the step changes the value of a row by more than [`REACHED`] of its rounding.
    fn step_is_noticeable(&self, set: &ActiveSet, k: usize) -> bool {
        let mut changes = self.work.iter().zip(set.rows.of_level(k));
        changes.any(|(change, row)| change.abs() > REACHED * set.rounding(row))
    }

    /// Puts a limit that blocked a step into the working set.
    fn activate(&mut self, problem: &Problem, set: &mut ActiveSet, k: usize, constraint: Constraint, side: Side) {
        set.dropped.block(constraint, side);
        match constraint {
            Constraint::Bound(i) => set.move_to_bound(problem, i, side),
            Constraint::Row(row) => set.working_set.set_row(row, RowState::Active, side),
        }
        if self.append(problem, set, k, constraint) {
            return;
        }
        match constraint {
            Constraint::Bound(_) => self.dependent.push(constraint),
            Constraint::Row(row) => set.working_set.set_aside(row),
        }
    }

    /// Drops a constraint, and appends those that depended on it.
    fn drop_constraint(&mut self, problem: &Problem, set: &mut ActiveSet, k: usize, dropped: Constraint) {
        set.drop_from_working_set(dropped);
        let row = self.factor.constraints().iter().position(|constraint| *constraint == dropped);
        if row.is_some_and(|row| self.factor.remove(row)) {
            for _ in 0..self.dependent.len() {
                let constraint = self.dependent.remove(0);
                if !self.append(problem, set, k, constraint) {
                    self.dependent.push(constraint);
                }
            }
            return;
        }
        self.entering.clear();
        self.entering.extend(self.factor.constraints().iter().filter(|constraint| **constraint != dropped));
        self.entering.append(&mut self.dependent);
        self.factorise(problem, set, k);
    }

    /// Computes the multipliers; gives the bound or row above whose multiplier has the wrong sign.
    fn constraint_to_drop(&mut self, set: &mut ActiveSet, k: usize) -> Option<Constraint> {
        let first = set.rows.of_level(k).start;
        let rows = self.missing.iter().enumerate().map(|(i, missing)| (missing.abs(), first + i));
        let counts = rows.clone().any(|(missing, row)| missing > set.rounding(row));
        let size: f64 = if counts { rows.map(|(missing, row)| missing * set.rows.norm(row)).sum() } else { 0.0 };
        let (bounds, rows) = set.multipliers.level_mut(k);
        bounds.fill(0.0);
        rows.fill(0.0);
        if size == 0.0 {
            return None;
        }
        let rank = self.factor.len();
        self.factor.solve_lower_transposed(rank, &mut self.transformed);
        for (multiplier, constraint) in self.transformed.iter().zip(self.factor.constraints()) {
            match *constraint {
                Constraint::Bound(i) => bounds[i] = *multiplier,
                Constraint::Row(row) => rows[row] = *multiplier,
            }
        }
        set.most_dual_infeasible(k, self.factor.constraints(), size)
    }
}

/// True for an undamped level with an equation for each unknown, zeros below its diagonal, and diagonal entries of similar size.
fn is_triangular(problem: &Problem, k: usize) -> bool {
    let (level, n) = (&problem.levels[k], problem.unknowns());
    if level.rows() != n || n < 2 || level.damping > 0.0 || level.lower != level.upper {
        return false;
    }
    let rows = || level.matrix.chunks_exact(n).enumerate();
    let (least, most) = rows().fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), (i, row)| {
        (least.min(row[i].abs()), most.max(row[i].abs()))
    });
    least > ILL_CONDITIONED * most && rows().all(|(i, row)| row[..i].iter().all(|entry| *entry == 0.0))
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use crate::linalg::norm;
    use crate::{Level, Problem, Solver, Status};

    use super::is_triangular;

    /// Bounds, a level of equations, one of inequalities, and an upper triangular one.
    fn random_problem(random: &mut Pcg64Mcg, n: usize) -> Problem {
        let mut problem = Problem::new(n);
        for i in 0..n {
            if random.random_range(0..4) > 0 {
                problem.lower[i] = -random.random_range(0.0..1.0);
                problem.upper[i] = random.random_range(0.0..1.0);
            }
        }
        let mut level = |rows: usize, inequality: bool| {
            let mut level = Level::default();
            for _ in 0..rows {
                let row: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
                let right = random.random_range(-0.5..0.5);
                level.push(&row, right, if inequality { right + random.random_range(0.0..0.5) } else { right });
            }
            level
        };
        problem.levels.extend([level(n / 5, false), level(n / 2, true)]);
        let mut last = Level::default();
        for r in 0..n {
            let mut row: Vec<f64> = (0..n).map(|j| if j > r { random.random_range(-1.0..1.0) } else { 0.0 }).collect();
            row[r] = random.random_range(0.5..3.0);
            let right = random.random_range(-2.0..2.0);
            last.push(&row, right, right);
        }
        problem.levels.push(last);
        problem
    }

    /// The same problem with the rows of its last level in the opposite order: the general solver solves it.
    fn reversed(problem: &Problem) -> Problem {
        let (mut other, n) = (problem.clone(), problem.unknowns());
        if let Some(last) = other.levels.last_mut() {
            let given = std::mem::take(last);
            (0..n).rev().for_each(|r| last.push(&given.matrix[r * n..(r + 1) * n], given.lower[r], given.upper[r]));
        }
        other
    }

    #[test]
    fn answers_and_multipliers_are_those_of_the_general_solver() {
        let seed = 20_261_130;
        println!("seed {seed}");
        let mut random = Pcg64Mcg::new(seed);
        let (mut worst, mut changes) = (0f64, [0; 2]);
        for case in 0..2000 {
            let n = random.random_range(3..30);
            let problem = random_problem(&mut random, n);
            let other = reversed(&problem);
            assert!(is_triangular(&problem, 2) && !is_triangular(&other, 2));
            let (mut solver, mut general) = (Solver::new(), Solver::new());
            for step in 0..3 {
                let solve = |solver: &mut Solver, problem: &Problem| match step {
                    0 => solver.solve(problem),
                    1 => solver.solve_next(problem),
                    _ => solver.solve_near(problem),
                };
                assert_eq!(solve(&mut solver, &problem), Ok(Status::Solved), "case {case}");
                assert_eq!(solve(&mut general, &other), Ok(Status::Solved), "case {case}");
                let off = solver.solution().iter().zip(general.solution()).map(|(a, b)| (a - b).abs());
                worst = off.fold(worst, f64::max);
                assert!(worst < 1e-9, "case {case}, step {step}: off by {worst}");
                changes[0] += solver.changes();
                changes[1] += general.changes();
                let (ours, theirs) = (solver.multipliers(2), general.multipliers(2));
                let both = ours.bounds.iter().zip(theirs.bounds).chain(ours.rows.iter().zip(theirs.rows));
                let size = norm(theirs.bounds) + norm(theirs.rows) + 1.0;
                let off = both.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs() / size));
                assert!(off < 1e-8, "case {case}, step {step}: multipliers off by {off}");
            }
        }
        println!("off by {worst:.1e} at most; {} and {} changes", changes[0], changes[1]);
    }

    /// After a warm start equations may say what active bounds say: they depend on these, and hold alone once a bound leaves.
    #[test]
    fn equations_that_depend_on_bounds_hold_where_the_bounds_leave() {
        let seed = 20_261_201;
        println!("seed {seed}");
        let mut random = Pcg64Mcg::new(seed);
        let mut held = 0;
        for case in 0..500 {
            let n = random.random_range(10..30);
            let problem = random_problem(&mut random, n);
            let mut solver = Solver::new();
            assert_eq!(solver.solve(&problem), Ok(Status::Solved), "case {case}");
            let x = solver.solution().to_vec();
            let mut next = problem.clone();
            let at_bounds = (0..n).filter(|&i| x[i] == problem.lower[i] || x[i] == problem.upper[i]);
            for (row, i) in (0..problem.levels[0].rows()).zip(at_bounds) {
                let level = &mut next.levels[0];
                level.matrix[row * n..(row + 1) * n].fill(0.0);
                level.matrix[row * n + i] = 1.0;
                (level.lower[row], level.upper[row]) = (x[i], x[i]);
                held += 1;
            }
            // What pulled the unknowns to their bounds pulls them away.
            let last = &mut next.levels[2];
            last.lower.iter_mut().chain(&mut last.upper).for_each(|right| *right = -*right);
            assert_eq!(solver.solve_next(&next), Ok(Status::Solved), "case {case}");
            let mut general = Solver::new();
            assert_eq!(general.solve(&reversed(&next)), Ok(Status::Solved), "case {case}");
            let off = solver.solution().iter().zip(general.solution()).map(|(a, b)| (a - b).abs());
            let off = off.fold(0.0, f64::max);
            assert!(off < 1e-9, "case {case}: off by {off}");
        }
        assert!(held > 500, "{held}");
    }

    #[test]
    fn a_level_that_is_nearly_singular_is_left_to_the_general_solver() {
        let mut random = Pcg64Mcg::new(3);
        let mut problem = random_problem(&mut random, 8);
        assert!(is_triangular(&problem, 2));
        problem.levels[2].matrix[7 * 8 + 7] = 1e-9;
        assert!(!is_triangular(&problem, 2));
        assert_eq!(Solver::new().solve(&problem), Ok(Status::Solved));
    }
}
