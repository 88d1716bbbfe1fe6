//! Computes the shortest line over a cylinder: straight, a helix, straight, with one slope along the axis throughout.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::contact::{Contact, Quadrant, Wrapping};
use crate::muscle::tolerances::FULL_TURN;

/// Points at which lines from two points touch a circle about z, and the way round that the quadrant asks for.
pub(super) struct Touching {
    pub(super) first: Vector3<f64>,
    pub(super) second: Vector3<f64>,
    /// The line turns counterclockwise, seen from +z.
    pub(super) counterclockwise: bool,
    /// On the side of the axis away from the straight line, as OpenSim counts it.
    pub(super) far: bool,
    /// More than half a turn, as OpenSim counts it.
    pub(super) long: bool,
    /// The straight line passes through the cylinder.
    pub(super) crosses: bool,
}

/// Lays the straight line between two points over a cylinder about z.
pub(super) fn wrap(radius: f64, length: f64, quadrant: Quadrant, from: &Vector3<f64>, to: &Vector3<f64>) -> Wrapping {
    let touching = match touching(radius, quadrant, from, to) {
        Ok(touching) => touching,
        Err(other) => return other,
    };
    let (mut first, mut second) = (touching.first, touching.second);
    let angle = libm::atan2(first.x.mul_add(second.y, -(first.y * second.x)), first.x * second.x + first.y * second.y);
    let turned = if touching.counterclockwise { angle } else { -angle }.rem_euclid(TAU);
    // A line that only just touches turns by nothing, not once round.
    let arc = radius * if turned > TAU - FULL_TURN { 0.0 } else { turned };
    let before = (first - from).xy().norm();
    let flat = before + arc + (to - second).xy().norm();
    let slope = if flat > 0.0 { (to.z - from.z) / flat } else { 0.0 };
    (first.z, second.z) = (from.z + slope * before, from.z + slope * (before + arc));
    if first.z.abs() > length / 2.0 && second.z.abs() > length / 2.0 {
        return Wrapping::Free;
    }
    let contact = Contact { first, second, length: arc * libm::hypot(slope, 1.0) };
    if touching.crosses { Wrapping::Crosses(contact) } else { Wrapping::Touches(contact) }
}

/// The points that lines from a point touch on a circle about z: counterclockwise of the point, and clockwise.
fn tangents(radius: f64, point: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let distance = point.xy().norm();
    let out = point.xy() / distance;
    let along = radius * radius / distance;
    let across = (radius * radius - along * along).max(0.0).sqrt();
    [across, -across].map(|s| Vector3::new(along * out.x - s * out.y, along * out.y + s * out.x, point.z))
}

/// Chooses the points and the way round. The choice is that of OpenSim, but for a cylinder that is touched all round, where it is the
/// shorter way.
pub(super) fn touching(
    radius: f64,
    quadrant: Quadrant,
    from: &Vector3<f64>,
    to: &Vector3<f64>,
) -> Result<Touching, Wrapping> {
    if from.xy().norm() < radius || to.xy().norm() < radius {
        return Err(Wrapping::Inside);
    }
    let straight = to - from;
    let share = -from.xy().dot(&straight.xy()) / straight.xy().norm_squared();
    let nearest = from + share * straight;
    let crosses = nearest.xy().norm_squared() < radius * radius && share > 0.0 && share < 1.0;
    let [a1, b1] = tangents(radius, from);
    let [a2, b2] = tangents(radius, to);
    let cos = |x: &Vector3<f64>, y: &Vector3<f64>| (x.xy().dot(&y.xy()) / (radius * radius)).clamp(-1.0, 1.0);
    // The greater the cosine, the smaller the angle between the points of a pair.
    let counterclockwise_is_longer = cos(&a1, &b2) < cos(&b1, &a2);
    let Quadrant::Half { axis, positive } = quadrant else {
        if !crosses {
            return Err(Wrapping::Free);
        }
        let counterclockwise = !counterclockwise_is_longer;
        let (first, second) = if counterclockwise { (a1, b2) } else { (b1, a2) };
        return Ok(Touching { first, second, counterclockwise, far: false, long: false, crosses });
    };
    let on = |point: &Vector3<f64>| Quadrant::on(axis, positive, point);
    if (on(from) || on(to)) && !crosses && (on(from) == on(to) || on(&nearest)) {
        return Err(Wrapping::Free);
    }
    let none = !on(&a1) && !on(&b1) && !on(&a2) && !on(&b2);
    let counterclockwise = match (on(&a1), on(&b1)) {
        (true, true) => !on(&a2),
        (true, false) => true,
        (false, true) => false,
        (false, false) if none => counterclockwise_is_longer,
        (false, false) => !on(&a2),
    };
    let (first, second) = if counterclockwise { (a1, b2) } else { (b1, a2) };
    let far = none || counterclockwise == counterclockwise_is_longer;
    let outward = (first + second).xy();
    let beyond = (first - from + second - to).xy();
    let crosses = crosses && (on(from) || on(to));
    Ok(Touching { first, second, counterclockwise, far, long: outward.dot(&beyond) < 0.0, crosses })
}
