//! Error and Jacobian of coordinates against wanted values.
//!
//! Error `q - target` of hinges and slides (rad, m), `log(q_t^-1 q)` of a ball in its own axes (rad; at most half a
//! turn, where it jumps to the other side). Turning a ball by `w` changes its error by `J_r^-1(r) w`, the right
//! Jacobian's inverse, which is the left one's of `-r`. Rows are multiplied with the weight of their rate.

use super::check::{Check, TaskError, TaskPart};
use super::orientation::inverse_left_jacobian;
use super::rows::{append, equation};
use super::unit::Unit;
use crate::joint_torques::JointTorques;
use crate::model::Model;
use crate::posture::{Part, parts};
use hierarchical_least_squares::Level;

/// Coordinates at wanted values.
#[derive(Clone, Debug, PartialEq)]
pub struct Posture {
    /// The wanted values; only those of weighted rates count.
    pub target: crate::posture::Posture,
    /// Weight of every rate of the model, 0 where nothing is asked.
    pub weights: Vec<f64>,
}

impl Posture {
    /// Every independent coordinate, all with weight 1.
    pub fn whole(model: &Model, target: crate::posture::Posture) -> Self {
        let dependent = |rate: &crate::model::Rate| rate.coordinate.is_some_and(|c| model.is_dependent(c));
        let weights = model.rates().iter().map(|rate| if dependent(rate) { 0.0 } else { 1.0 }).collect();
        Self { target, weights }
    }

    pub(super) fn unit(&self, model: &Model, row: usize) -> Unit {
        let asked = model.rates().iter().zip(&self.weights).filter(|(_, weight)| **weight > 0.0);
        asked.map(|(rate, _)| Unit::of(rate)).nth(row).unwrap_or(Unit::Radian)
    }

    pub(super) fn residual(&self, model: &Model, body: &JointTorques, out: &mut Vec<f64>) {
        for part in parts(model) {
            match part {
                Part::Axis { rate, coordinate } if self.weights[rate] > 0.0 => {
                    out.push(body.posture().values()[coordinate] - self.target.values()[coordinate]);
                }
                Part::Ball { rate, first } => {
                    let turn = self.target.turn_to(first, body.posture());
                    out.extend((0..3).filter(|axis| self.weights[rate + axis] > 0.0).map(|axis| turn[axis]));
                }
                Part::Axis { .. } => {}
            }
        }
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        for part in parts(model) {
            match part {
                Part::Axis { rate, coordinate } => {
                    let weight = self.weights[rate];
                    if weight > 0.0 {
                        append(level, model, 1)[rate] = weight;
                        let error = body.posture().values()[coordinate] - self.target.values()[coordinate];
                        equation(level, weight * error);
                    }
                }
                Part::Ball { rate, first } => {
                    let turn = self.target.turn_to(first, body.posture());
                    let slopes = inverse_left_jacobian(&-turn);
                    for axis in 0..3 {
                        let weight = self.weights[rate + axis];
                        if weight > 0.0 {
                            let row = append(level, model, 1);
                            (0..3).for_each(|k| row[rate + k] = weight * slopes[(axis, k)]);
                            equation(level, weight * turn[axis]);
                        }
                    }
                }
            }
        }
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        let model = check.model;
        self.target.check(model)?;
        let (given, needed) = (self.weights.len(), model.rates().len());
        if given != needed {
            return Err(TaskError::Length { task: check.task, what: "weights", given, needed });
        }
        for (rate, &weight) in model.rates().iter().zip(&self.weights) {
            if !(0.0..=crate::model::LARGEST).contains(&weight) {
                return check.refuse(TaskPart::Weight, weight, "between 0 and 1e9");
            }
            if weight > 0.0 && rate.coordinate.is_some_and(|c| model.is_dependent(c)) {
                return check.unable(&rate.name, "follows another coordinate; ask that one");
            }
        }
        check.some(TaskPart::WeightedCoordinate, self.weights.iter().any(|weight| *weight > 0.0))
    }
}
