//! Gives the boxes that stand for held things, seats, steps and walls in drawings.
//!
//! Lengths of tools, bags, rests, legs, steps and walls are assumed: no number of a result depends on them.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::statics::{Load, LoadKind};
use contrapposto::tasks::Task;
use nalgebra::{Isometry3, Rotation3, Vector3};

use super::plan::{HandTask, forearm, grip, points};
use crate::scenario::stage::Stage;
use crate::scenario::task_text::SupportText;
use crate::thing::{Swing, Thing};

/// Lengths, m: forward, up, sideways.
const BAG: [f64; 3] = [0.34, 0.26, 0.12];
const RUCKSACK: [f64; 3] = [0.20, 0.42, 0.30];
const STEP: [f64; 2] = [0.34, 0.24];
const WALL: [f64; 3] = [0.02, 2.2, 1.6];
/// A tool that is carried: a bar through the fist.
const CARRIED_BAR: [f64; 3] = [0.26, 0.035, 0.035];
/// A tool that presses against something: body and tip, each with the distance of its middle from the hand toward the tip.
const TOOL_BODY: ([f64; 3], f64) = ([0.05, 0.20, 0.05], 0.03);
const TOOL_TIP: ([f64; 3], f64) = ([0.016, 0.10, 0.016], 0.18);
/// Strap or handle of a bag in a hand.
const HAND_STRAP: [f64; 2] = [0.16, 0.02];
/// Thickness of a handle, m.
pub(super) const BAR: f64 = 0.03;
/// Distance of a bag's middle below the hand or the shoulder that carries it, m.
const BELOW_HAND: f64 = 0.20;
const BELOW_SHOULDER: f64 = 0.45;
/// Distance of a shoulder bag's middle outside of the point of its strap, m.
const OUTSIDE_STRAP: f64 = 0.10;
/// Thickness and width of a backrest, and its length below and above the patch of the back, m.
const BACKREST: [f64; 2] = [0.04, 0.42];
const BEYOND_BACK: [f64; 2] = [0.18, 0.04];
/// Lengths of an armrest.
const ARMREST: [f64; 3] = [0.28, 0.03, 0.07];
/// Thickness of the legs of tables and seats, m.
const LEG: f64 = 0.04;
/// Density of a weight of the longhand, kg/m3: a cube of water.
const CUBE_DENSITY: f64 = 1000.0;

fn thing(name: &str, size: [f64; 3], middle: Vector3<f64>, segment: Option<usize>) -> Thing {
    Thing::new(name, size, Isometry3::translation(middle.x, middle.y, middle.z), segment)
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

/// A tool in a hand: a bar through the fist, or, where something presses on it, a body with a tip against that force.
pub(super) fn tool(model: &Model, hand: usize, force: Option<Vector3<f64>>) -> Vec<Thing> {
    let at = grip(model, hand);
    let Some(up) = force.and_then(|force| (-force).try_normalize(1e-9)) else {
        return vec![thing("tool", CARRIED_BAR, at, Some(hand))];
    };
    // The tip is at the end of the y axis of the box, and the fingers at the other end of that of the hand.
    let turned = Isometry3::rotation(std::f64::consts::PI * Vector3::x());
    let part = |(size, beyond): ([f64; 3], f64)| {
        let middle = at - Vector3::new(0.0, beyond, 0.0);
        let place = Isometry3::from_parts(middle.into(), turned.rotation);
        Thing { swing: Some(Swing { at, up }), ..Thing::new("tool", size, place, Some(hand)) }
    };
    vec![part(TOOL_BODY), part(TOOL_TIP)]
}

/// A bag in a hand, which hangs down on its strap.
pub(super) fn bag_in_hand(model: &Model, hand: usize) -> Vec<Thing> {
    let at = grip(model, hand);
    let swing = Some(Swing { at, up: Vector3::y() });
    let bag = thing("bag", BAG, at - Vector3::new(0.0, BELOW_HAND, 0.0), Some(hand));
    let [length, thickness] = HAND_STRAP;
    let reach = BELOW_HAND - 0.5 * BAG[1];
    let strap = thing("bag", [length, reach, thickness], at - Vector3::new(0.0, 0.5 * reach, 0.0), Some(hand));
    [bag, strap].map(|part| Thing { swing, ..part }).into()
}

/// A weight of the longhand in a hand: a cube of water about the point where it acts.
pub(in crate::scenario) fn weights<'a>(model: &'a Model, loads: &'a [Load]) -> impl Iterator<Item = Thing> + 'a {
    loads.iter().filter_map(|load| {
        let LoadKind::Weight(mass) = load.kind else { return None };
        let hand = matches!(model.segments()[load.segment].name.as_str(), "hand_r" | "hand_l");
        let edge = libm::cbrt(mass / CUBE_DENSITY);
        let swing = Some(Swing { at: load.point, up: Vector3::y() });
        (hand && mass > 0.0).then(|| Thing { swing, ..thing("weight", [edge; 3], load.point, Some(load.segment)) })
    })
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

/// Backrest and armrests of a seat, where the supports are at the start.
pub(super) fn rests(stage: &Stage<'_>, segments: &[&str]) -> impl Iterator<Item = Thing> {
    stage.patches.iter().filter_map(|support| {
        let name = stage.model.segments()[support.segment].name.as_str();
        match name {
            _ if !segments.contains(&name) => None,
            "torso" => Some(backrest(stage.model, stage.kinematics, support)),
            "radius_r" | "radius_l" => {
                let below = forearm(stage.model) + 0.5 * ARMREST[1];
                let middle = middle(&stations(stage.model, stage.kinematics, support));
                Some(thing("armrest", ARMREST, middle - Vector3::new(0.0, below, 0.0), None))
            }
            _ => None,
        }
    })
}

/// The backrest behind the patch of a back.
fn backrest(model: &Model, kinematics: &Kinematics, support: &Support) -> Thing {
    let corners = stations(model, kinematics, support);
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), libm::atan2(support.normal.y, support.normal.x));
    let along = turn * Vector3::y();
    let heights = corners.iter().map(|corner| along.dot(corner));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
    let ([thickness, width], [below, above]) = (BACKREST, BEYOND_BACK);
    let (low, high, on) = (low - below, high + above, middle(&corners));
    let middle = on + along * (0.5 * (low + high) - along.dot(&on)) - 0.5 * thickness * support.normal;
    let place = Isometry3::from_parts(middle.into(), turn.into());
    Thing::new("backrest", [thickness, high - low, width], place, None)
}

