//! Error and Jacobian of effort: active torque as a share of strength.
//!
//! Error `e = tau_a / S` of every asked coordinate, a share of the strength `S(x)` of the group that works (the sign of
//! the active torque `tau_a = -(tau_p + tau_e)` about its axis), so between -1 and 1 for a posture that can be held. Its derivative
//! is `-(d tau_p/dq + d tau_e/dq)/S - tau_a S' (dx/dq)/S^2` with the angle `x` about the axis; it has a kink where the other group
//! takes over, at `e = 0`. Derivatives are by rotations about the axes of three-axis joints first, then by their coordinates
//! ([`JointTorques::fold_axes`]).

use super::check::{Check, TaskError, TaskPart};
use super::rows::{append, equation};
use crate::joint_torques::JointTorques;
use crate::model::{Model, Side};
use hierarchical_least_squares::Level;

/// Little muscle torque.
#[derive(Clone, Debug, PartialEq)]
pub struct Effort {
    /// Independent coordinates with known muscle groups.
    pub coordinates: Vec<usize>,
}

impl Effort {
    /// Every independent coordinate with known muscle groups.
    pub fn whole(model: &Model) -> Self {
        let known = |i: &usize| model.coordinates()[*i].groups.is_some() && !model.is_dependent(*i);
        Self { coordinates: (0..model.coordinates().len()).filter(known).collect() }
    }

    pub(super) fn residual(&self, model: &Model, body: &JointTorques, out: &mut Vec<f64>) {
        out.extend(self.coordinates.iter().map(|&coordinate| {
            let active = active(model, body, coordinate);
            active / strength(model, body, coordinate, active).0
        }));
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        for &coordinate in &self.coordinates {
            let row = append(level, model, 1);
            let Some(load) = add_relative_load_row(model, body, coordinate, row) else { continue };
            body.fold_axes(model, row);
            equation(level, load);
        }
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        check.some(TaskPart::Coordinate, !self.coordinates.is_empty())?;
        let count = check.model.coordinates().len();
        for &index in &self.coordinates {
            let Some(coordinate) = check.model.coordinates().get(index) else {
                return Err(TaskError::Index { task: check.task, what: "coordinate", index, count });
            };
            let Some(groups) = &coordinate.groups else {
                return check.unable(&coordinate.name, "has no known strength; it needs two muscle groups");
            };
            if coordinate.rate.is_none() {
                return check.unable(&coordinate.name, "has no torque of its own; it must be an angle or a distance");
            }
            for group in groups {
                let least = group.strength.peak * group.strength.floor;
                if !(least > 0.0 && least.is_finite()) {
                    return check.refuse(TaskPart::LeastStrength, least, "positive and finite");
                }
            }
            if check.model.is_dependent(index) {
                return check.unable(&coordinate.name, "follows another coordinate; ask that one");
            }
        }
        Ok(())
    }
}

/// Writes the derivatives of the relative load of a coordinate into `row`, one entry a rate, by rotations about the axes of
/// three-axis joints. Returns the relative load, with the sign of the active torque.
pub(crate) fn add_relative_load_row(
    model: &Model,
    body: &JointTorques,
    coordinate: usize,
    row: &mut [f64],
) -> Option<f64> {
    let rate = model.coordinates()[coordinate].rate?;
    body.passive_torque().add_row_about_axis(model, body.kinematics(), coordinate, row);
    let active = body.active_torque()[rate];
    let (strength, slope) = strength(model, body, coordinate, active);
    let share = -1.0 / strength;
    for (entry, external) in row.iter_mut().zip(body.gradient_about_axes().row(rate)) {
        *entry = share * (*entry + external);
    }
    if slope != 0.0 {
        let by_angle = -active * slope / (strength * strength);
        for_each_angle_slope(model, body, coordinate, |rate, slope| row[rate] += by_angle * slope);
    }
    Some(active / strength)
}

/// Calls `visit` with the rates that change the angle of a coordinate, and the slopes.
pub(crate) fn for_each_angle_slope(
    model: &Model,
    body: &JointTorques,
    coordinate: usize,
    mut visit: impl FnMut(usize, f64),
) {
    let rate = |i: usize| model.coordinates()[i].rate;
    let Some((joint, place)) = model.three_axis_joint_of(coordinate) else {
        rate(coordinate).into_iter().for_each(|rate| visit(rate, 1.0));
        return;
    };
    let first = &body.passive_torque().orientations()[joint].angles.first;
    for (k, i) in model.three_axis_joints()[joint].coordinates.into_iter().enumerate() {
        rate(i).into_iter().for_each(|rate| visit(rate, first[(place, k)]));
    }
}

/// Active torque of a coordinate about its axis, N m, dependent coordinates folded in.
fn active(model: &Model, body: &JointTorques, coordinate: usize) -> f64 {
    model.coordinates()[coordinate].rate.map_or(0.0, |rate| body.active_torque()[rate])
}

/// The error that a torque of 1 N m about the axis of a coordinate takes away: one over the strength of the group that works where
/// the error is `error`.
pub(crate) fn share_of_strength(model: &Model, body: &JointTorques, coordinate: usize, error: f64) -> f64 {
    1.0 / strength(model, body, coordinate, error).0
}

/// Strength of the group that gives `active`, N m, and its slope by the angle about the axis, N m/rad; without end where it is not
/// known.
fn strength(model: &Model, body: &JointTorques, coordinate: usize, active: f64) -> (f64, f64) {
    let groups = model.coordinates()[coordinate].groups.as_ref();
    groups.map_or((f64::INFINITY, 0.0), |groups| {
        groups[Side::of(active).index()].strength.torque_and_slope(body.angles()[coordinate])
    })
}
