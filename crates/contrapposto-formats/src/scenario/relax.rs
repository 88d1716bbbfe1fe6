//! A scenario read for `contrapposto relax`: body, start, loads, supports and tasks, all checked.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto::tasks::PriorityLevel;
use contrapposto::tasks::{Effort, Task};

use super::convert::{body, check_head, free, load, shown};
use super::pose::{locked, ranked, set};
use super::task::Stage;
use super::text::ScenarioText;
use super::{Located, read_toml, support};
use crate::input_error::InputError;

/// A body that looks for postures of little effort.
#[derive(Clone, Debug)]
pub struct RelaxScenario {
    /// Its name.
    pub title: String,
    /// The body.
    pub model: Model,
    /// Where it starts, inside all ranges.
    pub start: Posture,
    /// Rates that do not move, besides those of coordinates that the model itself locks.
    pub locked: Vec<usize>,
    /// What pulls on it besides its weight.
    pub loads: Vec<Load>,
    /// What carries it.
    pub supports: Vec<Support>,
    /// Tasks, the most important first; one of them is effort.
    pub goals: Vec<PriorityLevel>,
    /// A name for every task of every goal.
    pub labels: Vec<Vec<String>>,
    /// No task of the file asks for effort: that of all muscles was added as the last one.
    pub effort_added: bool,
    /// Tables of the file that have no part in it.
    pub unused: Vec<&'static str>,
}

/// Reads a scenario for `relax`. `name` is the file's name for messages; `model` is what [`super::scenario_model`] asked for.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_relax(name: &str, bytes: &[u8], model: Option<Model>) -> Result<RelaxScenario, InputError> {
    read_toml(name, bytes, |at, text| relax(at, text, model))
}

fn relax(at: &Located, text: &ScenarioText, model: Option<Model>) -> Result<RelaxScenario, InputError> {
    check_head(at, text)?;
    let model = body(at, text, model)?;
    let mut start = model.default_posture();
    set(at, &model, &["posture"], &text.posture, &mut start)?;
    start.displace(&model, &vec![0.0; model.rates().len()]);
    for (coordinate, &value) in model.coordinates().iter().zip(start.values()) {
        let (low, high) = coordinate.range;
        if value < low || value > high {
            let message = format!(
                "`{}` starts at {}, outside its range {}..{} (rad or m)",
                coordinate.name,
                shown(value),
                shown(low),
                shown(high)
            );
            return Err(at.error(&["posture"], message, None));
        }
    }
    let mut kinematics = Kinematics::new(&model);
    kinematics.update(&model, &start).map_err(|error| at.error(&["posture"], error.to_string(), None))?;
    let supports = support::supports(at, &model, &text.support, &kinematics)?;
    let standing = supports.iter().map(|support| support.segment).collect();
    let stage = Stage { at, model: &model, start: &start, kinematics: &kinematics, supports: standing };
    let (mut goals, mut labels) = (vec![], vec![]);
    for ranked in ranked(&stage, &text.task)? {
        goals.push(ranked.goal);
        labels.push(ranked.labels);
    }
    let asks = |goal: &PriorityLevel| goal.tasks.iter().any(|task| matches!(task, Task::Effort(_)));
    let effort_added = !goals.iter().any(asks);
    if effort_added {
        let effort = Effort::whole(&model);
        if effort.coordinates.is_empty() {
            let help =
                Some("give the body strengths with an overlay; `contrapposto inspect` shows what is known".to_owned());
            return Err(at.error(
                &["model"],
                "of no coordinate of this body the strength is known, so nothing is effort",
                help,
            ));
        }
        let effort = Task::Effort(effort);
        labels.push(vec![effort.label(&model)]);
        goals.push(effort.into());
    }
    if supports.is_empty() && !contrapposto::contact::root_rates(&model).is_empty() {
        let help = Some("add a [[support]], or lock the root's coordinates".to_owned());
        let free = free(at, &model, text, |_| true)?;
        let held = locked(at, &model, text, &free)?;
        if contrapposto::contact::root_rates(&model).iter().any(|rate| !held.contains(rate)) {
            return Err(at.error(&[], "nothing carries the body: it has a free root and no support", help));
        }
    }
    let free = free(at, &model, text, |_| true)?;
    let tables = [
        ("strategy", text.strategy.is_some()),
        ("solver", text.solver.is_some()),
        ("relief", at.has("relief")),
        // The law says how long a posture can be held.
        ("fatigue", at.has_beside("fatigue", &["law", "curve"])),
        ("event", at.has("event")),
        ("run", text.run.is_some()),
    ];
    Ok(RelaxScenario {
        title: text.title.clone(),
        locked: locked(at, &model, text, &free)?,
        loads: text.load.iter().enumerate().map(|(i, text)| load(at, &model, i, text)).collect::<Result<_, _>>()?,
        supports,
        goals,
        labels,
        effort_added,
        unused: tables.into_iter().filter_map(|(name, given)| given.then_some(name)).collect(),
        start,
        model,
    })
}
