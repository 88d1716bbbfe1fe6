//! Reads a scenario for `contrapposto pose`: body, start, loads and tasks in order of priority.

use contrapposto::contact::Support;
use contrapposto::joint_torques::JointMuscles;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::posture_solver::Options;
use contrapposto::statics::Load;
use contrapposto::tasks::{Placement, PriorityLevel, Task, free_place, held_place};
use nalgebra::Vector3;

use super::fatigue_choice::LAW_KEYS;
use super::rest::left_out;
use super::setup::{Setup, present};
use super::text::ScenarioText;
use crate::input_error::InputError;
use crate::thing::Thing;
use crate::tissue::ScenarioMuscles;
use crate::toml_file::{Located, read_toml, shown};

/// A posture to be solved for.
#[derive(Clone, Debug)]
pub struct PoseScenario {
    /// Name of the scenario.
    pub title: String,
    /// The body.
    pub model: Model,
    /// Muscles of its file that give its joints strength and passive torque: [`PoseScenario::take_muscles`].
    pub muscles: Option<JointMuscles>,
    /// Posture at the start: inside all ranges, quaternions of length 1, dependent coordinates at the values that their couplings give.
    pub start: Posture,
    /// Rates that do not move, besides those of coordinates that the model itself locks.
    pub locked: Vec<usize>,
    /// The loads besides the body's weight.
    pub loads: Vec<Load>,
    /// Inequalities above all tasks and below the supports.
    pub limits: Vec<Task>,
    /// The most important first; supports, if any, are the first one, and hard.
    pub goals: Vec<PriorityLevel>,
    /// A name for every task of every goal.
    pub labels: Vec<Vec<String>>,
    /// The supports, where the patches of all of them are known; else empty. Levels know supports without them.
    pub supports: Vec<Support>,
    /// Things around the body and in its hands, for drawings.
    pub things: Vec<Thing>,
    /// Settings of the solver.
    pub options: Options,
    /// Tables of the file that have no part in a pose.
    pub unused: Vec<&'static str>,
    /// Changes and additions of the reader, a sentence each.
    pub notes: Vec<String>,
}

impl PoseScenario {
    /// Takes the muscles of the scenario's model, in the posture of the start.
    pub fn take_muscles(&mut self, muscles: Option<ScenarioMuscles>) {
        let Some(muscles) = muscles else { return };
        let (muscles, notes) = muscles.settle(&mut self.model, &self.start, false);
        self.notes.extend(notes);
        self.muscles = Some(muscles);
    }

    /// Gives the body strength and passive torque of its muscles in `posture`. Returns the greatest change of one as a share
    /// ([`JointMuscles::pose`]); 0 without muscles.
    pub fn take_strength(&mut self, posture: &Posture) -> f64 {
        // A posture of the body fits it.
        self.muscles.as_mut().and_then(|muscles| muscles.pose(&mut self.model, posture).ok()).unwrap_or(0.0)
    }

    /// The levels to be solved for: supports, limits, the other goals; and the place of the limits, if there are any.
    pub fn levels(&self) -> (Vec<PriorityLevel>, Option<usize>) {
        let mut levels = self.goals.clone();
        if self.limits.is_empty() {
            return (levels, None);
        }
        let place = levels.iter().position(|level| !level.hard).unwrap_or(levels.len());
        levels.insert(place, PriorityLevel { tasks: self.limits.clone(), ..PriorityLevel::default() });
        (levels, Some(place))
    }
}

/// Reads a scenario for a pose. `name` is the file's name for messages; `model` is the model of the file that
/// [`super::scenario_model`] names.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_pose(name: &str, bytes: &[u8], model: Option<Model>) -> Result<PoseScenario, InputError> {
    read_toml(name, bytes, |at, text| pose(at, text, model))
}

fn pose(at: &Located, text: &ScenarioText, file: Option<Model>) -> Result<PoseScenario, InputError> {
    let setup = Setup::read(at, text, file)?;
    let (mut goals, mut labels) = (vec![], vec![]);
    for (level, names) in supports_hold(&setup) {
        goals.push(level);
        labels.push(names);
    }
    let locked = setup.locked(at, text)?;
    let rests = left_out(&setup.model, &setup.rests);
    for level in setup.levels {
        goals.push(level.tasks);
        labels.push(level.labels);
    }
    if goals.is_empty() {
        let help = Some("add a [[task]] with a `kind`; docs/scenario.md lists the kinds".to_owned());
        return Err(at.error(&[], "the scenario asks for nothing: it has neither tasks nor supports", help));
    }
    let mut unused = present(at, &["strategy", "relief"]);
    // The fatigue law says in the report how long the posture can be held; the other keys of its table have no part.
    if at.holds_beside("fatigue", &LAW_KEYS) {
        unused.push("fatigue");
    }
    unused.extend(present(at, &["event", "run"]));
    Ok(PoseScenario {
        title: text.title.clone(),
        muscles: None,
        // Friction, planes and shares have no part in the goals: an error of one of them is none here.
        supports: setup.supports.unwrap_or_default(),
        locked,
        limits: setup.limits,
        loads: setup.loads,
        things: setup.things,
        goals,
        labels,
        options: options(at, text)?,
        unused,
        notes: setup.notes.into_iter().chain(rests).collect(),
        start: setup.start,
        model: setup.model,
    })
}

/// The first levels, with a name for each task: supports stay where they are at the start or, where their place is free, flat on
/// their planes and, on the second level, in their regions.
fn supports_hold(setup: &Setup) -> Vec<(PriorityLevel, Vec<String>)> {
    let (model, segments) = (&setup.model, &setup.standing);
    let name = |segment: usize| model.segments()[segment].name.as_str();
    let supports = setup.supports.as_deref().unwrap_or_default();
    let (mut held, mut regions) = ((PriorityLevel::default(), vec![]), (PriorityLevel::default(), vec![]));
    held.0.hard = true;
    for &segment in segments {
        let support = supports.iter().find(|support| support.segment == segment);
        let target = setup.kinematics.placement(model, segment);
        let stays = Task::Placement(Placement { segment, point: Vector3::zeros(), target });
        held.0.tasks.push(support.map_or(stays, |support| held_place(support, model, &setup.kinematics)));
        held.1.push(format!("support {}", name(segment)));
        if let Some(region) = support.and_then(|support| free_place(support, model, &setup.kinematics)) {
            regions.0.tasks.push(region);
            regions.1.push(format!("place of {}", name(segment)));
        }
    }
    [held, regions].into_iter().filter(|(level, _)| !level.tasks.is_empty()).collect()
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
