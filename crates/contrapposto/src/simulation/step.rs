//! What happens in one time step?

use nalgebra::Vector3;

use super::whole::Whole;
use super::{Scenario, ScenarioError, Tables};
use crate::constraint::{HalfSpace, relief_step};
use crate::contact::Balance;
use crate::fatigue::FatigueState;
use crate::hybrid::{Decision, Outcome, Problem, Strategy, minimise, minimise_literal};
use crate::kinematics::Kinematics;
use crate::model::Side;
use crate::posture::Posture;
use crate::statics::{ExternalTorque, Load};

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
    /// What became of the relief of every coordinate that asked for it, in the step that led here.
    pub reliefs: &'a [Option<Relief>],
    /// How it stands, for a body with supports or tasks.
    pub standing: Option<&'a Standing>,
    /// Strategy of every coordinate.
    pub strategies: &'a [Strategy],
    /// Relief was asked for, and moves nothing any more.
    pub settled: bool,
}

/// What became of a relief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relief {
    /// It was carried out: the change of active torque that the decision foretold, and the real one, N m.
    Done {
        /// From the slope along the motion.
        predicted: f64,
        /// Computed in the posture that was reached.
        real: f64,
    },
    /// Something more important stood against it: supports, tasks above relief, or a more tired group.
    Deferred,
    /// It made its own torque larger than foretold, and the whole effort with it, and was taken back.
    TakenBack,
    /// The joint cannot move without what stands above relief.
    Blocked,
    /// It was taken back so often that it waits for the next recovery.
    GivenUp,
}

/// How a body stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Standing {
    /// One a support, in the order of the scenario.
    pub contacts: Vec<Contact>,
    /// Length of the error of each task, in its units.
    pub errors: Vec<f64>,
    /// How far supports are off their places, m and rad together.
    pub slip: f64,
    /// Centre of mass, ground, m.
    pub center_of_mass: Vector3<f64>,
    /// `sum (active torque / strength)^2` over all coordinates with known strength.
    pub effort: f64,
}

/// What a support carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Force on the body, ground axes, N.
    pub force: Vector3<f64>,
    /// Its normal part as a share of body weight.
    pub share: f64,
    /// Where it acts, ground, m; `None` where nothing is carried.
    pub center_of_pressure: Option<Vector3<f64>>,
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
    reliefs: Vec<Option<Relief>>,
    standing: Standing,
    /// The body with supports or tasks.
    whole: Option<Whole<'a>>,
    loads: Vec<Load>,
    strategies: Vec<Strategy>,
    next_event: usize,
    /// Active torque before the last motion, and its change that each decision foretold.
    active_before: Vec<f64>,
    predicted: Vec<f64>,
    /// The relief of this recovery has led somewhere, and holds.
    held: Vec<bool>,
    /// Some relief asks for motion.
    pressing: bool,
    last_decisions: Vec<Option<Decision>>,
    /// Effort when the present recovery of each coordinate first asked for relief.
    effort_at_trip: Vec<f64>,
    /// Largest active torque that each decision foretold on the way to its goal, N m.
    foretold: Vec<f64>,
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
    /// How often its relief was taken back.
    taken_back: u32,
    /// Which kind of relief leads it now, and how many decisions in a row asked for the other.
    led: Option<Strategy>,
    contrary: u32,
}

