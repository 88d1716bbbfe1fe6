//! Reads a scenario for `contrapposto inspect`: its body at the start, and all that the file and its things became.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto::tasks::{Task, Thing};

use super::setup::Setup;
use super::text::ScenarioText;
use crate::input_error::InputError;
use crate::toml_file::{Located, read_toml};

/// A scenario as it was understood.
#[derive(Clone, Debug)]
pub struct ScenarioContents {
    /// Name of the scenario.
    pub title: String,
    /// The body.
    pub model: Model,
    /// Posture at the start: patches lie on their surfaces.
    pub start: Posture,
    /// Kinematics of the start.
    pub kinematics: Kinematics,
    /// The supports.
    pub supports: Vec<Support>,
    /// Supports that only a run puts on their planes, when a muscle group is tired.
    pub rests: Vec<Support>,
    /// The loads besides the body's weight.
    pub loads: Vec<Load>,
    /// The tasks, the most important first.
    pub tasks: Vec<ContentsTask>,
    /// Things that no part of the body passes through, by name.
    pub obstacles: Vec<(String, Thing)>,
    /// Changes and additions of the reader, a sentence each.
    pub notes: Vec<String>,
}

/// A task and its rank.
#[derive(Clone, Debug)]
pub struct ContentsTask {
    /// 1 is the most important.
    pub priority: usize,
    /// Kind and segment, with the thing that asks for it.
    pub label: String,
    /// The task.
    pub task: Task,
    /// More important than the relief of tired muscles.
    pub above_relief: bool,
}

/// Reads a scenario of any command. `name` is the file's name for messages; `model` is the model of the file that
/// [`super::scenario_model`] names.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_contents(name: &str, bytes: &[u8], model: Option<Model>) -> Result<ScenarioContents, InputError> {
    read_toml(name, bytes, |at, text| contents(at, text, model))
}

fn contents(at: &Located, text: &ScenarioText, file: Option<Model>) -> Result<ScenarioContents, InputError> {
    let setup = Setup::read(at, text, file)?;
    let mut tasks = vec![];
    for (i, level) in setup.levels.into_iter().enumerate() {
        let above_relief = level.above_relief;
        let task = |(task, label)| ContentsTask { priority: i + 1, label, task, above_relief };
        tasks.extend(level.tasks.tasks.into_iter().zip(level.labels).map(task));
    }
    Ok(ScenarioContents {
        title: text.title.clone(),
        model: setup.model,
        start: setup.start,
        kinematics: setup.kinematics,
        supports: setup.supports?,
        rests: setup.rests.into_iter().map(|(support, _)| support).collect(),
        loads: setup.loads,
        tasks,
        obstacles: setup.obstacles,
        notes: setup.notes,
    })
}
