//! Computes a line over a cylinder as OpenSim 4 does: points of tangency where a plane through both ends and a point on the cylinder
//! cuts the tangents, and a helix between them.
//!
//! The rule was learnt from the behaviour and the source of OpenSim (opensim-core, `WrapCylinder`); the helix meets the straight parts at
//! an angle. Where a path has several surfaces, OpenSim slides the points along the axis until the angle is small.

use std::f64::consts::TAU;

use nalgebra::{Rotation3, Vector3};

use super::contact::{Contact, Quadrant, Wrapping};
use super::cylinder::{Touching, touching};
use crate::muscle::tolerances::{
    OPENSIM_PARALLEL, OPENSIM_PIECE, OPENSIM_REACH, OPENSIM_TANGENCY, OPENSIM_TANGENCY_TRIES,
};

/// Lays the straight line between two points over a cylinder about z. `single`: the path has no other surface.
pub(super) fn wrap(
    radius: f64,
    length: f64,
    quadrant: Quadrant,
    from: &Vector3<f64>,
    to: &Vector3<f64>,
    single: bool,
) -> Wrapping {
    let touching = match touching(radius, quadrant, from, to) {
        Ok(touching) => touching,
        Err(other) => return other,
    };
    let (first, second) = cut(radius, from, to, &touching);
    if first.z.abs() > length / 2.0 && second.z.abs() > length / 2.0 {
        return Wrapping::Free;
    }
    let contact = Helix { radius, long: touching.long, first, second }.contact(from, to, single);
    if touching.crosses { Wrapping::Crosses(contact) } else { Wrapping::Touches(contact) }
}

/// The points of tangency, moved along the axis to the plane through both ends and an apex on the cylinder.
fn cut(radius: f64, from: &Vector3<f64>, to: &Vector3<f64>, touching: &Touching) -> (Vector3<f64>, Vector3<f64>) {
    let (d1, d2) = (from.xy().norm(), to.xy().norm());
    let middle = from + d1 / (d1 + d2) * (to - from);
    let on_axis = Vector3::new(0.0, 0.0, middle.z);
    let normal = (from - on_axis).normalize().cross(&(to - on_axis).normalize());
    let out = radius * Vector3::z().cross(&normal).normalize();
    let nearer =
        if (on_axis + out - middle).norm_squared() < (on_axis - out - middle).norm_squared() { out } else { -out };
    let apex = on_axis + if touching.far { -nearer } else { nearer };
    let normal = (from - apex).normalize().cross(&(to - apex).normalize()).normalize();
    let at_plane = |point: Vector3<f64>, other: f64| {
        if (2.0 * OPENSIM_REACH * normal.z).abs() < OPENSIM_PARALLEL {
            return point;
        }
        let z = from.z - (point - from).xy().dot(&normal.xy()) / normal.z;
        let reached = (z - point.z).abs() <= OPENSIM_REACH * (1.0 + 2.0 * OPENSIM_PARALLEL);
        let between = (z - other).abs() < (from.z - to.z).abs();
        if reached && between { Vector3::new(point.x, point.y, z) } else { point }
    };
    (at_plane(touching.first, to.z), at_plane(touching.second, from.z))
}

/// A helix between two points on a cylinder.
struct Helix {
    radius: f64,
    /// The other way round.
    long: bool,
    first: Vector3<f64>,
    second: Vector3<f64>,
}

impl Helix {
    /// Length and ends of the helix, moved until it is tangent to both straight parts unless this is the path's only surface.
    fn contact(mut self, from: &Vector3<f64>, to: &Vector3<f64>, single: bool) -> Contact {
        for _ in 0..OPENSIM_TANGENCY_TRIES {
            let length = self.length();
            let pieces = (length / OPENSIM_PIECE).floor();
            if single || pieces < 2.0 {
                break;
            }
            let first = slid(from, &self.first, &self.point(1.0 / pieces));
            // OpenSim takes the last point but one from the moved first end.
            let rise = first.map_or(0.0, |moved| moved.z - self.first.z);
            let second = slid(to, &self.second, &(self.point(1.0 - 1.0 / pieces) + rise * Vector3::z()));
            if first.is_none() && second.is_none() {
                break;
            }
            (self.first, self.second) = (first.unwrap_or(self.first), second.unwrap_or(self.second));
        }
        Contact { first: self.first, second: self.second, length: self.length() }
    }

    /// The angle that it turns. With its sign: for a turn of more than half a circle the other way, OpenSim's angle exceeds a circle.
    fn angle(&self) -> f64 {
        let (a, b) = (self.first, self.second);
        let angle = libm::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
        if self.long { TAU - angle } else { angle }
    }

    fn length(&self) -> f64 {
        libm::hypot(self.radius * self.angle(), self.second.z - self.first.z)
    }

    /// The point at a share of it.
    fn point(&self, share: f64) -> Vector3<f64> {
        let sense = if self.long { -1.0 } else { 1.0 };
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), sense * share * self.angle());
        turn * self.first + Vector3::z() * (share * (self.second.z - self.first.z))
    }
}

/// A point of tangency moved along the axis, unless the straight part and the helix, whose next point is `next`, meet there at one angle
/// to the axis.
fn slid(end: &Vector3<f64>, tangent: &Vector3<f64>, next: &Vector3<f64>) -> Option<Vector3<f64>> {
    let to_axis = |v: Vector3<f64>| libm::acos(v.normalize().z.clamp(-1.0, 1.0));
    let bend = (to_axis(tangent - end) - to_axis(next - tangent)).abs();
    if bend <= OPENSIM_TANGENCY {
        return None;
    }
    // Where the line from the end to the next point comes nearest to the line along the axis through the point of tangency.
    let line = next - end;
    let share = (tangent - end).xy().dot(&line.xy()) / line.xy().norm_squared();
    let z = tangent.z + 1.5 * (end.z + share * line.z - tangent.z);
    z.is_finite().then(|| Vector3::new(tangent.x, tangent.y, z))
}
