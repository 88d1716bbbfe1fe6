//! Sets up body, start, loads, supports and tasks of a scenario, which the readers for `simulate`, `pose` and `relax` share.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::Rest;
use contrapposto::statics::Load;
use contrapposto::tasks::{Task, Thing as Obstacle};

use super::ball::with_free_heels;
use super::flat::lay_flat;
use super::hanging_arms::add_hanging_arms;
use super::head::check_head;
use super::least_effort::add_least_effort;
use super::levels::{Level, levels};
use super::load::load;
use super::model::body;
use super::obstacle::{boxes, limits, obstacles};
use super::obstacle_text::ObstacleText;
use super::place::set_places;
use super::posture::{balls, free, free_rates, rates, set, set_result};
use super::rest;
use super::rest_text::RestText;
use super::shoulder_rhythm::add_shoulder_rhythm;
use super::stage::{Stage, Start};
use super::support;
use super::task_text::SupportText;
use super::text::ScenarioText;
use super::upright::add_upright;
use super::world::{World, drawn_things, fit_things, read_world, weights};
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
    /// Supports that only a run puts on their planes, numbered after the others.
    pub(super) rests: Vec<(Support, Rest)>,
    /// Things that no part of the body passes through, by name.
    pub(super) obstacles: Vec<(String, Obstacle)>,
    /// Inequalities above all tasks.
    pub(super) limits: Vec<Task>,
    /// The tasks by priority, the most important first.
    pub(super) levels: Vec<Level>,
    /// Things around the body and in its hands, for drawings.
    pub(super) things: Vec<Thing>,
    /// Changes and additions of the scenario's reader, a sentence each, for the reader of the results.
    pub(super) notes: Vec<String>,
}

impl Setup {
    /// Reads what the scenario says of body, start, loads, supports and tasks. `file` is the model of the file that it names.
    pub(super) fn read(at: &Located, text: &ScenarioText, file: Option<Model>) -> Result<Self, InputError> {
        check_head(at, text)?;
        let model = body(at, text, file)?;
        let world = read_world(at, text, &model)?;
        let (rest_texts, paths) = world.all_rests(at, text)?;
        let before = text.support.len() + world.supports.len();
        let at = &at.with_aliases(world.aliases(text).into_iter().chain(rest::aliases(before, &paths)).collect());
        let built_in = text.model.file.is_none();
        let as_supports: Vec<SupportText> = rest_texts.iter().map(RestText::as_support).collect();
        let texts: Vec<&SupportText> = text.support.iter().chain(&world.supports).chain(&as_supports).collect();
        let (model, texts) = with_free_heels(at, (model, built_in), &texts)?;
        let mut start = Start::new(at, &model, start_as_written(at, text, &world, &model)?)?;
        let load = |(i, text): (usize, _)| load(at, &model, &["load", &i.to_string()], text);
        let mut loads = text.load.iter().enumerate().map(load).collect::<Result<Vec<Load>, _>>()?;
        loads.extend(world.loads.iter().cloned());
        let texts: Vec<&SupportText> = texts.iter().collect();
        let mut standing = support::segments(at, &model, &texts)?;
        let mut rests = vec![];
        let mut notes = vec![];
        let mut supports = match support::resting(at, built_in, &model, (&texts, &standing)) {
            Ok(mut resting) => {
                rests = rest::rests(at, &model, (&rest_texts, before), resting.split_off(before))?;
                let free = free_rates(at, &model, text)?;
                fit_things(at, &model, &free, &mut start, &resting, (&world, text), &mut notes)?;
                Ok(lay_flat(at, &model, &free, &mut start, resting, &mut notes)?)
            }
            Err(error) => Err(error),
        };
        standing.truncate(before);
        let Start { posture: start, kinematics } = start;
        if let Ok(supports) = &mut supports {
            set_places(at, (&model, &kinematics), &texts[..before], supports)?;
        }
        let patches = supports.as_ref().map_or(&[][..], Vec::as_slice);
        let stage = Stage { at, model: &model, start: &start, kinematics: &kinematics, supports: &standing, patches };
        let mut levels: Vec<Level> = world.levels(&stage).into_iter().chain(levels(&stage, &text.task)?).collect();
        rest::check_free(at, &model, &rests, &levels)?;
        notes.extend(add_tasks(&stage, text, &loads, &mut levels)?);
        notes.extend(far_targets(&stage, &levels));
        let texts: Vec<&ObstacleText> = text.obstacle.iter().chain(&world.obstacles).collect();
        let obstacles = obstacles(at, &texts)?;
        let limits = limits(at, text, &obstacles, (&model, &standing), &kinematics)?;
        let longhand = weights(&model, &loads[..text.load.len()]);
        let things = boxes(&obstacles).chain(drawn_things(&world, &stage)).chain(longhand).collect();
        Ok(Self {
            obstacles,
            loads,
            standing,
            supports,
            rests,
            limits,
            levels,
            things,
            notes,
            kinematics,
            start,
            model,
        })
    }

    /// Level of each task of the file, and its place within the level.
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

/// Adds the tasks that a file leaves out and its body has all the same; gives a sentence on each.
fn add_tasks(
    stage: &Stage<'_>,
    text: &ScenarioText,
    loads: &[Load],
    levels: &mut Vec<Level>,
) -> Result<Vec<String>, InputError> {
    // The others find their places above the task of effort.
    let effort = add_least_effort(stage, text, levels)?;
    let upright = add_upright(stage, text, levels)?;
    let arms = add_hanging_arms(stage, text, loads, levels)?;
    add_shoulder_rhythm(stage, text, levels)?;
    Ok([upright, arms, effort].into_iter().flatten().map(str::to_owned).collect())
}

/// The start before patches lie on their surfaces: the seeds of things, and what the file says.
fn start_as_written(at: &Located, text: &ScenarioText, world: &World, model: &Model) -> Result<Posture, InputError> {
    let mut start = model.default_posture();
    world.seed(model, &mut start);
    set(at, model, &["posture"], &text.posture, &mut start)?;
    set_result(at, model, &text.start_from, &mut start)?;
    start.displace(model, &vec![0.0; model.rates().len()]);
    Ok(start)
}

/// Farthest place from the body that a person means, m (assumed).
const FARTHEST_TARGET: f64 = 3.0;

/// A sentence on every place that a point of the body should be at, and that is far away from the body at the start.
fn far_targets(stage: &Stage<'_>, levels: &[Level]) -> Vec<String> {
    let Some(body) = stage.kinematics.center_of_mass(stage.model) else { return vec![] };
    let far = |task: &Task| {
        let target = match task {
            Task::Point(task) => (0..3).map(|axis| if task.axes[axis] { task.target[axis] - body[axis] } else { 0.0 }),
            _ => return None,
        };
        let distance = target.map(|x| x * x).sum::<f64>().sqrt();
        (distance > FARTHEST_TARGET).then(|| {
            let distance = shown((10.0 * distance).round() / 10.0);
            let label = task.label(stage.model);
            format!(
                "the place of `{label}` is {distance} m away from the body; lengths are in metres: are metres meant?"
            )
        })
    };
    levels.iter().flat_map(|level| &level.tasks.tasks).filter_map(far).collect()
}

/// Names of the tables, among these, that the file has.
pub(super) fn present(at: &Located, tables: &[&'static str]) -> Vec<&'static str> {
    tables.iter().copied().filter(|table| at.holds(&[table])).collect()
}
