//! Error and Jacobian of point and rotation of a segment together.
//!
//! Three rows of [`Point`] (m), then three of [`Orientation`] (rad): a metre weighs as much as a radian.

use nalgebra::Vector3;

use super::check::{Check, TaskError};
use super::orientation::Orientation;
use super::point::Point;
use crate::joint_torques::JointTorques;
use crate::model::Model;
use hierarchical_least_squares::Level;

/// A point and the rotation of a segment, both as wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Index of the segment.
    pub segment: usize,
    /// The point in the segment's frame, m.
    pub point: Vector3<f64>,
    /// Wanted place of the point in ground, m, and wanted rotation from the segment's frame to ground.
    pub target: crate::model::Placement,
}

impl Placement {
    fn parts(&self) -> (Point, Orientation) {
        let Self { segment, point, target } = *self;
        (
            Point { segment, point, target: target.translation.vector, axes: [true; 3] },
            Orientation { segment, target: target.rotation },
        )
    }

    pub(super) fn error(&self, model: &Model, body: &JointTorques) -> [f64; 6] {
        let (point, orientation) = self.parts();
        let (shift, turn) = (point.error(model, body), orientation.error(model, body));
        [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z]
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        let (point, orientation) = self.parts();
        point.evaluate(model, body, level);
        orientation.evaluate(model, body, level);
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        let (point, orientation) = self.parts();
        point.check(check)?;
        orientation.check(check)
    }
}
