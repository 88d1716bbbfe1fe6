//! Computes the line over a sphere: two tangents and an arc of the great circle in the plane through both ends and the center.
//!
//! Sphere and choice of the way round are those of OpenSim (learnt from `WrapSphere` of opensim-core), whose arc is a shortest line. Both
//! rules differ in an arc of more than half a circle, the length of which is negative in OpenSim, and in a line through the center, which
//! no surface turns there.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

use super::contact::{Contact, Quadrant, Wrapping, crossings};
use crate::muscle::rule::PathRule;
use crate::muscle::tolerances::THROUGH_CENTER;

/// Lays the straight line between two points over a sphere about the origin.
pub(super) fn wrap(
    radius: f64,
    quadrant: Quadrant,
    from: &Vector3<f64>,
    to: &Vector3<f64>,
    rule: PathRule,
) -> Wrapping {
    let (d1, d2) = (from.norm(), to.norm());
    if d1 < radius || d2 < radius {
        return Wrapping::Inside;
    }
    if crossings(&(from / radius), &(to / radius)).is_none() {
        return Wrapping::Free;
    }
    let (u1, u2) = (from / d1, to / d2);
    let Some(axis) = axis(&u1, &u2, &(to - from), quadrant, rule) else { return Wrapping::Free };
    // Angles at the center between an end and the point where its line touches.
    let (b1, b2) = (libm::acos((radius / d1).min(1.0)), libm::acos((radius / d2).min(1.0)));
    let turned = |u: &Vector3<f64>, angle: f64| radius * (u * libm::cos(angle) + axis.cross(u) * libm::sin(angle));
    let between = libm::atan2(axis.dot(&u1.cross(&u2)), u1.dot(&u2)).rem_euclid(TAU);
    let near = (turned(&u1, b1), turned(&u2, -b2), between - b1 - b2);
    let far = (turned(&u1, -b1), turned(&u2, b2), TAU - between - b1 - b2);
    let (mut crosses, mut chosen) = (false, near);
    if let Quadrant::Half { axis, positive } = quadrant {
        let on = |point: &Vector3<f64>| Quadrant::on(axis, positive, point);
        crosses = on(from) || on(to);
        let outward = far.0 - from + far.1 - to;
        if !(on(from) && on(to)) && (outward[axis] == 0.0 || on(&outward)) {
            chosen = far;
        }
    }
    let (first, second, arc) = (chosen.0, chosen.1, chosen.2.max(0.0));
    let length = if rule == PathRule::OpenSim && arc > PI { -radius * arc } else { radius * arc };
    let contact = Contact { first, second, length };
    if crosses { Wrapping::Crosses(contact) } else { Wrapping::Touches(contact) }
}

/// Axis about which the shorter way turns. Where the line passes through the center, every plane through it is as good: the one that
/// contains the axis of the quadrant.
fn axis(
    u1: &Vector3<f64>,
    u2: &Vector3<f64>,
    line: &Vector3<f64>,
    quadrant: Quadrant,
    rule: PathRule,
) -> Option<Vector3<f64>> {
    if line.normalize().cross(u2).norm() >= THROUGH_CENTER {
        return u1.cross(u2).try_normalize(0.0);
    }
    if rule == PathRule::OpenSim {
        return None;
    }
    let preferred = match quadrant {
        Quadrant::All => u1.iamin(),
        Quadrant::Half { axis, .. } => axis,
    };
    let sign = if let Quadrant::Half { positive: false, .. } = quadrant { -1.0 } else { 1.0 };
    [preferred, u1.iamin()]
        .iter()
        .find_map(|&index| u1.cross(&(sign * Vector3::<f64>::ith(index, 1.0))).try_normalize(0.5))
}
