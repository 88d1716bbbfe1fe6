//! Advances a scenario by one time step (Rodriguez & Boulic 2007, section 3).

use super::easiest::{Eased, Searched};
use super::foot_step::Changes;
use super::motion::Motion;
use super::muscle_course::{MuscleCourse, MuscleState};
use super::path::Path;
use super::sample::{Attempt, Record, Relief, Sample};
use super::state::State;
use super::strength::PosedStrength;
use super::{Event, Fall, Scenario, ScenarioError};
use crate::contact::Balance;
use crate::joint_torques::{active_torque, effort, relative_load};
use crate::model::{SharedModel, Side};

/// A step of relief below this size, rad, counts as none.
pub(super) const SMALLEST_STEP: f64 = 1e-6;
/// An event is due when it is no later than this after the step's time, s.
pub(super) const TIME_TOLERANCE: f64 = 1e-9;
/// A motion for relief may raise active torque to so many times its predicted peak.
const PEAK_LIMIT: f64 = 1.5;

/// A scenario under way.
#[derive(Debug)]
pub struct Simulation<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) state: State,
    pub(super) motion: Motion<'a>,
    /// The body, with the strength of its present posture.
    pub(super) model: SharedModel<'a>,
    /// For a body with muscles.
    pub(super) strength: Option<PosedStrength>,
    pub(super) tiring: Option<MuscleCourse>,
    pub(super) record: Record,
    /// Postures after a change of a support that a search of this time step has found: several tired groups may ask for one.
    pub(super) changes: Option<Changes>,
    /// Values of the posture and active torque before the last motion.
    values_before: Vec<f64>,
    pub(super) active_before: Vec<f64>,
    /// The step that relief requests of one coordinate, one entry a coordinate, rad.
    pub(super) relief_step: Vec<f64>,
}

impl<'a> Simulation<'a> {
    /// Ready for the first step.
    ///
    /// # Errors
    /// [`ScenarioError`] when the scenario is not in order.
    pub fn new(scenario: &'a Scenario) -> Result<Self, ScenarioError> {
        scenario.check()?;
        let strategies = match scenario.strategies.is_empty() {
            true => vec![scenario.strategy.kind; scenario.model.coordinates().len()],
            false => scenario.strategies.clone(),
        };
        let mut simulation =
            Self::with(scenario, State::new(scenario.start.clone(), strategies, scenario.supports_at_start().len()))?;
        if let Some(body) = simulation.motion.body_mut() {
            let Searched { found, minima, work, cut } = body.start()?;
            simulation.state.minima = minima;
            let asked = vec![false; simulation.state.requests.len()];
            simulation.state.eased = Some(Eased { posture: found.clone(), asked });
            (simulation.state.posture, simulation.state.searched, simulation.state.search_cut) = (found, work, cut);
        }
        simulation.carry_out_reliefs()?;
        for (i, coordinate) in scenario.model.coordinates().iter().enumerate() {
            let Some(groups) = &coordinate.groups else { continue };
            for side in Side::BOTH {
                let load = simulation.group_load(i, side);
                let level = scenario.start_fatigue[i][side.index()];
                let start = groups[side.index()].fatigue.start(level, load);
                simulation.state.groups[i][side.index()].fatigue = Some(start);
            }
        }
        simulation.begin_muscles()?;
        Ok(simulation)
    }

    /// From the state of another simulation of the same scenario.
    ///
    /// # Errors
    /// [`ScenarioError::Snapshot`] if the state is that of another body or run.
    pub(super) fn resume(scenario: &'a Scenario, state: State) -> Result<Self, ScenarioError> {
        scenario.check()?;
        let n = scenario.model.coordinates().len();
        let eased = state.eased.as_ref().map(|eased| &eased.posture);
        let postures = [Some(&state.posture), state.placed_at.as_ref(), eased];
        let fit =
            postures.into_iter().flatten().chain(&state.minima).all(|posture| posture.check(&scenario.model).is_ok());
        if !fit || !state.fits(n, scenario.supports.len(), scenario.events.len()) {
            return Err(ScenarioError::Snapshot);
        }
        let events = state.next_event;
        let mut simulation = Self::with(scenario, state.clone())?;
        for event in &scenario.events[..events] {
            simulation.apply(event)?;
        }
        simulation.motion.forget();
        simulation.state = state;
        match (&mut simulation.tiring, &simulation.state.muscles) {
            (Some(course), Some(muscles)) if muscles.fits(course) => course.resume(muscles),
            (None, None) => {}
            _ => return Err(ScenarioError::Snapshot),
        }
        Ok(simulation)
    }