/// The corners of a support in ground, m.
fn stations(model: &Model, kinematics: &Kinematics, support: &Support) -> Vec<Vector3<f64>> {
    support.corners.iter().map(|corner| kinematics.station(model, support.segment, *corner)).collect()
}

fn middle(points: &[Vector3<f64>]) -> Vector3<f64> {
    points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64
}

/// Legs from the floor to the underside of a block: four at its corners, or one in the middle.
pub(super) fn legs(name: &str, middle: Vector3<f64>, size: [f64; 3], one: bool) -> Vec<Thing> {
    let height = middle.y - 0.5 * size[1];
    let aside = |k: usize| if one { 0.0 } else { 0.5 * (size[k] - LEG).max(0.0) };
    let leg = |(x, z): (f64, f64)| {
        let at = Vector3::new(middle.x + x * aside(0), 0.5 * height, middle.z + z * aside(2));
        thing(name, [LEG, height, LEG], at, None)
    };
    let corners: &[(f64, f64)] =
        if one { &[(0.0, 0.0)] } else { &[(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] };
    if height > 0.0 { corners.iter().copied().map(leg).collect() } else { vec![] }
}

/// A wall with a normal of ground, and a point of its surface.
pub(super) fn wall(normal: Vector3<f64>, point: Vector3<f64>) -> Thing {
    let [thickness, height, width] = WALL;
    let size = if normal.x == 0.0 { [width, height, thickness] } else { [thickness, height, width] };
    thing("wall", size, point - 0.5 * thickness * normal + Vector3::new(0.0, 0.5 * height, 0.0), None)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use contrapposto::model::{Adult, adult};

    use super::*;

    /// A litre of water weighs 1 kg.
    #[test]
    fn a_weight_in_a_hand_is_a_cube_of_water() {
        let model = adult(&Adult::default()).unwrap();
        let load = |name: &str, mass: f64| Load {
            segment: model.segment(name).unwrap(),
            point: Vector3::new(0.0, -0.1, 0.0),
            kind: LoadKind::Weight(mass),
        };
        let loads = [load("hand_r", 1.0), load("hand_l", 27.0), load("torso", 5.0), load("hand_r", 0.0)];
        let drawn: Vec<Thing> = weights(&model, &loads).collect();
        assert_eq!(drawn.len(), 2);
        for (cube, edge) in drawn.iter().zip([0.1, 0.3]) {
            assert!((cube.size - Vector3::repeat(edge)).norm() < 1e-12, "{}", cube.size);
        }
    }
}
