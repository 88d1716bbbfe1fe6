//! Chooses among the two sets of angles that a joint of three axes has for one posture.
//!
//! A turn `Rz(a) Rx(b) Ry(c)` is also `Rz(a + 180) Rx(180 - b) Ry(c + 180)`, and every angle may have whole turns more. A motion that passes the posture in which both
//! meet (an arm held sideways) can leave it by angles that no joint has. Of a whole motion one set is taken, so that its angles go on without jumps.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use contrapposto::model::{CoordinateKind, Model};
use contrapposto::posture::Posture;

/// Gives each joint of three axes, but the root, those angles over a whole motion of the built-in adult that leave its ranges less. The postures stay what they are.
pub fn settle_branches<'p>(model: &Model, postures: impl IntoIterator<Item = &'p mut Posture>) {
    let mut postures: Vec<&mut Posture> = postures.into_iter().collect();
    for segment in model.segments().iter().filter(|segment| segment.parent.is_some()) {
        let slides = |c: &usize| model.coordinates()[*c].kind == CoordinateKind::Translation;
        let joint = segment.coordinates.clone().find(|c| !slides(c)).unwrap_or(segment.coordinates.end)
            ..segment.coordinates.end;
        let turns = model.coordinates()[joint.clone()].iter().all(|c| c.kind == CoordinateKind::Rotation);
        if joint.len() != 3 || !turns {
            continue;
        }
        let (same, same_shift) = outside(model, &postures, joint.clone(), |_, value| value);
        let (other, other_shift) = outside(model, &postures, joint.clone(), turned);
        let changed = other < same;
        for posture in &mut postures {
            for (axis, value) in posture.values_mut()[joint.clone()].iter_mut().enumerate() {
                *value = if changed { turned(axis, *value) + other_shift[axis] } else { *value + same_shift[axis] };
            }
        }
    }
}

/// The other angle about an axis of the chain.
fn turned(axis: usize, value: f64) -> f64 {
    if axis == 1 { PI - value } else { value + PI }
}

/// The angles by which a joint leaves its ranges, summed over a motion, and the whole turns to add to each.
fn outside(
    model: &Model,
    postures: &[&mut Posture],
    joint: Range<usize>,
    of: fn(usize, f64) -> f64,
) -> (f64, [f64; 3]) {
    let mut shifts = [0.0; 3];
    let mut sum = 0.0;
    for (axis, c) in joint.enumerate() {
        let (low, high) = model.coordinates()[c].range;
        let values = || postures.iter().map(|posture| of(axis, posture.values()[c]));
        let mean = values().sum::<f64>() / postures.len().max(1) as f64;
        shifts[axis] = TAU * (((low + high) / 2.0 - mean) / TAU).round();
        sum +=
            values().map(|value| (low - value - shifts[axis]).max(value + shifts[axis] - high).max(0.0)).sum::<f64>();
    }
    (sum, shifts)
}
