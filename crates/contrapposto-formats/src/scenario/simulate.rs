//! Reads a scenario for `contrapposto simulate`: a checked experiment over time.

use contrapposto::contact::Support;
use contrapposto::fatigue::Hysteresis;
use contrapposto::joint_torques::MuscleShareError;
use contrapposto::model::Model;
use contrapposto::simulation::{
    Event, ReliefSettings, Rest, RunSettings, Scenario, ScenarioError, Setting, StrategySettings, Tables, TaskSettings,
};

use super::error_keys::scenario_path;
use super::events::{change_strategies, check_events_happen, events};
use super::fatigue_text::{FatigueText, TiresText};
use super::names::coordinate;
use super::posture::free;
use super::relief_text::{ReliefText, TablesText};
use super::setup::Setup;
use super::text::{RunText, ScenarioText, StrategyText};
use crate::input_error::InputError;
use crate::thing::Thing;
use crate::tissue::ScenarioMuscles;
use crate::toml_file::{Located, read_toml, shown};

/// A scenario of a run, with the parts of its file that the experiment itself does not need.
#[derive(Clone, Debug)]
pub struct RunScenario {
    /// The experiment.
    pub scenario: Scenario,
    /// Things around the body and in its hands, for drawings.
    pub things: Vec<Thing>,
    /// Changes and additions of the reader, a sentence each.
    pub notes: Vec<String>,
    /// Whether the file lets muscles tire one by one, where it says.
    by_muscle: Option<bool>,
}

impl RunScenario {
    /// Takes the muscles of the scenario's model, in the posture of the start. They tire one by one unless the file says otherwise, or their groups
    /// have another law than 3CC-r.
    ///
    /// # Errors
    /// A sentence where the file lets muscles tire one by one, and they cannot.
    pub fn take_muscles(&mut self, muscles: Option<ScenarioMuscles>) -> Result<(), String> {
        if let Some(muscles) = muscles {
            let (muscles, notes) = muscles.settle(&mut self.scenario.model, &self.scenario.start, true);
            self.notes.extend(notes);
            self.scenario.muscles = Some(muscles);
        }
        let tire = match &self.scenario.muscles {
            Some(muscles) => muscles.can_tire(&self.scenario.model),
            None => Err(MuscleShareError::NoMuscles),
        };
        self.scenario.muscles_tire = self.by_muscle.unwrap_or(tire.is_ok());
        match tire {
            Err(why) if self.scenario.muscles_tire => Err(format!("[fatigue] by = \"muscle\": {why}")),
            _ => Ok(()),
        }
    }
}

/// Reads a scenario of a run. `name` is the file's name for messages; `model` is the model of the file that
/// [`super::scenario_model`] names.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_scenario(name: &str, bytes: &[u8], model: Option<Model>) -> Result<Scenario, InputError> {
    Ok(read_run(name, bytes, model)?.scenario)
}

/// As [`read_scenario`], with the things around the body and the notes.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_run(name: &str, bytes: &[u8], model: Option<Model>) -> Result<RunScenario, InputError> {
    read_toml(name, bytes, |at, text| scenario(at, text, model))
}

/// Whether a scenario asks for time, as a run does and a pose does not. `name` is its file's name for messages.
///
/// # Errors
/// [`InputError`] when it is no scenario.
pub fn scenario_runs(name: &str, bytes: &[u8]) -> Result<bool, InputError> {
    read_toml(name, bytes, |_, text: &ScenarioText| Ok(text.run.is_some()))
}

