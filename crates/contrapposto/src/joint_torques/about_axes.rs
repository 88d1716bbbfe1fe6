//! Computes external torque about the axes of three-axis joints, on the body that has a ball for each.
//!
//! Rotations of such a joint about its axes need no coordinates: the ball is turned from the orientation that its coordinates give.

use super::{JointTorques, JointTorquesError};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture::Posture;
use crate::statics::{ExternalTorque, Gradient, Load};

/// Square of the rotation about an axis by steps of length 1 of the coordinates, from which on they turn the joint about it.
const LEAST_TURN: f64 = 1e-6;

/// External torque about axes, and its gradient by rotations about them. Filled by [`AboutAxes::update`].
#[derive(Clone, Debug)]
pub struct AboutAxes {
    kinematics: Kinematics,
    external: ExternalTorque,
    gradient: Gradient,
    /// The posture moved by all rates that are none of a three-axis joint.
    moved: Posture,
    step: Vec<f64>,
}

impl AboutAxes {
    /// Space for `model`, which need not have such joints.
    pub fn new(model: &Model) -> Self {
        let balls = model.by_axes();
        Self {
            kinematics: Kinematics::new(balls),
            external: ExternalTorque::new(balls),
            gradient: Gradient::new(balls),
            moved: model.default_posture(),
            step: vec![0.0; model.rates().len()],
        }
    }

    /// Computes the torque of `loads` in `posture`, and its gradient if asked for. Does not allocate.
    ///
    /// # Errors
    /// [`JointTorquesError`] when posture or loads do not fit the model.
    pub fn update(
        &mut self,
        model: &Model,
        posture: &Posture,
        loads: &[Load],
        gradient: bool,
    ) -> Result<(), JointTorquesError> {
        self.kinematics.update(model.by_axes(), posture)?;
        self.apply(model, loads, gradient)
    }

    /// As [`AboutAxes::update`] with the gradient, after the rates have moved by `step`: three-axis joints about their axes.
    ///
    /// # Errors
    /// As [`AboutAxes::update`].
    pub fn update_displaced(
        &mut self,
        model: &Model,
        posture: &Posture,
        step: &[f64],
        loads: &[Load],
    ) -> Result<(), JointTorquesError> {
        self.step.copy_from_slice(step);
        let coordinates = model.three_axis_joints().iter().flat_map(|joint| joint.coordinates);
        coordinates.filter_map(|i| model.coordinates()[i].rate).for_each(|rate| self.step[rate] = 0.0);
        self.moved.values_mut().copy_from_slice(posture.values());
        self.moved.displace(model, &self.step);
        self.kinematics.update_turned(model.by_axes(), &self.moved, step)?;
        self.apply(model, loads, true)
    }

    fn apply(&mut self, model: &Model, loads: &[Load], gradient: bool) -> Result<(), JointTorquesError> {
        self.external.update(model.by_axes(), &self.kinematics, loads)?;
        if gradient {
            self.external.gradient(model.by_axes(), &self.kinematics, &mut self.gradient);
        }
        Ok(())
    }

    /// Frames of the body with balls ([`Model::by_axes`]).
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// External torque about axes, N m.
    pub fn external(&self) -> &ExternalTorque {
        &self.external
    }

    /// Gradient of the external torque by rotations about axes, N m/rad.
    pub(crate) fn gradient(&self) -> &Gradient {
        &self.gradient
    }
}

impl JointTorques {
    /// Writes the least step of coordinates that turns a joint by `turn` (rad) about the axis of a coordinate into `step`, one entry
    /// a coordinate: `A^T e_k turn / |A^T e_k|^2` for a three-axis joint. The step is zero where no coordinate turns it so.
    pub(crate) fn write_turn(&self, model: &Model, coordinate: usize, turn: f64, step: &mut [f64]) {
        step.fill(0.0);
        let Some((joint, place)) = model.three_axis_joint_of(coordinate) else {
            step[coordinate] = turn;
            return;
        };
        let row = self.passive.orientations()[joint].hinges.row(place).into_owned();
        let squared = row.norm_squared();
        if squared > LEAST_TURN {
            for (i, by) in model.three_axis_joints()[joint].coordinates.into_iter().zip(row.iter()) {
                step[i] = turn * by / squared;
            }
        }
    }

    /// Changes derivatives by rotations about the axes of three-axis joints into derivatives by their coordinates, row by row.
    pub(crate) fn fold_axes(&self, model: &Model, rows: &mut [f64]) {
        for (joint, orientation) in model.three_axis_joints().iter().zip(self.passive.orientations()) {
            let rates = joint.coordinates.map(|i| model.coordinates()[i].rate.unwrap_or_default());
            for row in rows.chunks_exact_mut(model.rates().len()) {
                let by_axes = nalgebra::Vector3::from(rates.map(|rate| row[rate]));
                let by_coordinates = orientation.hinges.tr_mul(&by_axes);
                for (k, rate) in rates.into_iter().enumerate() {
                    row[rate] = by_coordinates[k];
                }
            }
        }
    }
}
