//! Error and Jacobian of a point of a segment.
//!
//! Error `x - target` in ground axes, m, on the asked axes; its Jacobian is that of the point.

use nalgebra::Vector3;

use super::check::{Check, TaskError, TaskPart};
use super::rows::{append, equations};
use crate::joint_torques::JointTorques;
use crate::model::Model;
use hierarchical_least_squares::Level;

/// A point of a segment at a place in ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Index of the segment.
    pub segment: usize,
    /// The point in the segment's frame, m.
    pub point: Vector3<f64>,
    /// Wanted place of the point, in ground, m.
    pub target: Vector3<f64>,
    /// Ground axes that are asked for; one at least.
    pub axes: [bool; 3],
}

impl Point {
    pub(super) fn error(&self, model: &Model, body: &JointTorques) -> Vector3<f64> {
        body.kinematics().station(model, self.segment, self.point) - self.target
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        body.kinematics().point_jacobian(model, self.segment, self.point, append(level, model, 3));
        equations(level, model, self.axes, self.error(model, body));
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        check.segment(self.segment)?;
        check.vector(TaskPart::Point, &self.point)?;
        check.vector(TaskPart::Target, &self.target)?;
        check.some(TaskPart::Axis, self.axes.contains(&true))
    }
}
