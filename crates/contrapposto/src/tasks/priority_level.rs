//! One level of priority: tasks and half-spaces of the same importance.

use super::task::Task;
use crate::constraint::HalfSpace;

/// Tasks and half-spaces of one level of priority.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PriorityLevel {
    /// All of the same importance; their errors are weighed against each other in m, rad and shares of strength.
    pub tasks: Vec<Task>,
    /// Reliefs (Eqs. 4-6) on hinge and slide coordinates.
    pub half_spaces: Vec<HalfSpace>,
    /// A level that must be met; the status of a step says where it is not.
    pub hard: bool,
    /// A job that misses a target of this level is not done, whatever stands above the level. The steps are the same.
    pub demanded: bool,
}

impl PriorityLevel {
    /// Whether the level asks for something.
    pub(crate) fn asks(&self) -> bool {
        !self.tasks.is_empty() || !self.half_spaces.is_empty()
    }

    /// Number of rows: the errors of the tasks, then the half-spaces.
    pub(crate) fn rows(&self) -> usize {
        self.tasks.iter().map(Task::rows).sum::<usize>() + self.half_spaces.len()
    }
}

impl From<Task> for PriorityLevel {
    fn from(task: Task) -> Self {
        Self { tasks: vec![task], ..Self::default() }
    }
}
