//! Reads a scenario for `contrapposto relax`: body, start, loads, supports and tasks.

use contrapposto::contact::{Support, root_rates};
use contrapposto::equilibria::{Aim, SCATTERED_STARTS, Search};
use contrapposto::joint_torques::JointMuscles;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::posture_solver::Options;
use contrapposto::statics::Load;
use contrapposto::tasks::{PriorityLevel, Task};

use super::fatigue_choice::LAW_KEYS;
use super::least_effort::effort_of_all;
use super::levels::is_effort;
use super::rest::left_out;
use super::setup::{Setup, present};
use super::text::ScenarioText;
use crate::input_error::InputError;
use crate::thing::Thing;
use crate::tissue::ScenarioMuscles;
use crate::toml_file::{Located, read_toml};

/// A body whose postures of least effort are sought.
#[derive(Clone, Debug)]
pub struct RelaxScenario {
    /// Name of the scenario.
    pub title: String,
    /// The body.
    pub model: Model,
    /// Muscles of its file that give its joints strength and passive torque: [`RelaxScenario::take_muscles`].
    pub muscles: Option<JointMuscles>,
    /// Posture at the start, inside all ranges.
    pub start: Posture,
    /// Rates that do not move, besides those of coordinates that the model itself locks.
    pub locked: Vec<usize>,
    /// The loads besides the body's weight.
    pub loads: Vec<Load>,
    /// The supports that carry it.
    pub supports: Vec<Support>,
    /// Things around the body and in its hands, for drawings.
    pub things: Vec<Thing>,
    /// Inequalities above all tasks.
    pub limits: Vec<Task>,
    /// Tasks, the most important first; one of them is effort.
    pub goals: Vec<PriorityLevel>,
    /// A name for every task of every goal.
    pub labels: Vec<Vec<String>>,
    /// No task of the file asks for effort: that of all muscles was added as the last one.
    pub effort_added: bool,
    /// Tables of the file that have no part in it.
    pub unused: Vec<&'static str>,
    /// Changes and additions of the reader, a sentence each.
    pub notes: Vec<String>,
}

impl RelaxScenario {
    /// Of its search: largest change of a joint in one step, rad, and most steps of the last stage of each posture.
    pub const OPTIONS: Options = Options { max_step: 0.1, max_steps: 300, ..Options::least_effort() };

    /// The search for its postures of least effort, with all starts.
    pub fn search(&self) -> Search<'_> {
        Search {
            model: &self.model,
            start: &self.start,
            supports: &self.supports,
            limits: &self.limits,
            goals: &self.goals,
            loads: &self.loads,
            locked: &self.locked,
            most_work: usize::MAX,
            scattered: SCATTERED_STARTS,
            aim: Aim::WaysOnEitherSide,
            threads: 1,
        }
    }

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
}

/// Reads a scenario for `relax`. `name` is the file's name for messages; `model` is the model of the file that
/// [`super::scenario_model`] names.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_relax(name: &str, bytes: &[u8], model: Option<Model>) -> Result<RelaxScenario, InputError> {
    read_toml(name, bytes, |at, text| relax(at, text, model))
}

fn relax(at: &Located, text: &ScenarioText, file: Option<Model>) -> Result<RelaxScenario, InputError> {
    let setup = Setup::read(at, text, file)?;
    setup.check_ranges(at)?;
    let locked = setup.locked(at, text)?;
    let Setup { model, start, loads, supports, rests, limits, levels, things, mut notes, .. } = setup;
    notes.extend(left_out(&model, &rests));
    let supports = supports?;
    let (mut goals, mut labels) = (vec![], vec![]);
    for level in levels {
        goals.push(level.tasks);
        labels.push(level.labels);
    }
    let effort_added = !goals.iter().any(is_effort);
    if effort_added {
        let effort = effort_of_all(at, &model)?;
        labels.push(vec![effort.label(&model)]);
        goals.push(effort.into());
    }
    if supports.is_empty() && root_rates(&model).iter().any(|rate| !locked.contains(rate)) {
        let help = Some("add a [[support]], or lock the root's coordinates".to_owned());
        return Err(at.error(&[], "nothing carries the body: it has a free root and no support", help));
    }
    let mut unused = present(at, &["strategy", "solver", "relief"]);
    // The fatigue law says how long a posture can be held; the other keys of its table have no part.
    if at.holds_beside("fatigue", &LAW_KEYS) {
        unused.push("fatigue");
    }
    unused.extend(present(at, &["event", "run"]));
    Ok(RelaxScenario {
        title: text.title.clone(),
        muscles: None,
        locked,
        loads,
        supports,
        things,
        limits,
        goals,
        labels,
        effort_added,
        unused,
        notes,
        start,
        model,
    })
}
