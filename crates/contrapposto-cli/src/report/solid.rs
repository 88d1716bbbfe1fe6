//! How thick is each segment? Its volume is that of its mass in water; its length joins its joints.

use contrapposto::model::Model;
use contrapposto_report::{Ball, balls_of};
use nalgebra::Vector3;

/// Density of a body, kg/m3.
const WATER: f64 = 1000.0;
/// Points nearer than this, m, are one.
const NEAR: f64 = 1e-6;
/// Radius at the edge of a sole, m.
const EDGE: f64 = 0.012;

/// Hulls of balls that together are the segment, in its frame; none for one that is nothing but a frame.
pub(crate) fn parts(model: &Model, s: usize) -> Vec<Vec<Ball>> {
    let segment = &model.segments()[s];
    let joint = segment.in_segment.translation.vector;
    let mut ends: Vec<(Vector3<f64>, f64)> = vec![];
    for child in model.segments().iter().filter(|child| child.parent == Some(s)) {
        let end = child.in_parent.translation.vector;
        if (end - joint).norm() > NEAR && ends.iter().all(|(other, _)| (other - end).norm() > NEAR) {
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
            return vec![skull, vec![ball(joint, neck), ball(joint + reach, neck)]];
        }
        [] if reach.norm() > NEAR => points.push(ball(joint + 2.0 * reach, 0.75)),
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
    vec![balls_of(&points, volume)]
}

/// The corners of a patch, as much above it as the edge is thick.
fn sole(patch: &[Vector3<f64>], joint: Vector3<f64>) -> Vec<Ball> {
    let [a, b, c, ..] = patch else { return vec![] };
    let across = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
    let up = if across.dot(&(joint - a)) < 0.0 { -across } else { across };
    patch.iter().map(|corner| corner + EDGE * up).map(|p| [p.x, p.y, p.z, 0.0]).collect()
}
