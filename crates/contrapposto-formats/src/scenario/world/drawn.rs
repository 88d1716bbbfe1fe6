//! Gives the boxes that stand for held things, steps and walls in drawings.
//!
//! Lengths of tools, bags, steps and walls are assumed: no number of a result depends on them.

use contrapposto::model::Model;
use contrapposto::tasks::Task;
use nalgebra::{Isometry3, Vector3};

use super::plan::{HandTask, grip, points};
use crate::scenario::stage::Stage;
use crate::scenario::task_text::SupportText;
use crate::thing::Thing;

/// Lengths, m: forward, up, sideways.
const TOOL: [f64; 3] = [0.05, 0.20, 0.05];
const BAG: [f64; 3] = [0.34, 0.26, 0.12];
const RUCKSACK: [f64; 3] = [0.20, 0.42, 0.30];
const STEP: [f64; 2] = [0.34, 0.24];
const WALL: [f64; 3] = [0.02, 2.2, 1.6];
/// Thickness of a handle, m.
pub(super) const BAR: f64 = 0.03;
/// Distance of a bag's middle below the hand or the shoulder that carries it, m.
const BELOW_HAND: f64 = 0.20;
const BELOW_SHOULDER: f64 = 0.45;
/// Distance of a shoulder bag's middle outside of the point of its strap, m.
const OUTSIDE_STRAP: f64 = 0.10;

fn thing(name: &str, size: [f64; 3], middle: Vector3<f64>, segment: Option<usize>) -> Thing {
    Thing {
        name: name.to_owned(),
        size: size.into(),
        place: Isometry3::translation(middle.x, middle.y, middle.z),
        segment,
    }
}

/// The thing that both hands hold, where the hands must be at the start.
pub(super) fn between_hands(task: &HandTask, stage: &Stage<'_>) -> Option<Thing> {
    let size = task.size?;
    let targets: Vec<Vector3<f64>> = points(task, stage)
        .iter()
        .filter_map(|task| match task {
            Task::Point(point) => Some(point.target),
            _ => None,
        })
        .collect();
    let middle = targets.iter().sum::<Vector3<f64>>() / targets.len().max(1) as f64;
    Some(thing(task.name, size.into(), middle, None))
}

/// A tool in a hand.
pub(super) fn tool(model: &Model, hand: usize) -> Thing {
    thing("tool", TOOL, grip(model, hand), Some(hand))
}

/// A bag in a hand, which hangs down.
pub(super) fn bag_in_hand(model: &Model, hand: usize) -> Thing {
    thing("bag", BAG, grip(model, hand) - Vector3::new(0.0, BELOW_HAND, 0.0), Some(hand))
}

/// A bag whose strap is at a point of the trunk.
pub(super) fn bag_on_trunk(torso: usize, strap: Vector3<f64>) -> Thing {
    if strap.z == 0.0 {
        return thing("rucksack", RUCKSACK, strap, Some(torso));
    }
    let middle = strap + Vector3::new(0.0, -BELOW_SHOULDER, OUTSIDE_STRAP * strap.z.signum());
    thing("bag", BAG, middle, Some(torso))
}

/// The step under a foot at the start.
pub(super) fn step(support: &SupportText, stage: &Stage<'_>) -> Option<Thing> {
    let height = support.step_m.filter(|height| *height > 0.0)?;
    let segment = stage.model.segment(&support.segment)?;
    let patch = &stage.model.segments()[segment].patch;
    let middle = patch.iter().sum::<Vector3<f64>>() / patch.len().max(1) as f64;
    let under = stage.kinematics.station(stage.model, segment, middle);
    let [forward, sideways] = STEP;
    Some(thing("step", [forward, height, sideways], Vector3::new(under.x, 0.5 * height, under.z), None))
}

/// A wall with a normal of ground, and a point of its surface.
pub(super) fn wall(normal: Vector3<f64>, point: Vector3<f64>) -> Thing {
    let [thickness, height, width] = WALL;
    let size = if normal.x == 0.0 { [width, height, thickness] } else { [thickness, height, width] };
    thing("wall", size, point - 0.5 * thickness * normal + Vector3::new(0.0, 0.5 * height, 0.0), None)
}
