//! Moves postures to local minima of effort, by descents of [`crate::effort`] under the constraints of the engine.

use super::engine::Engine;
use super::error::EngineError;
use super::report::SolvedPosture;
use super::settings::Rates;
use super::tolerances::{LEAST_NEARING, MISSED_LEVELS, STEPS_OF_NEARING};
use crate::contact::Balance;
use crate::effort::problem::EffortProblem;
use crate::effort::sqp::LocalMinimum;
use crate::joint_torques::JointTorquesError;
use crate::posture::Posture;

impl Engine<'_> {
    /// Moves `posture` to the lowest of `count` local minima; returns whether nothing is left for steps to do, and the number
    /// of steps that it took. Where levels above effort are out of reach, they stay missed as they are.
    pub(super) fn compare_local_minima(
        &mut self,
        posture: &mut Posture,
        count: usize,
    ) -> Result<(bool, usize), EngineError> {
        if count == 0 || !self.settings.can_descend() {
            return Ok((false, 0));
        }
        self.evaluate(posture)?;
        let (mut minimum, mut steps) = (self.lowest_minimum(posture, count, &[])?, 0);
        if minimum.is_none() {
            let (shortfall, made) = self.shortfall_out_of_reach(posture)?;
            steps = made;
            if let Some(shortfall) = shortfall {
                minimum = self.lowest_minimum(posture, count, &shortfall)?;
            }
        }
        let Some(minimum) = minimum else { return Ok((false, steps)) };
        self.evaluate(posture)?;
        Ok((minimum.converged && self.is_held() && self.settings.effort_is_last(), steps + minimum.steps))
    }

    /// Whether the supports hold the body in the posture that was evaluated last.
    fn is_held(&self) -> bool {
        self.iterate.contact.balance() == Balance::Held
    }

    /// Sum of the errors of the levels above effort in the posture that was evaluated last.
    fn distance_above_effort(&self) -> f64 {
        (0..self.settings.effort_level.unwrap_or(0)).map(|level| self.error(level)).sum()
    }

    fn lowest_minimum(
        &mut self,
        posture: &mut Posture,
        count: usize,
        shortfall: &[f64],
    ) -> Result<Option<LocalMinimum>, JointTorquesError> {
        let problem = self.settings.effort_problem(&self.iterate.contact, Rates::Free);
        let problem = problem.map(|problem| EffortProblem { shortfall, ..problem });
        problem.map_or(Ok(None), |problem| self.basin_hopping.minimise(&problem, posture, count))
    }

    /// The errors that descents have to keep ([`EffortProblem::shortfall`]) where levels above effort are missed and some steps bring `posture` no
    /// nearer to them, else `None`; and the number of steps made.
    fn shortfall_out_of_reach(&mut self, posture: &mut Posture) -> Result<(Option<Vec<f64>>, usize), EngineError> {
        self.evaluate(posture)?;
        let before = self.distance_above_effort();
        if before <= MISSED_LEVELS {
            return Ok((None, 0));
        }
        for _ in 0..STEPS_OF_NEARING {
            self.step(posture)?;
        }
        self.evaluate(posture)?;
        let stays = (before - self.distance_above_effort()).abs() <= LEAST_NEARING;
        Ok((if stays { self.shortfall(posture)? } else { None }, STEPS_OF_NEARING))
    }

    /// The errors of `posture`, for descents that keep them; `None` without effort, or where no level above it is missed.
    fn shortfall(&mut self, posture: &Posture) -> Result<Option<Vec<f64>>, EngineError> {
        self.evaluate(posture)?;
        if self.distance_above_effort() <= MISSED_LEVELS {
            return Ok(None);
        }
        let problem = self.settings.effort_problem(&self.iterate.contact, Rates::Free);
        Ok(problem.map(|problem| self.basin_hopping.shortfall(&problem, posture)).transpose()?)
    }

    /// Moves `posture`, in which steps have ended that did not reach all levels above effort, to its local minimum of effort with the errors that
    /// it has, unless the supports would no longer hold the body there; returns the number of steps.
    pub(super) fn descend_as_near(&mut self, posture: &mut Posture) -> Result<usize, EngineError> {
        if self.settings.options.local_minima == 0 || !self.settings.can_descend() {
            return Ok(0);
        }
        let Some(shortfall) = self.shortfall(posture)? else { return Ok(0) };
        let (before, held) = (posture.clone(), self.is_held());
        let Some(minimum) = self.lowest_minimum(posture, 1, &shortfall)? else { return Ok(0) };
        self.evaluate(posture)?;
        if held && !self.is_held() {
            *posture = before;
        }
        Ok(minimum.steps)
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
    /// itself where the descent leaves supports or levels, or [`Options::local_minima`] is 0. Levels that `start` misses stay missed as they are where
    /// some steps come no nearer to them, and where no descent meets them.
    ///
    /// # Errors
    /// As [`Engine::step`].
    pub(crate) fn near_minimum(&mut self, start: &Posture) -> Result<SolvedPosture, EngineError> {
        self.restart();
        let (mut posture, mut steps) = (start.clone(), 0);
        if self.settings.options.local_minima > 0 && self.settings.can_descend() {
            let (shortfall, made) = self.shortfall_out_of_reach(&mut posture)?;
            let before = self.basin_hopping.steps();
            let descended = self.descend_near(&mut posture, shortfall.as_deref().unwrap_or_default())?;
            if !descended
                && shortfall.is_none()
                && let Some(shortfall) = self.shortfall(&posture)?
            {
                self.descend_near(&mut posture, &shortfall)?;
            }
            steps = made + self.basin_hopping.steps() - before;
            self.settings.keep_ranges(&mut posture);
        }
        self.evaluate(&posture)?;
        self.describe(posture, false, steps)
    }

    /// Moves `posture` near its local minimum; returns whether it did: not where the descent leaves supports or levels.
    fn descend_near(&mut self, posture: &mut Posture, shortfall: &[f64]) -> Result<bool, JointTorquesError> {
        let problem = self.settings.effort_problem(&self.iterate.contact, Rates::Free);
        let problem = problem.map(|problem| EffortProblem { shortfall, ..problem });
        problem.map_or(Ok(false), |problem| self.basin_hopping.near_minimum(&problem, posture))
    }
}
