//! How far may steps of posture and contact forces go, what comes of them, and why were they refused?

use crate::contact::{Balance, SupportError};
use crate::posture::Posture;
use crate::posture_solver::inverse_kinematics::GoalError;
use crate::tasks::body::BodyError;
use hierarchical_least_squares::{ProblemError, Status};

/// How far a step may go, and when steps end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest change of any rate in one step, rad or m.
    pub max_step: f64,
    /// Largest number of steps of [`Engine::solve`](super::Engine::solve).
    pub max_steps: usize,
    /// Steps end when no rate would change by more than this, rad or m.
    pub still: f64,
    /// Steps end when several in a row lower the merit by less than this share of it.
    pub gain: f64,
    /// Steps that made things worse are taken back; without it every step counts, and the next one is shorter.
    pub guarded: bool,
    /// Valleys of effort that [`Engine::solve`](super::Engine::solve) looks into before its steps: 1 for the nearest one, more for others beside it; 0
    /// for steps alone, which stay nearest to the start.
    pub valleys: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { max_step: 0.3, max_steps: 200, still: 1e-9, gain: 1e-9, guarded: true, valleys: 12 }
    }
}

/// Why a body, its supports or its goals were refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RelaxError {
    /// A support does not fit the model.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// A goal does not fit the model.
    #[error(transparent)]
    PriorityLevel(#[from] GoalError),
    /// The posture or a load does not fit the model.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// Numbers so large that the rows of a task are not finite.
    #[error("the goals have no finite rows in this posture: {0}")]
    Rows(#[from] ProblemError),
}

/// What one step did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Largest change of any rate, rad or m.
    pub largest: f64,
    /// The step before this one made things worse and was taken back.
    pub taken_back: bool,
    /// What the solver says of the linearised problem.
    pub status: Status,
}

/// Why [`Engine::solve`](super::Engine::solve) ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Nothing moves any more, or nothing is gained.
    Settled,
    /// The largest number of steps was made.
    Steps,
}

/// Where [`Engine::solve`](super::Engine::solve) came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxed {
    /// All coordinates.
    pub posture: Posture,
    /// Sum of squares of the effort level, 0 without one.
    pub effort: f64,
    /// Length of the error of each goal, in its units.
    pub errors: Vec<f64>,
    /// How far supports are off their places: lengths of the errors in m and rad together.
    pub slip: f64,
    /// Is the root in equilibrium?
    pub balance: Balance,
    /// Why it ended there.
    pub reason: Reason,
    /// Steps made.
    pub steps: usize,
}
