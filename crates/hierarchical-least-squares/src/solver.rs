//! Down the levels: what is fixed, what is active, what is still free.

use crate::diagonal::Diagonal;
use crate::factor::{Entry, Factor};
use crate::linalg::LeastSquares;
use crate::linalg::{dot, norm, norm_and_nonzeros};
use crate::multipliers::{Multipliers, Table};
use crate::problem::{LARGEST, Problem, ProblemError};

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every level is as small as the levels above allow, and every hard level holds.
    Solved,
    /// As [`Status::Solved`], but a level marked hard keeps a residual: the first such level.
    Infeasible {
        /// Which.
        level: usize,
    },
    /// It did not come to an end: the answer keeps the bounds, and is not the best.
    Stopped,
}

/// Which limit is active.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    None,
    Lower,
    Upper,
    /// Lower and upper limit are the same number.
    Both,
}

/// What a row is to the level that is being solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Holds, and is not active.
    Out,
    /// Its residual is being minimised.
    Soft,
    /// Holds and is active; a level below may leave it.
    Active,
    /// Holds as long as what is active holds, of which it is a combination: steps do not change it.
    Dependent,
    /// Never changes again.
    Fixed,
}

/// Relative size below which a row adds no new direction.
pub(crate) const INDEPENDENT: f64 = 1e-10;
/// Relative size of what counts as rounding in the value of a row.
pub(crate) const ROUNDING: f64 = 1e-12;
/// Relative size of a multiplier that counts as zero: what presses with more is needed for good.
pub(crate) const MULTIPLIER: f64 = 1e-11;
/// Rows shorter than this count as zero.
const NOTHING: f64 = 1e-60;

/// Solves a [`Problem`]; keeps its space, its last answer and what was active there. Nothing is allocated when a problem
/// of the same size is solved again.
#[derive(Clone, Debug, Default)]
pub struct Solver {
    pub(crate) x: Vec<f64>,
    /// Where the rows of each level begin; one more at the end.
    pub(crate) offsets: Vec<usize>,
    /// Level of each row, and its place there.
    pub(crate) places: Vec<(usize, usize)>,
    pub(crate) bounds: Vec<Side>,
    /// Bounds that a level above needs: they are not left again.
    pub(crate) held: Vec<bool>,
    /// By row, counted through all levels.
    pub(crate) sides: Vec<Side>,
    pub(crate) roles: Vec<Role>,
    pub(crate) norms: Vec<f64>,
    /// The only unknown in a row, where there is but one.
    pub(crate) single: Vec<Option<usize>>,
    /// The larger of the row's finite limits, in size.
    pub(crate) limits: Vec<f64>,
    /// Length of `x`.
    pub(crate) length: f64,
    /// What is left of each row.
    pub(crate) residuals: Vec<f64>,
    /// Is the last answer an answer?
    pub(crate) came_to_an_end: bool,
    /// The unknowns in the order of the factor's columns.
    pub(crate) order: Vec<usize>,
    pub(crate) factor: Factor,
    /// Fixed rows that say nothing new beside those in the factor.
    pub(crate) dependents: Vec<usize>,
    pub(crate) table: Table,
    /// Rows of the level in question, turned; their indices; their right-hand sides.
    pub(crate) turned: Vec<f64>,
    pub(crate) left: Vec<(f64, f64)>,
    pub(crate) soft: Vec<usize>,
    pub(crate) right: Vec<f64>,
    /// What the best step leaves of each soft row.
    pub(crate) kept: Vec<f64>,
    /// How strongly the soft rows pull, all together.
    pub(crate) size: f64,
    pub(crate) y: Vec<f64>,
    pub(crate) step: Vec<f64>,
    pub(crate) gradient: Vec<f64>,
    pub(crate) work: Vec<f64>,
    /// `x` turned, for a damped level.
    pub(crate) turned_x: Vec<f64>,
    pub(crate) entries: Vec<Entry>,
    pub(crate) least: LeastSquares,
    pub(crate) diagonal: Diagonal,
    pub(crate) changes: usize,
    pub(crate) limit: usize,
}

impl Solver {
    /// Knows nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Solves from zero (or the bound nearest to it), nothing active.
    ///
    /// # Errors
    /// [`ProblemError`] for lengths that do not fit and numbers without meaning.
    pub fn solve(&mut self, problem: &Problem) -> Result<Status, ProblemError> {
        self.measure(problem)?;
        self.forget();
        Ok(self.run(problem))
    }

    /// Forgets the last answer and what was active there.
    pub fn forget(&mut self) {
        self.x.clear();
        self.came_to_an_end = false;
        self.bounds.clear();
        self.sides.clear();
        self.table.starts.clear();
    }

