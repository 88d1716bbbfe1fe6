//! Moves the body of a simulation as reliefs request: joint by joint, or as a whole on its supports and with its tasks.

use super::body_motion::BodyMotion;
use super::joint_motion::JointMotion;
use super::{Event, Scenario, ScenarioError};
use crate::joint_torques::JointTorques;
use crate::model::SharedModel;
use crate::posture::Posture;

/// Motion of the body by reliefs.
#[derive(Debug)]
pub(super) enum Motion<'a> {
    /// Without supports and tasks.
    Joints(Box<JointMotion<'a>>),
    /// With supports or tasks.
    Body(Box<BodyMotion<'a>>),
}

impl<'a> Motion<'a> {
    /// The motion of a scenario whose supports `in_use` are as in the posture `placed_at`.
    pub(super) fn new(
        scenario: &'a Scenario,
        model: SharedModel<'a>,
        placed_at: &Posture,
        in_use: &[usize],
    ) -> Result<Self, ScenarioError> {
        if scenario.has_supports_or_tasks() {
            return Ok(Self::Body(Box::new(BodyMotion::new(scenario, model, placed_at, in_use)?)));
        }
        Ok(Self::Joints(Box::new(JointMotion::new(scenario, model))))
    }

    pub(super) fn body(&self) -> Option<&BodyMotion<'a>> {
        if let Self::Body(body) = self { Some(body) } else { None }
    }

    /// Replaces the body by the same one with other strength and passive torque.
    pub(super) fn set_model(&mut self, model: &SharedModel<'a>) {
        match self {
            Self::Joints(joints) => joints.set_model(model),
            Self::Body(body) => body.set_model(model),
        }
    }

    pub(super) fn body_mut(&mut self) -> Option<&mut BodyMotion<'a>> {
        if let Self::Body(body) = self { Some(body) } else { None }
    }

    /// Applies what an event changes of loads and tasks.
    pub(super) fn apply(&mut self, event: &Event) -> Result<(), ScenarioError> {
        match self {
            Self::Joints(joints) => event.loads.iter().for_each(|loads| joints.set_loads(loads)),
            Self::Body(body) => {
                if let Some(loads) = &event.loads {
                    body.set_loads(loads)?;
                }
                event.tasks.iter().for_each(|(task, goal)| body.set_task(*task, goal));
                body.restart_convergence();
            }
        }
        Ok(())
    }

    /// Computes all torques in a posture.
    pub(super) fn update(&mut self, posture: &Posture) -> Result<(), ScenarioError> {
        match self {
            Self::Joints(joints) => Ok(joints.update(posture)?),
            Self::Body(body) => body.update(posture),
        }
    }

    /// Torques of the last update.
    pub(super) fn torques(&self) -> &JointTorques {
        match self {
            Self::Joints(joints) => joints.torques(),
            Self::Body(body) => body.torques(),
        }
    }

    /// Slope of a coordinate's external torque along the motion that relieves it, N m/rad; `None` where it cannot move.
    pub(super) fn external_slope(
        &mut self,
        posture: &Posture,
        coordinate: usize,
        rate: usize,
    ) -> Result<Option<f64>, ScenarioError> {
        match self {
            Self::Joints(joints) => Ok(Some(joints.external_slope(rate))),
            Self::Body(body) => body.external_slope(posture, coordinate, rate),
        }
    }

    /// Whether the body has come to rest; joints that move one by one rest when no relief moves them.
    pub(super) fn is_at_rest(&self) -> bool {
        self.body().is_none_or(BodyMotion::is_at_rest)
    }

    /// Forgets all that earlier steps have shown and that only makes the next ones faster.
    pub(super) fn forget(&mut self) {
        if let Self::Body(body) = self {
            body.forget();
        }
    }
}
