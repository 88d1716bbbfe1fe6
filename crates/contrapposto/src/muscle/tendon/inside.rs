//! Computes the point of a circle about the origin at which the shortest line between two points outside touches it from within.
//!
//! At that point both straight parts make the same angle with the circle. With distances `a` and `b` of the two points, `G` the angle between
//! them and `x` that between the first one and the point: `a sin(x) / |first - point| = b sin(G - x) / |second - point|`. MuJoCo solves an
//! equation of the same meaning to an error of 1e-6 rad; this one is solved to rounding.

use nalgebra::{Rotation2, Vector2};

use crate::muscle::tolerances::{INSIDE_STEPS, MUJOCO_LEAST};

/// The point; `None` where the straight line passes through the circle or an end is in it.
pub(super) fn reflect(radius: f64, [from, to]: [Vector2<f64>; 2]) -> Option<Vector2<f64>> {
    let (near, far) = (from.norm(), to.norm());
    if near <= radius || far <= radius || radius < MUJOCO_LEAST {
        return None;
    }
    let straight = to - from;
    let square = straight.norm_squared();
    if square > MUJOCO_LEAST {
        let share = -straight.dot(&from) / square;
        if share > 0.0 && share < 1.0 && (from + straight * share).norm() <= radius {
            return None;
        }
    }
    let turned = libm::atan2(from.perp(&to), from.dot(&to));
    let angle = balance(radius, near, far, turned.abs());
    Some(Rotation2::new(angle.copysign(turned)) * (from / near) * radius)
}

/// The root between 0 and `all` by Newton's method with bisection.
fn balance(radius: f64, near: f64, far: f64, all: f64) -> f64 {
    // The part of a unit tension along the circle, and its slope.
    let pull = |distance: f64, angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        let length = libm::hypot(distance - radius * cos, radius * sin);
        let along = distance * sin / length;
        (along, (distance * cos - radius * along * along) / length)
    };
    let (mut low, mut high) = (0.0, all);
    let mut angle = all * (near - radius) / (near - radius + (far - radius));
    for _ in 0..INSIDE_STEPS {
        let (first, second) = (pull(near, angle), pull(far, all - angle));
        let error = first.0 - second.0;
        if error > 0.0 {
            high = angle
        } else {
            low = angle
        }
        let newton = angle - error / (first.1 + second.1);
        let next = if newton > low && newton < high { newton } else { f64::midpoint(low, high) };
        if (next - angle).abs() <= f64::EPSILON * all {
            break;
        }
        angle = next;
    }
    angle
}
