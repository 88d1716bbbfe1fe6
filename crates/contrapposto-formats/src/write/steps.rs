//! Lists a segment's elementary motions for joints of every kind.

use contrapposto::math::Function;
use contrapposto::model::{Coordinate, Drive, JointKind, Motion, Placement, Segment};
use nalgebra::{Quaternion, Translation3, UnitQuaternion};

/// The source of the value of a motion; coordinates by their index in the model.
#[derive(Clone, Copy)]
pub(super) enum By<'m> {
    Coordinate(usize),
    Function(&'m Function, usize),
    Fixed(f64),
}

/// The motions, nearest the parent first.
pub(super) fn steps(segment: &Segment) -> Vec<(Motion, By<'_>)> {
    let first = segment.coordinates.start;
    if let JointKind::Driven(motions) = &segment.joint_kind {
        let by = |drive| match drive {
            &Drive::Coordinate(c) => By::Coordinate(first + c),
            Drive::Function(function, c) => By::Function(function, first + c),
            &Drive::Fixed(value) => By::Fixed(value),
        };
        return motions.iter().map(|(motion, drive)| (*motion, by(drive))).collect();
    }
    let mut next = first;
    let numbered = segment.joint_kind.motions().into_iter().map(|motion| {
        let own = next;
        next += motion.coordinates();
        (motion, By::Coordinate(own))
    });
    numbered.collect()
}

/// Orientation of a ball with these four coordinates at their defaults.
pub(super) fn resting(ball: &[Coordinate]) -> UnitQuaternion<f64> {
    let [w, i, j, k] = [0, 1, 2, 3].map(|part| ball[part].default);
    UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k))
}

/// Placement after a motion of this size.
pub(super) fn moved(motion: Motion, value: f64) -> Placement {
    match motion {
        Motion::Hinge(axis) => {
            Placement::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&axis, value))
        }
        Motion::Slide(axis) => Translation3::from(axis.into_inner() * value).into(),
        Motion::Ball => Placement::identity(),
    }
}
