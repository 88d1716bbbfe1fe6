//! Plans the way of a body to a posture, in balance in every sample, with or without a step of one support.
//!
//! The body moves by priorities: supports, the tasks above effort, then the coordinates toward the posture. A step has three parts:
//! the body brings its centre of mass over the other supports until they hold it without the lifted one, the lifted one follows an arc
//! to its new place, and the body takes the posture. The whole way is planned before the first sample is shown. A way on which any sample would be off
//! balance, or in which a muscle group would need more than its strength, is no way.

use std::cell::Cell;

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::contact::{Balance, Support};
use crate::joint_torques::relative_load;
use crate::kinematics::Kinematics;
use crate::model::{Coordinate, Model, Placement};
use crate::posture::Posture;
use crate::posture_solver::{Engine, EngineError, Options};
use crate::statics::Load;
use crate::tasks::{self, CenterOfMass, CenterOfMassGoal, PriorityLevel, Task};

use super::Scenario;

/// Greatest change of a rate in one step of the solver, rad or m.
const PATH_STEP: f64 = 0.02;
/// Greatest speed of a rate, rad/s or m/s (assumed: a slow, deliberate motion).
const SPEED: f64 = 0.6;
/// Time that a lifted support is in the air, s (assumed: a slow step).
const SWING_TIME: f64 = 1.0;
/// Height of the arc above the line between both places, m (assumed).
const LIFT: f64 = 0.03;
/// A body is at a posture when no rate differs by more, rad or m, and it stays where it is when no rate changes by more in a step.
const AT_POSTURE: f64 = 1e-3;
/// A lifted support has arrived when its place and rotation differ by no more, m and rad.
const PLACED: f64 = 1e-6;
/// Most steps of the solver for each part of a way.
const MOST_STEPS_OF_PART: usize = 600;
/// Tries in which a body shifts its weight off a support.
const UNLOADING_STEPS: usize = 100;

/// A way that is under way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Path {
    postures: Vec<Posture>,
    /// By posture: the support that is in the air.
    lifted: Vec<Option<usize>>,
    /// Number of postures taken.
    taken: usize,
}

impl Path {
    /// The next posture.
    pub(super) fn take(&mut self) -> Option<&Posture> {
        self.taken += 1;
        self.postures.get(self.taken - 1)
    }

    fn push(&mut self, posture: &Posture, lifted: Option<usize>) {
        self.postures.push(posture.clone());
        self.lifted.push(lifted);
    }

    /// Leaves out all postures but the last.
    pub(super) fn skip_to_end(&mut self) {
        self.taken = self.taken.max(self.postures.len().saturating_sub(1));
    }

    pub(super) fn is_over(&self) -> bool {
        self.taken >= self.postures.len()
    }

    /// The support that is in the air in the posture taken last.
    pub(super) fn lifted(&self) -> Option<usize> {
        self.taken.checked_sub(1).and_then(|last| self.lifted.get(last).copied().flatten())
    }

    /// Whether a support is put elsewhere on the way.
    pub(super) fn has_step(&self) -> bool {
        self.lifted.iter().any(Option::is_some)
    }

    /// Whether every number is finite, and every posture has `n` coordinates.
    pub(super) fn fits(&self, n: usize, supports: usize) -> bool {
        let fits = |posture: &Posture| posture.values().len() == n && posture.values().iter().all(|v| v.is_finite());
        self.postures.iter().all(fits)
            && self.lifted.len() == self.postures.len()
            && self.lifted.iter().flatten().all(|support| *support < supports)
    }
}

/// Plans ways of a scenario's body.
pub(super) struct Planner<'a> {
    pub(super) scenario: &'a Scenario,
    /// The body, with the strength of its present posture.
    pub(super) model: &'a Model,
    /// All supports, none of them free.
    pub(super) supports: &'a [Support],
    /// The levels above effort.
    pub(super) levels: &'a [PriorityLevel],
    pub(super) loads: &'a [Load],
    /// Work that is left of the budget; a way that needs more is none.
    pub(super) left: Cell<usize>,
}

