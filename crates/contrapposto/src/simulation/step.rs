//! What happens in one time step?

use super::sample::{Contact, Relief, Sample, Standing};
use super::state::State;
use super::whole::Whole;
use super::{Event, Fall, Scenario, ScenarioError, Tables};
use crate::constraint::{HalfSpace, relief_step};
use crate::contact::Balance;
use crate::hybrid::{Problem, Strategy, minimise, minimise_literal};
use crate::joint_torques::{JointTorques, Quantities, active_torque, effort, relative_load};
use crate::model::Side;
use crate::statics::Load;

/// Motion below this size, rad or m, counts as none.
const SETTLED: f64 = 1e-6;

/// A scenario under way.
#[derive(Debug)]
pub struct Simulation<'a> {
    scenario: &'a Scenario,
    state: State,
    /// The body with supports or tasks.
    whole: Option<Whole<'a>>,
    loads: Vec<Load>,
    /// Of a body without supports and tasks.
    torques: JointTorques,
    // What the last sample showed, beside what is in `state`.
    external: Vec<f64>,
    passive: Vec<f64>,
    load: Vec<f64>,
    asking: Vec<Option<Side>>,
    reliefs: Vec<Option<Relief>>,
    standing: Standing,
    settled: bool,
    /// Active torque before the last motion.
    active_before: Vec<f64>,
    shift: Vec<f64>,
}

/// Relief may cost the whole body so many times the effort there was before it.
const DEAR: f64 = 2.0;

/// A relief that was taken back so often is tried the other way, and twice as often given up.
const PATIENCE: u32 = 3;

/// Places between a joint and its goal at which the torque that a decision foretells is looked at.
const ON_THE_WAY: u32 = 16;

impl<'a> Simulation<'a> {
    /// Ready for the first step.
    ///
    /// # Errors
    /// [`ScenarioError`] when the scenario is not in order.
    pub fn new(scenario: &'a Scenario) -> Result<Self, ScenarioError> {
        scenario.check()?;
        let (whole, start) = match scenario.is_whole() {
            true => Whole::new(scenario).map(|(whole, start)| (Some(whole), start))?,
            false => (None, scenario.start.clone()),
        };
        let strategies = match scenario.strategies.is_empty() {
            true => vec![scenario.strategy.kind; scenario.model.coordinates().len()],
            false => scenario.strategies.clone(),
        };
        let mut simulation = Self::with(scenario, whole, State::new(start, strategies));
        simulation.torques()?;
        for (i, coordinate) in scenario.model.coordinates().iter().enumerate() {
            let Some(groups) = &coordinate.groups else { continue };
            for side in Side::BOTH {
                let load = simulation.load_of(i, side);
                let level = scenario.start_fatigue[i][side.index()];
                let start = groups[side.index()].fatigue.start(level, load);
                simulation.state.groups[i][side.index()].fatigue = Some(start);
            }
        }
        Ok(simulation)
    }

    /// Where another simulation of the same scenario was when it was asked for its state.
    ///
    /// # Errors
    /// [`ScenarioError::Snapshot`] if the state is that of another body or run.
    pub(super) fn resume(scenario: &'a Scenario, state: State) -> Result<Self, ScenarioError> {
        scenario.check()?;
        let whole = match scenario.is_whole() {
            true => Some(Whole::new(scenario)?.0),
            false => None,
        };
        let n = scenario.model.coordinates().len();
        if !state.fits(n, scenario.events.len()) || state.posture.check(&scenario.model).is_err() {
            return Err(ScenarioError::Snapshot);
        }
        let events = state.next_event;
        let mut simulation = Self::with(scenario, whole, state.clone());
        for event in &scenario.events[..events] {
            simulation.happen(event)?;
        }
        simulation.state = state;
        Ok(simulation)
    }

