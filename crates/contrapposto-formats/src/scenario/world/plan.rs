//! Holds the things of a scenario in terms of the longhand: supports, obstacles, loads, tasks of hands, and a guess of the start.

use std::collections::BTreeMap;

use contrapposto::model::Model;
use contrapposto::statics::Load;
use contrapposto::tasks::{Point, PriorityLevel, Task};
use nalgebra::Vector3;

use super::word::Word;
use crate::input_error::InputError;
use crate::scenario::levels::Level;
use crate::scenario::obstacle_text::ObstacleText;
use crate::scenario::rest_text::RestText;
use crate::scenario::stage::Stage;
use crate::scenario::task_text::SupportText;
use crate::scenario::text::ScenarioText;
use crate::thing::Thing;
use crate::toml_file::{Alias, Located};

/// The things of a scenario, in terms of the longhand.
#[derive(Default)]
pub(in crate::scenario) struct World {
    /// Supports, after those of the file.
    pub(in crate::scenario) supports: Vec<SupportText>,
    /// Rests, after those of the file, and the tables of the file that they come from.
    pub(in crate::scenario) may_rest: Vec<(RestText, Vec<String>)>,
    /// Obstacles, after those of the file.
    pub(in crate::scenario) obstacles: Vec<ObstacleText>,
    /// Loads, after those of the file.
    pub(in crate::scenario) loads: Vec<Load>,
    /// Tasks of hands, before those of the file, one priority a thing.
    pub(super) tasks: Vec<HandTask>,
    /// Values of coordinates by name, rad or m, for what `[posture]` leaves out.
    pub(super) seeds: BTreeMap<String, f64>,
    /// Wanted place of the middle of a patch at the start, by segment: forward and sideways, ground, m.
    pub(super) places: Vec<(&'static str, [f64; 2])>,
    /// Distance of a foot's wanted place ahead of its place at the start, m.
    pub(super) strides: Vec<(&'static str, f64)>,
    /// Whether the body sits.
    pub(super) sits: bool,
    /// Segments that rest on a part of the seat: a backrest, armrests.
    pub(super) rests: Vec<&'static str>,
    /// Things for drawings.
    pub(super) drawn: Vec<Thing>,
    /// The tables of the file that entries of supports and obstacles come from.
    pub(super) origins: Vec<(&'static str, usize, Vec<String>)>,
}

/// Hands at places.
pub(super) struct HandTask {
    /// Name of the thing.
    pub(super) name: &'static str,
    /// Lengths of a thing that is drawn between the hands, m.
    pub(super) size: Option<Vector3<f64>>,
    pub(super) hands: Vec<(usize, HandTarget)>,
}

/// Place that a hand must have.
pub(super) enum HandTarget {
    /// At a place of ground, m.
    At(Vector3<f64>),
    /// The hand's place at the start but for the height, which is the mean of both hands, and sideways by this, m, from the mean.
    Beside(f64),
}

impl World {
    /// Whether the file names no thing.
    pub(in crate::scenario) fn is_empty(&self) -> bool {
        self.supports.is_empty() && self.obstacles.is_empty() && self.loads.is_empty() && self.tasks.is_empty()
    }

    /// The tables of the file that entries of supports and obstacles come from, after so many entries of the file itself.
    pub(in crate::scenario) fn aliases(&self, text: &ScenarioText) -> Vec<Alias> {
        let before = |table: &str| if table == "support" { text.support.len() } else { text.obstacle.len() };
        let alias = |(table, i, from): &(&'static str, usize, Vec<String>)| Alias {
            entry: (table, (before(table) + i).to_string()),
            from: from.clone(),
        };
        self.origins.iter().map(alias).collect()
    }

    /// The rests of the file and of its things, and the tables of the file that they come from.
    pub(in crate::scenario) fn all_rests(
        &self,
        at: &Located,
        text: &ScenarioText,
    ) -> Result<(Vec<RestText>, Vec<Vec<String>>), InputError> {
        let of_file = text.rest.iter().enumerate();
        let of_file = of_file.map(|(i, rest)| (rest.clone(), vec!["rest".to_owned(), i.to_string()]));
        let all: Vec<_> = of_file.chain(self.may_rest.iter().cloned()).collect();
        for (rest, path) in &all {
            rest.check(at, &path.iter().map(String::as_str).collect::<Vec<_>>())?;
        }
        Ok(all.into_iter().unzip())
    }

    /// The tasks of hands by priority, above relief.
    pub(in crate::scenario) fn levels(&self, stage: &Stage<'_>) -> Vec<Level> {
        let level = |task: &HandTask| {
            let tasks: Vec<Task> = points(task, stage);
            let labels = tasks.iter().map(|point| format!("{}: {}", task.name, point.label(stage.model))).collect();
            let tasks = PriorityLevel { tasks, ..PriorityLevel::default() };
            Level { tasks, labels, above_relief: true, added: true }
        };
        self.tasks.iter().map(level).collect()
    }

    pub(super) fn support(&mut self, word: &Word<'_>, support: SupportText) {
        self.origins.push(("support", self.supports.len(), word.path.clone()));
        self.supports.push(support);
    }

    pub(super) fn obstacle(&mut self, word: &Word<'_>, obstacle: ObstacleText) {
        self.origins.push(("obstacle", self.obstacles.len(), word.path.clone()));
        self.obstacles.push(obstacle);
    }
}

/// The point tasks of hands at the start of the stage.
pub(super) fn points(task: &HandTask, stage: &Stage<'_>) -> Vec<Task> {
    let model = stage.model;
    let now = |hand: usize| stage.kinematics.station(model, hand, grip(model, hand));
    let mean = task.hands.iter().map(|(hand, _)| now(*hand)).sum::<Vector3<f64>>() / task.hands.len().max(1) as f64;
    let point = |(hand, target): &(usize, HandTarget)| {
        let target = match target {
            HandTarget::At(place) => *place,
            HandTarget::Beside(aside) => mean + Vector3::new(0.0, 0.0, *aside),
        };
        Task::Point(Point { segment: *hand, point: grip(model, *hand), target, axes: [true; 3] })
    };
    task.hands.iter().map(point).collect()
}

/// The point of a hand that holds things, in its frame, m: below the wrist by 8/7 of the distance of the palm's middle, 4 % of stature
/// in the built-in adult, near the knuckles (assumed); the centre of mass of a hand without a patch.
pub(super) fn grip(model: &Model, hand: usize) -> Vector3<f64> {
    const KNUCKLES: f64 = 8.0 / 7.0;
    let segment = &model.segments()[hand];
    if segment.patch.is_empty() {
        return segment.center_of_mass;
    }
    let middle = segment.patch.iter().sum::<Vector3<f64>>() / segment.patch.len() as f64;
    Vector3::new(0.0, KNUCKLES * middle.y, 0.0)
}

/// Height of the bone of a forearm above the armrest under it, m: the radius of the forearm's shape.
pub(super) fn forearm(model: &Model) -> f64 {
    let segment = model.segment("radius_r");
    let shape = model.shapes().iter().find(|shape| Some(shape.capsule.segment) == segment);
    shape.map_or(0.0, |shape| shape.capsule.radius)
}
