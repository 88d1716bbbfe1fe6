//! Moves joints one by one, on a body without supports and tasks: every relief projects the posture into its half-space
//! (Rodriguez & Boulic 2007, Eqs. 4-6).

use super::Scenario;
use super::state::State;
use crate::joint_torques::{JointTorques, JointTorquesError, Quantities};
use crate::model::SharedModel;
use crate::posture::Posture;
use crate::statics::Load;

/// Joints that find relief one by one.
#[derive(Debug)]
pub(super) struct JointMotion<'a> {
    scenario: &'a Scenario,
    loads: Vec<Load>,
    model: SharedModel<'a>,
    torques: JointTorques,
}

impl<'a> JointMotion<'a> {
    pub(super) fn new(scenario: &'a Scenario, model: SharedModel<'a>) -> Self {
        Self { scenario, loads: scenario.loads.clone(), torques: JointTorques::new(&model), model }
    }

    /// Replaces the body by the same one with other strength and passive torque.
    pub(super) fn set_model(&mut self, model: &SharedModel<'a>) {
        self.model = model.clone();
    }

    pub(super) fn set_loads(&mut self, loads: &[Load]) {
        self.loads.clear();
        self.loads.extend_from_slice(loads);
    }

    /// Projects the posture into the half-space of every decision, free coordinates only, and into the ranges.
    pub(super) fn step(&self, state: &mut State) {
        for (request, decision) in state.requests.iter().zip(&state.decisions) {
            if decision.is_some() {
                request.half_space.project(state.posture.values_mut(), &self.scenario.free);
            }
        }
        for (value, coordinate) in state.posture.values_mut().iter_mut().zip(self.scenario.model.coordinates()) {
            *value = value.clamp(coordinate.range.0, coordinate.range.1);
        }
    }

    /// Computes all torques in a posture.
    pub(super) fn update(&mut self, posture: &Posture) -> Result<(), JointTorquesError> {
        self.torques.update(&self.model, posture, &self.loads, Quantities::TORQUES)
    }

    pub(super) fn torques(&self) -> &JointTorques {
        &self.torques
    }

    /// Slope of a rate's external torque when that joint alone moves, N m/rad.
    pub(super) fn external_slope(&self, rate: usize) -> f64 {
        self.torques.own_slope_about_axis(&self.model, rate)
    }
}
