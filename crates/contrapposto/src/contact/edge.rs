//! Solves for contact forces, with a slack where the weight acts at the very edge of the supports.
//!
//! At the edge the forces that hold the body exactly are few, however much muscles work or a support carries with them: the last digits of a
//! posture would decide, and forces jump from one posture to the next. There equilibrium may be missed by as much as counts as held
//! ([`HELD`]), and a share that cannot be kept by a millionth more than it must.

use super::forces::{ContactForces, EFFORT, HELD, ROOT, SHARE};
use hierarchical_least_squares::{ProblemError, Status};

/// Change of effort that so little of equilibrium may make, `1/2 sum (tau_a / S)^2`; where it makes more the weight acts at the edge (assumed).
const MOST_CHANGE: f64 = 1e-6;
/// Addition to the least that a support must carry beyond its share, in body weights: room for muscles to work less (assumed).
const SHARE_SLACK: f64 = 1e-6;

impl ContactForces {
    /// Solves for the forces. The levels keep a slack until they are filled anew.
    pub(super) fn solve(&mut self) -> Result<(), ProblemError> {
        let mut status = self.solver.solve_near(&self.problem)?;
        if status != Status::Solved {
            // What is missing does not depend, in its last digits, on the postures before.
            status = self.solver.solve(&self.problem)?;
        }
        let root = &self.problem.levels[ROOT];
        let has_slack = root.lower != root.upper;
        let decided = status == Status::Solved && self.is_near(SHARE) && !self.is_at_the_edge();
        if has_slack || decided || !self.is_near(ROOT) {
            return Ok(());
        }
        let level = &mut self.problem.levels[ROOT];
        level.lower.iter_mut().for_each(|lower| *lower -= HELD);
        level.upper.iter_mut().for_each(|upper| *upper += HELD);
        self.solver.solve_near(&self.problem)?;
        if !self.is_near(SHARE) {
            let beyond = self.solver.residual(SHARE);
            let level = &mut self.problem.levels[SHARE];
            level.upper.iter_mut().zip(beyond).for_each(|(upper, beyond)| *upper += beyond + SHARE_SLACK);
            self.solver.solve_near(&self.problem)?;
        }
        Ok(())
    }

    /// Whether effort depends on the last digits of equilibrium.
    fn is_at_the_edge(&self) -> bool {
        let first = self.problem.levels[..ROOT].iter().map(|level| level.rows()).sum();
        let root = self.solver.multipliers(EFFORT).rows.iter().skip(first).take(self.problem.levels[ROOT].rows());
        HELD * root.fold(0.0, |most: f64, multiplier| most.max(multiplier.abs())) > MOST_CHANGE
    }

    /// Whether a level is met as nearly as equilibrium counts as held.
    pub(super) fn is_near(&self, level: usize) -> bool {
        self.solver.residual(level).iter().all(|left| left.abs() <= HELD)
    }
}
