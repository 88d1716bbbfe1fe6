//! Advances a scenario by one time step (Rodriguez & Boulic 2007, section 3).

use super::motion::Motion;
use super::prediction::Prediction;
use super::sample::{Record, Relief, Sample};
use super::state::State;
use super::{Event, Fall, Scenario, ScenarioError, Tables};
use crate::contact::Balance;
use crate::hybrid::{Problem, Strategy, minimise, minimise_literal};
use crate::joint_torques::{active_torque, effort, relative_load};
use crate::model::Side;

/// A step of relief below this size, rad, counts as none.
const SMALLEST_STEP: f64 = 1e-6;
/// An event is due when it is no later than this after the step's time, s.
pub(super) const TIME_TOLERANCE: f64 = 1e-9;
/// A motion for relief may raise effort to so many times the effort at the start of the recovery.
const EFFORT_LIMIT: f64 = 2.0;
/// A motion for relief may raise active torque to so many times its predicted peak.
const PEAK_LIMIT: f64 = 1.5;
/// After so many rejected motions a relief follows the passive strategy,
const REJECTIONS_BEFORE_PASSIVE: u32 = 3;
/// and after so many it waits for the next recovery.
const REJECTIONS_BEFORE_END: u32 = 6;

/// A scenario under way.
#[derive(Debug)]
pub struct Simulation<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) state: State,
    pub(super) motion: Motion<'a>,
    pub(super) record: Record,
    /// Values of the posture and active torque before the last motion.
    values_before: Vec<f64>,
    active_before: Vec<f64>,
    /// The step that relief requests of one coordinate, one entry a coordinate, rad.
    relief_step: Vec<f64>,
}

impl<'a> Simulation<'a> {
    /// Ready for the first step.
    ///
    /// # Errors
    /// [`ScenarioError`] when the scenario is not in order.
    pub fn new(scenario: &'a Scenario) -> Result<Self, ScenarioError> {
        scenario.check()?;
        let (mut motion, mut start) = (Motion::new(scenario, &scenario.start)?, scenario.start.clone());
        let mut searched = 0;
        if let Some(body) = motion.body_mut() {
            (start, searched) = body.start()?;
        }
        let strategies = match scenario.strategies.is_empty() {
            true => vec![scenario.strategy.kind; scenario.model.coordinates().len()],
            false => scenario.strategies.clone(),
        };
        let mut simulation = Self::with(scenario, motion, State { searched, ..State::new(start, strategies) });
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
        Ok(simulation)
    }

    /// From the state of another simulation of the same scenario.
    ///
    /// # Errors
    /// [`ScenarioError::Snapshot`] if the state is that of another body or run.
    pub(super) fn resume(scenario: &'a Scenario, state: State) -> Result<Self, ScenarioError> {
        scenario.check()?;
        let n = scenario.model.coordinates().len();
        let postures = [Some(&state.posture), state.placed_at.as_ref()];
        let fit = postures.iter().flatten().all(|posture| posture.check(&scenario.model).is_ok());
        if !fit || !state.fits(n, scenario.supports.len(), scenario.events.len()) {
            return Err(ScenarioError::Snapshot);
        }
        let motion = Motion::new(scenario, state.placed_at.as_ref().unwrap_or(&scenario.start))?;
        let events = state.next_event;
        let mut simulation = Self::with(scenario, motion, state.clone());
        for event in &scenario.events[..events] {
            simulation.apply(event)?;
        }
        simulation.state = state;
        Ok(simulation)
    }

    fn with(scenario: &'a Scenario, motion: Motion<'a>, state: State) -> Self {
        let n = scenario.model.coordinates().len();
        Self {
            scenario,
            state,
            motion,
            record: Record::new(n),
            values_before: vec![0.0; n],
            active_before: vec![0.0; n],
            relief_step: vec![0.0; n],
        }
    }

