//! Halves a step that would lead away from tasks, or break the share of a support, by what it leaves of second order.

use super::engine::Engine;
use super::error::EngineError;
use super::linearisation::{SHARES, missing};
use crate::posture::Posture;

/// A step that breaks a share is halved so many times at most. Assumed.
const STEP_HALVINGS: usize = 4;

impl Engine<'_> {
    /// One step as [`Engine::step`], or half of it where all of it leaves more than `tolerance` of second order in one of the first `levels`, or in what
    /// supports carry beyond their shares: an error, in the unit of the level, that is larger by more than the one before, and than the one that the
    /// linear problem foresaw. Half of a step leaves a quarter as much. What supports carry may jump at the very edge of the supports: the step is halved
    /// on while it does, and where a sixteenth is too long the body stays. Returns the largest change of a rate, rad or m.
    ///
    /// # Errors
    /// As [`Engine::step`].
    pub(crate) fn step_or_part(
        &mut self,
        posture: &mut Posture,
        levels: usize,
        tolerance: f64,
    ) -> Result<f64, EngineError> {
        let mut largest = self.step(posture)?.largest;
        if !self.leaves_second_order(posture, levels, tolerance) {
            return Ok(largest);
        }
        let rates = self.part.len();
        self.part.copy_from_slice(&self.solver.solution()[..rates]);
        for _ in 0..STEP_HALVINGS {
            self.part.iter_mut().for_each(|change| *change *= 0.5);
            posture.values_mut().copy_from_slice(self.last.values());
            posture.displace(&self.settings.model, &self.part);
            self.settings.keep_ranges(posture);
            largest *= 0.5;
            if !self.has_shares() || !self.leaves_second_order(posture, 0, tolerance) {
                return Ok(largest);
            }
        }
        posture.values_mut().copy_from_slice(self.last.values());
        Ok(0.0)
    }

    /// Whether the last step, to `posture`, leaves so much in one of the first `levels` or in the shares. A posture in which a law gives no numbers is
    /// refused when its torques are computed.
    fn leaves_second_order(&mut self, posture: &Posture, levels: usize, tolerance: f64) -> bool {
        if self.evaluate(posture).is_err() {
            return false;
        }
        let first = self.settings.first_level();
        let errors = (0..levels).map(|k| (self.error(k), self.errors()[k], self.solver.residual_norm(first + k)));
        let shares = self.has_shares().then(|| {
            let before = missing(&self.linearisation.problem.levels[SHARES]).map(f64::abs).sum();
            (self.iterate.contact.beyond_shares(), before, self.solver.residual_norm(SHARES))
        });
        errors.chain(shares).any(|(now, before, foreseen)| now > before.max(foreseen) + tolerance)
    }

    /// Whether a support may carry a share of the weight only.
    fn has_shares(&self) -> bool {
        self.settings.on_supports() && self.linearisation.problem.levels[SHARES].rows() > 0
    }
}
