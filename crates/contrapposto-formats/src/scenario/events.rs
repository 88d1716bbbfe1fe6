//! Reads events: strategies, loads and targets that change during a run.

use std::collections::BTreeMap;

use contrapposto::hybrid::Strategy;
use contrapposto::model::{Model, data};
use contrapposto::simulation::{Event, RunSettings};
use contrapposto::statics::Load;
use contrapposto::tasks::PriorityLevel;
use nalgebra::Vector3;

use super::load::load;
use super::text::{EventText, ScenarioText, StrategyKindText};
use crate::input_error::{InputError, suggestion};
use crate::toml_file::{Located, shown};

/// Strategies of all coordinates, changed for the regions and coordinates that the table at `path` names.
pub(super) fn change_strategies(
    at: &Located,
    model: &Model,
    path: &[&str],
    mut all: Vec<Strategy>,
    of: &BTreeMap<String, StrategyKindText>,
) -> Result<Vec<Strategy>, InputError> {
    let region = |name: &str| data::library().sources(name).map(|sources| sources.region);
    // Regions first, so that a coordinate that is named itself has the last word.
    let (single, regions): (Vec<_>, Vec<_>) = of.iter().partition(|(name, _)| model.coordinate(name).is_some());
    for (name, &text) in regions {
        let within: Vec<usize> = (0..all.len())
            .filter(|&i| region(&model.coordinates()[i].name).is_some_and(|region| region == name))
            .collect();
        if within.is_empty() {
            let path: Vec<&str> = path.iter().copied().chain([name.as_str()]).collect();
            let names = ["spine", "neck", "arms", "legs"]
                .into_iter()
                .chain(model.coordinates().iter().map(|c| c.name.as_str()));
            let help = suggestion(name, names);
            return Err(at.key_error(&path, format!("the body has no region or coordinate `{name}`"), help));
        }
        within.into_iter().for_each(|i| all[i] = text.into());
    }
    for (name, &text) in single {
        if let Some(i) = model.coordinate(name) {
            all[i] = text.into();
        }
    }
    Ok(all)
}

/// The events, the earliest first. `levels` and `strategies` are those of the start; each event changes what the earlier events
/// left. `places`: level and place in it of each task of the file.
pub(super) fn events(
    at: &Located,
    model: &Model,
    text: &ScenarioText,
    mut levels: Vec<PriorityLevel>,
    places: &[(usize, usize)],
    mut strategies: Vec<Strategy>,
) -> Result<Vec<Event>, InputError> {
    let mut order: Vec<(usize, &EventText)> = text.event.iter().enumerate().collect();
    order.sort_by(|a, b| a.1.at_s.total_cmp(&b.1.at_s));
    let mut events = vec![];
    for (i, event_text) in order {
        let number = i.to_string();
        let reader = Reader { at, model, text: event_text, number: &number };
        if event_text.at_s < 0.0 {
            let message = format!("at_s is {}; it must not be negative", shown(event_text.at_s));
            return Err(reader.error("at_s", message, None));
        }
        let mut event = Event { time: event_text.at_s, ..Event::default() };
        if event_text.strategy.is_some() || !event_text.strategy_of.is_empty() {
            strategies = reader.strategies(strategies)?;
            event.strategies = Some(strategies.clone());
        }
        event.loads = reader.loads()?;
        event.tasks.extend(reader.task(places, &mut levels)?);
        if event.strategies.is_none() && event.loads.is_none() && event.tasks.is_empty() {
            let help = Some("give it `strategy`, `strategy_of`, `load`, or `task` and `target_m`".to_owned());
            return Err(at.error(&["event", &number], "nothing changes at this event", help));
        }
        events.push(event);
    }
    Ok(events)
}

/// Refuses an event after the last step of the run, which would never happen.
pub(super) fn check_events_happen(at: &Located, text: &ScenarioText, run: &RunSettings) -> Result<(), InputError> {
    for (i, event) in text.event.iter().enumerate() {
        if event.at_s > run.end() + 1e-9 {
            let (time, end) = (shown(event.at_s), shown((run.end() * 1e9).round() / 1e9));
            let message =
                format!("event {} would never happen: it is at {time} s, the last step of the run at {end} s", i + 1);
            let help = Some("lengthen `duration_s` of [run], or leave the event out".to_owned());
            return Err(at.error(&["event", &i.to_string(), "at_s"], message, help));
        }
    }
    Ok(())
}

/// Reads one event.
struct Reader<'a> {
    at: &'a Located<'a>,
    model: &'a Model,
    text: &'a EventText,
    number: &'a str,
}

impl Reader<'_> {
    /// Strategies from the event on, from those before it.
    fn strategies(&self, mut strategies: Vec<Strategy>) -> Result<Vec<Strategy>, InputError> {
        if let Some(all) = self.text.strategy {
            strategies.fill(all.into());
        }
        let path = ["event", self.number, "strategy_of"];
        change_strategies(self.at, self.model, &path, strategies, &self.text.strategy_of)
    }

    fn loads(&self) -> Result<Option<Vec<Load>>, InputError> {
        let load =
            |(j, text): (usize, _)| load(self.at, self.model, &["event", self.number, "load", &j.to_string()], text);
        self.text.load.as_ref().map(|loads| loads.iter().enumerate().map(load).collect()).transpose()
    }

    /// The level whose task gets a new target, with its place among `levels`, in which the target is changed.
    fn task(
        &self,
        places: &[(usize, usize)],
        levels: &mut [PriorityLevel],
    ) -> Result<Option<(usize, PriorityLevel)>, InputError> {
        let (task, target) = match (self.text.task, self.text.target_m) {
            (Some(task), Some(target)) => (task, target),
            (None, None) => return Ok(None),
            (Some(_), None) => return Err(self.error("task", "a new target is missing: `target_m`", None)),
            (None, Some(_)) => {
                return Err(self.error("target_m", "which task is meant? `task = 1` is the first", None));
            }
        };
        let place = task.checked_sub(1).and_then(|i| places.get(i).copied());
        let Some((priority, place)) = place else {
            let message = format!("there is no task {task}; the scenario has {} of them", places.len());
            return Err(self.error("task", message, Some("1 is the first".to_owned())));
        };
        let moved = &mut levels[priority].tasks[place];
        if !moved.retarget(Vector3::from(target)) {
            let message = format!("task {task} ({}) has no place as its target", moved.kind());
            return Err(self.error("task", message, None));
        }
        moved.check(self.model).map_err(|error| self.error("target_m", error.to_string(), None))?;
        Ok(Some((priority, levels[priority].clone())))
    }

    fn error(&self, key: &str, message: impl Into<String>, help: Option<String>) -> InputError {
        self.at.error(&["event", self.number, key], message, help)
    }
}
