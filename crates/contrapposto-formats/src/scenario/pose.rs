//! A scenario read for `contrapposto pose`: body, start, loads and goals in order of priority, all checked.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateKind, Model};
use contrapposto::posture::Posture;
use contrapposto::posture_solver::Options;
use contrapposto::statics::Load;
use contrapposto::tasks::PriorityLevel;
use contrapposto::tasks::{Placement, Task};
use nalgebra::Vector3;

use super::convert::{body, check_head, free, load, posture_value, shown};
use super::task::{Stage, task};
use super::task_text::TaskText;
use super::text::{RootText, ScenarioText};
use super::{Located, read_toml, support};
use crate::body::BodyRoot;
use crate::input_error::InputError;

/// A posture to be solved for.
#[derive(Clone, Debug)]
pub struct PoseScenario {
    /// Its name.
    pub title: String,
    /// The body.
    pub model: Model,
    /// Where it starts: inside all ranges, quaternions of length 1, coordinates that follow others where they must be.
    pub start: Posture,
    /// Rates that do not move, besides those of coordinates that the model itself locks.
    pub locked: Vec<usize>,
    /// What pulls on it besides its weight.
    pub loads: Vec<Load>,
    /// The most important first; supports, if any, are the first one, and hard.
    pub goals: Vec<PriorityLevel>,
    /// A name for every task of every goal.
    pub labels: Vec<Vec<String>>,
    /// What carries it, where the patches of all supports are known; else empty. Goals know supports without them.
    pub supports: Vec<Support>,
    /// How it is solved.
    pub options: Options,
    /// Tables of the file that have no part in a pose.
    pub unused: Vec<&'static str>,
}

/// A model file that a scenario names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelFile {
    /// Its path, as seen from the scenario's folder.
    pub file: String,
    /// What is laid over it, as seen from the scenario's folder.
    pub overlay: Option<String>,
    /// How its root is attached, if that is said.
    pub root: Option<BodyRoot>,
}

/// Which model file does a scenario name? `None`: it has the built-in adult. `name` is the scenario's name for messages.
///
/// # Errors
/// [`InputError`] when it is no scenario.
pub fn scenario_model(name: &str, bytes: &[u8]) -> Result<Option<ModelFile>, InputError> {
    read_toml(name, bytes, |at, text: &ScenarioText| {
        check_head(at, text)?;
        let model = &text.model;
        let Some(file) = &model.file else {
            for (key, given) in [("overlay", model.overlay.is_some()), ("root", model.root.is_some())] {
                if given {
                    let help = Some("add `file = \"MODEL\"`, or leave it out".to_owned());
                    return Err(at.key_error(&["model", key], format!("`{key}` goes with a model file"), help));
                }
            }
            return Ok(None);
        };
        if model.adult.is_some() {
            let help = Some("keep one of `file` and `adult`".to_owned());
            return Err(at.key_error(&["model", "adult"], "the body is either a file or the built-in adult", help));
        }
        for (key, path) in [("file", Some(file)), ("overlay", model.overlay.as_ref())] {
            if path.is_some_and(|path| path.is_empty() || path.chars().any(char::is_control)) {
                return Err(at.error(&["model", key], format!("`{key}` is no name of a file"), None));
            }
        }
        let root = model.root.map(|root| match root {
            RootText::Fixed => BodyRoot::Fixed,
            RootText::Free => BodyRoot::Free,
        });
        Ok(Some(ModelFile { file: file.clone(), overlay: model.overlay.clone(), root }))
    })
}

/// Reads a scenario for a pose. `name` is the file's name for messages; `model` is what [`scenario_model`] asked for.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_pose(name: &str, bytes: &[u8], model: Option<Model>) -> Result<PoseScenario, InputError> {
    read_toml(name, bytes, |at, text| pose(at, text, model))
}

