//! Gives a body whose muscles are known the strength and the passive torque of its present posture.

use std::sync::Arc;

use super::ScenarioError;
use crate::joint_torques::{JointMuscles, JointTorquesError};
use crate::model::Model;
use crate::posture::Posture;

/// The muscles of a body, and the posture whose strength and passive torque it has.
#[derive(Debug)]
pub(super) struct PosedStrength {
    muscles: JointMuscles,
    posture: Option<Posture>,
}

impl PosedStrength {
    pub(super) fn new(muscles: JointMuscles) -> Self {
        Self { muscles, posture: None }
    }

    /// The muscles, in the posture of the last [`PosedStrength::pose`].
    pub(super) fn muscles(&self) -> &JointMuscles {
        &self.muscles
    }

    /// The body of `model` with the strength and the passive torque of `posture`; `None` where it has that already.
    pub(super) fn pose(&mut self, model: &Model, posture: &Posture) -> Result<Option<Arc<Model>>, ScenarioError> {
        if self.posture.as_ref() == Some(posture) {
            return Ok(None);
        }
        let mut posed = model.clone();
        self.muscles.pose(&mut posed, posture).map_err(JointTorquesError::from)?;
        self.posture = Some(posture.clone());
        Ok(Some(Arc::new(posed)))
    }
}
