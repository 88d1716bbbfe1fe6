//! Holds the scenario file of a session: its tables, the points that are held, the posture, and the files that it names.
//!
//! Every change of the body's job is a change of the document, which the readers of `contrapposto-formats` then read anew. Points
//! that are held are its first tasks. Comments of an opened file are not kept.

use std::collections::BTreeMap;

use contrapposto::hybrid::Strategy;
use contrapposto::model::Model;
use contrapposto::toml_value::typed;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use toml::de::DeTable;
use toml::{Table, Value};

use crate::error::Refusal;
use crate::events;
use crate::message::{Handle, RegionScene, ThingTable};
use crate::strategies;
use crate::things;

/// The scenario of a new page.
pub(crate) const FIRST: &str = include_str!("first.toml");
/// Duration of a run of a scenario that says nothing about it, s, and its time step, s.
const RUN: (f64, f64) = (3600.0, 0.1);

/// A scenario file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Document {
    /// As it was opened, with the changes of its own tables.
    table: Table,
    /// Points that stay where they are: with their places in ground, m.
    pub(crate) held: Vec<(Handle, [f64; 3])>,
    /// Names and values of all coordinates; empty where the file says how the body starts.
    pub(crate) posture: Vec<(String, f64)>,
    /// Texts of other files, by name.
    pub(crate) files: BTreeMap<String, String>,
}

impl Document {
    /// From the text of a scenario and of the files that it names. Only the grammar is checked here.
    pub(crate) fn new(text: &str, files: BTreeMap<String, String>) -> Result<Self, Refusal> {
        let mut table: Table = parsed(text)?;
        let strategy = table.entry("strategy").or_insert_with(|| Value::Table(Table::new()));
        if let Value::Table(strategy) = strategy {
            strategy.entry("kind").or_insert_with(|| Value::String("passive".to_owned()));
        }
        let run = table.entry("run").or_insert_with(|| Value::Table(Table::new()));
        if let Value::Table(run) = run
            && run.is_empty()
        {
            run.insert("duration_s".to_owned(), Value::Float(RUN.0));
            run.insert("step_s".to_owned(), Value::Float(RUN.1));
        }
        Ok(Self { table, held: vec![], posture: vec![], files })
    }

    /// From a text of [`Document::state`].
    pub(crate) fn from_state(state: &str) -> Result<Self, Refusal> {
        parsed(state)
    }

    /// All of it as a text. Unlike the file, it keeps held points apart from tasks, and other files are in it.
    pub(crate) fn state(&self) -> Result<String, Refusal> {
        toml::to_string(self).map_err(Refusal::of)
    }

    /// The text of the file.
    pub(crate) fn text(&self) -> String {
        self.written(None)
    }

    /// The text of the file, whose run ends after `duration`, s. Events that would come later are left out.
    pub(crate) fn text_of_run(&self, duration: f64) -> String {
        self.written(Some(duration))
    }

    fn written(&self, duration: Option<f64>) -> String {
        let mut table = self.table.clone();
        let held = self.held.iter().map(|(handle, place)| point_task(handle, *place));
        let of_file = table.get("task").and_then(Value::as_array).cloned().unwrap_or_default();
        let tasks: Vec<Value> = held.chain(of_file).collect();
        if !tasks.is_empty() {
            table.insert("task".to_owned(), Value::Array(tasks));
        }
        events::count_on(&mut table, self.held.len());
        if !self.posture.is_empty() {
            let values = self.posture.iter().map(|(name, value)| (name.clone(), Value::Float(*value)));
            table.insert("start_from".to_owned(), Value::Table(values.collect()));
        }
        if let Some(duration) = duration {
            events::end_at(&mut table, duration);
            if let Some(Value::Table(run)) = table.get_mut("run") {
                run.insert("duration_s".to_owned(), Value::Float(duration));
            }
        }
        // A table of texts and numbers can always be written.
        toml::to_string(&table).unwrap_or_default()
    }

    /// Holds a point at a place in ground, m, as the last of those that are held; it replaces that of the same segment.
    pub(crate) fn hold(&mut self, handle: Handle, place: [f64; 3]) {
        self.free(&handle.segment);
        self.held.push((handle, place));
    }

    /// Frees the point of a segment.
    pub(crate) fn free(&mut self, segment: &str) {
        self.held.retain(|(handle, _)| handle.segment != segment);
    }