    fn with(scenario: &'a Scenario, state: State) -> Result<Self, ScenarioError> {
        let n = scenario.model.coordinates().len();
        let mut strength = scenario.muscles.clone().map(PosedStrength::new);
        let model = match &mut strength {
            Some(strength) => strength.pose(&scenario.model, &state.posture)?.map(SharedModel::from),
            None => None,
        };
        let model = model.unwrap_or(SharedModel::Borrowed(&scenario.model));
        let placed_at = state.placed_at.as_ref().unwrap_or(&scenario.start);
        Ok(Self {
            motion: Motion::new(scenario, model.clone(), placed_at, &state.in_use)?,
            scenario,
            state,
            model,
            strength,
            tiring: MuscleCourse::of(scenario)?,
            record: Record::new(n),
            changes: None,
            values_before: vec![0.0; n],
            active_before: vec![0.0; n],
            relief_step: vec![0.0; n],
        })
    }

    /// Solver steps of all searches so far.
    pub(super) fn searched(&self) -> usize {
        self.state.searched
    }

    /// The state from which another simulation goes on to the same numbers as this one. Data that only make this one faster
    /// are forgotten.
    pub(super) fn state(&mut self) -> State {
        self.motion.forget();
        if let (Some(course), Some(muscles)) = (&mut self.tiring, &self.state.muscles) {
            course.resume(muscles);
        }
        self.state.clone()
    }