/// So many decisions in a row turn a relief round.
const REPEATED: u32 = 30;

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
        let model = &scenario.model;
        let n = model.coordinates().len();
        let rested = GroupState {
            fatigue: None,
            recovering: false,
            load_at_trip: 0.0,
            accepted: None,
            taken_back: 0,
            led: None,
            contrary: 0,
        };
        let (whole, start) = match scenario.is_whole() {
            true => Whole::new(scenario).map(|(whole, start)| (Some(whole), start))?,
            false => (None, scenario.start.clone()),
        };
        let strategies = match scenario.strategies.is_empty() {
            true => vec![scenario.strategy.kind; n],
            false => scenario.strategies.clone(),
        };
        let mut simulation = Self {
            scenario,
            steps: 0,
            posture: start,
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
            reliefs: vec![None; n],
            standing: Standing::default(),
            whole,
            loads: scenario.loads.clone(),
            strategies,
            next_event: 0,
            active_before: vec![0.0; n],
            predicted: vec![0.0; n],
            foretold: vec![0.0; n],
            held: vec![false; n],
            pressing: false,
            last_decisions: vec![None; n],
            effort_at_trip: vec![f64::INFINITY; n],
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
        let time = self.steps as f64 * self.scenario.run.step;
        self.events(time)?;
        self.torques()?;
        self.levels();
        self.decide()?;
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
            reliefs: &self.reliefs,
            standing: self.whole.is_some().then_some(&self.standing),
            strategies: &self.strategies,
            settled: self.settled,
        })
    }

    /// What changes now.
    fn events(&mut self, time: f64) -> Result<(), ScenarioError> {
        let scenario = self.scenario;
        while let Some(event) = scenario.events.get(self.next_event).filter(|event| event.time <= time + 1e-9) {
            self.next_event += 1;
            if let Some(strategies) = &event.strategies {
                self.strategies.clone_from(strategies);
                // A new wish is a new recovery.
                self.groups.iter_mut().flatten().for_each(|group| (group.accepted, group.led) = (None, None));
            }
            if let Some(loads) = &event.loads {
                self.loads.clone_from(loads);
                if let Some(whole) = &mut self.whole {
                    whole.set_loads(loads)?;
                }
            }
            for (task, goal) in &event.tasks {
                if let Some(whole) = &mut self.whole {
                    whole.set_task(*task, goal);
                }
            }
            if let Some(whole) = &mut self.whole {
                whole.wake();
            }
        }
        Ok(())
    }

    /// Moves to where the last decisions asked, then computes all torques there.
    fn torques(&mut self) -> Result<(), ScenarioError> {
        self.reliefs.fill(None);
        if self.whole.is_some() {
            return self.torques_of_the_whole();
        }
        let model = &self.scenario.model;
        self.carry_out();
        self.kinematics.update(model, &self.posture)?;
        self.external_torque.update(model, &self.kinematics, &self.loads)?;
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            self.external[i] = coordinate.rate.map_or(0.0, |rate| self.external_torque.torques()[rate]);
            self.passive[i] = coordinate.passive.as_ref().map_or(0.0, |law| law.torque(i, self.kinematics.values()));
        }
        self.weigh();
        Ok(())
    }

    /// Active torque and relative load of every coordinate; gives the effort.
    fn weigh(&mut self) -> f64 {
        let mut effort = 0.0;
        for (i, coordinate) in self.scenario.model.coordinates().iter().enumerate() {
            self.active[i] = -(self.passive[i] + self.external[i]);
            let side = Side::of(self.active[i]).index();
            let angle = self.posture.values()[i];
            let strength = coordinate.groups.as_ref().map(|groups| groups[side].strength.torque(angle));
            self.load[i] = strength.map_or(0.0, |strength| self.active[i].abs() / strength);
            effort += self.load[i] * self.load[i];
        }
        effort
    }

    /// As [`Simulation::torques`], through the priorities of the whole body. A step that lets the body fall, or makes the torque
    /// of a group that asked for relief larger than was foretold and effort with it, is taken back.
    fn torques_of_the_whole(&mut self) -> Result<(), ScenarioError> {
        let Some(mut whole) = self.whole.take() else { return Ok(()) };
        let asks = |i: &usize| self.decisions[*i].is_some() || self.held[*i];
        let mut asked: Vec<usize> = (0..self.decisions.len()).filter(asks).collect();
        let tired = |i: &usize| self.fatigue[*i][0].max(self.fatigue[*i][1]);
        asked.sort_by(|a, b| tired(b).total_cmp(&tired(a)));
        let reliefs: Vec<(usize, &HalfSpace)> = asked.iter().map(|&i| (i, &self.constraints[i])).collect();
        let mut deferred = vec![];
        whole.carry_out(&mut self.posture, &reliefs, self.pressing, &mut deferred)?;
        self.active_before.copy_from_slice(&self.active);
        let before = self.standing.effort;
        let mut effort = self.look(&mut whole)?;
        let tolerance = self.scenario.relief.torque_tolerance;
        let fell = whole.contact().balance() != Balance::Held;
        // A passive goal may lie beyond a rise that the decision foretold.
        let rose = |i: usize| self.active[i].abs() > 1.5 * self.foretold[i] + tolerance;
        // Relief that costs the rest of the body more than it is worth is given back.
        let dear = |i: usize| effort > DEAR * self.effort_at_trip[i];
        let worse = asked
            .iter()
            .copied()
            .filter(|&i| self.decisions[i].is_some() && (fell || ((rose(i) || dear(i)) && effort > before)));
        let worse: Vec<usize> = worse.collect();
        if fell || !worse.is_empty() {
            whole.take_back(&mut self.posture)?;
            effort = self.look(&mut whole)?;
        }
        for &i in asked.iter().filter(|&&i| self.decisions[i].is_some()) {
            self.reliefs[i] = Some(if worse.contains(&i) {
                let side = self.asking_side(i);
                self.groups[i][side.index()].taken_back += 1;
                Relief::TakenBack
            } else if deferred.contains(&i) || !worse.is_empty() {
                Relief::Deferred
            } else {
                Relief::Done { predicted: self.predicted[i], real: self.active[i] - self.active_before[i] }
            });
        }
        self.stand(&whole, effort);
        self.whole = Some(whole);
        Ok(())
    }

    /// All torques where the body is; gives the effort.
    fn look(&mut self, whole: &mut Whole<'a>) -> Result<f64, ScenarioError> {
        whole.see(&self.posture)?;
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
        }));
        self.standing.slip = whole.errors(&mut self.standing.errors);
        self.standing.center_of_mass = whole.center_of_mass(model).unwrap_or_default();
        self.standing.effort = effort;
    }

    /// The group of a coordinate that asks for relief: the one that works if it is tired, else the other one.
    fn asking_side(&self, coordinate: usize) -> Side {
        let works = Side::of(self.active_before[coordinate]);
        if self.groups[coordinate][works.index()].recovering { works } else { Side::BOTH[1 - works.index()] }
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
            self.decisions[i] = None;
            if !self.groups[i].iter().any(|group| group.recovering) {
                (self.held[i], self.last_decisions[i]) = (false, None);
            }
            let (Some(law), Some(rate), true) = (&coordinate.passive, coordinate.rate, free[i]) else { continue };
            // The group that works asks; within the tolerance neither does, and either may.
            let within = self.active[i].abs() <= relief.torque_tolerance;
            let works = Side::of(self.active[i]);
            let asks = |side: Side| self.groups[i][side.index()].recovering && (within || side == works);
            let Some(side) = [works, Side::BOTH[1 - works.index()]].into_iter().find(|&side| asks(side)) else {
                continue;
            };
            let group = self.groups[i][side.index()];
            if group.taken_back >= 2 * PATIENCE {
                self.reliefs[i] = Some(Relief::GivenUp);
                self.held[i] = false;
                continue;
            }
            let angle = self.posture.values()[i];
            let (values, slope) = match &mut self.whole {
                Some(whole) => {
                    let Some(slope) = whole.slope(&self.posture, i, rate)? else {
                        self.reliefs[i] = Some(Relief::Blocked);
                        continue;
                    };
                    (whole.values(), slope)
                }
                None => (self.kinematics.values(), self.external_torque.own_slope(&self.kinematics, model, rate)),
            };
            let Some(curve) = law.curve_at(i, values, coordinate.range) else { continue };
            let problem = Problem {
                curve: &curve,
                angle,
                external_torque: self.external[i],
                external_slope: slope,
                strategy: if group.taken_back >= PATIENCE { Strategy::Passive } else { self.strategies[i] },
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
            let decision = match (&self.whole, self.last_decisions[i]) {
                (Some(_), Some(last)) if !self.groups[i][side.index()].believes(decision.outcome) => last,
                _ => decision,
            };
            if self.last_decisions[i].is_none() {
                self.effort_at_trip[i] = self.standing.effort;
            }
            self.last_decisions[i] = Some(decision);
            self.groups[i][side.index()].accept(decision.outcome);
            self.shift.fill(0.0);
            self.predicted[i] = 0.0;
            self.foretold[i] = self.active[i].abs();
            if let Some(goal) = decision.goal {
                for share in 1..=ON_THE_WAY {
                    let way = (goal - angle) * f64::from(share) / f64::from(ON_THE_WAY);
                    let active = curve.torque(angle + way) + self.external[i] + slope * way;
                    self.foretold[i] = self.foretold[i].max(active.abs());
                }
                let gain = relief.step_gain * 0.5f64.powi(group.taken_back.min(30) as i32);
                self.shift[i] = relief_step(goal, angle, gain, relief.max_step);
                self.predicted[i] = -(curve.slope(angle) + slope) * self.shift[i];
                moved |= self.shift[i].abs() > SETTLED;
            }
            // Where it is relieved it stays for as long as it recovers, whatever less important tasks would like.
            if self.whole.is_none() || !self.held[i] || self.shift[i].abs() > SETTLED {
                self.held[i] = self.constraints[i].ask_for(self.posture.values(), &self.shift);
            }
            self.decisions[i] = Some(decision);
        }
        self.pressing = moved;
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
                let group = &mut self.groups[i][side.index()];
                group.fatigue = group.fatigue.map(|state| groups[side.index()].fatigue.advance(state, load, step));
            }
        }
    }
}

impl GroupState {
    /// Is a decision to be followed that asks for another kind of relief than this recovery began with? The slope that it
    /// extrapolates jumps where a foot's edge begins or ends to carry, so only if it is repeated.
    fn believes(&mut self, outcome: Outcome) -> bool {
        let kind = match outcome {
            Outcome::Active => Some(Strategy::Active),
            Outcome::Passive | Outcome::AtLimit => Some(Strategy::Passive),
            Outcome::Stay | Outcome::None => None,
        };
        let contrary = kind.is_some() && self.led.is_some() && kind != self.led;
        self.contrary = if contrary { self.contrary + 1 } else { 0 };
        let follow = self.contrary == 0 || self.contrary > REPEATED;
        if follow {
            (self.contrary, self.led) = (0, kind.or(self.led));
        }
        follow
    }

    /// Keeps the first strategy that led somewhere; from active it may fall back to passive once, never the other way.
    fn accept(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Active if self.accepted.is_none() => self.accepted = Some(Strategy::Active),
            Outcome::Passive | Outcome::AtLimit => self.accepted = Some(Strategy::Passive),
            _ => {}
        }
    }
}
