//! Plans the way of a body to a posture, in balance in every sample, with or without a step of one support.
//!
//! The body moves by priorities: supports, the tasks above effort, then the coordinates toward the posture. A step has three parts:
//! the body brings its centre of mass over the other supports until they hold it without the lifted one, the lifted one follows an arc
//! to its new place, and the body takes the posture. The whole way is planned before the first sample is shown. A way on which any sample would be off
//! balance, or in which a muscle group would need more than its strength, is no way. Where a hand is taken off for a task, the tasks are left on the
//! way, and a body in which a group needs more than its strength already may begin it.

use std::cell::Cell;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::contact::{Balance, Support};
use crate::joint_torques::{JointTorques, relative_load};
use crate::kinematics::Kinematics;
use crate::model::{Coordinate, Model, Placement};
use crate::posture::Posture;
use crate::posture_solver::{Engine, EngineError, Options};
use crate::statics::Load;
use crate::tasks::{self, CenterOfMass, CenterOfMassGoal, PriorityLevel, Task, half_planes};

use super::Scenario;
use super::offer::Offer;
use super::sample::StepKind;

/// Greatest change of a rate in one step of the solver, rad or m.
const PATH_STEP: f64 = 0.02;
/// Greatest speed of a rate, rad/s or m/s (assumed: a slow, deliberate motion).
pub(super) const SPEED: f64 = 0.6;
/// A body is at a posture when no rate differs by more, rad or m, and it stays where it is when no rate changes by more in a step.
pub(super) const AT_POSTURE: f64 = 1e-3;
/// Least distance of the centre of mass from the edge of the other supports while a hand is taken off, m (assumed).
const OFF_THE_EDGE: f64 = 0.01;
/// A patch lies on its plane when it is no farther off, m and rad.
const LAID: f64 = 1e-4;
/// Most steps of the solver for each part of a way.
pub(super) const MOST_STEPS_OF_PART: usize = 600;
/// Tries in which a body shifts its weight off a support.
const UNLOADING_STEPS: usize = 100;

/// A way that is under way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Path {
    postures: Vec<Posture>,
    /// By posture: the number of the support that is in the air.
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

    pub(super) fn push(&mut self, posture: &Posture, lifted: Option<usize>) {
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

    /// The number of the support that is in the air in the posture taken last.
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
    /// All supports before and after the change, none of them free, and their numbers in the scenario.
    pub(super) supports: &'a [Support],
    pub(super) numbers: &'a [usize],
    /// Inequalities above all tasks.
    pub(super) limits: &'a [Task],
    /// The levels above effort.
    pub(super) levels: &'a [PriorityLevel],
    pub(super) loads: &'a [Load],
    /// Greatest share of its strength that a muscle group may need on the way.
    pub(super) most_load: f64,
    /// Work that is left of the budget; a way that needs more is none.
    pub(super) left: Cell<usize>,
}

