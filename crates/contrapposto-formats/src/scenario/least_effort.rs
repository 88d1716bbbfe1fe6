//! Adds the task `effort` to a job that does not name it.
//!
//! Without it a body keeps the angles of its start: with straight elbows its muscles press against the ligaments of the elbow until they
//! fail. A person lets go of what no task needs.

use contrapposto::model::Model;
use contrapposto::tasks::{Effort, Task};

use super::levels::{Level, is_effort};
use super::stage::Stage;
use super::text::ScenarioText;
use crate::input_error::InputError;
use crate::toml_file::Located;

/// Note for the reader where the task was added by default.
const LEAST_EFFORT_NOTE: &str = "no task asks for little effort; `effort` of all muscles was added as the last one (`least_effort = false` leaves it out)";

/// Adds the effort of all muscles as the last task, if no task of the file is effort and the file asks for it or leaves it to the default:
/// that of the built-in adult on supports in a run. Returns a note for the reader where the file says nothing.
pub(super) fn add_least_effort(
    stage: &Stage<'_>,
    text: &ScenarioText,
    levels: &mut Vec<Level>,
) -> Result<Option<&'static str>, InputError> {
    let by_default = text.model.file.is_none() && !stage.supports.is_empty() && text.run.is_some();
    if !text.least_effort.unwrap_or(by_default) || levels.iter().any(|level| is_effort(&level.tasks)) {
        return Ok(None);
    }
    let effort = effort_of_all(stage.at, stage.model)?;
    let labels = vec![effort.label(stage.model)];
    levels.push(Level { tasks: effort.into(), labels, above_relief: false, added: true });
    Ok(text.least_effort.is_none().then_some(LEAST_EFFORT_NOTE))
}

/// The effort of all muscles with known strength.
pub(super) fn effort_of_all(at: &Located, model: &Model) -> Result<Task, InputError> {
    let effort = Effort::whole(model);
    if effort.coordinates.is_empty() {
        let help = "give the body strengths with an overlay; `contrapposto inspect` shows what is known".to_owned();
        let message = "of no coordinate of this body the strength is known, so nothing is effort";
        return Err(at.error(&["model"], message, Some(help)));
    }
    Ok(Task::Effort(effort))
}
