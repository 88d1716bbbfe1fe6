//! Writes what is around a body into glTF: things as boxes that let the body be seen, and forces as arrows.

use contrapposto::model::{Model, Placement};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use serde_json::{Value, json};

use super::buffer::Buffer;
use super::course::{Course, Moving};
use super::{Clip, hull};
use crate::Thing;

/// A force at a point over time, drawn as an arrow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrow {
    /// Name of the force.
    pub name: String,
    /// Whether a support gives it; else it is a load.
    pub contact: bool,
    /// The point at which the arrow begins in every posture of the clip, ground, m.
    pub at: Vec<Vector3<f64>>,
    /// Direction and length of the arrow in every posture, ground, m; none where it is zero.
    pub along: Vec<Vector3<f64>>,
}

/// Names and colours of the materials beside that of the body: things let the body be seen.
const MATERIALS: [(&str, [f64; 4]); 3] = [
    ("thing", [0.115, 0.181, 0.279, 0.5]),
    ("load", [0.144, 0.025, 0.287, 1.0]),
    ("contact force", [0.0, 0.342, 0.171, 1.0]),
];
/// Radii of shaft and head of an arrow, and the length of the head, m.
const SHAFT: f64 = 0.012;
const ARROW_HEAD: (f64, f64) = (0.034, 0.09);
/// The share of its own size of what is not there: readers do not like a scale of nothing.
const NOTHING: f64 = 1e-6;
/// An arrow of its own size has this length, m; others are scaled as a whole.
const ARROW_LENGTH: f64 = 0.3;
/// Points and lengths of arrows are rounded to this, m, so that what hardly changes needs no keys.
const ARROW_GRAIN: f64 = 2e-3;

/// The things and the arrows of a clip.
#[derive(Clone, Copy)]
pub(super) struct Around<'a> {
    model: &'a Model,
    things: &'a [Thing],
    arrows: &'a [Arrow],
    times: &'a [f64],
}

impl<'a> Around<'a> {
    /// Of a clip.
    pub(super) fn of(&Clip { model, things, arrows, times, .. }: &Clip<'a>) -> Self {
        Self { model, things, arrows, times }
    }

    /// Number of nodes.
    pub(super) fn count(self) -> usize {
        self.things.len() + self.arrows.len()
    }

    /// Placement and size of every node in posture number `index`, ground.
    pub(super) fn places(self, index: usize, frames: &[Placement]) -> Vec<(Placement, f64)> {
        let segment = |s: usize| carrier(self.model, s, &frames[s]);
        let time = self.times.get(index).copied().unwrap_or_default();
        let size = |thing: &Thing| if thing.is_there(time) { 1.0 } else { NOTHING };
        let things = self.things.iter().map(|thing| (thing.place_by(segment), size(thing)));
        let rounded = |v: Vector3<f64>| v.map(|x| (x / ARROW_GRAIN).round() * ARROW_GRAIN);
        let arrows = self.arrows.iter().map(|arrow| {
            let of = |list: &[Vector3<f64>]| rounded(list.get(index).or(list.last()).copied().unwrap_or_default());
            let (at, along) = (of(&arrow.at), of(&arrow.along));
            let turn = UnitQuaternion::rotation_between(&Vector3::y(), &along);
            let turn =
                turn.unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
            (Isometry3::from_parts(at.into(), turn), (along.norm() / ARROW_LENGTH).max(NOTHING))
        });
        things.chain(arrows).collect()
    }

    /// Nodes and meshes with these courses; `first`: numbers of the first node, mesh and material.
    pub(super) fn written(self, courses: &[Course], first: [usize; 3], buffer: &mut Buffer) -> Scenery {
        let [first_node, first_mesh, first_material] = first;
        let mut scenery = Scenery::default();
        if courses.is_empty() {
            return scenery;
        }
        let look = |(name, color): (&str, [f64; 4])| {
            let look = json!({ "baseColorFactor": color, "metallicFactor": 0.0, "roughnessFactor": 0.8 });
            let mode = if color[3] < 1.0 { "BLEND" } else { "OPAQUE" };
            json!({ "name": name, "pbrMetallicRoughness": look, "alphaMode": mode })
        };
        scenery.materials = MATERIALS.into_iter().map(look).collect();
        let things = self.things.iter().map(|thing| (thing.name.as_str(), 0, cuboid(&thing.size, buffer)));
        let things: Vec<_> = things.collect();
        let arrow = (!self.arrows.is_empty()).then(|| arrow(buffer));
        let arrows = self.arrows.iter().zip(arrow.iter().cycle());
        let arrows =
            arrows.map(|(arrow, parts)| (arrow.name.as_str(), if arrow.contact { 2 } else { 1 }, parts.clone()));
        for ((name, material, parts), (i, course)) in things.into_iter().chain(arrows).zip(courses.iter().enumerate()) {
            let primitive = |[position, normal, indices]: [usize; 3]| {
                json!({
                    "attributes": { "POSITION": position, "NORMAL": normal }, "indices": indices,
                    "material": first_material + material,
                })
            };
            let primitives: Vec<Value> = parts.into_iter().map(primitive).collect();
            scenery.meshes.push(json!({ "name": name, "primitives": primitives }));
            scenery.nodes.push(json!({
                "name": name, "mesh": first_mesh + i, "translation": course.place.first(), "rotation": course.turn.first(),
                "scale": course.size.first(),
            }));
            scenery.channels.push((first_node + i, course.moving()));
        }
        scenery
    }
}

/// The placement of a segment, given its joint frame.
fn carrier(model: &Model, s: usize, frame: &Placement) -> Placement {
    frame * Isometry3::from(-model.segments()[s].in_segment.translation.vector)
}

/// Nodes, meshes and materials of the scenery in a file of which so many are there already, and the channels of its nodes.
#[derive(Default)]
pub(super) struct Scenery {
    pub(super) nodes: Vec<Value>,
    pub(super) meshes: Vec<Value>,
    pub(super) materials: Vec<Value>,
    pub(super) channels: Vec<(usize, Moving)>,
}

/// A box about the origin: positions, normals, corners of triangles.
fn cuboid(size: &Vector3<f64>, buffer: &mut Buffer) -> Vec<[usize; 3]> {
    let (mut corners, mut triangles) = (vec![], vec![]);
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let mut normal = [0.0; 3];
            normal[axis] = side;
            let first = corners.len() as u16;
            for (u, v) in [(-1.0, -1.0), (side, -side), (1.0, 1.0), (-side, side)] {
                let mut at = [0.0; 3];
                (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (side, u, v);
                let at = [0, 1, 2].map(|k| (0.5 * at[k] * size[k]) as f32);
                corners.push([at, normal.map(|v| v as f32)]);
            }
            triangles.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
        }
    }
    let [position, normal] = buffer.vertices(&corners);
    vec![[position, normal, buffer.triangles(&triangles)]]
}

/// An arrow from the origin along y: shaft and head.
fn arrow(buffer: &mut Buffer) -> Vec<[usize; 3]> {
    let indices = buffer.triangles(&hull::triangles());
    let neck = ARROW_LENGTH - ARROW_HEAD.1;
    let shaft = [[0.0, SHAFT, 0.0, SHAFT], [0.0, neck, 0.0, SHAFT]];
    let head = [[0.0, neck, 0.0, ARROW_HEAD.0], [0.0, ARROW_LENGTH - 0.002, 0.0, 0.002]];
    [shaft, head]
        .map(|balls| {
            let [position, normal] = buffer.vertices(&hull::corners(&balls, [0.0; 3]));
            [position, normal, indices]
        })
        .into()
}
