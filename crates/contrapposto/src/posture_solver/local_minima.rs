//! Moves postures to local minima of effort, by descents of [`crate::effort`] under the constraints of the engine.

use super::engine::Engine;
use super::error::EngineError;
use super::report::SolvedPosture;
use super::settings::Rates;
use crate::contact::Balance;
use crate::posture::Posture;

impl Engine<'_> {
    /// Moves `posture` to the lowest of `count` local minima; returns whether nothing is left for steps to do, and the number
    /// of steps that it took.
    pub(super) fn compare_local_minima(
        &mut self,
        posture: &mut Posture,
        count: usize,
    ) -> Result<(bool, usize), EngineError> {
        if count == 0 || !self.settings.can_descend() {
            return Ok((false, 0));
        }
        self.evaluate(posture)?;
        let Some(problem) = self.settings.effort_problem(&self.iterate.contact, Rates::Free) else {
            return Ok((false, 0));
        };
        let Some(minimum) = self.basin_hopping.minimise(&problem, posture, count)? else { return Ok((false, 0)) };
        self.evaluate(posture)?;
        let held = self.iterate.contact.balance() == Balance::Held;
        Ok((minimum.converged && held && self.settings.effort_is_last(), minimum.steps))
    }

    /// Moves `posture` to the nearest local minimum of effort under the supports and the levels above effort, and
    /// returns whether it did: not if that is farther away than the largest step, or if levels below effort would be
    /// passed over.
    ///
    /// # Errors
    /// [`EngineError::Body`] when the posture does not fit the model.
    pub(crate) fn descend(&mut self, posture: &mut Posture) -> Result<bool, EngineError> {
        if !self.settings.effort_is_last() || !self.settings.can_descend() {
            return Ok(false);
        }
        self.evaluate(posture)?;
        let Some(problem) = self.settings.effort_problem(&self.iterate.contact, Rates::Free) else { return Ok(false) };
        let descended = self.basin_hopping.descend(&problem, posture, self.settings.options.max_step)?;
        self.settings.keep_ranges(posture);
        Ok(descended)
    }

    /// The posture near the local minimum of effort that is nearest to `start`, by a descent that ends where little is to be gained; `start`
    /// itself where the descent leaves supports or levels, or [`Options::local_minima`] is 0.
    ///
    /// # Errors
    /// As [`Engine::step`].
    pub(crate) fn near_minimum(&mut self, start: &Posture) -> Result<SolvedPosture, EngineError> {
        self.restart();
        self.evaluate(start)?;
        let (mut posture, mut steps) = (start.clone(), 0);
        let descends = self.settings.options.local_minima > 0 && self.settings.can_descend();
        if let Some(problem) = self.settings.effort_problem(&self.iterate.contact, Rates::Free).filter(|_| descends) {
            steps = self.basin_hopping.near_minimum(&problem, &mut posture)?;
            self.settings.keep_ranges(&mut posture);
        }
        self.evaluate(&posture)?;
        self.describe(posture, false, steps)
    }
}