    /// One time step: events, the motion that the decisions of the step before requested, torques, fatigue and hysteresis,
    /// minimisation and constraints, time under load. The sample shows torques and decisions in the same posture.
    ///
    /// # Errors
    /// For a scenario that was checked only [`ScenarioError::Falls`], and [`ScenarioError::Torques`] where a model file's own law
    /// gives no torque; the posture never leaves its ranges. After an error the posture is that of the last sample, and an event
    /// that could not be withstood is still to come.
    pub fn step(&mut self) -> Result<Sample<'_>, ScenarioError> {
        let time = self.state.steps as f64 * self.scenario.run.step;
        self.values_before.copy_from_slice(self.state.posture.values());
        let next_event = self.state.next_event;
        if let Err(error) = self.advance(time) {
            self.state.posture.values_mut().copy_from_slice(&self.values_before);
            self.state.next_event = next_event;
            self.motion.forget();
            return Err(error);
        }
        Ok(Sample {
            time,
            posture: self.state.posture.values(),
            angles: &self.record.angles,
            external: &self.record.external,
            passive: &self.record.passive,
            active: &self.state.active,
            load: &self.record.load,
            group_load: &self.record.group_load,
            fatigue: &self.state.fatigue,
            muscles: self.state.muscles.as_ref().map_or(&[], MuscleState::muscles),
            exhausted: &self.record.exhausted,
            seconds_left: &self.record.seconds_left,
            stepping: self.record.stepping,
            decisions: &self.state.decisions,
            asking: &self.record.asking,
            attempts: &self.record.attempts,
            reliefs: &self.record.reliefs,
            standing: self.motion.body().map(|_| &self.record.standing),
            strategies: &self.state.strategies,
            settled: self.record.settled,
        })
    }

    fn advance(&mut self, time: f64) -> Result<(), ScenarioError> {
        self.apply_events(time)?;
        self.record.stepping = self.state.path.as_ref().is_some_and(Path::has_step);
        self.carry_out_reliefs()?;
        self.update_fatigue();
        self.decide()?;
        self.load_groups()?;
        self.state.steps += 1;
        Ok(())
    }

    /// Applies the events that are due, and recovers the balance of a body on supports.
    fn apply_events(&mut self, time: f64) -> Result<(), ScenarioError> {
        let scenario = self.scenario;
        let due = |event: &&Event| event.time <= time + TIME_TOLERANCE;
        let first = self.state.next_event;
        while let Some(event) = scenario.events.get(self.state.next_event).filter(due) {
            self.state.next_event += 1;
            self.apply(event)?;
        }
        if self.state.next_event > first {
            self.end_path_at_once()?;
        }
        let Some(body) = self.motion.body_mut().filter(|_| self.state.next_event > first) else { return Ok(()) };
        let missing = body.recover_balance(&mut self.state.posture)?;
        missing.map_or(Ok(()), |missing| Err(ScenarioError::Falls(Fall { time, missing })))
    }

    fn apply(&mut self, event: &Event) -> Result<(), ScenarioError> {
        self.state.apply(event);
        self.motion.apply(event)
    }

    /// Moves as the last decisions requested, and computes all torques in the posture reached.
    fn carry_out_reliefs(&mut self) -> Result<(), ScenarioError> {
        self.record.reliefs.fill(None);
        self.active_before.copy_from_slice(&self.state.active);
        match &self.motion {
            Motion::Body(_) => self.move_body(),
            Motion::Joints(joints) => {
                joints.step(&mut self.state);
                self.evaluate()?;
                for i in 0..self.record.reliefs.len() {
                    self.record.reliefs[i] = self.state.decisions[i].is_some().then(|| self.done(i));
                }
                Ok(())
            }
        }
    }

    /// Moves the body by its priorities. A motion after which the supports do not hold the body, or that makes relief cost more
    /// than predicted, is taken back.
    fn move_body(&mut self) -> Result<(), ScenarioError> {
        if self.follow_path()? {
            return Ok(());
        }
        let requested = self.state.requested();
        let Some(body) = self.motion.body_mut() else { return Ok(()) };
        body.step(&mut self.state.posture, &requested, &self.state.requests, self.state.reliefs_move)?;
        let deferred = body.deferred().to_vec();
        let mut effort = self.evaluate()?;
        let falls = self.motion.body().is_some_and(|body| body.contact().balance() != Balance::Held);
        let rejected = self.rejected(&requested, falls, effort);
        if falls || !rejected.is_empty() {
            if let Some(body) = self.motion.body() {
                body.take_back(&mut self.state.posture);
            }
            effort = self.evaluate()?;
        }
        for i in requested {
            let request = &mut self.state.requests[i];
            let (side, is_kept) = (request.side, request.step.is_none());
            if is_kept {
                request.in_force &= !rejected.contains(&i);
                continue;
            }
            self.record.reliefs[i] = Some(if rejected.contains(&i) {
                if let Some(side) = side {
                    self.state.groups[i][side.index()].rejections += 1;
                }
                Relief::TakenBack
            } else if deferred.contains(&i) || !rejected.is_empty() {
                Relief::Deferred
            } else {
                self.done(i)
            });
        }
        if let Some(body) = self.motion.body() {
            body.write_standing(&mut self.record.standing);
        }
        (self.record.standing.effort, self.state.effort) = (effort, Some(effort));
        Ok(())
    }

    /// The reliefs for which the last motion is taken back, of the `requested` ones. Where the supports do not hold the body, or where
    /// effort has risen and is far above that before all present reliefs, these are the reliefs that move, or all if none moves.
    fn rejected(&self, requested: &[usize], falls: bool, effort: f64) -> Vec<usize> {
        let moves = |i: usize| self.state.requests[i].step.is_some_and(|step| step.abs() > SMALLEST_STEP);
        let some_move = requested.iter().any(|&i| moves(i));
        let rises = self.state.effort.is_some_and(|before| effort > before);
        let limit = self.state.effort_at_start.map(|start| self.scenario.relief.effort_factor * start);
        let too_high = limit.is_some_and(|limit| effort > limit);
        let costs = |i: usize| {
            ((falls || (rises && too_high)) && (moves(i) || !some_move)) || (moves(i) && self.is_in_vain(i, rises))
        };
        requested.iter().copied().filter(|&i| costs(i)).collect()
    }

    /// Whether a motion has made the torque of a coordinate far greater than its predicted peak while effort `rises` (a passive goal
    /// may lie beyond a rise, which is predicted), or, as a motion of another joint, has not lowered it.
    fn is_in_vain(&self, i: usize, rises: bool) -> bool {
        let request = &self.state.requests[i];
        let (torque, before) = (self.state.active[i].abs(), self.active_before[i].abs());
        let peak = PEAK_LIMIT * request.predicted_peak + self.scenario.relief.torque_tolerance;
        let attempt = request.side.map(|side| self.state.groups[i][side.index()].attempt);
        (rises && torque > peak) || (torque >= before && matches!(attempt, Some(Attempt::OtherJoint { .. })))
    }

    /// The relief of a coordinate, carried out.
    fn done(&self, i: usize) -> Relief {
        let actual = self.state.active[i] - self.active_before[i];
        Relief::Done { predicted: self.state.requests[i].predicted_change, actual }
    }

    /// Computes torques and relative loads in the present posture; gives the effort.
    pub(super) fn evaluate(&mut self) -> Result<f64, ScenarioError> {
        let posed = self.strength.as_mut().map(|strength| strength.pose(&self.scenario.model, &self.state.posture));
        if let Some(model) = posed.transpose()?.flatten() {
            self.model = model.into();
            self.motion.set_model(&self.model);
        }
        self.motion.update(&self.state.posture)?;
        let torques = self.motion.torques();
        for (i, coordinate) in self.model.coordinates().iter().enumerate() {
            let of_rate = |rate| torques.external_and_passive(rate);
            let (external, passive) = coordinate.rate.map_or((0.0, 0.0), of_rate);
            (self.record.external[i], self.record.passive[i]) = (external, passive);
            self.state.active[i] = active_torque(external, passive);
            self.record.angles[i] = torques.angles()[i];
            self.record.load[i] = relative_load(coordinate, torques.angles()[i], self.state.active[i]);
        }
        Ok(effort(&self.record.load))
    }

    /// Relative load of one group; 0 for the one that does not work.
    pub(super) fn group_load(&self, coordinate: usize, side: Side) -> f64 {
        if side == Side::of(self.state.active[coordinate]) { self.record.load[coordinate] } else { 0.0 }
    }

    /// Fatigue of every group under its present load, and the recoveries that begin or end.
    fn update_fatigue(&mut self) {
        let stepping = self.state.path.as_ref().is_some_and(Path::has_step);
        for i in 0..self.state.groups.len() {
            let of_muscles = self.groups_of_muscles(i);
            for side in Side::BOTH {
                let mut load = self.group_load(i, side);
                let group = &mut self.state.groups[i][side.index()];
                if let Some(groups) = of_muscles {
                    let (fatigue, share) = groups[side.index()];
                    (group.fatigue, load) = (Some(fatigue), share);
                }
                let Some(fatigue) = group.fatigue else { continue };
                self.record.group_load[i][side.index()] = load;
                // Three-compartment fatigue is relative to the load. A recovering group is judged at the load that tired it:
                // taking the load off must not count as having rested (docs/deviations.md, D15).
                let judged = if group.recovering { load.max(group.load_at_start) } else { load };
                let level = fatigue.level(judged);
                self.state.fatigue[i][side.index()] = level;
                let present = fatigue.level(load);
                self.record.exhausted[i][side.index()] = present >= 1.0;
                let law =
                    self.scenario.model.coordinates()[i].groups.as_ref().map(|groups| &groups[side.index()].fatigue);
                self.record.seconds_left[i][side.index()] =
                    law.map_or(f64::INFINITY, |law| law.time_left(present, load));
                // Nor is a group judged by the load of a second on one leg: it would be tired until it could bear that again.
                if !stepping {
                    group.set_recovering(self.scenario.hysteresis.recovering(group.recovering, level), load);
                }
            }
        }
    }

    /// Loads every muscle group for one time step.
    fn load_groups(&mut self) -> Result<(), ScenarioError> {
        let step = self.scenario.run.step;
        for (i, coordinate) in self.scenario.model.coordinates().iter().enumerate() {
            let Some(groups) = &coordinate.groups else { continue };
            for side in Side::BOTH {
                let load = self.group_load(i, side);
                let group = &mut self.state.groups[i][side.index()];
                group.fatigue = group.fatigue.map(|state| groups[side.index()].fatigue.advance(state, load, step));
            }
        }
        self.load_muscles()
    }
}