    /// Whether a point of this segment is held.
    pub(crate) fn holds(&self, segment: &str) -> bool {
        self.held.iter().any(|(handle, _)| handle.segment == segment)
    }

    /// The scenario from a moment of its run on, s: what its events have changed by then is so from the start. `strategies`: by
    /// coordinate, where an event has changed them.
    pub(crate) fn begin_at(&mut self, time: f64, strategies: Option<Vec<(String, Strategy)>>) {
        events::begin_at(&mut self.table, time);
        let (Some(strategies), Some(Value::Table(table))) = (strategies, self.table.get_mut("strategy")) else {
            return;
        };
        let actives = strategies.iter().filter(|(_, strategy)| *strategy == Strategy::Active).count();
        let most = if 2 * actives > strategies.len() { Strategy::Active } else { Strategy::Passive };
        let word = |strategy| Value::String(if strategy == Strategy::Active { "active" } else { "passive" }.to_owned());
        let others = strategies.into_iter().filter(|(_, strategy)| *strategy != most);
        let others: Table = others.map(|(name, strategy)| (name, word(strategy))).collect();
        table.insert("kind".to_owned(), word(most));
        table.insert("of".to_owned(), Value::Table(others));
    }

    /// Sex, stature (m) and mass (kg) of the built-in adult, where the file gives them.
    pub(crate) fn adult(&self) -> Option<(String, f64, f64)> {
        let adult = self.table.get("model")?.as_table()?.get("adult")?.as_table()?;
        let number =
            |key: &str| adult.get(key).and_then(|value| value.as_float().or(value.as_integer().map(|n| n as f64)));
        Some((adult.get("sex")?.as_str()?.to_owned(), number("stature_m")?, number("mass_kg")?))
    }

    /// Gives the built-in adult another size. The body starts as the file says.
    pub(crate) fn set_adult(&mut self, sex: &str, stature: f64, mass: f64) -> Result<(), Refusal> {
        let model = self.table.entry("model").or_insert_with(|| Value::Table(Table::new()));
        let Value::Table(model) = model else { return Err(Refusal::of("[model] is no table")) };
        if model.contains_key("file") {
            return Err(Refusal::of(
                "this body comes from a file; only the built-in adult has a sex, a stature and a mass to choose",
            ));
        }
        let adult = model.entry("adult").or_insert_with(|| Value::Table(Table::new()));
        let Value::Table(adult) = adult else { return Err(Refusal::of("adult of [model] is no table")) };
        adult.insert("sex".to_owned(), Value::String(sex.to_owned()));
        adult.insert("stature_m".to_owned(), Value::Float(stature));
        adult.insert("mass_kg".to_owned(), Value::Float(mass));
        adult.remove("lengths_m");
        self.begin_anew();
        Ok(())
    }

    /// Hangs a weight, kg, on a segment in place of the one that hangs there; 0 takes it off.
    pub(crate) fn set_load(&mut self, segment: &str, mass: f64) -> Result<(), Refusal> {
        let weight = (mass != 0.0).then(|| vec![("mass_kg", Value::Float(mass))]);
        self.replace_load(segment, &["mass_kg"], weight)
    }

    /// Pushes on a point of a segment, m, with a force in ground, N, in place of the one that pushes there; no force takes it off.
    pub(crate) fn set_force(&mut self, segment: &str, point: [f64; 3], force: [f64; 3]) -> Result<(), Refusal> {
        let pushes = force != [0.0; 3];
        let keys = pushes.then(|| vec![("at_m", numbers(point)), ("force_n", numbers(force))]);
        self.replace_load(segment, &["at_m", "force_n"], keys)
    }

    /// Puts a load on a segment in place of those that have these keys and no others beside the segment.
    fn replace_load(&mut self, segment: &str, keys: &[&str], load: Option<Vec<(&str, Value)>>) -> Result<(), Refusal> {
        let loads = self.table.entry("load").or_insert_with(|| Value::Array(vec![]));
        let Value::Array(loads) = loads else { return Err(Refusal::of("[[load]] is no list of tables")) };
        loads.retain(|load| !has_keys(load, segment, keys));
        if let Some(load) = load {
            let segment = [("segment", Value::String(segment.to_owned()))];
            let table = segment.into_iter().chain(load).map(|(key, value)| (key.to_owned(), value));
            loads.push(Value::Table(table.collect()));
        }
        if loads.is_empty() {
            self.table.remove("load");
        }
        Ok(())
    }