    fn with(scenario: &'a Scenario, whole: Option<Whole<'a>>, state: State) -> Self {
        let model = &scenario.model;
        let n = model.coordinates().len();
        Self {
            scenario,
            state,
            whole,
            loads: scenario.loads.clone(),
            torques: JointTorques::new(model),
            external: vec![0.0; n],
            passive: vec![0.0; n],
            load: vec![0.0; n],
            asking: vec![None; n],
            reliefs: vec![None; n],
            standing: Standing::default(),
            settled: false,
            active_before: vec![0.0; n],
            shift: vec![0.0; n],
        }
    }

    /// What a simulation needs to go on from here. It goes on in the same way itself: all that only made it faster is forgotten.
    pub(super) fn state(&mut self) -> State {
        if let Some(whole) = &mut self.whole {
            whole.forget();
        }
        self.state.clone()
    }

    /// Torques, fatigue, hysteresis, minimisation, constraint, record, motion: once.
    ///
    /// # Errors
    /// For a scenario that was checked only [`ScenarioError::Falls`], and [`ScenarioError::Passive`] where a model file's own law
    /// gives no torque; the posture never leaves its ranges.
    pub fn step(&mut self) -> Result<Sample<'_>, ScenarioError> {
        let time = self.state.steps as f64 * self.scenario.run.step;
        self.events(time)?;
        self.torques()?;
        self.levels();
        self.decide()?;
        self.tire();
        self.state.steps += 1;
        // The motion is carried out at the start of the next step, so that the sample can be lent out as it is.
        Ok(Sample {
            time,
            posture: self.state.posture.values(),
            external: &self.external,
            passive: &self.passive,
            active: &self.state.active,
            load: &self.load,
            fatigue: &self.state.fatigue,
            decisions: &self.state.decisions,
            asking: &self.asking,
            reliefs: &self.reliefs,
            standing: self.whole.is_some().then_some(&self.standing),
            strategies: &self.state.strategies,
            settled: self.settled,
        })
    }

    /// What changes now. Falls if it throws the body off balance.
    fn events(&mut self, time: f64) -> Result<(), ScenarioError> {
        let scenario = self.scenario;
        let mut happened = false;
        while let Some(event) = scenario.events.get(self.state.next_event).filter(|event| event.time <= time + 1e-9) {
            self.state.next_event += 1;
            self.happen(event)?;
            happened = true;
        }
        let Some(whole) = self.whole.as_mut().filter(|_| happened) else { return Ok(()) };
        let missing = whole.catch(&self.scenario.model, &mut self.state.posture)?;
        missing.map_or(Ok(()), |missing| Err(ScenarioError::Falls(Fall { time, missing })))
    }

    fn happen(&mut self, event: &Event) -> Result<(), ScenarioError> {
        let elsewhere = event.loads.is_some() || !event.tasks.is_empty();
        let wishes = event.strategies.as_ref().unwrap_or(&self.state.strategies).clone();
        for (i, &wish) in wishes.iter().enumerate() {
            let wished = wish != self.state.strategies[i];
            // A new wish is a new recovery, and with another load or target what was too dear may pay.
            for group in &mut self.state.groups[i] {
                if wished {
                    (group.accepted, group.led) = (None, None);
                }
                if wished || elsewhere {
                    group.taken_back = 0;
                }
            }
            if wished || elsewhere {
                self.state.requests[i].followed = None;
            }
        }
        self.state.strategies = wishes;
        if elsewhere {
            // What effort was before does not say whether the next step is worth it.
            self.state.effort = f64::INFINITY;
        }
        if let Some(loads) = &event.loads {
            self.loads.clone_from(loads);
        }
        let Some(whole) = &mut self.whole else { return Ok(()) };
        if let Some(loads) = &event.loads {
            whole.set_loads(loads)?;
        }
        event.tasks.iter().for_each(|(task, goal)| whole.set_task(*task, goal));
        whole.wake();
        Ok(())
    }

    /// Moves to where the last decisions asked, then computes all torques there.
    fn torques(&mut self) -> Result<(), ScenarioError> {
        self.reliefs.fill(None);
        if self.whole.is_some() {
            return self.torques_of_the_whole();
        }
        let model = &self.scenario.model;
        self.active_before.copy_from_slice(&self.state.active);
        self.carry_out();
        self.torques.update(model, &self.state.posture, &self.loads, Quantities::TORQUES)?;
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            let torques = |rate: usize| self.torques.external_and_passive(rate);
            (self.external[i], self.passive[i]) = coordinate.rate.map_or((0.0, 0.0), torques);
        }
        self.weigh();
        for i in 0..self.reliefs.len() {
            let done = || self.done(i);
            self.reliefs[i] = self.state.decisions[i].is_some().then(done);
        }
        Ok(())
    }

    /// The relief of a coordinate, carried out.
    fn done(&self, i: usize) -> Relief {
        let real = self.state.active[i] - self.active_before[i];
        Relief::Done { predicted: self.state.requests[i].predicted, real }
    }

    /// Active torque and relative load of every coordinate; gives the effort.
    fn weigh(&mut self) -> f64 {
        for (i, coordinate) in self.scenario.model.coordinates().iter().enumerate() {
            self.state.active[i] = active_torque(self.external[i], self.passive[i]);
            self.load[i] = relative_load(coordinate, self.state.posture.values()[i], self.state.active[i]);
        }
        effort(&self.load)
    }

    /// As [`Simulation::torques`], through the priorities of the whole body. A step that lets the body fall, or makes the torque
    /// of a group that asked for relief larger than was foretold and effort with it, is taken back.
    fn torques_of_the_whole(&mut self) -> Result<(), ScenarioError> {
        let Some(mut whole) = self.whole.take() else { return Ok(()) };
        let asks = |i: &usize| self.state.decisions[*i].is_some() || self.state.requests[*i].held;
        let mut asked: Vec<usize> = (0..self.state.decisions.len()).filter(asks).collect();
        let tired = |i: &usize| self.state.fatigue[*i][0].max(self.state.fatigue[*i][1]);
        asked.sort_by(|a, b| tired(b).total_cmp(&tired(a)));
        let reliefs: Vec<(usize, &HalfSpace)> =
            asked.iter().map(|&i| (i, &self.state.requests[i].constraint)).collect();
        let mut deferred = vec![];
        whole.carry_out(&mut self.state.posture, &reliefs, self.state.pressing, &mut deferred)?;
        self.active_before.copy_from_slice(&self.state.active);
        let before = self.state.effort;
        let mut effort = self.look(&mut whole)?;
        let tolerance = self.scenario.relief.torque_tolerance;
        let fell = whole.contact().balance() != Balance::Held;
        // A passive goal may lie beyond a rise that the decision foretold.
        let rose = |i: usize| self.state.active[i].abs() > 1.5 * self.state.requests[i].foretold + tolerance;
        // Relief that costs the rest of the body more than it is worth is given back.
        let dear = |i: usize| effort > DEAR * self.state.requests[i].effort_at_trip;
        let worse = asked
            .iter()
            .copied()
            .filter(|&i| self.state.decisions[i].is_some() && (fell || ((rose(i) || dear(i)) && effort > before)));
        let worse: Vec<usize> = worse.collect();
        if fell || !worse.is_empty() {
            whole.take_back(&mut self.state.posture)?;
            effort = self.look(&mut whole)?;
        }
        for &i in asked.iter().filter(|&&i| self.state.decisions[i].is_some()) {
            self.reliefs[i] = Some(if worse.contains(&i) {
                let side = self.asking_side(i);
                self.state.groups[i][side.index()].taken_back += 1;
                Relief::TakenBack
            } else if deferred.contains(&i) || !worse.is_empty() {
                Relief::Deferred
            } else {
                self.done(i)
            });
        }
        self.stand(&whole, effort);
        self.whole = Some(whole);
        Ok(())
    }

    /// All torques where the body is; gives the effort.
    fn look(&mut self, whole: &mut Whole<'a>) -> Result<f64, ScenarioError> {
        whole.see(&self.state.posture)?;
        for (i, coordinate) in self.scenario.model.coordinates().iter().enumerate() {
            (self.external[i], self.passive[i]) = coordinate.rate.map_or((0.0, 0.0), |rate| whole.torques(rate));
        }
        Ok(self.weigh())
    }

    fn stand(&mut self, whole: &Whole<'a>, effort: f64) {
        let model = &self.scenario.model;
        let contact = whole.contact();
        self.standing.contacts.clear();
        self.standing.contacts.extend((0..contact.supports().len()).map(|support| Contact {
            force: contact.force(support),
            share: contact.share(support),
            center_of_pressure: whole.center_of_pressure(model, support),
            couple: whole.couple(model, support),
        }));
        self.standing.slip = whole.errors(&mut self.standing.errors);
        self.standing.center_of_mass = whole.center_of_mass(model).unwrap_or_default();
        (self.standing.effort, self.state.effort) = (effort, effort);
    }

    /// The group of a coordinate that asks for relief: the one that works if it is tired, else the other one.
    fn asking_side(&self, coordinate: usize) -> Side {
        let works = Side::of(self.active_before[coordinate]);
        if self.state.groups[coordinate][works.index()].recovering { works } else { Side::BOTH[1 - works.index()] }
    }

    /// Projects the posture into every half-space, free coordinates only, and into the ranges.
    fn carry_out(&mut self) {
        for (request, decision) in self.state.requests.iter().zip(&self.state.decisions) {
            if decision.is_some() {
                request.constraint.project(self.state.posture.values_mut(), &self.scenario.free);
            }
        }
        for (value, coordinate) in self.state.posture.values_mut().iter_mut().zip(self.scenario.model.coordinates()) {
            *value = value.clamp(coordinate.range.0, coordinate.range.1);
        }
    }

    /// Relative load of one group: the one that does not work rests.
    fn load_of(&self, coordinate: usize, side: Side) -> f64 {
        if side == Side::of(self.state.active[coordinate]) { self.load[coordinate] } else { 0.0 }
    }

    /// Fatigue now, and who must rest.
    fn levels(&mut self) {
        for i in 0..self.state.groups.len() {
            for side in Side::BOTH {
                let load = self.load_of(i, side);
                let group = &mut self.state.groups[i][side.index()];
                let Some(state) = group.fatigue else { continue };
                // Three-compartment fatigue is relative to the load. A recovering group is judged at the load that tired it:
                // taking the load off must not count as having rested (docs/deviations.md, D15).
                let judged = if group.recovering { load.max(group.load_at_trip) } else { load };
                let level = state.level(judged);
                self.state.fatigue[i][side.index()] = level;
                let recovering = self.scenario.hysteresis.recovering(group.recovering, level);
                if recovering && !group.recovering {
                    group.load_at_trip = load;
                } else if !recovering {
                    (group.accepted, group.led) = (None, None);
                    group.taken_back = 0;
                }
                group.recovering = recovering;
            }
        }
    }

    /// Asks the hybrid minimisation for every tired coordinate and builds its half-space.
    fn decide(&mut self) -> Result<(), ScenarioError> {
        let Scenario { model, strategy, relief, free, .. } = self.scenario;
        let mut asked = false;
        let mut moved = false;
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            self.state.decisions[i] = None;
            self.asking[i] = None;
            if !self.state.groups[i].iter().any(|group| group.recovering) {
                (self.state.requests[i].held, self.state.requests[i].followed) = (false, None);
            }
            let (Some(law), Some(rate), true) = (&coordinate.passive, coordinate.rate, free[i]) else { continue };
            // The group that works asks; within the tolerance neither does, and either may.
            let within = self.state.active[i].abs() <= relief.torque_tolerance;
            let works = Side::of(self.state.active[i]);
            let asks = |side: Side| self.state.groups[i][side.index()].recovering && (within || side == works);
            let Some(side) = [works, Side::BOTH[1 - works.index()]].into_iter().find(|&side| asks(side)) else {
                continue;
            };
            self.asking[i] = Some(side);
            let group = self.state.groups[i][side.index()];
            if group.taken_back >= 2 * PATIENCE {
                self.reliefs[i] = Some(Relief::GivenUp);
                self.state.requests[i].held = false;
                continue;
            }
            let angle = self.state.posture.values()[i];
            let (values, slope) = match &mut self.whole {
                Some(whole) => {
                    let Some(slope) = whole.slope(&self.state.posture, i, rate)? else {
                        self.reliefs[i] = Some(Relief::Blocked);
                        continue;
                    };
                    (whole.values(), slope)
                }
                None => {
                    let (kinematics, external) = (self.torques.kinematics(), self.torques.external_torque());
                    (kinematics.values(), external.own_slope(kinematics, model, rate))
                }
            };
            let Some(curve) = law.curve_at(i, values, coordinate.range) else { continue };
            let problem = Problem {
                curve: &curve,
                angle,
                external_torque: self.external[i],
                external_slope: slope,
                strategy: if group.taken_back >= PATIENCE { Strategy::Passive } else { self.state.strategies[i] },
                minimum_decrease_ratio: strategy.minimum_decrease_ratio,
                torque_tolerance: relief.torque_tolerance,
                accepted: group.accepted,
            };
            let decision = match relief.tables {
                Tables::Total => minimise(&problem),
                Tables::Literal => minimise_literal(&problem),
            };
            // Every number was checked with the scenario, and the posture is clamped to its ranges.
            let Ok(decision) = decision else { continue };
            asked = true;
            let decision = match (&self.whole, self.state.requests[i].followed) {
                (Some(_), Some(last)) if !self.state.groups[i][side.index()].believes(decision.outcome) => last,
                _ => decision,
            };
            if self.state.requests[i].followed.is_none() {
                self.state.requests[i].effort_at_trip = self.state.effort;
            }
            self.state.requests[i].followed = Some(decision);
            self.state.groups[i][side.index()].accept(decision.outcome);
            self.shift.fill(0.0);
            self.state.requests[i].predicted = 0.0;
            self.state.requests[i].foretold = self.state.active[i].abs();
            if let Some(goal) = decision.goal {
                for share in 1..=ON_THE_WAY {
                    let way = (goal - angle) * f64::from(share) / f64::from(ON_THE_WAY);
                    let active = curve.torque(angle + way) + self.external[i] + slope * way;
                    self.state.requests[i].foretold = self.state.requests[i].foretold.max(active.abs());
                }
                let gain = relief.step_gain * 0.5f64.powi(group.taken_back.min(30) as i32);
                self.shift[i] = relief_step(goal, angle, gain, relief.max_step);
                self.state.requests[i].predicted = -(curve.slope(angle) + slope) * self.shift[i];
                moved |= self.shift[i].abs() > SETTLED;
            }
            // Where it is relieved it stays for as long as it recovers, whatever less important tasks would like.
            if self.whole.is_none() || !self.state.requests[i].held || self.shift[i].abs() > SETTLED {
                self.state.requests[i].held =
                    self.state.requests[i].constraint.ask_for(self.state.posture.values(), &self.shift);
            }
            self.state.decisions[i] = Some(decision);
        }
        self.state.pressing = moved;
        self.settled = asked && !moved && self.whole.as_ref().is_none_or(Whole::still);
        Ok(())
    }

    /// One time step of load on every muscle group.
    fn tire(&mut self) {
        let step = self.scenario.run.step;
        for (i, coordinate) in self.scenario.model.coordinates().iter().enumerate() {
            let Some(groups) = &coordinate.groups else { continue };
            for side in Side::BOTH {
                let load = self.load_of(i, side);
                let group = &mut self.state.groups[i][side.index()];
                group.fatigue = group.fatigue.map(|state| groups[side.index()].fatigue.advance(state, load, step));
            }
        }
    }
}
