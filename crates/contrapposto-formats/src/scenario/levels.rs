//! Reads the tasks of a scenario by priority.

use contrapposto::model::Model;
use contrapposto::tasks::{PriorityLevel, Task};

use super::stage::Stage;
use super::task::task;
use super::task_text::TaskText;
use crate::input_error::InputError;

/// Tasks of one priority.
pub(super) struct Level {
    pub(super) tasks: PriorityLevel,
    /// A name for each task.
    pub(super) labels: Vec<String>,
    /// More important than the relief of tired muscles.
    pub(super) above_relief: bool,
    /// Not of the file, but added by default.
    pub(super) added: bool,
}

/// The tasks by priority.
pub(super) fn levels(stage: &Stage<'_>, texts: &[TaskText]) -> Result<Vec<Level>, InputError> {
    let mut levels: Vec<Level> = vec![];
    for (i, text) in texts.iter().enumerate() {
        let task = task(stage, i, text)?;
        let label = task.label(stage.model);
        match levels.last_mut() {
            Some(before) if text.same_priority => {
                before.tasks.tasks.push(task);
                before.labels.push(label);
                before.above_relief |= text.above_relief;
                before.tasks.demanded |= text.above_relief;
            }
            None if text.same_priority => {
                let path = ["task", &i.to_string(), "same_priority"];
                let help = Some("leave it out".to_owned());
                return Err(stage.at.key_error(&path, "no task stands before the first one", help));
            }
            _ => levels.push(Level {
                tasks: PriorityLevel { demanded: text.above_relief, ..task.into() },
                labels: vec![label],
                above_relief: text.above_relief,
                added: false,
            }),
        }
    }
    Ok(levels)
}

/// Whether one of these tasks is effort.
pub(super) fn is_effort(level: &PriorityLevel) -> bool {
    level.tasks.iter().any(|task| matches!(task, Task::Effort(_)))
}

/// Adds tasks that the file does not name, just above effort, or as the last level.
pub(super) fn add_above_effort(levels: &mut Vec<Level>, tasks: PriorityLevel, model: &Model) {
    let place = levels.iter().position(|level| is_effort(&level.tasks)).unwrap_or(levels.len());
    let labels = tasks.tasks.iter().map(|task| task.label(model)).collect();
    levels.insert(place, Level { tasks, labels, above_relief: false, added: true });
}
