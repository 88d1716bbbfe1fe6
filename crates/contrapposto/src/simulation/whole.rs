//! How is relief carried out by a body on its feet, with something to do?
//!
//! Reliefs are half-spaces (Eqs. 4-6) in the priorities of [`crate::posture_solver::Engine`]: supports, tasks that stand above relief,
//! the reliefs, the most tired group first, then the other tasks. Each is a level of its own, so reliefs that conflict are
//! decided by fatigue, and of equals by the order of the model.

use crate::constraint::HalfSpace;
use crate::contact::{Balance, ContactForces, Missing};
use crate::model::Model;
use crate::posture::Posture;
use crate::posture_solver::{Engine, Options};
use crate::statics::LoadKind;
use crate::tasks::PriorityLevel;

use super::{Scenario, ScenarioError};

/// Most reliefs at once; the less tired groups wait.
const MOST: usize = 16;
/// Largest change of a joint in one time step, in largest steps of relief: the rest of the body must be able to follow.
const FOLLOW: f64 = 2.0;
/// Nothing changes by more in a time step, rad or m: the body hardly moves, or is still.
const SLOW: f64 = 1e-3;
const STILL: f64 = 1e-9;
/// After so many slow time steps it sinks to the bottom of its valley, if that is near.
const SOON: u32 = 30;
/// What `calm` is when it has come to rest.
const CALM: u32 = u32::MAX;
/// A slope is computed anew when some coordinate has moved so far, rad or m.
const MOVED: f64 = 0.005;
/// Whoever is thrown off balance by an event has so many steps to find it again.
const CATCHES: usize = 300;
/// A half-space that is missed by more was not kept, rad or m.
const MISSED: f64 = 1e-6;

/// A body under way with supports and tasks.
#[derive(Clone, Debug)]
pub(super) struct Whole<'a> {
    engine: Engine<'a>,
    /// Goals above the reliefs.
    above: usize,
    /// Place of each of the scenario's tasks among the engine's goals.
    places: Vec<usize>,
    /// By coordinate: where the slope was computed, and what it is.
    slopes: Vec<Option<Slope>>,
    before: Posture,
    /// Slow steps in a row, [`CALM`] at rest; with which reliefs, and those that were not kept.
    calm: u32,
    asked: Vec<usize>,
    deferred: Vec<usize>,
}

#[derive(Clone, Debug)]
struct Slope {
    at: Posture,
    value: Option<f64>,
}

