//! Computes the line between two points of a plane round a circle about the origin, on the side of a third point.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use crate::muscle::tolerances::{FULL_TURN, MUJOCO_LEAST};

/// Points at which a line touches a circle, and the length of the arc, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    pub(super) first: Vector2<f64>,
    pub(super) second: Vector2<f64>,
    pub(super) arc: f64,
}

/// The line round the circle; `None` where it is straight. It goes the shorter way if the straight line meets the circle, and the other way
/// if the direction opposite to `side`, of unit length, is between those of the two points: then the straight line has the circle's centre
/// and the side point on different sides of it.
pub(super) fn round(radius: f64, [from, to]: [Vector2<f64>; 2], side: Option<Vector2<f64>>) -> Option<Turn> {
    let square = radius * radius;
    if from.norm_squared() < square || to.norm_squared() < square || radius < MUJOCO_LEAST {
        return None;
    }
    let straight = to - from;
    if straight.norm_squared() < MUJOCO_LEAST {
        return None;
    }
    let share = (-straight.dot(&from) / straight.norm_squared()).clamp(0.0, 1.0);
    let meets = (from + straight * share).norm_squared() <= square;
    let sense = from.perp(&to);
    let opposite = |side: Vector2<f64>| side.perp(&from) * sense >= 0.0 && to.perp(&side) * sense >= 0.0;
    let far = sense != 0.0 && side.is_some_and(opposite);
    if !meets && !far {
        return None;
    }
    let clockwise = if sense == 0.0 { side.is_some_and(|side| from.perp(&side) < 0.0) } else { (sense > 0.0) == far };
    let turn = if clockwise { 1.0 } else { -1.0 };
    let (first, second) = (tangent(radius, &from, turn), tangent(radius, &to, -turn));
    let angle = libm::atan2(first.perp(&second), first.dot(&second));
    let turned = if clockwise { -angle } else { angle }.rem_euclid(TAU);
    // A line that only just touches turns by nothing, not once round.
    let arc = radius * if turned > TAU - FULL_TURN { 0.0 } else { turned };
    Some(Turn { first, second, arc })
}

/// The point at which a line from a point touches the circle: clockwise of the point for a positive sense.
fn tangent(radius: f64, point: &Vector2<f64>, sense: f64) -> Vector2<f64> {
    let square = point.norm_squared();
    let across = sense * radius * (square - radius * radius).sqrt();
    (point * (radius * radius) + Vector2::new(point.y, -point.x) * across) / square
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation2, Vector2};

    use super::round;

    /// Radius of the circle, m.
    const RADIUS: f64 = 0.03;

    /// A straight line at the distance of the radius, to rounding, in many directions.
    #[test]
    fn a_line_that_only_just_touches_turns_by_nothing() {
        let mut touching = 0;
        for k in 0..2000 {
            let turn = Rotation2::new(0.1 + 0.7 * f64::from(k));
            let (before, after) = (0.02 + 1e-4 * f64::from(k % 37), 0.05 + 1e-4 * f64::from(k % 53));
            let ends = [Vector2::new(-before, RADIUS), Vector2::new(after, RADIUS)].map(|end| turn * end);
            for ends in [ends, [ends[1], ends[0]]] {
                let Some(line) = round(RADIUS, ends, None) else { continue };
                touching += 1;
                assert!(line.arc < 1e-6 * RADIUS, "{k}: {line:?}");
                let place = turn * Vector2::new(0.0, RADIUS);
                assert!((line.first - place).norm() < 1e-8 && (line.second - place).norm() < 1e-8, "{k}: {line:?}");
            }
        }
        assert!(touching > 100, "{touching}");
    }
}
