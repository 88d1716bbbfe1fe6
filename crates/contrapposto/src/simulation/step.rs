//! What happens in one time step?

use super::{Scenario, ScenarioError, Tables};
use crate::constraint::{HalfSpace, relief_step};
use crate::fatigue::FatigueState;
use crate::hybrid::{Decision, Outcome, Problem, Strategy, minimise, minimise_literal};
use crate::kinematics::Kinematics;
use crate::model::Side;
use crate::posture::Posture;
use crate::statics::ExternalTorque;

/// Motion below this size, rad or m, counts as none.
const SETTLED: f64 = 1e-6;

/// One instant. Torques and decisions belong to the posture shown, which is the one before the step's motion.
#[derive(Debug)]
pub struct Sample<'a> {
    /// Time, s.
    pub time: f64,
    /// Value of every coordinate, rad or m.
    pub posture: &'a [f64],
    /// External torque of every coordinate, N m (N for slides). Depends on posture and loads.
    pub external: &'a [f64],
    /// Passive torque of every coordinate. Depends on posture.
    pub passive: &'a [f64],
    /// Active torque, `-(passive + external)` (Eq. 1).
    pub active: &'a [f64],
    /// |Active torque| over the strength of the group that works, of every coordinate; 0 where strength is not known.
    pub load: &'a [f64],
    /// Fatigue of the positive and negative group of every coordinate, 0..=1. Depends on the load so far.
    pub fatigue: &'a [[f64; 2]],
    /// The decision of every coordinate that asked for relief.
    pub decisions: &'a [Option<Decision>],
    /// Relief was asked for, and moves nothing any more.
    pub settled: bool,
}

/// A scenario under way.
#[derive(Debug)]
pub struct Simulation<'a> {
    scenario: &'a Scenario,
    steps: u64,
    posture: Posture,
    kinematics: Kinematics,
    external_torque: ExternalTorque,
    groups: Vec<[GroupState; 2]>,
    // What the last sample showed.
    external: Vec<f64>,
    passive: Vec<f64>,
    active: Vec<f64>,
    load: Vec<f64>,
    fatigue: Vec<[f64; 2]>,
    decisions: Vec<Option<Decision>>,
    settled: bool,
    // What the relief of each coordinate asks for; the whole space where there is none.
    constraints: Vec<HalfSpace>,
    shift: Vec<f64>,
}

/// One muscle group over time.
#[derive(Clone, Copy, Debug)]
struct GroupState {
    fatigue: Option<FatigueState>,
    recovering: bool,
    /// Relative load when its present recovery began.
    load_at_trip: f64,
    /// The strategy its present recovery ended up with (docs/deviations.md, D4).
    accepted: Option<Strategy>,
}

