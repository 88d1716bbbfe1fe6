//! Sets up body, start, loads, supports and tasks of a scenario, which the readers for `simulate`, `pose` and `relax` share.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Coordinate, Model};
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto::tasks::PriorityLevel;

use super::head::check_head;
use super::load::load;
use super::model::body;
use super::names::coordinate;
use super::posture::{balls, rates, set};
use super::stage::Stage;
use super::support;
use super::task::task;
use super::task_text::TaskText;
use super::text::ScenarioText;
use super::upright::add_upright;
use crate::input_error::InputError;
use crate::toml_file::{Located, shown};

/// The checked parts of a scenario that every reader needs.
pub(super) struct Setup {
    pub(super) model: Model,
    /// Start, with quaternions of length 1 and dependent coordinates where the independent ones put them.
    pub(super) start: Posture,
    pub(super) loads: Vec<Load>,
    /// Segments that carry weight.
    pub(super) standing: Vec<usize>,
    /// Kinematics of the start.
    pub(super) kinematics: Kinematics,
    /// Supports with their patches. A pose needs only their segments: for it, an error of a patch is none.
    pub(super) supports: Result<Vec<Support>, InputError>,
    /// The tasks by priority, the most important first.
    pub(super) levels: Vec<Level>,
    /// What was changed or added, a sentence each, for the reader of the results.
    pub(super) notes: Vec<String>,
}

/// Tasks of one priority.
pub(super) struct Level {
    pub(super) tasks: PriorityLevel,
    /// A name for each task.
    pub(super) labels: Vec<String>,
    /// More important than the relief of tired muscles.
    pub(super) above_relief: bool,
    /// Not of the file, but added by default.
    pub(super) added: bool,
}

impl Setup {
    /// Reads what the scenario says of body, start, loads, supports and tasks. `file` is the model of the file that it names.
    pub(super) fn read(at: &Located, text: &ScenarioText, file: Option<Model>) -> Result<Self, InputError> {
        check_head(at, text)?;
        let model = body(at, text, file)?;
        let mut start = model.default_posture();
        set(at, &model, &["posture"], &text.posture, &mut start)?;
        start.displace(&model, &vec![0.0; model.rates().len()]);
        let mut kinematics = Kinematics::new(&model);
        kinematics.update(&model, &start).map_err(|error| at.error(&["posture"], error.to_string(), None))?;
        let load = |(i, text): (usize, _)| load(at, &model, &["load", &i.to_string()], text);
        let loads = text.load.iter().enumerate().map(load).collect::<Result<_, _>>()?;
        let standing = support::segments(at, &model, &text.support)?;
        let supports = support::supports(at, &model, &text.support, &standing, &kinematics);
        let stage = Stage { at, model: &model, start: &start, kinematics: &kinematics, supports: &standing };
        let mut levels = levels(&stage, &text.task)?;
        let notes = add_upright(&stage, text, &mut levels)?.map(str::to_owned);
        let notes = notes.into_iter().collect();
        Ok(Self { loads, standing, supports, levels, notes, kinematics, start, model })
    }

    /// Where each task of the file stands: its level, and its place within the level.
    pub(super) fn places(&self) -> Vec<(usize, usize)> {
        let of_file = self.levels.iter().enumerate().filter(|(_, level)| !level.added);
        of_file.flat_map(|(i, level)| (0..level.tasks.tasks.len()).map(move |place| (i, place))).collect()
    }

    /// Checks that the start lies inside all ranges; dependent coordinates may leave theirs.
    pub(super) fn check_ranges(&self, at: &Located) -> Result<(), InputError> {
        for (coordinate, &value) in self.model.coordinates().iter().zip(self.start.values()) {
            let (low, high) = coordinate.range;
            if value < low || value > high {
                let (name, value, low, high) = (&coordinate.name, shown(value), shown(low), shown(high));
                let message = format!("`{name}` starts at {value}, outside its range {low}..{high} (rad or m)");
                return Err(at.error(&["posture"], message, None));
            }
        }
        Ok(())
    }

    /// Rates of the coordinates that are not free.
    pub(super) fn locked(&self, at: &Located, text: &ScenarioText) -> Result<Vec<usize>, InputError> {
        let model = &self.model;
        let free = free(at, model, text, |_| true)?;
        for first in balls(model) {
            if free[first..first + 4].iter().any(|flag| *flag != free[first]) {
                let key = if text.coordinates.free.is_some() { "free" } else { "locked" };
                let name = &model.coordinates()[first].name;
                let message = format!("the four coordinates from `{name}` on turn together");
                let help = Some("name all four of them, or none".to_owned());
                return Err(at.error(&["coordinates", key], message, help));
            }
        }
        let mut locked: Vec<usize> = (0..free.len()).filter(|&i| !free[i]).flat_map(|i| rates(model, i)).collect();
        locked.sort_unstable();
        locked.dedup();
        Ok(locked)
    }
}

/// One flag a coordinate: the coordinate may move. `otherwise` decides where the file has neither list.
pub(super) fn free(
    at: &Located,
    model: &Model,
    text: &ScenarioText,
    otherwise: impl Fn(&Coordinate) -> bool,
) -> Result<Vec<bool>, InputError> {
    let (list, key, listed) = match (&text.coordinates.free, &text.coordinates.locked) {
        (Some(_), Some(_)) => {
            let help = Some("keep one of the two lists".to_owned());
            return Err(at.key_error(&["coordinates", "locked"], "both `free` and `locked` are given", help));
        }
        (Some(list), None) => (list, "free", true),
        (None, Some(list)) => (list, "locked", false),
        (None, None) => return Ok(model.coordinates().iter().map(otherwise).collect()),
    };
    let mut flags = vec![!listed; model.coordinates().len()];
    for (i, name) in list.iter().enumerate() {
        flags[coordinate(at, model, &["coordinates", key, &i.to_string()], name)?] = listed;
    }
    Ok(flags)
}

/// The tasks by priority.
fn levels(stage: &Stage<'_>, texts: &[TaskText]) -> Result<Vec<Level>, InputError> {
    let mut levels: Vec<Level> = vec![];
    for (i, text) in texts.iter().enumerate() {
        let task = task(stage, i, text)?;
        let label = task.label(stage.model);
        match levels.last_mut() {
            Some(before) if text.same_priority => {
                before.tasks.tasks.push(task);
                before.labels.push(label);
                before.above_relief |= text.above_relief;
            }
            None if text.same_priority => {
                let path = ["task", &i.to_string(), "same_priority"];
                let help = Some("leave it out".to_owned());
                return Err(stage.at.key_error(&path, "no task stands before the first one", help));
            }
            _ => levels.push(Level {
                tasks: task.into(),
                labels: vec![label],
                above_relief: text.above_relief,
                added: false,
            }),
        }
    }
    Ok(levels)
}

/// Names of the tables, among these, that the file has.
pub(super) fn present(at: &Located, tables: &[&'static str]) -> Vec<&'static str> {
    tables.iter().copied().filter(|table| at.holds(&[table])).collect()
}