    /// Solves from zero, with what was active in the last answer: for the next of a sequence of alike problems. The same
    /// answer as [`Solver::solve`] where the levels leave nothing open, usually with less work.
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn solve_next(&mut self, problem: &Problem) -> Result<Status, ProblemError> {
        self.measure(problem)?;
        self.x.clear();
        Ok(self.run(problem))
    }

    /// Solves from the last answer and what was active there. Where the last answer, with its multipliers, satisfies the
    /// optimality conditions of every level, it stays as it is, to the bit.
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn solve_again(&mut self, problem: &Problem) -> Result<Status, ProblemError> {
        self.measure(problem)?;
        if self.is_still_best(problem) {
            self.changes = 0;
            return Ok(self.report(problem));
        }
        Ok(self.run(problem))
    }

    /// The unknowns, `x`.
    pub fn solution(&self) -> &[f64] {
        &self.x
    }

    /// What is left of each row of a level, recomputed from the problem at the end.
    pub fn residual(&self, level: usize) -> &[f64] {
        &self.residuals[self.offsets[level]..self.offsets[level + 1]]
    }

    /// Length of [`Solver::residual`].
    pub fn residual_norm(&self, level: usize) -> f64 {
        norm(self.residual(level))
    }

    /// What the levels above and the bounds cost a level; nothing where nothing was solved since the start or
    /// [`Solver::forget`].
    pub fn multipliers(&self, level: usize) -> Multipliers<'_> {
        self.table.level(level)
    }

    /// Unknowns that stand at a bound which was active at the end; `true` for the upper one.
    pub fn active_bounds(&self) -> impl Iterator<Item = (usize, bool)> {
        let active = self.bounds.iter().enumerate().filter(|(_, side)| **side != Side::None);
        active.map(|(i, side)| (i, *side != Side::Lower))
    }

    /// How often the active set changed.
    pub fn changes(&self) -> usize {
        self.changes
    }

    fn run(&mut self, problem: &Problem) -> Status {
        self.came_to_an_end = self.descend(problem);
        if !self.came_to_an_end {
            // What was active the last time may be far from what is now: once more with nothing active.
            self.forget();
            self.came_to_an_end = self.descend(problem);
        }
        self.report(problem)
    }

    /// All levels in turn; `false` if one did not come to an end.
    fn descend(&mut self, problem: &Problem) -> bool {
        self.prepare(problem);
        let last = problem.levels.len().wrapping_sub(1);
        (0..problem.levels.len()).all(|k| {
            let single = if k == last { self.diagonal_level(problem, k) } else { None };
            single.unwrap_or_else(|| self.level(problem, k))
        })
    }

    /// Residuals, recomputed from the problem, and what they say.
    fn report(&mut self, problem: &Problem) -> Status {
        for row in 0..self.residuals.len() {
            self.residuals[row] = self.row_residual(problem, row);
        }
        self.came_to_an_end &= self.residuals.iter().chain(&self.x).all(|v| v.is_finite());
        if !self.came_to_an_end {
            return Status::Stopped;
        }
        let broken = |k: &usize| {
            problem.levels[*k].hard
                && (0..problem.levels[*k].rows()).any(|i| {
                    let row = self.offsets[*k] + i;
                    self.residuals[row].abs() > self.rounding(row)
                })
        };
        (0..problem.levels.len()).find(broken).map_or(Status::Solved, |level| Status::Infeasible { level })
    }

    fn prepare(&mut self, problem: &Problem) {
        let n = problem.unknowns();
        if self.x.len() != n {
            self.x.clear();
            self.x.resize(n, 0.0);
        }
        self.offsets.clear();
        self.places.clear();
        self.offsets.push(0);
        for (k, level) in problem.levels.iter().enumerate() {
            self.places.extend((0..level.rows()).map(|i| (k, i)));
            self.offsets.push(self.places.len());
        }
        let rows = self.places.len();
        if self.bounds.len() != n {
            self.bounds.clear();
            self.bounds.resize(n, Side::None);
        }
        if self.sides.len() != rows {
            self.sides.clear();
            self.sides.resize(rows, Side::None);
        }
        for i in 0..n {
            let (lower, upper) = (problem.lower[i], problem.upper[i]);
            self.bounds[i] = match self.bounds[i] {
                _ if lower == upper => Side::Both,
                Side::Lower if lower.is_finite() => Side::Lower,
                Side::Upper if upper.is_finite() => Side::Upper,
                _ => Side::None,
            };
            self.x[i] = match self.bounds[i] {
                Side::Lower | Side::Both => lower,
                Side::Upper => upper,
                Side::None => self.x[i].max(lower).min(upper),
            };
        }
        let reset = |v: &mut Vec<f64>, len: usize| {
            v.clear();
            v.resize(len, 0.0);
        };
        for v in [&mut self.step, &mut self.gradient, &mut self.y] {
            reset(v, n);
        }
        reset(&mut self.work, n.next_multiple_of(8));
        reset(&mut self.residuals, rows);
        self.arrange(problem);
        self.length = norm(&self.x);
        self.held.clear();
        self.held.resize(n, false);
        self.roles.clear();
        self.roles.resize(rows, Role::Out);
        self.table.reset(n, &self.offsets);
        self.dependents.clear();
        self.factor.reset(&self.order, |i| self.bounds[i] != Side::None);
        self.changes = 0;
        self.limit = 100 + 10 * (n + rows);
    }

    /// Where the first level touches less than half of many unknowns, these come first; few make short vectors anyway.
    fn arrange(&mut self, problem: &Problem) {
        let n = problem.unknowns();
        self.gradient.fill(0.0);
        for row in problem.levels.first().map_or(&[][..], |level| &level.matrix).chunks_exact(n.max(1)) {
            self.gradient.iter_mut().zip(row).for_each(|(sum, a)| *sum += a.abs());
        }
        let touched = |i: &usize| self.gradient[*i] > 0.0;
        let few = n >= 32 && 2 * (0..n).filter(touched).count() < n;
        self.order.clear();
        self.order.extend((0..n).filter(|i| few && touched(i)));
        self.order.extend((0..n).filter(|i| !(few && touched(i))));
    }

    /// Sizes of all rows, in one look at each, and whether the problem has a meaning.
    fn measure(&mut self, problem: &Problem) -> Result<(), ProblemError> {
        problem.check_limits()?;
        let n = problem.unknowns();
        self.norms.clear();
        self.limits.clear();
        self.single.clear();
        let finite = |v: f64| if v.is_finite() { v.abs() } else { 0.0 };
        let mut fits = true;
        for level in &problem.levels {
            for i in 0..level.rows() {
                let row = &level.matrix[i * n..(i + 1) * n];
                let (norm, count) = norm_and_nonzeros(row);
                // Most often the unknown behind that of the row before.
                let next = self.single.last().copied().flatten().map_or(0, |c| c + 1);
                let only = |c: &usize| row.get(*c).is_some_and(|a| *a != 0.0);
                let single = if count == 1 { [next].into_iter().chain(0..n).find(only) } else { None };
                self.norms.push(single.map_or(norm, |c| row[c].abs()));
                self.single.push(single);
                self.limits.push(finite(level.lower[i]).max(finite(level.upper[i])));
                fits &= norm <= LARGEST;
            }
        }
        // Coefficients that are too large, or no numbers, show in the lengths.
        if fits { Ok(()) } else { problem.check() }
    }

    /// One more change of the active set; `false` when there were too many.
    pub(crate) fn may_change(&mut self) -> bool {
        self.changes += 1;
        self.changes <= self.limit
    }

    /// So many changes that rounding must be at work: light rows beside heavy ones are no longer judged by their own.
    pub(crate) fn is_weary(&self) -> bool {
        self.changes > self.limit / 4
    }

    /// Level and row within it.
    pub(crate) fn place(&self, row: usize) -> (usize, usize) {
        self.places[row]
    }

    /// Rounding to be expected in the value of a row.
    pub(crate) fn rounding(&self, row: usize) -> f64 {
        ROUNDING * (self.limits[row] + self.norms[row] * self.length) + f64::MIN_POSITIVE
    }

    /// `a . x` of a row.
    pub(crate) fn value(&self, problem: &Problem, row: usize, x: &[f64]) -> f64 {
        value(problem, self.places[row], self.single[row], x)
    }

    /// What is left of a row, computed from the problem.
    pub(crate) fn row_residual(&self, problem: &Problem, row: usize) -> f64 {
        let (k, i) = self.place(row);
        let value = self.value(problem, row, &self.x);
        (value - problem.levels[k].upper[i]).max(0.0) + (value - problem.levels[k].lower[i]).min(0.0)
    }

    /// Does a row have any direction at all?
    pub(crate) fn is_something(&self, row: usize) -> bool {
        self.norms[row] > NOTHING
    }

    /// Adds the bound of unknown `i` behind what is in the factor. `false` if it says nothing new.
    pub(crate) fn activate_bound(&mut self, problem: &Problem, i: usize, side: Side) -> bool {
        self.bounds[i] = side;
        self.x[i] = if side == Side::Lower { problem.lower[i] } else { problem.upper[i] };
        self.work.fill(0.0);
        let Some(column) = self.factor.free.iter().position(|&f| f == i) else { return false };
        self.work[column] = 1.0;
        self.append(Entry::Bound(i), 1.0)
    }

    /// Adds the row that stands in `work`, not turned yet.
    fn append(&mut self, entry: Entry, size: f64) -> bool {
        let (r, w) = (self.factor.len(), self.factor.width());
        self.factor.turn(&mut self.work, 0, r);
        let new = r < w && norm(&self.work[r..w]) > INDEPENDENT * size;
        if new {
            self.factor.append(&self.work, entry);
        }
        new
    }

    /// Adds a row of a level behind what is in the factor.
    pub(crate) fn activate_row(&mut self, problem: &Problem, row: usize) -> bool {
        let (k, i) = self.place(row);
        let n = problem.unknowns();
        self.factor.gather(&problem.levels[k].matrix[i * n..(i + 1) * n], &mut self.work);
        self.append(Entry::Row(row), self.norms[row])
    }

    /// Leaves an active bound or row, and factorises the rest anew.
    pub(crate) fn leave(&mut self, problem: &Problem, dropped: Entry) {
        match dropped {
            Entry::Bound(i) => self.bounds[i] = Side::None,
            Entry::Row(row) => (self.roles[row], self.sides[row]) = (Role::Out, Side::None),
        }
        self.refactor(problem);
    }

    /// Factorises what is active and fixed anew, bounds as columns left out.
    pub(crate) fn refactor(&mut self, problem: &Problem) {
        self.entries.clear();
        self.entries.extend_from_slice(&self.factor.entries);
        self.entries.extend(self.dependents.iter().map(|&row| Entry::Row(row)));
        self.dependents.clear();
        for role in self.roles.iter_mut().filter(|role| **role == Role::Dependent) {
            *role = Role::Out;
        }
        self.factor.reset(&self.order, |i| self.bounds[i] != Side::None);
        for e in 0..self.entries.len() {
            let Entry::Row(row) = self.entries[e] else { continue };
            if self.roles[row] != Role::Out && !self.activate_row(problem, row) {
                self.lay_aside(row);
            }
        }
    }

    /// A row that says nothing new: kept in mind if it is fixed, not active otherwise.
    pub(crate) fn lay_aside(&mut self, row: usize) {
        if self.roles[row] == Role::Fixed {
            self.dependents.push(row);
        } else {
            (self.roles[row], self.sides[row]) = (Role::Dependent, Side::None);
        }
    }

    /// The first limit that the step meets before its end: how far (0 to 1), and whose.
    pub(crate) fn first_block(&self, problem: &Problem, k: usize) -> (f64, Option<(Entry, Side)>) {
        let length = norm(&self.step);
        let mut found = (1.0, None);
        let mut meet = |room: f64, speed: f64, entry: Entry, side: Side| {
            let share = (room / speed).max(0.0);
            if share < found.0 {
                found = (share, Some((entry, side)));
            }
        };
        for (i, &speed) in self.step.iter().enumerate() {
            if self.bounds[i] != Side::None || speed.abs() <= 1e-14 * length {
                continue;
            }
            if speed > 0.0 {
                meet(problem.upper[i] - self.x[i], speed, Entry::Bound(i), Side::Upper);
            } else {
                meet(problem.lower[i] - self.x[i], speed, Entry::Bound(i), Side::Lower);
            }
        }
        for j in 0..=k {
            let level = &problem.levels[j];
            for i in 0..level.rows() {
                let row = self.offsets[j] + i;
                if self.roles[row] != Role::Out || (level.lower[i].is_infinite() && level.upper[i].is_infinite()) {
                    continue;
                }
                let speed = self.value(problem, row, &self.step);
                if speed.abs() <= 1e-14 * length * self.norms[row] || !self.is_something(row) {
                    continue;
                }
                let value = self.value(problem, row, &self.x);
                if speed > 0.0 {
                    meet(level.upper[i] - value, speed, Entry::Row(row), Side::Upper);
                } else {
                    meet(level.lower[i] - value, speed, Entry::Row(row), Side::Lower);
                }
            }
        }
        found
    }

    /// `x += share step`, bounds kept exactly.
    pub(crate) fn advance(&mut self, problem: &Problem, share: f64) {
        // What stands at a bound has no step.
        let limits = problem.lower.iter().zip(&problem.upper);
        for ((x, step), (lower, upper)) in self.x.iter_mut().zip(&self.step).zip(limits) {
            let end = *x + share * step;
            let end = if end < *lower { *lower } else { end };
            *x = if end > *upper { *upper } else { end };
        }
        self.length = norm(&self.x);
    }
}

/// `a . x` of row `i` of level `k`, which may have a single unknown.
pub(crate) fn value(problem: &Problem, (k, i): (usize, usize), single: Option<usize>, x: &[f64]) -> f64 {
    let a = &problem.levels[k].matrix[i * x.len()..(i + 1) * x.len()];
    single.map_or_else(|| dot(a, x), |c| a[c] * x[c])
}