    /// Forces that push on segments: segment, point and force.
    pub(crate) fn forces(&self) -> Vec<(String, [f64; 3], [f64; 3])> {
        let loads = self.table.get("load").and_then(Value::as_array).into_iter().flatten();
        let force = |load: &Value| {
            let segment = load.get("segment")?.as_str()?;
            let keys = has_keys(load, segment, &["at_m", "force_n"]);
            keys.then(|| Some((segment.to_owned(), vector(load.get("at_m")?)?, vector(load.get("force_n")?)?)))
                .flatten()
        };
        loads.filter_map(force).collect()
    }

    /// Things that its tables put there.
    pub(crate) fn things(&self) -> Vec<ThingTable> {
        things::all(&self.table)
    }

    /// Adds a thing. The body begins anew, unless it only carries it.
    pub(crate) fn put(&mut self, word: &str, keys: Table) -> Result<(), Refusal> {
        if !things::is_only_carried(word, &keys) {
            self.begin_anew();
        }
        things::put(&mut self.table, word, keys)
    }

    /// Takes a thing away. The body begins anew.
    pub(crate) fn take_away(&mut self, word: &str, number: usize) -> Result<(), Refusal> {
        self.begin_anew();
        things::take_away(&mut self.table, word, number)
    }

    fn begin_anew(&mut self) {
        self.held.clear();
        self.posture.clear();
    }

    /// Strategy of a region, or of the whole body.
    pub(crate) fn set_strategy(&mut self, kind: &str, region: Option<&str>) -> Result<(), Refusal> {
        strategies::set(&mut self.table, kind, region)
    }

    /// Strategies of the regions that a body has.
    pub(crate) fn regions(&self, model: &Model) -> Vec<RegionScene> {
        strategies::by_region(&self.table, model)
    }

    /// Fatigue at the start, by coordinate of the positive and negative group, 0 to 1; of all others 0.
    pub(crate) fn set_fatigue(&mut self, levels: Vec<(String, [f64; 2])>) {
        let sides = |[positive, negative]: [f64; 2]| {
            let sides = [("positive", positive), ("negative", negative)];
            Value::Table(sides.into_iter().map(|(side, level)| (side.to_owned(), Value::Float(level))).collect())
        };
        let start = levels.into_iter().map(|(name, levels)| (name, sides(levels))).collect();
        let fatigue = self.table.entry("fatigue").or_insert_with(|| Value::Table(Table::new()));
        if let Value::Table(fatigue) = fatigue {
            fatigue.insert("start".to_owned(), Value::Table(start));
        }
    }

    /// Changes the tables of the file.
    pub(crate) fn exchange(&mut self, change: impl FnOnce(&mut Table) -> Result<(), Refusal>) -> Result<(), Refusal> {
        change(&mut self.table)
    }

    /// `active` or `passive`.
    pub(crate) fn strategy(&self) -> &str {
        self.table.get("strategy").and_then(|strategy| strategy.get("kind")?.as_str()).unwrap_or_default()
    }
}

/// A text of TOML as values of a type.
fn parsed<T: DeserializeOwned>(text: &str) -> Result<T, Refusal> {
    let table = DeTable::parse(text).map_err(Refusal::of)?;
    typed(table.get_ref()).map_err(Refusal::of)
}

/// Whether a load acts on a segment and has these keys and no others.
fn has_keys(load: &Value, segment: &str, keys: &[&str]) -> bool {
    load.as_table().is_some_and(|load| {
        load.len() == keys.len() + 1
            && keys.iter().all(|key| load.contains_key(*key))
            && load.get("segment").and_then(Value::as_str) == Some(segment)
    })
}

/// Three numbers of a file.
pub(crate) fn numbers(numbers: [f64; 3]) -> Value {
    Value::Array(numbers.map(Value::Float).to_vec())
}

/// Three numbers from a file.
pub(crate) fn vector(value: &Value) -> Option<[f64; 3]> {
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|n| n as f64));
    value.as_array()?.iter().map(number).collect::<Option<Vec<f64>>>()?.try_into().ok()
}

/// The task that holds a point at a place in ground.
fn point_task(handle: &Handle, place: [f64; 3]) -> Value {
    let task = [
        ("kind".to_owned(), Value::String("point".to_owned())),
        ("segment".to_owned(), Value::String(handle.segment.clone())),
        ("at_m".to_owned(), numbers(handle.point)),
        ("target_m".to_owned(), numbers(place)),
    ];
    Value::Table(task.into_iter().collect())
}
