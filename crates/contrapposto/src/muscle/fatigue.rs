//! Computes how muscles tire that share the torques of a posture.
//!
//! Every muscle has the three compartments of 3CC-r ([`ThreeCompartment`]); its load is its activation `a`, its capacity `1 - MF`. Static
//! optimisation finds the activations within the capacities:
//!
//! ```text
//! minimise  sum a_m^2     subject to   sum_m R_km F_m a_m = tau_k,   0 <= a_m <= 1 - MF_m
//! ```
//!
//! A muscle carries its share until it is exhausted, `a_m = 1 - MF_m`; from then on the others take over what it loses, until no
//! activations within the capacities give the torques. The sum of squares does not spare a tired muscle before. A step of time is taken by the
//! midpoint rule: each muscle tires under the activation in the middle of the step.

use hierarchical_least_squares::{ProblemError, Status};

use super::shared_torques::SharedTorques;
use super::static_optimisation::StaticOptimisation;
use super::tolerances::AT_CAPACITY;
use crate::fatigue::{Compartments, ThreeCompartment};

/// The reason for which activations were not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SharingError {
    /// A force, an arm or a torque is not finite, or too large.
    #[error(transparent)]
    Numbers(#[from] ProblemError),
    /// The solver stopped before its answer was optimal.
    #[error("the activations of least effort were not found: the solver's working set changed too often")]
    Stopped,
}

/// Muscles that tire. Depends on the history of their loads; filled by [`MuscleFatigue::begin`] and [`MuscleFatigue::advance`].
#[derive(Clone, Debug)]
pub struct MuscleFatigue {
    laws: Vec<ThreeCompartment>,
    states: Vec<Compartments>,
    loads: Vec<f64>,
    /// States and loads at the start of the last step.
    before: (Vec<Compartments>, Vec<f64>),
    bounds: Vec<(f64, f64)>,
    /// No reserve actuators, by rate.
    none: Vec<f64>,
    optimisation: StaticOptimisation,
}

impl MuscleFatigue {
    /// Rested muscles without load, one for each law.
    pub fn rested(laws: Vec<ThreeCompartment>) -> Self {
        let count = laws.len();
        let states = vec![Compartments::with_fatigue(0.0, 0.0); count];
        Self {
            laws,
            loads: vec![0.0; count],
            before: (states.clone(), vec![0.0; count]),
            states,
            bounds: vec![(0.0, 1.0); count],
            none: vec![],
            optimisation: StaticOptimisation::default(),
        }
    }

    /// The law of every muscle.
    pub fn laws(&self) -> &[ThreeCompartment] {
        &self.laws
    }

    /// The compartments of every muscle.
    pub fn states(&self) -> &[Compartments] {
        &self.states
    }

    /// Activation of every muscle, 0 to 1.
    pub fn loads(&self) -> &[f64] {
        &self.loads
    }

    /// Greatest activation that fatigue has left to every muscle, `1 - MF`.
    pub fn capacities(&self) -> impl ExactSizeIterator<Item = f64> {
        self.states.iter().map(|state| 1.0 - state.fatigued)
    }

    /// Whether a muscle gives all that fatigue has left to it.
    pub fn is_exhausted(&self, muscle: usize) -> bool {
        self.loads[muscle] > 0.0 && self.loads[muscle] >= (1.0 - self.states[muscle].fatigued) * (1.0 - AT_CAPACITY)
    }

    /// Number of exhausted muscles.
    pub(super) fn exhausted(&self) -> usize {
        (0..self.laws.len()).filter(|&muscle| self.is_exhausted(muscle)).count()
    }

    /// Largest violation of the conditions of optimality of the last activations: see [`StaticOptimisation::optimality`].
    pub fn optimality(&self) -> f64 {
        self.optimisation.optimality()
    }

    /// Finds the activations for the present capacities. Returns whether the muscles can give the torques; if not, the activations are
    /// those of the least sum of squared residuals. Does not allocate once it has had a problem of the size.
    ///
    /// # Errors
    /// [`SharingError`] for numbers that cannot be calculated with.
    ///
    /// # Panics
    /// Unless there are as many laws and forces as muscles, and a torque for every rate.
    pub fn share(&mut self, asked: &SharedTorques<'_>) -> Result<bool, SharingError> {
        assert_eq!(asked.muscles.muscles.len(), self.laws.len(), "a law for every muscle");
        self.none.resize(asked.rates.len(), 0.0);
        for (bound, state) in self.bounds.iter_mut().zip(&self.states) {
            bound.1 = 1.0 - state.fatigued;
        }
        let problem = asked.recruitment(&self.none, &self.bounds);
        let status = self.optimisation.solve(asked.muscles, asked.geometry, &problem)?;
        self.loads.copy_from_slice(self.optimisation.activations());
        match status {
            Status::Solved => Ok(true),
            Status::Infeasible { .. } => Ok(false),
            Status::Stopped => Err(SharingError::Stopped),
        }
    }

