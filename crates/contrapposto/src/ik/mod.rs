//! What should the body reach for, and which step brings it there?
//!
//! [`task`] says what can be asked, with error and Jacobian; a [`Goal`] is what is asked at one level of priority; an
//! [`Engine`] makes a step of it, or a whole posture. Ranges of motion and the largest step always hold; then the levels
//! follow in their order, and no level costs one above it anything (Baerlocher & Boulic 2004, "An inverse kinematics
//! architecture enforcing an arbitrary number of strict priority levels").

pub mod body;
mod curvature;
mod engine;
pub(crate) mod hold;
mod symmetric;
pub mod task;

pub(crate) use engine::bound_rates;
pub use engine::{Engine, GoalError, Options, Pose, Reached, Reason, Step};

use crate::constraint::HalfSpace;
use task::Task;

/// What is asked at one level of priority.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Goal {
    /// All of the same importance; their errors are weighed against each other in m, rad and shares of strength.
    pub tasks: Vec<Task>,
    /// Reliefs (Eqs. 4-6) on hinge and slide coordinates.
    pub half_spaces: Vec<HalfSpace>,
    /// It is meant to hold: where it cannot, the answer says so.
    pub hard: bool,
}

impl Goal {
    /// Rows of its level: the errors of its tasks, then its half-spaces.
    pub fn rows(&self) -> usize {
        self.tasks.iter().map(Task::rows).sum::<usize>() + self.half_spaces.len()
    }
}

impl From<Task> for Goal {
    fn from(task: Task) -> Self {
        Self { tasks: vec![task], ..Self::default() }
    }
}
