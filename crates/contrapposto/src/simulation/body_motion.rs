//! Moves a body on its supports and with its tasks, by strict priorities.
//!
//! Reliefs are half-spaces (Rodriguez & Boulic 2007, Eqs. 4-6) in the priorities of [`crate::posture_solver::Engine`]: supports,
//! tasks above relief, the reliefs, that of the most fatigued group first, then the other tasks. Each relief is a level of its
//! own, so that of two conflicting reliefs the one of the more fatigued group is kept, and of equals the first of the model.

use nalgebra::Vector3;

use crate::contact::{ContactForces, Place, Support};
use crate::joint_torques::JointTorques;
use crate::model::SharedModel;
use crate::posture::Posture;
use crate::posture_solver::{Engine, Options};
use crate::statics::{Load, LoadKind};
use crate::tasks::{PriorityLevel, Task};

use super::sample::{Contact, Standing};
use super::state::Request;
use super::step_length::{StepLength, leads_farther};
use super::{Scenario, ScenarioError};

/// Levels for reliefs; requests of less fatigued groups beyond them wait.
const MOST_RELIEFS: usize = 16;
/// Greatest change of a joint in one time step, in greatest steps of relief: the rest of the body must be able to follow.
const FOLLOWING_STEPS: f64 = 2.0;
/// A time step in which no rate changes by more is slow, rad or m.
const SLOW_STEP: f64 = 1e-3;
/// A time step in which no rate changes by more is at rest, rad or m.
const REST_STEP: f64 = 1e-9;
/// After so many slow time steps in a row the body descends to the local minimum of effort, if that is near.
const SLOW_STEPS: u32 = 30;
/// Convergence count of a body at rest.
const RESTING: u32 = u32::MAX;
/// A slope is computed anew when some coordinate has moved farther, rad or m.
const SLOPE_VALIDITY: f64 = 0.005;
/// Half of a step is taken where all of it leaves more of second order in a task above relief, m or rad. Assumed.
const SECOND_ORDER: f64 = 5e-4;
/// A half-space that is violated by more was not kept, rad or m.
const HALF_SPACE_TOLERANCE: f64 = 1e-6;

/// A body with supports or tasks under way.
#[derive(Clone, Debug)]
pub(super) struct BodyMotion<'a> {
    pub(super) scenario: &'a Scenario,
    /// Numbers of the scenario's supports that are in use, ascending.
    pub(super) in_use: Vec<usize>,
    /// The supports in use at the places where the body stands: none is free.
    pub(super) supports: Vec<Support>,
    /// Inequalities above all tasks while these supports are in use.
    pub(super) limits: Vec<Task>,
    pub(super) engine: Engine<'a>,
    /// The number of a support in use that is in the air, and an engine without it.
    pub(super) lifted: Option<(usize, Engine<'a>)>,
    /// The body, with the strength of its present posture.
    pub(super) model: SharedModel<'a>,
    /// Number of levels above the reliefs.
    above: usize,
    /// Level of each of the scenario's tasks.
    task_levels: Vec<usize>,
    /// The tasks of these levels, also those that have no part while the supports in use are.
    pub(super) goals: Vec<PriorityLevel>,
    /// By coordinate.
    slopes: Vec<Option<Slope>>,
    /// The supports are as in this posture.
    pub(super) placed_at: Posture,
    /// The posture before the last step.
    pub(super) before: Posture,
    /// Slow steps in a row, [`RESTING`] at rest.
    convergence_count: u32,
    /// Of the next step.
    step_length: StepLength,
    /// Coordinates whose half-spaces the last step was to keep, and those of them that it did not keep.
    pub(super) requested: Vec<usize>,
    deferred: Vec<usize>,
}

/// A slope of external torque, and the posture that it was computed in; without value where the coordinate cannot move.
#[derive(Clone, Debug)]
struct Slope {
    posture: Posture,
    value: Option<f64>,
}