impl Planner<'_> {
    /// The way to `to` while all supports stay; `None` where there is none.
    pub(super) fn way(&self, from: &Posture, to: &Posture) -> Result<Option<Path>, EngineError> {
        let mut path = Path { postures: vec![], lifted: vec![], taken: 0 };
        let arrived = self.shift((from, to), (self.supports, vec![]), &mut path)?;
        Ok(arrived.map(|_| path))
    }

    /// The way to `to` with a change of a support; `None` where there is none.
    pub(super) fn step(&self, from: &Posture, to: &Posture, offer: Offer) -> Result<Option<Path>, EngineError> {
        let mut path = Path { postures: vec![], lifted: vec![], taken: 0 };
        let Some(lifted) = self.numbers.iter().position(|number| *number == offer.number) else { return Ok(None) };
        // While a hand is taken off, the centre of mass is kept inside the corners of the other supports.
        let off_the_edge = |from: &Posture| match offer.kind {
            StepKind::TakenOff => self.between_the_others(from, lifted).map(|task| vec![task]),
            _ => Ok(vec![]),
        };
        let mut begin = from.clone();
        if offer.kind != StepKind::PutDown {
            let toward = if offer.for_a_task { to } else { from };
            let Some(unloaded) = self.unloaded((from, toward), (lifted, offer.kind))? else { return Ok(None) };
            let over = off_the_edge(from)?;
            let Some(reached) = self.shift((from, &unloaded), (self.supports, over), &mut path)? else {
                return Ok(None);
            };
            begin = reached;
        }
        let Some(landed) = self.swing(&begin, to, (lifted, offer.kind), &mut path)? else { return Ok(None) };
        let supports = if offer.kind == StepKind::TakenOff { self.without(lifted) } else { self.supports.to_vec() };
        let over = off_the_edge(&landed)?;
        Ok(self.shift((&landed, to), (&supports, over), &mut path)?.map(|_| path))
    }

    /// One step of the solver; gives the largest change, none where the budget is spent.
    pub(super) fn step_within_budget(
        &self,
        engine: &mut Engine<'_>,
        posture: &mut Posture,
    ) -> Result<Option<f64>, EngineError> {
        if self.left.get() == 0 {
            return Ok(None);
        }
        let step = engine.step(posture)?;
        self.left.set(self.left.get().saturating_sub(step.work()));
        Ok(Some(step.largest))
    }

    /// Steps of the solver from one sample to the next, so that no rate moves faster than [`SPEED`].
    pub(super) fn steps_of_sample(&self) -> usize {
        (SPEED * self.scenario.run.step / PATH_STEP).ceil().max(1.0) as usize
    }

    fn options(&self) -> Options {
        let max_step = SPEED * self.scenario.run.step / self.steps_of_sample() as f64;
        Options { max_step, reject_steps: false, local_minima: 0, ..Options::least_effort() }
    }

    /// An engine without effort whose last level asks for the coordinates of `to`; `first` stands above the other levels.
    pub(super) fn engine(
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
        self.limits.iter().try_for_each(|task| engine.limit(task.clone()))?;
        Ok(engine)
    }

    pub(super) fn without(&self, lifted: usize) -> Vec<Support> {
        let others = self.supports.iter().enumerate().filter(|(i, _)| *i != lifted);
        others.map(|(_, support)| support.clone()).collect()
    }

    /// Placement of the segment of a support in a posture.
    pub(super) fn placement(&self, posture: &Posture, support: usize) -> Result<Placement, EngineError> {
        let model = self.model;
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, posture).map_err(crate::joint_torques::JointTorquesError::from)?;
        Ok(kinematics.placement(model, self.supports[support].segment))
    }

    pub(super) fn held_at(&self, target: Placement, support: usize) -> Task {
        let segment = self.supports[support].segment;
        Task::Placement(tasks::Placement { segment, point: Vector3::zeros(), target })
    }

    /// The posture nearest to `toward` that a body at `from` comes to in which the other supports hold it while the lifted one touches its place.
    fn unloaded(
        &self,
        (from, toward): (&Posture, &Posture),
        (lifted, kind): (usize, StepKind),
    ) -> Result<Option<Posture>, EngineError> {
        let stays = self.held_at(self.placement(from, lifted)?, lifted);
        let Some(over_the_others) = self.over_the_others(from, (lifted, kind))? else { return Ok(None) };
        let mut engine = self.engine(from, &self.without(lifted), vec![stays, over_the_others], toward)?;
        let mut posture = from.clone();
        for _ in 0..UNLOADING_STEPS {
            let Some(largest) = self.step_within_budget(&mut engine, &mut posture)? else { return Ok(None) };
            if largest <= AT_POSTURE {
                break;
            }
        }
        Ok(self.is_held(&mut engine, &posture)?.then_some(posture))
    }

    /// The centre of mass over the other supports: for a hand that is taken off between their corners, else each by the weight that it carries in
    /// `from`; `None` where they carry nothing.
    pub(super) fn over_the_others(
        &self,
        from: &Posture,
        (lifted, kind): (usize, StepKind),
    ) -> Result<Option<Task>, EngineError> {
        if kind == StepKind::TakenOff {
            return self.between_the_others(from, lifted).map(Some);
        }
        let touches = kind == StepKind::Elsewhere;
        let model = self.model;
        let supports = if touches { self.supports.to_vec() } else { self.without(lifted) };
        let mut engine = self.engine(from, &supports, vec![], from)?;
        engine.evaluate(from)?;
        let (mut target, mut weight) = (Vector3::zeros(), 0.0);
        for (i, support) in supports.iter().enumerate().filter(|(i, _)| !touches || *i != lifted) {
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

    /// The centre of mass between the corners of the other supports, off the edge of balance.
    fn between_the_others(&self, from: &Posture, lifted: usize) -> Result<Task, EngineError> {
        let mut kinematics = Kinematics::new(self.model);
        kinematics.update(self.model, from).map_err(crate::joint_torques::JointTorquesError::from)?;
        let others = self.without(lifted);
        let corner = |support: &Support, at: &Vector3<f64>| kinematics.station(self.model, support.segment, *at);
        let corners = others.iter().flat_map(|support| support.corners.iter().map(move |at| corner(support, at)));
        let polygon = half_planes(&corners.collect::<Vec<_>>(), self.model.gravity());
        let goal = CenterOfMassGoal::Inside { polygon, margin: OFF_THE_EDGE };
        Ok(Task::CenterOfMass(CenterOfMass { goal }))
    }

    /// The posture nearest to `from` in which two tasks are met, the supports stay, and the other tasks are done as far as that allows, whether the
    /// supports hold the body in it or not; `None` where the two are not met.
    pub(super) fn nearest(&self, from: &Posture, tasks: [Task; 2]) -> Result<Option<Posture>, EngineError> {
        let mut engine = self.engine(from, self.supports, tasks.to_vec(), from)?;
        let mut posture = from.clone();
        for _ in 0..MOST_STEPS_OF_PART {
            let Some(largest) = self.step_within_budget(&mut engine, &mut posture)? else { return Ok(None) };
            if largest <= AT_POSTURE {
                break;
            }
        }
        let met = engine.report(&posture)?.iter().take(2).all(|level| level.length <= LAID);
        Ok(met.then_some(posture))
    }

    /// Whether the supports hold the body in a posture, and no group needs more than the way allows.
    pub(super) fn is_held(&self, engine: &mut Engine<'_>, posture: &Posture) -> Result<bool, EngineError> {
        engine.evaluate(posture)?;
        let strong = greatest_load(self.model, engine.torques()) <= self.most_load;
        Ok(strong && engine.contact().balance() == Balance::Held)
    }

    /// Moves to `to` on `supports` as they are in `from`, `first` above the tasks; gives the posture that was reached.
    fn shift(
        &self,
        (from, to): (&Posture, &Posture),
        (supports, first): (&[Support], Vec<Task>),
        path: &mut Path,
    ) -> Result<Option<Posture>, EngineError> {
        let mut engine = self.engine(from, supports, first, to)?;
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
}

/// The greatest relative load of all muscle groups of coordinates.
pub(super) fn greatest_load(model: &Model, torques: &JointTorques) -> f64 {
    let load = |(i, coordinate): (usize, &Coordinate)| {
        let active = coordinate.rate.map_or(0.0, |rate| torques.active_torque()[rate]);
        relative_load(coordinate, torques.angles()[i], active)
    };
    model.coordinates().iter().enumerate().map(load).fold(0.0, f64::max)
}
