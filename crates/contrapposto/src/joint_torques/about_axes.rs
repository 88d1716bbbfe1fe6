//! Computes external torque about the axes of three-axis joints, on the body that has a ball for each.
//!
//! Rotations of such a joint about its axes need no coordinates: the ball is turned from the orientation that its coordinates give.

use super::JointTorquesError;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture::Posture;
use crate::statics::{ExternalTorque, Gradient, Load};

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

    /// Its gradient by rotations about axes, N m/rad.
    pub(crate) fn gradient(&self) -> &Gradient {
        &self.gradient
    }
}
