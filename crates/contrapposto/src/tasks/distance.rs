//! Error and Jacobian of the distance of two points.
//!
//! `lower <= |a - b| <= upper`, m: one inequality, whose row is `n . (J_a - J_b)` with `n` the unit line from `b` to
//! `a`. Where the points meet, `n` is ground x.

use nalgebra::Vector3;

use super::check::{Check, TaskError, TaskPart};
use super::rows::{add_along, append};
use crate::joint_torques::JointTorques;
use crate::model::{LARGEST, Model};
use hierarchical_least_squares::Level;

/// Two points within a range of distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// A segment's index and a point in its frame, m.
    pub a: (usize, Vector3<f64>),
    /// The other point.
    pub b: (usize, Vector3<f64>),
    /// Least distance, m, not negative.
    pub lower: f64,
    /// Greatest distance, m; may be infinite.
    pub upper: f64,
}

impl Distance {
    fn line(&self, model: &Model, body: &JointTorques) -> Vector3<f64> {
        let station = |(segment, point)| body.kinematics().station(model, segment, point);
        station(self.a) - station(self.b)
    }

    /// Above the upper limit positive, below the lower one negative, m.
    pub(super) fn error(&self, model: &Model, body: &JointTorques) -> f64 {
        let length = self.line(model, body).norm();
        length - length.clamp(self.lower, self.upper)
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        let n = model.rates().len();
        let line = self.line(model, body);
        let length = line.norm();
        let unit = if length > 0.0 { line / length } else { Vector3::x() };
        // One row, then the six that it is made of, which are removed again.
        let (row, jacobians) = append(level, model, 7).split_at_mut(n);
        let (a, b) = jacobians.split_at_mut(3 * n);
        body.kinematics().point_jacobian(model, self.a.0, self.a.1, a);
        body.kinematics().point_jacobian(model, self.b.0, self.b.1, b);
        add_along(row, &unit, a);
        add_along(row, &-unit, b);
        level.matrix.truncate(level.matrix.len() - 6 * n);
        level.lower.push(self.lower - length);
        level.upper.push(self.upper - length);
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        for ((segment, point), part) in [(self.a, TaskPart::PointA), (self.b, TaskPart::PointB)] {
            check.segment(segment)?;
            check.vector(part, &point)?;
        }
        if !(0.0..=LARGEST).contains(&self.lower) {
            return check.refuse(TaskPart::LowerLimit, self.lower, "between 0 and 1e9");
        }
        if self.upper.is_nan() || self.upper < self.lower {
            return check.refuse(TaskPart::UpperLimit, self.upper, "at or above the lower limit");
        }
        Ok(())
    }
}
