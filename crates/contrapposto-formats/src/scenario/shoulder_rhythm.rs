//! Adds the task that the shoulder joints rise as the arms are raised.
//!
//! Without it an arm that reaches would shrug for nothing: no strength of the girdle is known, so its rise costs no effort. The task asks for the
//! rise that goes with the elevation of the upper arm: one row a shoulder, above effort and below all other tasks, so that a target out of reach is
//! reached by as much more as the girdle's range allows.

use contrapposto::tasks::{Height, PriorityLevel, Task};

use super::levels::{Level, add_above_effort};
use super::posture::free;
use super::stage::Stage;
use super::text::ScenarioText;
use crate::input_error::InputError;

/// Adds the task for the shoulders of the built-in adult whose rise is free, unless the file leaves it out. A body without supports and tasks
/// moves only what muscles relieve, and a rise has none.
pub(super) fn add_shoulder_rhythm(
    stage: &Stage<'_>,
    text: &ScenarioText,
    levels: &mut Vec<Level>,
) -> Result<(), InputError> {
    let Stage { at, model, supports, .. } = *stage;
    let by_default = !(supports.is_empty() && levels.is_empty());
    if !text.shoulder_rhythm.unwrap_or(by_default) {
        return Ok(());
    }
    let shoulders = Height::shoulder_rhythm(model);
    if text.shoulder_rhythm.is_some() && shoulders.is_empty() {
        let help =
            "leave it out; it is known for the built-in adult and for model files that were made of it".to_owned();
        return Err(at.error(&["shoulder_rhythm"], "the body has no coordinate `shoulder_rise_r`", Some(help)));
    }
    let free = free(at, model, text, |_| true)?;
    let of_free = shoulders.into_iter().filter(|(coordinate, _)| free[*coordinate]);
    let tasks: Vec<Task> = of_free.map(|(_, task)| Task::Height(task)).collect();
    if !tasks.is_empty() {
        add_above_effort(levels, PriorityLevel { tasks, ..PriorityLevel::default() }, model);
    }
    Ok(())
}