    /// Begins with rested muscles that carry the torques already. Returns whether they can.
    ///
    /// # Errors
    /// As [`MuscleFatigue::share`].
    ///
    /// # Panics
    /// As [`MuscleFatigue::share`].
    pub fn begin(&mut self, asked: &SharedTorques<'_>) -> Result<bool, SharingError> {
        self.begin_tired(asked, |_| 0.0)
    }

    /// The same with the fatigue `level` (0..=1) of every muscle, under the load that it would have if all were rested.
    ///
    /// # Errors
    /// As [`MuscleFatigue::share`].
    ///
    /// # Panics
    /// As [`MuscleFatigue::share`].
    pub fn begin_tired(
        &mut self,
        asked: &SharedTorques<'_>,
        level: impl Fn(usize) -> f64,
    ) -> Result<bool, SharingError> {
        self.states.fill(Compartments::with_fatigue(0.0, 0.0));
        let mut held = self.share(asked)?;
        let mut is_tired = false;
        for (muscle, (state, load)) in self.states.iter_mut().zip(&self.loads).enumerate() {
            *state = Compartments::with_fatigue(level(muscle), *load);
            is_tired |= state.fatigued > 0.0;
        }
        if is_tired {
            held = self.share(asked)?;
        }
        Ok(held)
    }

    /// Goes on from the compartments of every muscle in another run, and forgets what only makes the next answer faster.
    ///
    /// # Panics
    /// Unless there is a state for every muscle.
    pub(crate) fn resume(&mut self, states: &[Compartments]) {
        self.states.copy_from_slice(states);
        self.optimisation = StaticOptimisation::default();
    }

    /// Holds the torques for so many seconds. Returns the greatest change of an activation between start, middle and end; `None` where
    /// the muscles cannot give the torques at one of the three: states and activations are then those of the start. Does not allocate once it
    /// has had a problem of the size.
    ///
    /// # Errors
    /// As [`MuscleFatigue::share`].
    ///
    /// # Panics
    /// As [`MuscleFatigue::share`].
    pub fn advance(&mut self, asked: &SharedTorques<'_>, seconds: f64) -> Result<Option<f64>, SharingError> {
        self.before.0.copy_from_slice(&self.states);
        if !self.share(asked)? {
            return Ok(None);
        }
        self.before.1.copy_from_slice(&self.loads);
        self.carry(0.5 * seconds);
        let held = self.share(asked)?;
        let first = self.change();
        self.states.copy_from_slice(&self.before.0);
        if !held {
            self.undo();
            return Ok(None);
        }
        self.carry(seconds);
        if !self.share(asked)? {
            self.undo();
            return Ok(None);
        }
        Ok(Some(first.max(self.change())))
    }

    /// Gives the torques for so many seconds, or as much of them as the muscles can. Returns whether they gave them all the time.
    ///
    /// # Errors
    /// As [`MuscleFatigue::share`].
    ///
    /// # Panics
    /// As [`MuscleFatigue::share`].
    pub fn work(&mut self, asked: &SharedTorques<'_>, seconds: f64) -> Result<bool, SharingError> {
        if self.advance(asked, seconds)?.is_some() {
            return Ok(true);
        }
        self.share(asked)?;
        self.carry(seconds);
        self.share(asked)?;
        Ok(false)
    }

    /// Lets every muscle rest for so many seconds. Activations are those of before until the next call.
    pub fn rest(&mut self, seconds: f64) {
        for (law, state) in self.laws.iter().zip(&mut self.states) {
            *state = law.advance(*state, 0.0, seconds);
        }
    }

    /// Returns to the start of the last step.
    pub(super) fn undo(&mut self) {
        self.states.copy_from_slice(&self.before.0);
        self.loads.copy_from_slice(&self.before.1);
    }

    /// Greatest change of an activation since the start of the step.
    fn change(&self) -> f64 {
        let changes = self.loads.iter().zip(&self.before.1).map(|(now, before)| (now - before).abs());
        changes.fold(0.0, f64::max)
    }

    /// Lets every muscle tire under its present activation.
    fn carry(&mut self, seconds: f64) {
        for ((law, state), load) in self.laws.iter().zip(&mut self.states).zip(&self.loads) {
            *state = law.advance(*state, *load, seconds);
        }
    }
}
