//! Holds what is asked at one level of priority: tasks and half-spaces.

use super::Task;
use crate::constraint::HalfSpace;

/// Tasks and half-spaces of one level of priority.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PriorityLevel {
    /// All of the same importance; their errors are weighed against each other in m, rad and shares of strength.
    pub tasks: Vec<Task>,
    /// Reliefs (Eqs. 4-6) on hinge and slide coordinates.
    pub half_spaces: Vec<HalfSpace>,
    /// It is meant to hold: where it cannot, the answer says so.
    pub hard: bool,
}

impl PriorityLevel {
    /// Rows of its level: the errors of its tasks, then its half-spaces.
    pub fn rows(&self) -> usize {
        self.tasks.iter().map(Task::rows).sum::<usize>() + self.half_spaces.len()
    }
}

impl From<Task> for PriorityLevel {
    fn from(task: Task) -> Self {
        Self { tasks: vec![task], ..Self::default() }
    }
}