    /// The state from which another simulation goes on to the same numbers as this one. Whatever only makes this one faster is
    /// forgotten.
    pub(super) fn state(&mut self) -> State {
        self.motion.forget();
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
            external: &self.record.external,
            passive: &self.record.passive,
            active: &self.state.active,
            load: &self.record.load,
            fatigue: &self.state.fatigue,
            decisions: &self.state.decisions,
            asking: &self.record.asking,
            reliefs: &self.record.reliefs,
            standing: self.motion.body().map(|_| &self.record.standing),
            strategies: &self.state.strategies,
            settled: self.record.settled,
        })
    }

    fn advance(&mut self, time: f64) -> Result<(), ScenarioError> {
        self.apply_events(time)?;
        self.carry_out_reliefs()?;
        self.update_fatigue();
        self.decide()?;
        self.load_groups();
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
        let effort_before = self.state.effort;
        let Some(body) = self.motion.body_mut() else { return Ok(()) };
        body.step(&mut self.state.posture, &requested, &self.state.requests, self.state.reliefs_move)?;
        let deferred = body.deferred().to_vec();
        let mut effort = self.evaluate()?;
        let falls = self.motion.body().is_some_and(|body| body.contact().balance() != Balance::Held);
        let decided: Vec<usize> = requested.into_iter().filter(|&i| self.state.decisions[i].is_some()).collect();
        let rejected = |i: &&usize| falls || (effort > effort_before && self.costs_too_much(**i, effort));
        let rejected: Vec<usize> = decided.iter().filter(rejected).copied().collect();
        if falls || !rejected.is_empty() {
            if let Some(body) = self.motion.body() {
                body.take_back(&mut self.state.posture);
            }
            effort = self.evaluate()?;
        }
        for i in decided {
            self.record.reliefs[i] = Some(if rejected.contains(&i) {
                let side = self.tired_side(i);
                self.state.groups[i][side.index()].rejections += 1;
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
        (self.record.standing.effort, self.state.effort) = (effort, effort);
        Ok(())
    }

    /// Whether the torque of a coordinate is far above its predicted peak (a passive goal may lie beyond a rise, which is
    /// predicted), or the effort far above that at the start of its recovery.
    fn costs_too_much(&self, i: usize, effort: f64) -> bool {
        let request = &self.state.requests[i];
        let tolerance = self.scenario.relief.torque_tolerance;
        self.state.active[i].abs() > PEAK_LIMIT * request.predicted_peak + tolerance
            || effort > EFFORT_LIMIT * request.effort_at_start
    }

    /// The relief of a coordinate, carried out.
    fn done(&self, i: usize) -> Relief {
        let actual = self.state.active[i] - self.active_before[i];
        Relief::Done { predicted: self.state.requests[i].predicted_change, actual }
    }

    /// The group that requested the last motion of a coordinate: the working one if it recovers, else the other one.
    fn tired_side(&self, coordinate: usize) -> Side {
        let working = Side::of(self.active_before[coordinate]);
        let recovers = self.state.groups[coordinate][working.index()].recovering;
        if recovers { working } else { Side::BOTH[1 - working.index()] }
    }

    /// Computes torques and relative loads in the present posture; gives the effort.
    pub(super) fn evaluate(&mut self) -> Result<f64, ScenarioError> {
        self.motion.update(&self.state.posture)?;
        let torques = self.motion.torques();
        for (i, coordinate) in self.scenario.model.coordinates().iter().enumerate() {
            let of_rate = |rate| torques.external_and_passive(rate);
            let (external, passive) = coordinate.rate.map_or((0.0, 0.0), of_rate);
            (self.record.external[i], self.record.passive[i]) = (external, passive);
            self.state.active[i] = active_torque(external, passive);
            self.record.load[i] = relative_load(coordinate, torques.angles()[i], self.state.active[i]);
        }
        Ok(effort(&self.record.load))
    }

    /// Relative load of one group; 0 for the one that does not work.
    fn group_load(&self, coordinate: usize, side: Side) -> f64 {
        if side == Side::of(self.state.active[coordinate]) { self.record.load[coordinate] } else { 0.0 }
    }

    /// Fatigue of every group under its present load, and the recoveries that begin or end.
    fn update_fatigue(&mut self) {
        for i in 0..self.state.groups.len() {
            for side in Side::BOTH {
                let load = self.group_load(i, side);
                let group = &mut self.state.groups[i][side.index()];
                let Some(fatigue) = group.fatigue else { continue };
                // Three-compartment fatigue is relative to the load. A recovering group is judged at the load that tired it:
                // taking the load off must not count as having rested (docs/deviations.md, D15).
                let judged = if group.recovering { load.max(group.load_at_start) } else { load };
                let level = fatigue.level(judged);
                self.state.fatigue[i][side.index()] = level;
                group.set_recovering(self.scenario.hysteresis.recovering(group.recovering, level), load);
            }
        }
    }

    /// Decides anew for every free coordinate whose working group recovers ([`State::requesting_side`]), and notes whether any
    /// relief still moves. The others have no decision; a request ends only when no group of its coordinate recovers.
    fn decide(&mut self) -> Result<(), ScenarioError> {
        let (mut decided, mut moves) = (false, false);
        for i in 0..self.state.decisions.len() {
            self.state.decisions[i] = None;
            self.record.asking[i] = None;
            if !self.state.groups[i].iter().any(|group| group.recovering) {
                self.state.requests[i].end();
                self.state.step_tried[i] = false;
            }
            if self.state.path.is_some() {
                continue;
            }
            let coordinate = &self.scenario.model.coordinates()[i];
            if coordinate.passive.is_none() || coordinate.rate.is_none() || !self.scenario.free[i] {
                continue;
            }
            let Some(side) = self.state.requesting_side(i, self.scenario.relief.torque_tolerance) else { continue };
            self.record.asking[i] = Some(side);
            if let Some(step) = self.decide_for(i, side)? {
                decided = true;
                moves |= step.abs() > SMALLEST_STEP;
            }
            if let Some(decision) = self.state.decisions[i] {
                self.look_for_step(i, side, &decision)?;
            }
        }
        self.state.reliefs_move = moves;
        self.state.searched_here &= !moves;
        self.look_for_ease()?;
        let still = self.state.path.is_none() && self.motion.is_at_rest();
        self.record.settled = decided && !moves && still;
        Ok(())
    }

    /// Stores the decision that one group follows (on a body the last one until a new one is confirmed) and requests its step,
    /// which the next time step carries out. Gives that step, rad, zero without a goal; `None` without a decision: given up,
    /// which lets the half-space go, blocked, which keeps it (both replace the recorded outcome of the last motion), or a
    /// passive law without a falling curve.
    fn decide_for(&mut self, i: usize, side: Side) -> Result<Option<f64>, ScenarioError> {
        let Scenario { model, strategy, relief, .. } = self.scenario;
        let coordinate = &model.coordinates()[i];
        let Some(rate) = coordinate.rate else { return Ok(None) };
        let group = self.state.groups[i][side.index()];
        if group.rejections >= REJECTIONS_BEFORE_END {
            self.record.reliefs[i] = Some(Relief::GivenUp);
            self.state.requests[i].in_force = false;
            return Ok(None);
        }
        let Some(external_slope) = self.motion.external_slope(&self.state.posture, i, rate)? else {
            self.record.reliefs[i] = Some(Relief::Blocked);
            return Ok(None);
        };
        let (passive_torque, kinematics) = (self.motion.torques().passive_torque(), self.motion.torques().kinematics());
        let Some(curve) = passive_torque.curve_about_axis(model, kinematics, i, coordinate.range) else {
            return Ok(None);
        };
        let passive = group.rejections >= REJECTIONS_BEFORE_PASSIVE;
        let problem = Problem {
            curve: &curve,
            angle: passive_torque.angles()[i],
            external_torque: self.record.external[i],
            external_slope,
            strategy: if passive { Strategy::Passive } else { self.state.strategies[i] },
            minimum_decrease_ratio: strategy.minimum_decrease_ratio,
            torque_tolerance: relief.torque_tolerance,
            accepted: group.accepted,
        };
        let decision = match relief.tables {
            Tables::Total => minimise(&problem),
            Tables::Literal => minimise_literal(&problem),
        };
        // Every number was checked with the scenario, and the posture is clamped to its ranges.
        let Ok(decision) = decision else { return Ok(None) };
        let is_body = self.motion.body().is_some();
        let decision = self.state.follow(i, side, decision, is_body);
        let prediction = Prediction::new(&problem, &decision, self.state.active[i], relief, group.rejections);
        self.request(i, &prediction, is_body);
        self.state.decisions[i] = Some(decision);
        Ok(Some(prediction.step))
    }

    /// Requests the step of a prediction of coordinate `i`.
    fn request(&mut self, i: usize, prediction: &Prediction, is_body: bool) {
        let request = &mut self.state.requests[i];
        (request.predicted_change, request.predicted_peak) = (prediction.change, prediction.peak);
        // On a body a half-space stays as long as its group recovers, whatever less important tasks ask for.
        if !is_body || !request.in_force || prediction.step.abs() > SMALLEST_STEP {
            let model = &self.scenario.model;
            self.motion.torques().write_turn(model, i, prediction.step, &mut self.relief_step);
            request.in_force = request.half_space.ask_for(self.state.posture.values(), &self.relief_step);
        }
    }

    /// Loads every muscle group for one time step.
    fn load_groups(&mut self) {
        let step = self.scenario.run.step;
        for (i, coordinate) in self.scenario.model.coordinates().iter().enumerate() {
            let Some(groups) = &coordinate.groups else { continue };
            for side in Side::BOTH {
                let load = self.group_load(i, side);
                let group = &mut self.state.groups[i][side.index()];
                group.fatigue = group.fatigue.map(|state| groups[side.index()].fatigue.advance(state, load, step));
            }
        }
    }
}