fn scenario(at: &Located, text: &ScenarioText, file: Option<Model>) -> Result<RunScenario, InputError> {
    let setup = Setup::read(at, text, file)?;
    let (strategy, run) = tables_of_a_run(at, text)?;
    setup.check_ranges(at)?;
    let places = setup.places();
    let Setup { model, start, loads, supports, rests, limits, levels, mut things, notes, .. } = setup;
    let mut supports = supports?;
    let (resting, rests): (Vec<Support>, Vec<Rest>) = rests.into_iter().unzip();
    supports.extend(resting);
    let tasks: Vec<TaskSettings> =
        levels.into_iter().map(|level| TaskSettings { goal: level.tasks, above_relief: level.above_relief }).collect();
    let whole = !supports.is_empty() || !tasks.is_empty();
    let free = free(at, &model, text, |coordinate| whole || coordinate.can_be_relieved())?;
    let strategies = vec![strategy.kind.into(); model.coordinates().len()];
    let strategies = change_strategies(at, &model, &["strategy", "of"], strategies, &strategy.of)?;
    let goals = tasks.iter().map(|task| task.goal.clone()).collect();
    let events = events(at, &model, text, goals, &places, strategies.clone())?;
    let FatigueText { critical_level, recovery_level, by, .. } = text.fatigue;
    let scenario = Scenario {
        title: text.title.clone(),
        start_fatigue: start_fatigue(at, &model, &text.fatigue)?,
        model,
        muscles: None,
        muscles_tire: false,
        start,
        free,
        loads,
        supports,
        rests,
        limits,
        tasks,
        events,
        strategies,
        strategy: StrategySettings {
            kind: strategy.kind.into(),
            minimum_decrease_ratio: strategy.minimum_decrease_ratio,
        },
        relief: relief(&text.relief, whole),
        hysteresis: Hysteresis { critical_level, recovery_level },
        run: RunSettings {
            duration: run.duration_s,
            step: run.step_s,
            stop_when_settled: run.stop_when_settled,
            threads: 1,
        },
    };
    scenario.check().map_err(|error| at.error(scenario_path(&error), in_units_of_file(&error, text, run), None))?;
    check_events_happen(at, text, &scenario.run)?;
    things.iter_mut().for_each(|thing| thing.until = put_down(&scenario.events, thing));
    Ok(RunScenario { scenario, things, notes, by_muscle: by.map(|by| by == TiresText::Muscle) })
}

/// The time of the first event from which on nothing loads the segment that carries a thing.
fn put_down(events: &[Event], thing: &Thing) -> Option<f64> {
    let segment = thing.segment?;
    let unloads =
        |event: &&Event| event.loads.as_ref().is_some_and(|loads| loads.iter().all(|load| load.segment != segment));
    events.iter().find(unloads).map(|event| event.time)
}

/// The tables that a run needs; a table that only a pose takes is refused.
fn tables_of_a_run<'a>(at: &Located, text: &'a ScenarioText) -> Result<(&'a StrategyText, &'a RunText), InputError> {
    if text.solver.is_some() {
        let help = Some("leave it out; `contrapposto pose` takes it".to_owned());
        return Err(at.error(&["solver"], "[solver] is for poses, not for simulations", help));
    }
    let missing = |key: &str| {
        let help = Some("`contrapposto schema` lists all keys".to_owned());
        at.error(&[], format!("the key `{key}` is missing"), help)
    };
    Ok((text.strategy.as_ref().ok_or_else(|| missing("strategy"))?, text.run.as_ref().ok_or_else(|| missing("run"))?))
}

/// Fatigue of the positive and negative group of every coordinate at the start.
fn start_fatigue(at: &Located, model: &Model, text: &FatigueText) -> Result<Vec<[f64; 2]>, InputError> {
    let mut fatigue = vec![[0.0; 2]; model.coordinates().len()];
    for (name, start) in &text.start {
        let index = coordinate(at, model, &["fatigue", "start", name], name)?;
        for (side, level) in [("positive", start.positive), ("negative", start.negative)] {
            if !(0.0..=1.0).contains(&level) {
                let message =
                    format!("fatigue at the start is {}; it must lie in 0 (rested) to 1 (exhausted)", shown(level));
                return Err(at.error(&["fatigue", "start", name, side], message, None));
            }
        }
        fatigue[index] = [start.positive, start.negative];
    }
    Ok(fatigue)
}

/// A joint on its own takes the steps of the paper; a whole body, which must be able to follow, takes smaller ones.
fn relief(text: &ReliefText, whole: bool) -> ReliefSettings {
    let (max_step_deg, torque_tolerance) = if whole { (0.5, 0.5) } else { (2.0, 0.05) };
    ReliefSettings {
        step_gain: text.step_gain,
        max_step: text.max_step_deg.unwrap_or(max_step_deg).to_radians(),
        torque_tolerance: text.torque_tolerance_nm.unwrap_or(torque_tolerance),
        effort_factor: text.effort_factor,
        tables: match text.tables {
            TablesText::Total => Tables::Total,
            TablesText::Literal => Tables::Literal,
        },
    }
}

/// The error in the keys and units of the file.
fn in_units_of_file(error: &ScenarioError, text: &ScenarioText, run: &RunText) -> String {
    let ScenarioError::Setting { setting, value, accepted } = error else { return error.to_string() };
    let value = match setting {
        Setting::Steps => {
            let (duration, step) = (shown(run.duration_s), shown(run.step_s));
            return format!("{duration} s in steps of {step} s are {} steps; ten million at most", shown(*value));
        }
        Setting::MaxStep => text.relief.max_step_deg.unwrap_or(value.to_degrees()),
        _ => *value,
    };
    match scenario_path(error).last() {
        Some(key) => format!("{key} is {}; it must be {accepted}", shown(value)),
        None => error.to_string(),
    }
}