impl<'a> Whole<'a> {
    /// The body at the posture nearest to the scenario's start in which its supports hold it and its tasks are done.
    pub(super) fn new(scenario: &'a Scenario) -> Result<(Self, Posture), ScenarioError> {
        let model = &scenario.model;
        let (above, below): (Vec<_>, Vec<_>) = (0..scenario.tasks.len()).partition(|&i| scenario.tasks[i].above_relief);
        let goal = |i: &usize| scenario.tasks[*i].goal.clone();
        let supports = || scenario.supports.clone();
        let goals: Vec<PriorityLevel> = above.iter().chain(&below).map(goal).collect();
        let lock = |engine: &mut Engine<'a>| {
            for (i, rate) in model.rates().iter().enumerate() {
                if rate.coordinate.is_some_and(|c| !scenario.free[c]) {
                    engine.lock(i);
                }
            }
        };
        let options = Options { max_step: 0.1, local_minima: 0, ..Options::least_effort() };
        let mut first = Engine::new(model, &scenario.start, supports(), goals, &scenario.loads, options)?;
        lock(&mut first);
        let start = first.solve(&scenario.start)?;
        let reliefs = std::iter::repeat_n(PriorityLevel::default(), MOST);
        let goals: Vec<PriorityLevel> = above.iter().map(goal).chain(reliefs).chain(below.iter().map(goal)).collect();
        let mut places = vec![0; scenario.tasks.len()];
        above.iter().enumerate().for_each(|(place, &i)| places[i] = place);
        below.iter().enumerate().for_each(|(place, &i)| places[i] = above.len() + MOST + place);
        let options = Options { reject_steps: false, max_step: FOLLOW * scenario.relief.max_step, ..options };
        // Supports stay where they were at the scenario's start, not where the first solution left them.
        let mut engine = Engine::new(model, &scenario.start, supports(), goals, &scenario.loads, options)?;
        lock(&mut engine);
        let mut whole = Self {
            engine,
            above: above.len(),
            places,
            slopes: vec![None; model.coordinates().len()],
            before: start.posture.clone(),
            calm: 0,
            asked: vec![],
            deferred: vec![],
        };
        // What stands at the very edge of its supports may be off balance by a hair.
        let mut posture = start.posture;
        match whole.catch(model, &mut posture)? {
            Some(missing) => Err(ScenarioError::CannotStand(missing)),
            None => {
                whole.forget();
                Ok((whole, posture))
            }
        }
    }

    /// Moves by one step toward the reliefs (the most tired first) and the tasks. Coordinates whose relief was not kept go to
    /// `deferred`. `pressing`: some relief asks for motion, not only to be kept.
    pub(super) fn carry_out(
        &mut self,
        posture: &mut Posture,
        reliefs: &[(usize, &HalfSpace)],
        pressing: bool,
        deferred: &mut Vec<usize>,
    ) -> Result<(), ScenarioError> {
        deferred.clear();
        self.before.values_mut().copy_from_slice(posture.values());
        if !pressing && self.still() && self.asked.iter().eq(reliefs.iter().map(|(i, _)| i)) {
            deferred.extend_from_slice(&self.deferred);
            return Ok(());
        }
        self.asked.clear();
        self.asked.extend(reliefs.iter().map(|(i, _)| *i));
        for (slot, goal) in self.engine.levels_mut()[self.above..self.above + MOST].iter_mut().enumerate() {
            goal.half_spaces.truncate(usize::from(slot < reliefs.len()));
            match (reliefs.get(slot), goal.half_spaces.first_mut()) {
                (Some((_, space)), Some(kept)) => kept.clone_from(space),
                (Some((_, space)), None) => goal.half_spaces.push((*space).clone()),
                _ => {}
            }
        }
        if pressing {
            self.engine.widen_trust_region();
        }
        let largest = self.engine.step(posture)?.largest;
        let before = if self.calm == CALM { 0 } else { self.calm };
        self.calm = if largest <= SLOW && !pressing { before + 1 } else { 0 };
        if self.calm > 0 && self.calm.is_multiple_of(SOON) && (largest <= STILL || self.engine.descend(posture)?) {
            self.calm = CALM;
        }
        let kept = |(slot, (_, space)): &(usize, &(usize, &HalfSpace))| {
            *slot < MOST && space.violation(posture.values()) <= MISSED
        };
        deferred.extend(reliefs.iter().enumerate().filter(|relief| !kept(relief)).map(|(_, (i, _))| *i));
        self.deferred.clone_from(deferred);
        Ok(())
    }

    /// Computes everything in a posture.
    pub(super) fn see(&mut self, posture: &Posture) -> Result<(), ScenarioError> {
        Ok(self.engine.evaluate(posture)?)
    }

    /// Goes back to where the last step began.
    pub(super) fn take_back(&mut self, posture: &mut Posture) -> Result<(), ScenarioError> {
        posture.values_mut().copy_from_slice(self.before.values());
        self.see(posture)
    }

    /// After an event: moves until the supports hold the body again, all at once, as a body does that meets a load it saw coming.
    /// Where no such posture is found `posture` stays, and what is missing there is told.
    pub(super) fn catch(&mut self, model: &Model, posture: &mut Posture) -> Result<Option<Missing>, ScenarioError> {
        self.see(posture)?;
        let missing = self.contact().missing(model, self.engine.body().kinematics());
        if missing.is_none() {
            return Ok(None);
        }
        self.before.values_mut().copy_from_slice(posture.values());
        for _ in 0..CATCHES {
            self.engine.step(posture)?;
            self.see(posture)?;
            if self.contact().balance() == Balance::Held {
                self.wake();
                return Ok(None);
            }
        }
        self.take_back(posture)?;
        Ok(missing)
    }

    /// Slope of a coordinate's external torque along the motion that everything above relief allows; `None` where it is held
    /// fast.
    pub(super) fn slope(
        &mut self,
        posture: &Posture,
        coordinate: usize,
        rate: usize,
    ) -> Result<Option<f64>, ScenarioError> {
        let far = |at: &Posture| at.values().iter().zip(posture.values()).any(|(a, b)| (a - b).abs() > MOVED);
        if let Some(slope) = self.slopes[coordinate].as_ref().filter(|slope| !far(&slope.at)) {
            return Ok(slope.value);
        }
        let value = self.engine.slope_along(posture, rate, self.above)?;
        self.slopes[coordinate] = Some(Slope { at: posture.clone(), value });
        Ok(value)
    }

    /// Forgets all that earlier steps have shown.
    pub(super) fn forget(&mut self) {
        self.engine.restart();
        self.calm = 0;
        self.slopes.fill(None);
    }

    /// Something changed: the body moves again.
    pub(super) fn wake(&mut self) {
        self.engine.widen_trust_region();
        self.calm = 0;
        self.slopes.fill(None);
    }

    pub(super) fn set_loads(&mut self, loads: &[crate::statics::Load]) -> Result<(), ScenarioError> {
        self.wake();
        Ok(self.engine.set_loads(loads)?)
    }

    pub(super) fn set_task(&mut self, task: usize, goal: &PriorityLevel) {
        self.wake();
        self.engine.levels_mut()[self.places[task]].clone_from(goal);
    }

    pub(super) fn still(&self) -> bool {
        self.calm == CALM
    }

    pub(super) fn contact(&self) -> &ContactForces {
        self.engine.contact()
    }

    /// External torque, contact included, and passive torque of a rate, N m.
    pub(super) fn torques(&self, rate: usize) -> (f64, f64) {
        self.engine.body().external_and_passive(rate)
    }

    pub(super) fn values(&self) -> &[f64] {
        self.engine.body().kinematics().values()
    }

    /// Length of the error of each of the scenario's tasks, and how far supports have slipped.
    pub(super) fn errors(&self, errors: &mut Vec<f64>) -> f64 {
        errors.clear();
        errors.extend(self.places.iter().map(|&place| self.engine.error(place)));
        self.engine.slip()
    }

    /// Where the centre of mass stands, ground, m.
    pub(super) fn center_of_mass(&self, model: &Model) -> Option<nalgebra::Vector3<f64>> {
        self.engine.body().kinematics().center_of_mass(model)
    }

    /// The couple of a support's forces about that point, ground, N m.
    pub(super) fn couple(&self, model: &Model, support: usize) -> nalgebra::Vector3<f64> {
        let contact = self.contact();
        let about = self.center_of_pressure(model, support).unwrap_or_default();
        let mut couple = nalgebra::Vector3::zeros();
        for load in &contact.loads()[contact.corners(support)] {
            if let LoadKind::Force(force, _) = load.kind {
                let at = self.engine.body().kinematics().station(model, load.segment, load.point);
                couple += (at - about).cross(&force);
            }
        }
        couple
    }

    /// Where the normal force of a support acts, ground, m.
    pub(super) fn center_of_pressure(&self, model: &Model, support: usize) -> Option<nalgebra::Vector3<f64>> {
        self.contact().center_of_pressure(model, self.engine.body().kinematics(), support)
    }
}