impl<'a> Simulation<'a> {
    /// Ready for the first step.
    ///
    /// # Errors
    /// [`ScenarioError`] when the scenario is not in order.
    pub fn new(scenario: &'a Scenario) -> Result<Self, ScenarioError> {
        scenario.check()?;
        let model = &scenario.model;
        let n = model.coordinates().len();
        let rested = GroupState { fatigue: None, recovering: false, load_at_trip: 0.0, accepted: None };
        let mut simulation = Self {
            scenario,
            steps: 0,
            posture: scenario.start.clone(),
            kinematics: Kinematics::new(model),
            external_torque: ExternalTorque::new(model),
            groups: vec![[rested; 2]; n],
            external: vec![0.0; n],
            passive: vec![0.0; n],
            active: vec![0.0; n],
            load: vec![0.0; n],
            fatigue: vec![[0.0; 2]; n],
            decisions: vec![None; n],
            settled: false,
            constraints: vec![HalfSpace::new(n); n],
            shift: vec![0.0; n],
        };
        simulation.torques()?;
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            let Some(groups) = &coordinate.groups else { continue };
            for side in Side::BOTH {
                let load = simulation.load_of(i, side);
                let level = scenario.start_fatigue[i][side.index()];
                let start = groups[side.index()].fatigue.start(level, load);
                simulation.groups[i][side.index()].fatigue = Some(start);
            }
        }
        Ok(simulation)
    }

    /// Torques, fatigue, hysteresis, minimisation, constraint, record, motion: once.
    ///
    /// # Errors
    /// None for a scenario that was checked; the posture never leaves its ranges.
    pub fn step(&mut self) -> Result<Sample<'_>, ScenarioError> {
        self.torques()?;
        self.levels();
        self.decide();
        let time = self.steps as f64 * self.scenario.run.step;
        self.tire();
        self.steps += 1;
        // The motion is carried out at the start of the next step, so that the sample can be lent out as it is.
        Ok(Sample {
            time,
            posture: self.posture.values(),
            external: &self.external,
            passive: &self.passive,
            active: &self.active,
            load: &self.load,
            fatigue: &self.fatigue,
            decisions: &self.decisions,
            settled: self.settled,
        })
    }

    /// Moves to where the last decisions asked, then computes all torques there.
    fn torques(&mut self) -> Result<(), ScenarioError> {
        let model = &self.scenario.model;
        self.carry_out();
        self.kinematics.update(model, &self.posture)?;
        self.external_torque.update(model, &self.kinematics, &self.scenario.loads)?;
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            let angle = self.posture.values()[i];
            self.external[i] = coordinate.rate.map_or(0.0, |rate| self.external_torque.torques()[rate]);
            self.passive[i] = coordinate.passive.as_ref().map_or(0.0, |law| law.torque(i, self.kinematics.values()));
            self.active[i] = -(self.passive[i] + self.external[i]);
            let side = Side::of(self.active[i]).index();
            let strength = coordinate.groups.as_ref().map(|groups| groups[side].strength.torque(angle));
            self.load[i] = strength.map_or(0.0, |strength| self.active[i].abs() / strength);
        }
        Ok(())
    }

    /// Projects the posture into every half-space, free coordinates only, and into the ranges.
    fn carry_out(&mut self) {
        for (constraint, decision) in self.constraints.iter().zip(&self.decisions) {
            if decision.is_some() {
                constraint.project(self.posture.values_mut(), &self.scenario.free);
            }
        }
        for (value, coordinate) in self.posture.values_mut().iter_mut().zip(self.scenario.model.coordinates()) {
            *value = value.clamp(coordinate.range.0, coordinate.range.1);
        }
    }

    /// Relative load of one group: the one that does not work rests.
    fn load_of(&self, coordinate: usize, side: Side) -> f64 {
        if side == Side::of(self.active[coordinate]) { self.load[coordinate] } else { 0.0 }
    }

    /// Fatigue now, and who must rest.
    fn levels(&mut self) {
        for i in 0..self.groups.len() {
            for side in Side::BOTH {
                let load = self.load_of(i, side);
                let group = &mut self.groups[i][side.index()];
                let Some(state) = group.fatigue else { continue };
                // Three-compartment fatigue is relative to the load. A recovering group is judged at the load that tired it:
                // taking the load off must not count as having rested (docs/deviations.md, D15).
                let judged = if group.recovering { load.max(group.load_at_trip) } else { load };
                let level = state.level(judged);
                self.fatigue[i][side.index()] = level;
                let recovering = self.scenario.hysteresis.recovering(group.recovering, level);
                if recovering && !group.recovering {
                    group.load_at_trip = load;
                } else if !recovering {
                    group.accepted = None;
                }
                group.recovering = recovering;
            }
        }
    }

    /// Asks the hybrid minimisation for every tired coordinate and builds its half-space.
    fn decide(&mut self) {
        let Scenario { model, strategy, relief, free, .. } = self.scenario;
        let mut asked = false;
        let mut moved = false;
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            self.decisions[i] = None;
            let (Some(law), Some(rate), true) = (&coordinate.passive, coordinate.rate, free[i]) else { continue };
            // The group that works asks; within the tolerance neither does, and either may.
            let within = self.active[i].abs() <= relief.torque_tolerance;
            let works = Side::of(self.active[i]);
            let asks = |side: Side| self.groups[i][side.index()].recovering && (within || side == works);
            let Some(side) = [works, Side::BOTH[1 - works.index()]].into_iter().find(|&side| asks(side)) else {
                continue;
            };
            let angle = self.posture.values()[i];
            let Some(curve) = law.curve_at(i, self.kinematics.values(), coordinate.range) else { continue };
            let problem = Problem {
                curve: &curve,
                angle,
                external_torque: self.external[i],
                external_slope: self.external_torque.own_slope(&self.kinematics, model, rate),
                strategy: strategy.kind,
                minimum_decrease_ratio: strategy.minimum_decrease_ratio,
                torque_tolerance: relief.torque_tolerance,
                accepted: self.groups[i][side.index()].accepted,
            };
            let decision = match relief.tables {
                Tables::Total => minimise(&problem),
                Tables::Literal => minimise_literal(&problem),
            };
            // Every number was checked with the scenario, and the posture is clamped to its ranges.
            let Ok(decision) = decision else { continue };
            asked = true;
            self.groups[i][side.index()].accept(decision.outcome);
            self.shift.fill(0.0);
            if let Some(goal) = decision.goal {
                self.shift[i] = relief_step(goal, angle, relief.step_gain, relief.max_step);
                moved |= self.shift[i].abs() > SETTLED;
            }
            self.constraints[i].ask_for(self.posture.values(), &self.shift);
            self.decisions[i] = Some(decision);
        }
        self.settled = asked && !moved;
    }

    /// One time step of load on every muscle group.
    fn tire(&mut self) {
        let step = self.scenario.run.step;
        for (i, coordinate) in self.scenario.model.coordinates().iter().enumerate() {
            let Some(groups) = &coordinate.groups else { continue };
            for side in Side::BOTH {
                let load = self.load_of(i, side);
                let group = &mut self.groups[i][side.index()];
                group.fatigue = group.fatigue.map(|state| groups[side.index()].fatigue.advance(state, load, step));
            }
        }
    }
}

impl GroupState {
    /// Keeps the first strategy that led somewhere; from active it may fall back to passive once, never the other way.
    fn accept(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Active if self.accepted.is_none() => self.accepted = Some(Strategy::Active),
            Outcome::Passive | Outcome::AtLimit => self.accepted = Some(Strategy::Passive),
            _ => {}
        }
    }
}
