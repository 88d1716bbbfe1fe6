//! Computes the line between two points round a sphere or cylinder, by MuJoCo's rule: in the plane of the sphere's centre, or in that
//! across the cylinder, with one slope along its axis throughout.

use nalgebra::{Vector2, Vector3};

use super::circle::{Turn, round};
use super::inside::reflect;
use super::parts::{RoundShape, TendonGeom};
use crate::muscle::tolerances::MUJOCO_LEAST;
use crate::muscle::wrap::Contact;

/// Points at which the line touches the surface, and the length between them; `None` where the line is straight. All in the surface's frame.
pub(super) fn around(
    geom: &TendonGeom,
    from: &Vector3<f64>,
    to: &Vector3<f64>,
    side: Option<&Vector3<f64>>,
) -> Option<Contact> {
    if from.norm() < MUJOCO_LEAST || to.norm() < MUJOCO_LEAST {
        return None;
    }
    let axes = match geom.shape {
        RoundShape::Sphere => plane(from, to),
        RoundShape::Cylinder => [Vector3::x(), Vector3::y()],
    };
    let flat = |place: &Vector3<f64>| Vector2::new(place.dot(&axes[0]), place.dot(&axes[1]));
    let ends = [flat(from), flat(to)];
    let turn = match side.filter(|side| side.norm() < geom.radius) {
        Some(_) => reflect(geom.radius, ends).map(|at| Turn { first: at, second: at, arc: 0.0 }),
        None => round(geom.radius, ends, side.map(|side| direction(flat(side)))),
    }?;
    let [mut first, mut second] = [turn.first, turn.second].map(|at| axes[0] * at.x + axes[1] * at.y);
    let mut length = turn.arc;
    if geom.shape == RoundShape::Cylinder {
        let (before, after) = ((first - from).xy().norm(), (to - second).xy().norm());
        let slope = (to.z - from.z) / (before + turn.arc + after);
        (first.z, second.z) = (from.z + slope * before, from.z + slope * (before + turn.arc));
        length = libm::hypot(turn.arc, second.z - first.z);
    }
    Some(Contact { first, second, length })
}

/// Axes of the plane through the origin and two points: the first one towards the first point.
fn plane(from: &Vector3<f64>, to: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let first = from.normalize();
    let normal = from.cross(to);
    let normal = match normal.norm() {
        size if size >= MUJOCO_LEAST => normal / size,
        // Any plane through both: the one that MuJoCo takes.
        _ => {
            let mut other = Vector3::repeat(1.0);
            other[largest(&first)] = 0.0;
            first.cross(&other).normalize()
        }
    };
    [first, normal.cross(&first).normalize()]
}

/// Index of the largest component; the first of equal ones.
fn largest(direction: &Vector3<f64>) -> usize {
    let size = direction.abs();
    match () {
        () if size.y > size.x && size.y > size.z => 1,
        () if size.z > size.x && size.z > size.y => 2,
        () => 0,
    }
}

/// The direction of a vector; x for one of no length.
fn direction(vector: Vector2<f64>) -> Vector2<f64> {
    match vector.norm() {
        size if size >= MUJOCO_LEAST => vector / size,
        _ => Vector2::x(),
    }
}