impl<'a> BodyMotion<'a> {
    /// The body on its supports `in_use` as they are in the posture `placed_at`.
    pub(super) fn new(
        scenario: &'a Scenario,
        model: SharedModel<'a>,
        placed_at: &Posture,
        in_use: &[usize],
    ) -> Result<Self, ScenarioError> {
        // A foot that carries does not slide.
        let stays = |support: &Support| Support { place: Place::Fixed, ..support.clone() };
        let supports: Vec<Support> = in_use.iter().map(|&number| stays(&scenario.supports[number])).collect();
        let limits = scenario.limits_with(in_use);
        let (above, below): (Vec<_>, Vec<_>) = (0..scenario.tasks.len()).partition(|&i| scenario.tasks[i].above_relief);
        let level = |i: &usize| scenario.goal_with(&scenario.tasks[*i].goal, in_use);
        let reliefs = std::iter::repeat_n(PriorityLevel::default(), MOST_RELIEFS);
        let levels = above.iter().map(level).chain(reliefs).chain(below.iter().map(level)).collect();
        let mut task_levels = vec![0; scenario.tasks.len()];
        above.iter().enumerate().for_each(|(level, &i)| task_levels[i] = level);
        below.iter().enumerate().for_each(|(level, &i)| task_levels[i] = above.len() + MOST_RELIEFS + level);
        let max_step = FOLLOWING_STEPS * scenario.relief.max_step;
        let options = Options { reject_steps: false, max_step, local_minima: 0, ..Options::least_effort() };
        Ok(Self {
            scenario,
            engine: engine((scenario, model.clone()), placed_at, (&supports, &limits), levels, options)?,
            in_use: in_use.to_vec(),
            supports,
            limits,
            lifted: None,
            above: above.len(),
            task_levels,
            goals: scenario.tasks.iter().map(|task| task.goal.clone()).collect(),
            slopes: vec![None; model.coordinates().len()],
            model,
            placed_at: placed_at.clone(),
            before: placed_at.clone(),
            convergence_count: 0,
            step_length: StepLength::new(max_step),
            requested: vec![],
            deferred: vec![],
        })
    }

    /// The levels that ask for something.
    pub(super) fn levels(&self) -> impl Iterator<Item = &PriorityLevel> {
        self.engine.levels().iter().filter(|level| level.asks())
    }

    /// The levels that ask for something while the supports with these numbers are in use.
    pub(super) fn levels_with(&self, in_use: &[usize]) -> Vec<PriorityLevel> {
        let mut levels = self.engine.levels().to_vec();
        for (goal, level) in self.levels_of_goals() {
            levels[level] = self.scenario.goal_with(goal, in_use);
        }
        levels.retain(PriorityLevel::asks);
        levels
    }

    /// The scenario's tasks, each with the number of its level.
    pub(super) fn levels_of_goals(&self) -> impl Iterator<Item = (&PriorityLevel, usize)> {
        self.goals.iter().zip(self.task_levels.iter().copied())
    }

