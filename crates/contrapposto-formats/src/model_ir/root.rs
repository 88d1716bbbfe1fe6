//! Attaches the outermost segment to the ground.

use super::{CoordinateIr, CoordinateKind, Drive, ModelIr, MotionIr};
use nalgebra::{Isometry3, Vector3};

/// Attachment of the outermost segment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RootAttachment {
    /// Fixed to the ground.
    #[default]
    Fixed,
    /// Three slides in world axes, then a ball.
    Free,
}

/// Endings of the names of a free joint's seven coordinates, in their order.
pub(crate) const FREE_ENDINGS: [&str; 7] = ["tx", "ty", "tz", "qw", "qx", "qy", "qz"];

impl ModelIr {
    /// Adds the seven coordinates of a free joint named `prefix`, which rests at `pose`, and gives its motions.
    pub(crate) fn free_joint(&mut self, prefix: &str, pose: &Isometry3<f64>) -> Vec<MotionIr> {
        let first = self.coordinates.len();
        let (t, q) = (pose.translation.vector, pose.rotation.quaternion());
        for (ending, default) in FREE_ENDINGS.iter().zip([t.x, t.y, t.z, q.w, q.i, q.j, q.k]) {
            let kind = match ending.starts_with('t') {
                true => CoordinateKind::Translation,
                false => CoordinateKind::Quaternion,
            };
            self.coordinates.push(CoordinateIr {
                name: format!("{prefix}_{ending}"),
                kind,
                range: (f64::NEG_INFINITY, f64::INFINITY),
                default,
                locked: false,
                clamped: false,
            });
        }
        let slide = |(i, axis)| MotionIr::Slide { axis, drive: Drive::Coordinate(first + i) };
        let mut motions: Vec<_> =
            [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().enumerate().map(slide).collect();
        motions.push(MotionIr::Ball { first: first + 3 });
        motions
    }
}