fn pose(at: &Located, text: &ScenarioText, model: Option<Model>) -> Result<PoseScenario, InputError> {
    check_head(at, text)?;
    let model = body(at, text, model)?;
    let mut start = model.default_posture();
    set(at, &model, &["posture"], &text.posture, &mut start)?;
    start.displace(&model, &vec![0.0; model.rates().len()]);
    let loads = text.load.iter().enumerate().map(|(i, text)| load(at, &model, i, text)).collect::<Result<_, _>>()?;
    let mut kinematics = Kinematics::new(&model);
    kinematics.update(&model, &start).map_err(|error| at.error(&["posture"], error.to_string(), None))?;
    let mut stage = Stage { at, model: &model, start: &start, kinematics: &kinematics, supports: vec![] };
    let mut goals: Vec<PriorityLevel> = vec![];
    let mut labels: Vec<Vec<String>> = vec![];
    let supports = supports(text, &mut stage)?;
    if !supports.is_empty() {
        let names = stage.supports.iter().map(|&segment| format!("support {}", model.segments()[segment].name));
        labels.push(names.collect());
        goals.push(PriorityLevel { tasks: supports, hard: true, ..PriorityLevel::default() });
    }
    for Ranked { goal, labels: own, .. } in ranked(&stage, &text.task)? {
        goals.push(goal);
        labels.push(own);
    }
    if goals.is_empty() {
        let help = Some("add a [[task]] with a `kind`; docs/scenario.md lists the kinds".to_owned());
        return Err(at.error(&[], "the scenario asks for nothing: it has neither tasks nor supports", help));
    }
    let free = free(at, &model, text, |_| true)?;
    let tables = [
        ("strategy", text.strategy.is_some()),
        ("relief", at.has("relief")),
        ("fatigue", at.has("fatigue")),
        ("event", at.has("event")),
        ("run", text.run.is_some()),
    ];
    // Friction, planes and shares have no part in the goals: what is wrong with them is no error here.
    let carriers = support::supports(at, &model, &text.support, &kinematics).unwrap_or_default();
    Ok(PoseScenario {
        title: text.title.clone(),
        supports: carriers,
        locked: locked(at, &model, text, &free)?,
        loads,
        goals,
        labels,
        options: options(at, text)?,
        unused: tables.into_iter().filter_map(|(name, given)| given.then_some(name)).collect(),
        start,
        model,
    })
}

/// Tasks of one priority.
pub(super) struct Ranked {
    pub(super) goal: PriorityLevel,
    pub(super) labels: Vec<String>,
    pub(super) above_relief: bool,
}

/// The tasks of a scenario by priority.
pub(super) fn ranked(stage: &Stage<'_>, texts: &[TaskText]) -> Result<Vec<Ranked>, InputError> {
    let mut all: Vec<Ranked> = vec![];
    for (i, text) in texts.iter().enumerate() {
        let task = task(stage, i, text)?;
        let label = task.label(stage.model);
        match all.last_mut() {
            Some(before) if text.same_priority => {
                before.goal.tasks.push(task);
                before.labels.push(label);
                before.above_relief |= text.above_relief;
            }
            None if text.same_priority => {
                let path = ["task", &i.to_string(), "same_priority"];
                let help = Some("leave it out".to_owned());
                return Err(stage.at.key_error(&path, "no task stands before the first one", help));
            }
            _ => all.push(Ranked { goal: task.into(), labels: vec![label], above_relief: text.above_relief }),
        }
    }
    Ok(all)
}

/// Farthest a quaternion may be from unit length.
pub(super) const UNIT: f64 = 1e-3;

/// Sets coordinates from a table of the file; its keys are as in `[posture]`.
pub(super) fn set(
    at: &Located,
    model: &Model,
    path: &[&str],
    table: &std::collections::BTreeMap<String, f64>,
    posture: &mut Posture,
) -> Result<(), InputError> {
    let mut quaternions: Vec<(usize, &str)> = vec![];
    for (key, &value) in table {
        let path: Vec<&str> = path.iter().copied().chain([key.as_str()]).collect();
        let (index, value) = posture_value(at, model, &path, value)?;
        if let Some(coupling) = model.couplings().iter().find(|coupling| coupling.dependent == index) {
            let leader = &model.coordinates()[coupling.independent].name;
            let message = format!("`{}` follows `{leader}`", model.coordinates()[index].name);
            return Err(at.key_error(&path, message, Some(format!("set `{leader}` and leave this out"))));
        }
        if let Some(first) = ball(model, index) {
            quaternions.push((first, key));
        }
        posture.values_mut()[index] = value;
    }
    for (first, key) in quaternions {
        let length = posture.values()[first..first + 4].iter().map(|v| v * v).sum::<f64>().sqrt();
        if length.is_nan() || (length - 1.0).abs() > UNIT {
            let path: Vec<&str> = path.iter().copied().chain([key]).collect();
            let message = format!(
                "the quaternion that begins with `{}` has length {}; it must have length 1",
                model.coordinates()[first].name,
                shown(length)
            );
            let help = Some("give all four of its coordinates; what is left out is at its default".to_owned());
            return Err(at.error(&path, message, help));
        }
    }
    Ok(())
}

