//! Recovers the balance of a body after an event.

use super::ScenarioError;
use super::body_motion::BodyMotion;
use crate::contact::{Balance, Missing, Slip};
use crate::posture::Posture;

/// Steps within which balance must be recovered after an event.
const RECOVERY_STEPS: usize = 300;

impl BodyMotion<'_> {
    /// After an event: moves until the supports hold the body again and are in their places, within the same time step, as a body does that anticipates a
    /// load. Where no such posture is found `posture` stays; the answer is the force and moment that are missing there.
    pub(super) fn recover_balance(&mut self, posture: &mut Posture) -> Result<Option<Missing>, ScenarioError> {
        self.update(posture)?;
        let missing = self.contact().missing(&self.model, self.torques().kinematics());
        if missing.is_none() {
            return Ok(None);
        }
        self.before.values_mut().copy_from_slice(posture.values());
        for _ in 0..RECOVERY_STEPS {
            self.engine.step(posture)?;
            self.update(posture)?;
            let is_held = self.contact().balance() == Balance::Held;
            if is_held && !self.engine.slip().exceeds(Slip::NOTICED) {
                break;
            }
            if is_held {
                // Where supports come back to their places at the cost of tasks and effort the merit rises, and steps would become ever shorter.
                self.engine.widen_trust_region();
            }
        }
        if self.contact().balance() == Balance::Held {
            self.restart_convergence();
            return Ok(None);
        }
        self.take_back(posture);
        self.update(posture)?;
        Ok(missing)
    }
}
