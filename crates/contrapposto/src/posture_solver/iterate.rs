//! The present posture, and all that follows from it.

use super::settings::Settings;
use crate::contact::ContactForces;
use crate::joint_torques::{JointTorques, JointTorquesError, Quantities};
use crate::model::Model;
use crate::posture::Posture;

/// Kinematics, torques and contact forces of a posture. Depends on posture and loads; filled by [`Iterate::evaluate`].
#[derive(Clone, Debug)]
pub(super) struct Iterate {
    pub(super) torques: JointTorques,
    /// No forces without supports.
    pub(super) contact: ContactForces,
    /// `torques` are those of the posture and the loads that were evaluated last.
    is_current: bool,
}

impl Iterate {
    pub(super) fn new(model: &Model, contact: ContactForces) -> Self {
        Self { torques: JointTorques::new(model), contact, is_current: false }
    }

    /// Computes everything that the tasks need in `posture`; on supports torques and contact forces, too.
    pub(super) fn evaluate(&mut self, settings: &Settings<'_>, posture: &Posture) -> Result<(), JointTorquesError> {
        if self.is_current && self.torques.posture() == posture {
            return Ok(());
        }
        self.is_current = false;
        let (model, loads) = (&settings.model, &settings.loads);
        if settings.on_supports() {
            self.torques.update_with_contact(model, posture, loads, &mut self.contact, Quantities::ALL)?;
        } else {
            self.torques.update(model, posture, loads, settings.quantities)?;
        }
        self.is_current = true;
        Ok(())
    }

    /// Supports need not hold the root at a rate.
    pub(super) fn hold_root(&mut self, rate: usize) {
        self.contact.hold_root(rate);
        self.is_current = false;
    }

    /// The next evaluation computes everything anew.
    pub(super) fn invalidate(&mut self) {
        self.is_current = false;
    }

    /// Forgets the posture and the contact forces: the next evaluation is that of a new workspace, to the bit.
    pub(super) fn forget(&mut self) {
        self.is_current = false;
        self.contact.forget();
    }
}
