//! Lets the muscles of a simulation work where they tire one by one.

use super::ScenarioError;
use super::muscle_outcome::MuscleOutcome;
use super::state::State;
use super::step::Simulation;
use crate::fatigue::FatigueState;

impl Simulation<'_> {
    /// Begins to let muscles tire one by one, where they do.
    pub(super) fn begin_muscles(&mut self) -> Result<(), ScenarioError> {
        let Self { tiring, strength, state, scenario, .. } = self;
        let Some((course, strength)) = tiring.as_mut().zip(strength.as_ref()) else { return Ok(()) };
        state.muscles =
            Some(course.begin(&scenario.model, strength.muscles(), &state.active, &scenario.start_fatigue)?);
        Ok(())
    }

    /// Fatigue and load of the groups of a coordinate whose muscles tire one by one.
    pub(super) fn groups_of_muscles(&self, coordinate: usize) -> Option<[(FatigueState, f64); 2]> {
        let (course, state) = (self.tiring.as_ref()?, self.state.muscles.as_ref()?);
        course.groups(state, coordinate, self.state.active[coordinate])
    }

    /// The muscles that tire one by one, at the end of the run so far.
    pub(super) fn muscle_outcome(&self, time: f64) -> Option<MuscleOutcome> {
        let (course, strength) = (self.tiring.as_ref()?, self.strength.as_ref()?);
        Some(course.outcome(strength.muscles(), time, self.state.muscles.as_ref()?))
    }

    /// Loads every muscle for one time step.
    pub(super) fn load_muscles(&mut self) -> Result<(), ScenarioError> {
        let Self { tiring, strength, state, scenario, .. } = self;
        let Some((course, strength)) = tiring.as_mut().zip(strength.as_ref()) else { return Ok(()) };
        let (steps, State { active, muscles: Some(muscles), .. }) = (state.steps, state) else { return Ok(()) };
        course.advance((steps, (steps + 1) as f64 * scenario.run.step), strength.muscles(), active, muscles)
    }
}
