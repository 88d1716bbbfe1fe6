//! Error and Jacobian of the rotation of a segment.
//!
//! Error `r = log(R R_t^-1)` in ground axes, rad: the turn that leads from the target to the present rotation, at most
//! half a turn. An angular velocity `w` in ground axes changes it by `J_l^-1(r) w`, with the inverse of the left
//! Jacobian of SO(3), `I - [r]/2 + c(|r|) [r]^2`, `c(a) = (1 - a/2 cot(a/2)) / a^2` (Sola, Deray & Atchuthan 2018, "A
//! micro Lie theory for state estimation in robotics", Eq. 146). At exactly half a turn the error jumps to the other
//! side.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::check::{Check, TaskError, TaskPart};
use super::rows::{append, equations, multiply};
use crate::joint_torques::JointTorques;
use crate::model::Model;
use hierarchical_least_squares::Level;

/// A segment turned as wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// Index of the segment.
    pub segment: usize,
    /// Wanted rotation from the segment's frame to ground.
    pub target: UnitQuaternion<f64>,
}

impl Orientation {
    pub(super) fn error(&self, model: &Model, body: &JointTorques) -> Vector3<f64> {
        let rotation = body.kinematics().placement(model, self.segment).rotation;
        (rotation * self.target.inverse()).scaled_axis()
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        let error = self.error(model, body);
        let rows = append(level, model, 3);
        body.kinematics().rotation_jacobian(model, self.segment, rows);
        multiply(&inverse_left_jacobian(&error), rows, model.rates().len());
        equations(level, model, [true; 3], error);
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        check.segment(self.segment)?;
        check.unit(TaskPart::TargetQuaternion, self.target.coords.norm())
    }
}

/// `d log(exp(w) exp(r)) / d w` at `w = 0`.
pub(super) fn inverse_left_jacobian(r: &Vector3<f64>) -> Matrix3<f64> {
    let square = r.norm_squared();
    // Below, the difference would lose digits; the series is good to 1e-16.
    let c = if square < 0.01 {
        1.0 / 12.0 + square * (1.0 / 720.0 + square * (1.0 / 30240.0 + square * (1.0 / 1_209_600.0)))
    } else {
        let half = 0.5 * square.sqrt();
        (1.0 - half / libm::tan(half)) / square
    };
    let cross = r.cross_matrix();
    Matrix3::identity() - 0.5 * cross + c * (cross * cross)
}
