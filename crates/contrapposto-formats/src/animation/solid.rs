//! Computes the solid shape of every segment: hulls of balls between its joints, whose volume is that of its mass in water.

use contrapposto::model::Model;
use nalgebra::Vector3;

use super::hull::{Ball, Solid};
use super::thickness::balls_of;

/// Density of a body, kg/m3.
pub(super) const WATER: f64 = 1000.0;
/// Points nearer than this, m, are one.
const SAME_POINT: f64 = 1e-6;
/// Radius at the edge of a sole, m.
const EDGE: f64 = 0.012;

/// Hulls of balls that together are the segment, in its frame; none for a segment without mass, child or patch.
pub fn solids(model: &Model, s: usize) -> Vec<Solid> {
    let segment = &model.segments()[s];
    let joint = segment.in_segment.translation.vector;
    let mut ends: Vec<(Vector3<f64>, f64)> = vec![];
    for child in model.segments().iter().filter(|child| child.parent == Some(s)) {
        let end = child.in_parent.translation.vector;
        // A joint in the sole, such as that of the toes, does not make the foot thicker.
        let within = upwards(&segment.patch, joint).is_some_and(|up| up.dot(&(end - segment.patch[0])) < EDGE);
        if (end - joint).norm() > SAME_POINT
            && !within
            && ends.iter().all(|(other, _)| (other - end).norm() > SAME_POINT)
        {
            ends.push((end, child.mass));
        }
    }
    let ball = |p: Vector3<f64>, thick: f64| [p.x, p.y, p.z, thick];
    let reach = segment.center_of_mass - joint;
    let volume = segment.mass / WATER;
    let mut points = vec![ball(joint, 1.0)];
    match ends.as_slice() {
        [] if !segment.patch.is_empty() => {}
        [] if segment.name.eq_ignore_ascii_case("head") => {
            let skull = balls_of(&[ball(joint + 0.95 * reach, 0.9), ball(joint + 1.3 * reach, 1.0)], 0.85 * volume);
            let neck = 0.55 * skull[0][3];
            return vec![vec![ball(joint, neck), ball(joint + reach, neck)], skull];
        }
        [] if reach.norm() > SAME_POINT => points.push(ball(joint + 2.0 * reach, 0.75)),
        [] if segment.mass > 0.0 => points = vec![ball(segment.center_of_mass, 1.0)],
        [] => return vec![],
        // A limb is slimmer at its far end, a spine is not.
        [(end, mass)] => points.push(ball(*end, if *mass < segment.mass { 0.72 } else { 1.0 })),
        // A trunk is thickest about its centre of mass.
        ends => {
            points.push(ball(segment.center_of_mass, 1.15));
            points.extend(ends.iter().map(|(end, _)| ball(*end, 0.6)));
        }
    }
    points.extend(sole(&segment.patch, joint));
    let mut balls = balls_of(&points, volume);
    if let Some(up) = upwards(&segment.patch, joint) {
        // Nothing goes through the sole, but a palm may be in the middle of its hand.
        for ball in &mut balls {
            let above = up.dot(&(Vector3::new(ball[0], ball[1], ball[2]) - segment.patch[0]));
            ball[3] = if above > EDGE { ball[3].min(above) } else { ball[3] };
        }
    }
    vec![balls]
}

/// Coordinates of the joint that moves a segment; a welded segment is moved by the joint of its carrier.
pub fn joined_by(model: &Model, s: usize) -> std::ops::Range<usize> {
    let mut carrier = s;
    while let (true, Some(parent)) =
        (model.segments()[carrier].coordinates.is_empty(), model.segments()[carrier].parent)
    {
        carrier = parent;
    }
    model.segments()[carrier].coordinates.clone()
}

/// Across a patch of three corners or more, to the side of the joint.
fn upwards(patch: &[Vector3<f64>], joint: Vector3<f64>) -> Option<Vector3<f64>> {
    let [a, b, c, ..] = patch else { return None };
    let across = (b - a).cross(&(c - a)).try_normalize(0.0)?;
    Some(if across.dot(&(joint - a)) < 0.0 { -across } else { across })
}

/// The corners of a patch, as much above it as the edge is thick.
fn sole(patch: &[Vector3<f64>], joint: Vector3<f64>) -> Vec<Ball> {
    let Some(up) = upwards(patch, joint) else { return vec![] };
    patch.iter().map(|corner| corner + EDGE * up).map(|p| [p.x, p.y, p.z, 0.0]).collect()
}
