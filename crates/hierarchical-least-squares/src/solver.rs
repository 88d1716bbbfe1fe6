//! Solves a problem level by level.

use crate::active_set::ActiveSet;
use crate::identity_level::{IdentityLevel, Outcome};
use crate::level_solver::LevelSolver;
use crate::linalg::norm;
use crate::multipliers::Multipliers;
use crate::problem::{Problem, ProblemError};
use crate::triangular_level::TriangularLevel;

/// End of a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every level is as small as the levels above allow, and every hard level is satisfied. Where more constraints meet in one point than are
    /// independent, rounding may leave a level larger.
    Solved,
    /// As [`Status::Solved`], but a level marked hard keeps a residual: the first such level.
    Infeasible {
        /// Index of the level.
        level: usize,
    },
    /// The working set changed too often, or a number is not finite: the answer satisfies the bounds and is not optimal.
    Stopped,
}

/// Solves a [`Problem`], and keeps its workspace, the last answer and its working set. Nothing is allocated when a problem of
/// the same size is solved again.
#[derive(Clone, Debug, Default)]
pub struct Solver {
    active_set: ActiveSet,
    level: LevelSolver,
    identity_level: IdentityLevel,
    triangular_level: TriangularLevel,
    /// Residual of each row at the answer.
    residuals: Vec<f64>,
}

impl Solver {
    /// A solver without an answer; it allocates when a problem is solved.
    pub fn new() -> Self {
        Self::default()
    }

    /// A solver that does not allocate for problems up to this size: `unknowns`, `levels`, `rows_of_level` in one level,
    /// `rows` in all levels.
    pub fn with_capacity(unknowns: usize, levels: usize, rows_of_level: usize, rows: usize) -> Self {
        Self {
            active_set: ActiveSet::with_capacity(unknowns, levels, rows),
            level: LevelSolver::with_capacity(unknowns, rows_of_level),
            identity_level: IdentityLevel::with_capacity(unknowns),
            triangular_level: TriangularLevel::with_capacity(unknowns),
            residuals: Vec::with_capacity(rows),
        }
    }

    /// Solves from zero (or the bound nearest to it) with an empty working set.
    ///
    /// # Errors
    /// [`ProblemError`] for lengths that do not fit and numbers that are not accepted.
    pub fn solve(&mut self, problem: &Problem) -> Result<Status, ProblemError> {
        self.active_set.rows.measure(problem)?;
        self.forget();
        Ok(self.run(problem))
    }

    /// Solves from zero with the working set of the last answer (warm start), for the next of a sequence of similar problems.
    /// Where the levels determine all unknowns, the answer is that of [`Solver::solve`], usually after less work.
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn solve_next(&mut self, problem: &Problem) -> Result<Status, ProblemError> {
        self.active_set.rows.measure(problem)?;
        self.active_set.x.clear();
        Ok(self.run(problem))
    }

    /// Solves from the last answer with its working set, for the next of a sequence of problems whose answers are near each
    /// other. Where the levels determine all unknowns, the answer is that of [`Solver::solve`]; other unknowns stay near the
    /// last answer. After [`Solver::forget`], or where the last answer is not finite, this is [`Solver::solve`].
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn solve_near(&mut self, problem: &Problem) -> Result<Status, ProblemError> {
        self.active_set.rows.measure(problem)?;
        if !self.active_set.x.iter().all(|x| x.is_finite()) {
            self.forget();
        }
        Ok(self.run(problem))
    }

    /// Forgets the last answer and its working set.
    pub fn forget(&mut self) {
        self.active_set.clear();
    }

    /// The unknowns, `x`.
    pub fn solution(&self) -> &[f64] {
        &self.active_set.x
    }

    /// The residual of each row of a level, computed from the problem at the answer.
    pub fn residual(&self, level: usize) -> &[f64] {
        &self.residuals[self.active_set.rows.of_level(level)]
    }

    /// Euclidean norm of [`Solver::residual`].
    pub fn residual_norm(&self, level: usize) -> f64 {
        norm(self.residual(level))
    }

    /// The multipliers of a level; empty before the first solution and after [`Solver::forget`].
    pub fn multipliers(&self, level: usize) -> Multipliers<'_> {
        self.active_set.multipliers.level(level)
    }

    /// Number of changes of the working set.
    pub fn changes(&self) -> usize {
        self.active_set.changes()
    }

    fn run(&mut self, problem: &Problem) -> Status {
        let mut converged = self.solve_levels(problem);
        if !converged {
            // The working set of the last answer may be far from that of this problem: once more with an empty one.
            self.forget();
            converged = self.solve_levels(problem);
        }
        self.compute_status(problem, converged)
    }

    /// Solves all levels in turn; `false` if one did not converge.
    fn solve_levels(&mut self, problem: &Problem) -> bool {
        self.active_set.prepare(problem);
        let set = &mut self.active_set;
        (0..problem.levels.len()).all(|k| {
            let is_last = k + 1 == problem.levels.len();
            set.dropped.clear();
            let mut outcome = if is_last { self.identity_level.solve(problem, set, k) } else { Outcome::NotApplicable };
            if is_last && outcome == Outcome::NotApplicable {
                outcome = self.triangular_level.solve(problem, set, k);
            }
            match outcome {
                Outcome::NotApplicable => self.level.solve(problem, set, k),
                outcome => outcome == Outcome::Solved,
            }
        })
    }

    /// Computes the residuals from the problem, and the status from them.
    fn compute_status(&mut self, problem: &Problem, converged: bool) -> Status {
        let set = &self.active_set;
        self.residuals.clear();
        self.residuals.extend((0..set.rows.count()).map(|row| set.rows.residual(problem, row, &set.x)));
        if !converged || !self.residuals.iter().chain(&set.x).all(|v| v.is_finite()) {
            return Status::Stopped;
        }
        let is_violated = |k: &usize| {
            let mut rows = set.rows.of_level(*k);
            problem.levels[*k].hard && rows.any(|row| self.residuals[row].abs() > set.rounding(row))
        };
        (0..problem.levels.len()).find(is_violated).map_or(Status::Solved, |level| Status::Infeasible { level })
    }
}
