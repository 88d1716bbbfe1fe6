//! Sets up body, start, loads, supports and tasks of a scenario, which the readers for `simulate`, `pose` and `relax` share.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto::tasks::Task;

use super::flat::lay_flat;
use super::head::check_head;
use super::levels::{Level, levels};
use super::load::load;
use super::model::body;
use super::obstacle::{boxes, limits};
use super::place::set_places;
use super::posture::{balls, free, free_rates, rates, set};
use super::stage::{Stage, Start};
use super::support;
use super::text::ScenarioText;
use super::upright::add_upright;
use crate::input_error::InputError;
use crate::thing::Thing;
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
    /// Inequalities above all tasks.
    pub(super) limits: Vec<Task>,
    /// The tasks by priority, the most important first.
    pub(super) levels: Vec<Level>,
    /// Things around the body and in its hands, for drawings.
    pub(super) things: Vec<Thing>,
    /// What was changed or added, a sentence each, for the reader of the results.
    pub(super) notes: Vec<String>,
}

impl Setup {
    /// Reads what the scenario says of body, start, loads, supports and tasks. `file` is the model of the file that it names.
    pub(super) fn read(at: &Located, text: &ScenarioText, file: Option<Model>) -> Result<Self, InputError> {
        check_head(at, text)?;
        let model = body(at, text, file)?;
        let mut start = model.default_posture();
        set(at, &model, &["posture"], &text.posture, &mut start)?;
        start.displace(&model, &vec![0.0; model.rates().len()]);
        let mut start = Start::new(at, &model, start)?;
        let load = |(i, text): (usize, _)| load(at, &model, &["load", &i.to_string()], text);
        let loads = text.load.iter().enumerate().map(load).collect::<Result<_, _>>()?;
        let standing = support::segments(at, &model, &text.support)?;
        let mut notes = vec![];
        let mut supports = match support::resting(at, text, &model, &standing) {
            Ok(resting) => Ok(lay_flat(at, &model, &free_rates(at, &model, text)?, &mut start, resting, &mut notes)?),
            Err(error) => Err(error),
        };
        let Start { posture: start, kinematics } = start;
        if let Ok(supports) = &mut supports {
            set_places(at, (&model, &kinematics), &text.support, supports)?;
        }
        let patches = supports.as_ref().map_or(&[][..], Vec::as_slice);
        let stage = Stage { at, model: &model, start: &start, kinematics: &kinematics, supports: &standing, patches };
        let mut levels = levels(&stage, &text.task)?;
        notes.extend(add_upright(&stage, text, &mut levels)?.map(str::to_owned));
        let limits = limits(at, text, &model, &standing, &kinematics)?;
        let things = boxes(at, text)?;
        Ok(Self { loads, standing, supports, limits, levels, things, notes, kinematics, start, model })
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

/// Names of the tables, among these, that the file has.
pub(super) fn present(at: &Located, tables: &[&'static str]) -> Vec<&'static str> {
    tables.iter().copied().filter(|table| at.holds(&[table])).collect()
}