impl Planner<'_> {
    /// The way to `to` while all supports stay; `None` where there is none.
    pub(super) fn way(&self, from: &Posture, to: &Posture) -> Result<Option<Path>, EngineError> {
        let mut path = Path { postures: vec![], lifted: vec![], taken: 0 };
        let arrived = self.shift(from, to, &mut path)?;
        Ok(arrived.map(|_| path))
    }

    /// The way to `to`, where support number `lifted` has another place; `None` where there is none.
    pub(super) fn step(&self, from: &Posture, to: &Posture, lifted: usize) -> Result<Option<Path>, EngineError> {
        let mut path = Path { postures: vec![], lifted: vec![], taken: 0 };
        let Some(unloaded) = self.unloaded(from, lifted)? else { return Ok(None) };
        let Some(begin) = self.shift(from, &unloaded, &mut path)? else { return Ok(None) };
        let Some(landed) = self.swing(&begin, to, lifted, &mut path)? else { return Ok(None) };
        Ok(self.shift(&landed, to, &mut path)?.map(|_| path))
    }

    /// One step of the solver; gives the largest change, none where the budget is spent.
    fn step_within_budget(&self, engine: &mut Engine<'_>, posture: &mut Posture) -> Result<Option<f64>, EngineError> {
        if self.left.get() == 0 {
            return Ok(None);
        }
        let step = engine.step(posture)?;
        self.left.set(self.left.get().saturating_sub(step.work()));
        Ok(Some(step.largest))
    }

    /// Steps of the solver from one sample to the next, so that no rate moves faster than [`SPEED`].
    fn steps_of_sample(&self) -> usize {
        (SPEED * self.scenario.run.step / PATH_STEP).ceil().max(1.0) as usize
    }

    fn options(&self) -> Options {
        let max_step = SPEED * self.scenario.run.step / self.steps_of_sample() as f64;
        Options { max_step, reject_steps: false, local_minima: 0, ..Options::least_effort() }
    }

    /// An engine without effort whose last level asks for the coordinates of `to`; `first` stands above the other levels.
    fn engine(
        &self,
        at: &Posture,
        supports: &[Support],
        first: Vec<Task>,
        to: &Posture,
    ) -> Result<Engine<'_>, EngineError> {
        let model = self.model;
        let mut levels: Vec<PriorityLevel> = first.into_iter().map(PriorityLevel::from).collect();
        levels.iter_mut().take(1).for_each(|level| level.hard = true);
        levels.extend_from_slice(self.levels);
        levels.push(Task::Posture(tasks::Posture::whole(model, to.clone())).into());
        let mut engine = Engine::with_supports(model, at, supports.to_vec(), levels, self.loads, self.options())?;
        self.scenario.locked_rates().for_each(|rate| engine.lock(rate));
        self.scenario.limits.iter().try_for_each(|task| engine.limit(task.clone()))?;
        Ok(engine)
    }

    fn without(&self, lifted: usize) -> Vec<Support> {
        let others = self.supports.iter().enumerate().filter(|(i, _)| *i != lifted);
        others.map(|(_, support)| support.clone()).collect()
    }

    /// Placement of the segment of a support in a posture.
    fn placement(&self, posture: &Posture, support: usize) -> Result<Placement, EngineError> {
        let model = self.model;
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture).map_err(crate::joint_torques::JointTorquesError::from)?;
        Ok(kinematics.placement(model, self.supports[support].segment))
    }

    fn held_at(&self, target: Placement, support: usize) -> Task {
        let segment = self.supports[support].segment;
        Task::Placement(tasks::Placement { segment, point: Vector3::zeros(), target })
    }

    /// The posture nearest to `from` in which the other supports hold the body while the lifted one touches its place.
    fn unloaded(&self, from: &Posture, lifted: usize) -> Result<Option<Posture>, EngineError> {
        let stays = self.held_at(self.placement(from, lifted)?, lifted);
        let Some(over_the_others) = self.over_the_others(from, lifted)? else { return Ok(None) };
        let mut engine = self.engine(from, &self.without(lifted), vec![stays, over_the_others], from)?;
        let mut posture = from.clone();
        for _ in 0..UNLOADING_STEPS {
            let Some(largest) = self.step_within_budget(&mut engine, &mut posture)? else { return Ok(None) };
            if largest <= AT_POSTURE {
                break;
            }
        }
        Ok(self.is_held(&mut engine, &posture)?.then_some(posture))
    }

    /// The centre of mass over the other supports, each by the weight that it carries in `from`; `None` where they carry nothing.
    fn over_the_others(&self, from: &Posture, lifted: usize) -> Result<Option<Task>, EngineError> {
        let model = self.model;
        let mut engine = self.engine(from, self.supports, vec![], from)?;
        engine.evaluate(from)?;
        let (mut target, mut weight) = (Vector3::zeros(), 0.0);
        for (i, support) in self.supports.iter().enumerate().filter(|(i, _)| *i != lifted) {
            let share = engine.contact().share(i).max(0.0);
            target += share * engine.torques().kinematics().station(model, support.segment, support.middle());
            weight += share;
        }
        if weight <= 0.0 {
            return Ok(None);
        }
        let up = model.gravity().iamax();
        let goal = CenterOfMassGoal::At { target: target / weight, axes: [0, 1, 2].map(|axis| axis != up) };
        Ok(Some(Task::CenterOfMass(CenterOfMass { goal })))
    }

    /// Whether the supports hold the body in a posture, and no group needs more than its strength.
    fn is_held(&self, engine: &mut Engine<'_>, posture: &Posture) -> Result<bool, EngineError> {
        engine.evaluate(posture)?;
        let torques = engine.torques();
        let load = |(i, coordinate): (usize, &Coordinate)| {
            let active = coordinate.rate.map_or(0.0, |rate| torques.active_torque()[rate]);
            relative_load(coordinate, torques.angles()[i], active)
        };
        let strong = self.model.coordinates().iter().enumerate().map(load).all(|load| load <= 1.0);
        Ok(strong && engine.contact().balance() == Balance::Held)
    }

    /// Moves to `to` on all supports as they are in `from`; gives the posture that was reached.
    fn shift(&self, from: &Posture, to: &Posture, path: &mut Path) -> Result<Option<Posture>, EngineError> {
        let mut engine = self.engine(from, self.supports, vec![], to)?;
        let mut posture = from.clone();
        let mut steps = 0;
        loop {
            let apart = posture.values().iter().zip(to.values()).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            if apart <= AT_POSTURE {
                return Ok(Some(posture));
            }
            let mut largest = 0.0f64;
            for _ in 0..self.steps_of_sample() {
                let Some(change) = self.step_within_budget(&mut engine, &mut posture)? else { return Ok(None) };
                largest = largest.max(change);
                steps += 1;
            }
            if !self.is_held(&mut engine, &posture)? || steps > MOST_STEPS_OF_PART {
                return Ok(None);
            }
            path.push(&posture, None);
            if largest <= AT_POSTURE {
                return Ok(Some(posture));
            }
        }
    }

    /// Carries the lifted support along an arc to its place in `to`, while the body moves toward `to`.
    fn swing(
        &self,
        from: &Posture,
        to: &Posture,
        lifted: usize,
        path: &mut Path,
    ) -> Result<Option<Posture>, EngineError> {
        let (begin, end) = (self.placement(from, lifted)?, self.placement(to, lifted)?);
        let Some(over_the_others) = self.over_the_others(from, lifted)? else { return Ok(None) };
        let first = vec![self.held_at(begin, lifted), over_the_others];
        let mut engine = self.engine(from, &self.without(lifted), first, to)?;
        let samples = (SWING_TIME / self.scenario.run.step).ceil().max(1.0);
        let steps = self.steps_of_sample().max((20.0 / samples).ceil() as usize);
        let count = samples as usize * steps;
        let mut posture = from.clone();
        for k in 1..=count {
            let share = k as f64 / count as f64;
            let height = LIFT * 4.0 * share * (1.0 - share) * self.supports[lifted].normal;
            let translation = begin.translation.vector.lerp(&end.translation.vector, share) + height;
            let rotation = UnitQuaternion::slerp(&begin.rotation, &end.rotation, share);
            let target = Placement::from_parts(translation.into(), rotation);
            engine.levels_mut()[0].tasks[0] = self.held_at(target, lifted);
            let Some(_) = self.step_within_budget(&mut engine, &mut posture)? else { return Ok(None) };
            if k % steps == 0 && k < count {
                if !self.is_held(&mut engine, &posture)? {
                    return Ok(None);
                }
                path.push(&posture, Some(lifted));
            }
        }
        // The last of the arc: until the support has come to rest on its place.
        for _ in 0..MOST_STEPS_OF_PART {
            let Some(largest) = self.step_within_budget(&mut engine, &mut posture)? else { return Ok(None) };
            if largest <= AT_POSTURE && engine.report(&posture)?.first().is_some_and(|level| level.length <= PLACED) {
                break;
            }
        }
        let missed = engine.report(&posture)?.first().map_or(0.0, |level| level.length);
        if !self.is_held(&mut engine, &posture)? || missed > PLACED {
            return Ok(None);
        }
        path.push(&posture, Some(lifted));
        Ok(Some(posture))
    }
}
