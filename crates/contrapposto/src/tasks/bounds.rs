//! Error and Jacobian of components of points and directions of a segment, each within limits.
//!
//! A component is `x = n . p` (m) of a point of the segment, or `x = n . d` of a direction that the segment carries, with a direction
//! `n` of ground. The row is `lower - x <= J step <= upper - x`; equal limits give an equation. A patch that lies on a plane, stays
//! in a region and turns about the normal by no more than an angle is a list of such rows.

use nalgebra::{UnitVector3, Vector3};

use super::check::{Check, TaskError, TaskPart};
use super::rows::{add_along, append};
use crate::joint_torques::JointTorques;
use crate::model::Model;
use hierarchical_least_squares::Level;

/// Greatest distance of a cosine from 1 at which two directions count as one.
const SAME: f64 = 1e-12;

/// Components of points and directions of a segment within limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// Index of the segment.
    pub segment: usize,
    /// One row each.
    pub components: Vec<Component>,
}

/// A component of a point or a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Of this.
    pub of: Carried,
    /// Along this direction of ground.
    pub along: UnitVector3<f64>,
    /// Least and greatest value: m for a point, a cosine for a direction. Infinite for none.
    pub limits: (f64, f64),
}

/// A vector that a segment carries, in the segment's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carried {
    /// A point, m.
    Point(Vector3<f64>),
    /// A direction.
    Direction(UnitVector3<f64>),
}

impl Component {
    /// Whether a direction has to be square to the direction of ground.
    pub(super) fn is_level(&self) -> bool {
        matches!(self.of, Carried::Direction(_)) && self.limits == (0.0, 0.0)
    }

    /// Whether a direction has to point `down` to within an angle less than 90 degrees.
    pub(super) fn hangs(&self, down: Vector3<f64>) -> bool {
        let (lower, upper) = self.limits;
        matches!(self.of, Carried::Direction(_)) && lower > 0.0 && upper >= 1.0 && self.along.dot(&down) > 1.0 - SAME
    }

    /// The component in the posture of `body`.
    fn value(&self, segment: usize, model: &Model, body: &JointTorques) -> f64 {
        let kinematics = body.kinematics();
        let vector = match self.of {
            Carried::Point(point) => kinematics.station(model, segment, point),
            Carried::Direction(direction) => kinematics.direction(model, segment, direction.into_inner()),
        };
        self.along.dot(&vector)
    }
}

impl Bounds {
    pub(super) fn residual(&self, model: &Model, body: &JointTorques, out: &mut Vec<f64>) {
        out.extend(self.components.iter().map(|component| {
            let (value, (lower, upper)) = (component.value(self.segment, model, body), component.limits);
            (value - upper).max(0.0) + (value - lower).min(0.0)
        }));
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        let (n, kinematics) = (model.rates().len(), body.kinematics());
        for component in &self.components {
            // The row, then the three that it is made of, which are removed again.
            let (row, jacobian) = append(level, model, 4).split_at_mut(n);
            match component.of {
                Carried::Point(point) => {
                    kinematics.point_jacobian(model, self.segment, point, jacobian);
                    add_along(row, &component.along, jacobian);
                }
                Carried::Direction(direction) => {
                    kinematics.rotation_jacobian(model, self.segment, jacobian);
                    let carried = kinematics.direction(model, self.segment, direction.into_inner());
                    add_along(row, &carried.cross(&component.along), jacobian);
                }
            }
            level.matrix.truncate(level.matrix.len() - 3 * n);
            let (value, (lower, upper)) = (component.value(self.segment, model, body), component.limits);
            level.lower.push(lower - value);
            level.upper.push(upper - value);
        }
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        check.segment(self.segment)?;
        check.some(TaskPart::Limit, !self.components.is_empty())?;
        for Component { of, limits: (lower, upper), .. } in &self.components {
            if let Carried::Point(point) = of {
                check.vector(TaskPart::Point, point)?;
            }
            if lower.is_nan() || *lower == f64::INFINITY {
                return check.refuse(TaskPart::LowerLimit, *lower, "a number, or -inf");
            }
            if upper.is_nan() || upper < lower {
                return check.refuse(TaskPart::UpperLimit, *upper, "a number, not less than the lower limit");
            }
        }
        Ok(())
    }
}