    pub(super) fn scenario(&self) -> &'a Scenario {
        self.scenario
    }

    pub(super) fn loads(&self) -> &[Load] {
        self.engine.loads()
    }

    /// Effort that the effort level counts, in the posture of the last update.
    pub(super) fn effort(&self) -> f64 {
        let level = self.engine.levels().iter().position(is_effort);
        level.map_or(0.0, |level| self.engine.error(level).powi(2))
    }

    /// Moves by one step toward the half-spaces of the `requested` coordinates, the most fatigued first, and the tasks. `reliefs_move`: some
    /// relief asks for motion, not only to be kept. A body at rest stays while the same coordinates request relief. Afterwards `deferred` holds
    /// the requested coordinates whose half-spaces the posture violates, and those past the first [`MOST_RELIEFS`].
    pub(super) fn step(
        &mut self,
        posture: &mut Posture,
        requested: &[usize],
        requests: &[Request],
        reliefs_move: bool,
    ) -> Result<(), ScenarioError> {
        self.before.values_mut().copy_from_slice(posture.values());
        if !reliefs_move && self.is_at_rest() && self.requested == requested {
            return Ok(());
        }
        self.requested.clear();
        self.requested.extend_from_slice(requested);
        self.write_relief_levels(requests);
        self.engine.evaluate(posture)?;
        self.step_length.observe(errors_of(&self.engine, self.above));
        self.engine.set_max_step(self.step_length.next(reliefs_move));
        if reliefs_move {
            self.engine.widen_trust_region();
        }
        let largest = self.engine.step_or_part(posture, self.above, SECOND_ORDER)?;
        // A posture in which a law gives no numbers is refused when its torques are computed.
        let farther = reliefs_move
            && self.engine.evaluate(posture).is_ok()
            && leads_farther(errors_of(&self.engine, self.above), &self.engine.errors()[..self.above]);
        if farther {
            self.take_back(posture);
        }
        self.count_convergence(posture, largest, reliefs_move)?;
        let kept = |slot: usize, i: usize| {
            slot < MOST_RELIEFS && requests[i].half_space.violation(posture.values()) <= HALF_SPACE_TOLERANCE
        };
        self.deferred.clear();
        self.deferred.extend(requested.iter().enumerate().filter(|(slot, i)| !kept(*slot, **i)).map(|(_, i)| *i));
        if reliefs_move {
            self.step_length.adapt(farther, largest);
        }
        Ok(())
    }

    /// Coordinates whose half-spaces the last step did not keep.
    pub(super) fn deferred(&self) -> &[usize] {
        &self.deferred
    }

    pub(super) fn write_relief_levels(&mut self, requests: &[Request]) {
        let levels = &mut self.engine.levels_mut()[self.above..self.above + MOST_RELIEFS];
        for (slot, level) in levels.iter_mut().enumerate() {
            level.half_spaces.truncate(usize::from(slot < self.requested.len()));
            let wanted = self.requested.get(slot).map(|&i| &requests[i].half_space);
            match (wanted, level.half_spaces.first_mut()) {
                (Some(half_space), Some(present)) => present.clone_from(half_space),
                (Some(half_space), None) => level.half_spaces.push(half_space.clone()),
                _ => {}
            }
        }
    }

    /// Counts slow steps; now and then a slow body descends to the local minimum, where it is at rest.
    fn count_convergence(
        &mut self,
        posture: &mut Posture,
        largest: f64,
        reliefs_move: bool,
    ) -> Result<(), ScenarioError> {
        let before = if self.is_at_rest() { 0 } else { self.convergence_count };
        let count = if largest <= SLOW_STEP && !reliefs_move { before + 1 } else { 0 };
        self.convergence_count = count;
        let due = count > 0 && count.is_multiple_of(SLOW_STEPS);
        if due && (largest <= REST_STEP || self.engine.descend(posture)?) {
            self.convergence_count = RESTING;
        }
        Ok(())
    }

    /// Computes all torques in a posture.
    pub(super) fn update(&mut self, posture: &Posture) -> Result<(), ScenarioError> {
        if let Some((_, engine)) = &mut self.lifted {
            engine.evaluate(posture)?;
        }
        Ok(self.engine.evaluate(posture)?)
    }

    /// Goes back to the posture in which the last step began; torques stay to be updated.
    pub(super) fn take_back(&self, posture: &mut Posture) {
        posture.values_mut().copy_from_slice(self.before.values());
    }

    /// Slope of a coordinate's external torque along the motion that all levels above relief allow; `None` where they do not let
    /// the coordinate move.
    pub(super) fn external_slope(
        &mut self,
        posture: &Posture,
        coordinate: usize,
        rate: usize,
    ) -> Result<Option<f64>, ScenarioError> {
        let far = |at: &Posture| at.values().iter().zip(posture.values()).any(|(a, b)| (a - b).abs() > SLOPE_VALIDITY);
        if let Some(slope) = self.slopes[coordinate].as_ref().filter(|slope| !far(&slope.posture)) {
            return Ok(slope.value);
        }
        let value = self.engine.slope_along(posture, rate, self.above)?;
        self.slopes[coordinate] = Some(Slope { posture: posture.clone(), value });
        Ok(value)
    }

    /// Forgets all that earlier steps have shown.
    pub(super) fn forget(&mut self) {
        self.step_length.forget();
        self.engine.set_max_step(self.step_length.greatest());
        self.engine.restart();
        self.convergence_count = 0;
        self.slopes.fill(None);
    }

    /// Begins to count slow steps anew: loads, tasks or the posture have changed.
    pub(super) fn restart_convergence(&mut self) {
        self.step_length.restart();
        self.engine.set_max_step(self.step_length.greatest());
        self.engine.widen_trust_region();
        self.convergence_count = 0;
        self.slopes.fill(None);
    }

    pub(super) fn set_loads(&mut self, loads: &[Load]) -> Result<(), ScenarioError> {
        self.restart_convergence();
        Ok(self.engine.set_loads(loads)?)
    }

    /// Replaces the body by the same one with other strength and passive torque.
    pub(super) fn set_model(&mut self, model: &SharedModel<'a>) {
        self.model = model.clone();
        self.engine.set_model(model.clone());
        if let Some((_, engine)) = &mut self.lifted {
            engine.set_model(model.clone());
        }
    }

    pub(super) fn set_task(&mut self, task: usize, goal: &PriorityLevel) {
        self.restart_convergence();
        self.goals[task].clone_from(goal);
        self.engine.levels_mut()[self.task_levels[task]] = self.scenario.goal_with(goal, &self.in_use);
    }

    pub(super) fn is_at_rest(&self) -> bool {
        self.convergence_count == RESTING
    }

    pub(super) fn contact(&self) -> &ContactForces {
        self.lifted.as_ref().map_or(&self.engine, |(_, engine)| engine).contact()
    }

    /// Torques of the last update, contact included.
    pub(super) fn torques(&self) -> &JointTorques {
        self.lifted.as_ref().map_or(&self.engine, |(_, engine)| engine).torques()
    }

    /// Writes how the body stands in the posture of the last update; `effort` stays.
    pub(super) fn write_standing(&self, standing: &mut Standing) {
        let contact = self.contact();
        standing.contacts.clear();
        standing.contacts.resize(self.scenario.supports.len(), Contact::default());
        let lifted = self.lifted.as_ref().map(|(number, _)| *number);
        let carrying = self.in_use.iter().filter(|number| Some(**number) != lifted);
        for (support, number) in (0..contact.supports().len()).zip(carrying) {
            standing.contacts[*number] = self.contact_of(support);
        }
        standing.errors.clear();
        standing.errors.extend(self.task_levels.iter().map(|&level| self.engine.error(level)));
        standing.slip = self.lifted.as_ref().map_or(&self.engine, |(_, engine)| engine).slip();
        standing.center_of_mass = self.torques().kinematics().center_of_mass(&self.model).unwrap_or_default();
    }

    fn contact_of(&self, support: usize) -> Contact {
        let (contact, kinematics) = (self.contact(), self.torques().kinematics());
        let center_of_pressure = contact.center_of_pressure(&self.model, kinematics, support);
        let about = center_of_pressure.unwrap_or_default();
        let mut couple = Vector3::zeros();
        for load in &contact.loads()[contact.corners(support)] {
            if let LoadKind::Force(force, _) = load.kind {
                let at = kinematics.station(&self.model, load.segment, load.point);
                couple += (at - about).cross(&force);
            }
        }
        Contact { force: contact.force(support), share: contact.share(support), center_of_pressure, couple }
    }
}

/// Whether effort is asked for.
pub(super) fn is_effort(level: &PriorityLevel) -> bool {
    level.tasks.iter().any(|task| matches!(task, Task::Effort(_)))
}

/// Errors of the first levels of an engine in the posture that it evaluated last.
fn errors_of(engine: &Engine<'_>, levels: usize) -> impl Iterator<Item = f64> {
    (0..levels).map(|level| engine.error(level))
}

/// An engine for a scenario's body, which has the strength of `model`, that moves its free coordinates.
pub(super) fn engine<'a>(
    (scenario, model): (&'a Scenario, SharedModel<'a>),
    placed_at: &Posture,
    (supports, limits): (&[Support], &[Task]),
    levels: Vec<PriorityLevel>,
    options: Options,
) -> Result<Engine<'a>, ScenarioError> {
    let mut engine = Engine::with_supports(model, placed_at, supports.to_vec(), levels, &scenario.loads, options)?;
    scenario.locked_rates().for_each(|rate| engine.lock(rate));
    limits.iter().try_for_each(|task| engine.limit(task.clone()))?;
    Ok(engine)
}
