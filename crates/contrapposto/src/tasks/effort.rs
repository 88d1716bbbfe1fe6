//! Error and Jacobian of effort: active torque as a share of strength.
//!
//! Error `e = tau_a / S` of every asked coordinate, a share of the strength `S(q)` of the group that works (the sign of
//! the active torque `tau_a = -(tau_p + tau_e)`), so between -1 and 1 for a posture that can be held. Its derivative is
//! `-(d tau_p/dq + d tau_e/dq)/S - tau_a S'/S^2`; it has a kink where the other group takes over, at `e = 0`.
//!
//! Passive torque is folded as external torque is: that of a dependent coordinate counts at its independent one. With
//! `q_d(q_i)` through however many couplings, `tau_i = sum_d q_d' tau_d` and `d tau_i/dq_i` has `q_d'' tau_d` besides.

use super::check::{Check, TaskError, TaskPart};
use super::rows::{append, equation};
use crate::joint_torques::{JointTorques, active_torque};
use crate::model::{Model, Side};
use crate::passive::PassiveLaw;
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
            let Some(rate) = model.coordinates()[coordinate].rate else { continue };
            let row = append(level, model, 1);
            let passive = passive_row(model, body, coordinate, rate, row);
            let active = active_torque(external(model, body, coordinate), passive);
            let (strength, slope) = strength(model, body, coordinate, active);
            let share = -1.0 / strength;
            for (entry, external) in row.iter_mut().zip(body.gradient().row(rate)) {
                *entry = share * (*entry + external);
            }
            row[rate] -= active * slope / (strength * strength);
            equation(level, active / strength);
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

/// Active torque of a coordinate, N m, dependent coordinates folded in.
fn active(model: &Model, body: &JointTorques, coordinate: usize) -> f64 {
    active_torque(external(model, body, coordinate), passive(model, body, coordinate, [1.0, 0.0], None))
}

/// The error that a torque of 1 N m on a coordinate takes away: one over the strength of the group that works where the
/// error is `error`.
pub(crate) fn share_of_strength(model: &Model, body: &JointTorques, coordinate: usize, error: f64) -> f64 {
    1.0 / strength(model, body, coordinate, error).0
}

/// Adds the derivatives of an independent coordinate's passive torque, dependent coordinates folded in, to `row`, one
/// entry a rate. Returns the torque.
pub(crate) fn passive_row(model: &Model, body: &JointTorques, coordinate: usize, rate: usize, row: &mut [f64]) -> f64 {
    let torque = passive(model, body, coordinate, [1.0, 0.0], Some((rate, &mut *row)));
    body.kinematics().fold_columns(model, row);
    torque
}

fn external(model: &Model, body: &JointTorques, coordinate: usize) -> f64 {
    model.coordinates()[coordinate].rate.map_or(0.0, |rate| body.external_torque().torques()[rate])
}

/// Strength and slope of the group that gives `active`; without end where it is not known.
fn strength(model: &Model, body: &JointTorques, coordinate: usize, active: f64) -> (f64, f64) {
    let groups = model.coordinates()[coordinate].groups.as_ref();
    groups.map_or((f64::INFINITY, 0.0), |groups| {
        groups[Side::of(active).index()].strength.torque_and_slope(body.kinematics().values()[coordinate])
    })
}

/// Passive torque of a coordinate and of all that follow it, `[q', q'']` times: derivatives of the coordinate by that
/// of `slopes`. Adds its derivatives by all rates, dependent coordinates not yet folded, to the row; the rate of the
/// independent coordinate is given beside the row.
fn passive(
    model: &Model,
    body: &JointTorques,
    coordinate: usize,
    [first, second]: [f64; 2],
    mut slopes: Option<(usize, &mut [f64])>,
) -> f64 {
    let values = body.kinematics().values();
    let q = values[coordinate];
    let mut sum = 0.0;
    if let Some(law) = &model.coordinates()[coordinate].passive {
        let mut add = |by: usize, slope: f64| {
            if let (Some((_, row)), Some(rate)) = (&mut slopes, model.coordinates()[by].rate) {
                row[rate] += first * slope;
            }
        };
        let torque = match law {
            PassiveLaw::Curve(curve) => {
                let (torque, slope) = curve.torque_and_slope(q);
                add(coordinate, slope);
                torque
            }
            PassiveLaw::Coupled(coupled) => {
                let (torque, gradient) = coupled.torque_and_gradient(values);
                for (neighbour, slope) in coupled.neighbours.iter().zip(gradient) {
                    if let Some((by, _)) = neighbour {
                        add(*by, slope);
                    }
                }
                torque
            }
            PassiveLaw::Sum(terms) => terms.iter().fold(0.0, |sum, term| {
                let (torque, slope) = term.torque_and_slope(q);
                add(coordinate, slope);
                sum + torque
            }),
        };
        sum += first * torque;
        if let Some((independent, row)) = &mut slopes {
            row[*independent] += second * torque;
        }
    }
    for coupling in model.couplings().iter().filter(|coupling| coupling.independent == coordinate) {
        let [_, slope, curvature] = coupling.function.value_slope_curvature(q);
        let by = [slope * first, curvature * first * first + slope * second];
        let slopes = slopes.as_mut().map(|(independent, row)| (*independent, &mut **row));
        sum += passive(model, body, coupling.dependent, by, slopes);
    }
    sum
}