/// First coordinates of all balls.
fn balls(model: &Model) -> Vec<usize> {
    let quaternions =
        (0..model.coordinates().len()).filter(|&i| model.coordinates()[i].kind == CoordinateKind::Quaternion);
    quaternions.step_by(4).collect()
}

/// First coordinate of the ball that a coordinate belongs to.
pub(super) fn ball(model: &Model, coordinate: usize) -> Option<usize> {
    balls(model).into_iter().find(|first| (*first..first + 4).contains(&coordinate))
}

/// The rates that a coordinate moves: its own, or the three of its ball.
pub(super) fn rates(model: &Model, coordinate: usize) -> Vec<usize> {
    if let Some(rate) = model.coordinates()[coordinate].rate {
        return vec![rate];
    }
    let place = balls(model).into_iter().position(|first| (first..first + 4).contains(&coordinate));
    let turning: Vec<usize> = (0..model.rates().len()).filter(|&i| model.rates()[i].coordinate.is_none()).collect();
    place.and_then(|place| turning.get(3 * place..3 * place + 3)).map_or(vec![], <[usize]>::to_vec)
}

/// Rates of the coordinates that are not free.
pub(super) fn locked(
    at: &Located,
    model: &Model,
    text: &ScenarioText,
    free: &[bool],
) -> Result<Vec<usize>, InputError> {
    for first in balls(model) {
        if free[first..first + 4].iter().any(|flag| *flag != free[first]) {
            let key = if text.coordinates.free.is_some() { "free" } else { "locked" };
            let message = format!("the four coordinates from `{}` on turn together", model.coordinates()[first].name);
            return Err(at.error(&["coordinates", key], message, Some("name all four of them, or none".to_owned())));
        }
    }
    let mut locked: Vec<usize> =
        (0..free.len()).filter(|&i| !free[i]).flat_map(|coordinate| rates(model, coordinate)).collect();
    locked.sort_unstable();
    locked.dedup();
    Ok(locked)
}

fn supports(text: &ScenarioText, stage: &mut Stage<'_>) -> Result<Vec<Task>, InputError> {
    let mut tasks = vec![];
    for (i, support) in text.support.iter().enumerate() {
        let segment = support::segment(stage.at, stage.model, i, support, &stage.supports)?;
        support::numbers(stage.at, i, support)?;
        let target = stage.kinematics.placement(stage.model, segment);
        tasks.push(Task::Placement(Placement { segment, point: Vector3::zeros(), target }));
        stage.supports.push(segment);
    }
    Ok(tasks)
}

fn options(at: &Located, text: &ScenarioText) -> Result<Options, InputError> {
    let Some(solver) = &text.solver else { return Ok(Options::inverse_kinematics()) };
    let refuse = |key: &str, value: f64, accepted: &str| {
        Err(at.error(&["solver", key], format!("{key} is {}; it must be {accepted}", shown(value)), None))
    };
    if !(1e-9..=180.0).contains(&solver.max_step_deg) {
        return refuse("max_step_deg", solver.max_step_deg, "from 1e-9 to 180");
    }
    if !(1..=100_000).contains(&solver.max_steps) {
        return refuse("max_steps", f64::from(solver.max_steps), "from 1 to 100000");
    }
    for (key, value) in [("still", solver.still), ("reached", solver.reached)] {
        if !(1e-15..=1.0).contains(&value) {
            return refuse(key, value, "from 1e-15 to 1");
        }
    }
    let max_step = solver.max_step_deg.to_radians();
    if solver.still >= max_step {
        return refuse("still", solver.still, &format!("below the largest step, {} rad", shown(max_step)));
    }
    Ok(Options {
        max_step,
        max_steps: solver.max_steps as usize,
        step_tolerance: solver.still,
        level_tolerance: solver.reached,
        ..Options::inverse_kinematics()
    })
}
