//! Lets the muscles of a body tire over a run, and gives the groups of its joints the fatigue that follows.
//!
//! Every muscle has the compartments of 3CC-r, and static optimisation shares the torques of the posture among the muscles within what fatigue
//! has left them ([`MuscleFatigue`]). The fatigue of a group is that of its strength: with `S0` the greatest torque of rested muscles while they
//! give all other torques, `S` that of the present ones, and the torque `T` asked of the group,
//!
//! ```text
//! MF = 1 - S / S0,   load = T / S0,   fatigue = MF / (1 - load) = (S0 - S) / (S0 - T)
//! ```
//!
//! as of a group with compartments of its own. Muscles work in pieces of about half a second under the torques at the end of each; `S0` and `S`
//! stay within a piece. People whose strength is a standard deviation below and above the mean work beside, for the spread of times; in runs that
//! are long enough for the breaks that are suggested, people who take them do, too.

use serde::{Deserialize, Serialize};

use super::muscle_outcome::{MEAN_PERSON, MuscleFailure, MuscleOutcome, MuscleSummary};
use super::{Scenario, ScenarioError};
use crate::fatigue::{Breaks, Compartments, FatigueState};
use crate::joint_torques::{JointMuscles, LEAST_MUSCLE_STRENGTH, MuscleShare, MuscleShareError};
use crate::model::data::library;
use crate::model::{Model, Side};
use crate::muscle::{CoupledStrength, MuscleFatigue, SharedTorques, TorqueLimit, hold_on, hold_with_breaks};

/// Length of a piece of work, s, where time steps are shorter (assumed: muscles tire by at most 1 % of their force in that time).
const MUSCLE_PIECE: f64 = 0.5;
/// Longest time for which the posture of the end is held on, s: a day.
const LONGEST_HOLD: f64 = 86_400.0;
/// Share of a torque in a limit below which its group does not count as failing.
const LEAST_SHARE_IN_LIMIT: f64 = 1e-6;

/// Strengths of people whose muscles work, in standard deviations from the mean: of those who work without breaks (weaker, mean, stronger), then of
/// those who take them.
const PEOPLE: [f64; 5] = [-1.0, 0.0, 1.0, -1.0, 0.0];
/// People who work without breaks.
const WITHOUT_BREAKS: usize = 3;
/// Share of a break's period by which time is rounded up, so that a sum of time steps does not miss the end of the period.
const PERIOD_ROUNDING: f64 = 1e-9;

/// State at the end of a piece of work, from which the next one goes on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct MuscleState {
    /// Compartments of every muscle, by person.
    people: Vec<Vec<Compartments>>,
    /// First time at which the muscles of each person could not give all torques, s of work and breaks, and the group with the greatest share in
    /// the limit.
    failed: Vec<Option<MuscleFailure>>,
    /// Of the mean person: `S0` and `MF` of the positive and the negative group, by rate whose strength is the muscles'.
    groups: Vec<[[f64; 2]; 2]>,
    /// Of the mean person: every muscle so far.
    muscles: Vec<MuscleSummary>,
}

/// The muscles of a run under way.
#[derive(Clone, Debug)]
pub(super) struct MuscleCourse {
    share: MuscleShare,
    /// Coordinate of every rate of the share.
    coordinates: Vec<usize>,
    people: Vec<Person>,
    /// Time steps of a piece, and its length, s.
    every: u64,
    seconds: f64,
    /// Strengths of rested muscles, with the torques and forces for which they were computed.
    rested: Option<(Vec<f64>, Vec<f64>, Vec<CoupledStrength>)>,
}

#[derive(Clone, Debug)]
struct Person {
    takes_breaks: bool,
    /// Strength of every muscle over the mean.
    strength: Vec<f64>,
    /// Tension of every muscle at full activation beyond that of its passive fibres, N.
    forces: Vec<f64>,
    fatigue: MuscleFatigue,
}

impl MuscleCourse {
    /// Of a scenario whose muscles tire one by one; `None` of another one.
    pub(super) fn of(scenario: &Scenario) -> Result<Option<Self>, MuscleShareError> {
        let muscles = scenario.muscles.as_ref().filter(|_| scenario.muscles_tire);
        let with_breaks = scenario.run.end() > Breaks::SUGGESTED.work;
        muscles.map(|muscles| Self::new(&scenario.model, muscles, scenario.run.step, with_breaks)).transpose()
    }

    /// Of muscles in time steps of `step`, s; `with_breaks`: whether people who take breaks work, too.
    fn new(model: &Model, muscles: &JointMuscles, step: f64, with_breaks: bool) -> Result<Self, MuscleShareError> {
        let share = MuscleShare::new(model, muscles, |_| 0.0)?;
        let coordinate = |&rate: &usize| model.rates()[rate].coordinate.ok_or(MuscleShareError::NoMuscles);
        let coordinates = share.rates.iter().map(coordinate).collect::<Result<_, _>>()?;
        let person = |(number, &deviations): (usize, &f64)| {
            let strength = |of: &Option<(usize, Side)>| {
                let (coordinate, side) = (*of)?;
                let groups = model.coordinates()[coordinate].groups.as_ref()?;
                let (variation, _) = library().strength_variation(&groups[side.index()].name)?;
                Some(1.0 + deviations * variation)
            };
            Person {
                takes_breaks: number >= WITHOUT_BREAKS,
                strength: share.works_for.iter().map(|of| strength(of).unwrap_or(1.0)).collect(),
                forces: share.forces.clone(),
                fatigue: MuscleFatigue::rested(share.laws.clone()),
            }
        };
        let count = if with_breaks { PEOPLE.len() } else { WITHOUT_BREAKS };
        let people = PEOPLE[..count].iter().enumerate().map(person).collect();
        let every = (MUSCLE_PIECE / step).round().max(1.0);
        Ok(Self { share, coordinates, people, every: every as u64, seconds: every * step, rested: None })
    }

    /// Takes the posture in which the muscles were last computed, with the active torque of every coordinate, N m.
    fn ask(&mut self, muscles: &JointMuscles, active: &[f64]) {
        self.share.torques.iter_mut().zip(&self.coordinates).for_each(|(torque, &i)| *torque = active[i]);
        self.share.forces.iter_mut().zip(muscles.forces()).for_each(|(force, now)| *force = now);
        for person in &mut self.people {
            let forces = self.share.forces.iter().zip(&person.strength);
            person.forces.iter_mut().zip(forces).for_each(|(own, (force, strength))| *own = force * strength);
        }
    }

    /// The muscles at the start of a run, with the fatigue of the group that each works for in its posture.
    pub(super) fn begin(
        &mut self,
        model: &Model,
        muscles: &JointMuscles,
        active: &[f64],
        levels: &[[f64; 2]],
    ) -> Result<MuscleState, ScenarioError> {
        self.ask(muscles, active);
        let works_for = muscles.works_for_now(model);
        let of_group = |of: Option<(usize, Side)>| of.map_or(0.0, |(i, side)| levels[i][side.index()]);
        let of_muscle =
            |works_for: &Option<(usize, Side)>| MuscleSummary { works_for: *works_for, ..Default::default() };
        let mut state = MuscleState {
            people: vec![vec![]; self.people.len()],
            failed: vec![None; self.people.len()],
            groups: vec![],
            muscles: self.share.works_for.iter().map(of_muscle).collect(),
        };
        for (person, Person { forces, fatigue, .. }) in self.people.iter_mut().enumerate() {
            let asked = SharedTorques { forces, ..self.share.asked(muscles) };
            let held = fatigue.begin_tired(&asked, |muscle| of_group(works_for[muscle]))?;
            state.take(person, 0.0, (!held).then_some((&asked, &self.coordinates)), fatigue);
        }
        self.judge(muscles, 0.0, &mut state)?;
        Ok(state)
    }

    /// Goes on from the state of another run.
    pub(super) fn resume(&mut self, state: &MuscleState) {
        for (person, states) in self.people.iter_mut().zip(&state.people) {
            person.fatigue.resume(states);
        }
        self.rested = None;
    }

    /// Ends the time step `step`, from which the next one begins at `time`, s: at the end of a piece the muscles have worked.
    pub(super) fn advance(
        &mut self,
        (step, time): (u64, f64),
        muscles: &JointMuscles,
        active: &[f64],
        state: &mut MuscleState,
    ) -> Result<(), ScenarioError> {
        if !(step + 1).is_multiple_of(self.every) {
            return Ok(());
        }
        self.ask(muscles, active);
        let [breaks, breaks_after] = [time - self.seconds, time].map(breaks_until);
        for (person, Person { takes_breaks, forces, fatigue, .. }) in self.people.iter_mut().enumerate() {
            let asked = SharedTorques { forces, ..self.share.asked(muscles) };
            let held = fatigue.work(&asked, self.seconds)?;
            let paused = if *takes_breaks { breaks * Breaks::SUGGESTED.rest } else { 0.0 };
            state.take(person, time + paused, (!held).then_some((&asked, &self.coordinates)), fatigue);
            if *takes_breaks && breaks_after > breaks {
                fatigue.rest((breaks_after - breaks) * Breaks::SUGGESTED.rest);
                state.people[person].copy_from_slice(fatigue.states());
            }
        }
        self.judge(muscles, time, state)
    }

    /// Computes what the groups and muscles of the mean person have left.
    fn judge(&mut self, muscles: &JointMuscles, time: f64, state: &mut MuscleState) -> Result<(), ScenarioError> {
        let asked = self.share.asked(muscles);
        let fatigue = &mut self.people[MEAN_PERSON].fatigue;
        let held = fatigue.share(&asked)?;
        let capacities: Vec<f64> = fatigue.capacities().collect();
        let rested = match self.rested.take() {
            Some(known) if known.0 == self.share.torques && known.1 == self.share.forces => known.2,
            _ => strengths(&asked, &vec![1.0; capacities.len()], false),
        };
        let tired = strengths(&asked, &capacities, held);
        state.groups.clear();
        state.groups.extend(rested.iter().zip(&tired).map(|(rested, tired)| {
            [(0, 1.0), (1, -1.0)].map(|(side, sense)| {
                let [rested, tired] = [rested, tired].map(|of| (sense * of.torque[side]).max(0.0));
                [rested, if rested > 0.0 { (1.0 - tired / rested).clamp(0.0, 1.0) } else { 0.0 }]
            })
        }));
        self.rested = Some((self.share.torques.clone(), self.share.forces.clone(), rested));
        for ((muscle, of), passive) in state.muscles.iter_mut().enumerate().zip(muscles.passive_forces()) {
            of.load = fatigue.loads()[muscle];
            of.tension = of.load * self.share.forces[muscle] + passive;
            of.fatigued = fatigue.states()[muscle].fatigued;
            if of.load > of.peak_load.0 {
                (of.peak_load, of.peak_tension) = ((of.load, time), of.tension);
            }
            if of.exhausted_at.is_none() && fatigue.is_exhausted(muscle) {
                of.exhausted_at = Some(time);
            }
        }
        Ok(())
    }

    /// Compartments of the groups of a coordinate, each with its load, under the torque `active`, N m; `None` where muscles do not give the strength.
    pub(super) fn groups(
        &self,
        state: &MuscleState,
        coordinate: usize,
        active: f64,
    ) -> Option<[(FatigueState, f64); 2]> {
        let place = self.coordinates.iter().position(|&other| other == coordinate)?;
        let [positive, negative] = *state.groups.get(place)?;
        let group = |[rested, fatigued]: [f64; 2], asked: f64| {
            let load = asked.max(0.0) / rested.max(LEAST_MUSCLE_STRENGTH);
            (FatigueState::Compartments(Compartments::of(load, fatigued)), load)
        };
        Some([group(positive, active), group(negative, -active)])
    }

    /// The muscles at the end of a run, `time` s after its start. A person who has not failed holds the last posture on.
    pub(super) fn outcome(&self, muscles: &JointMuscles, time: f64, state: &MuscleState) -> MuscleOutcome {
        let failure = |person: usize| {
            let Person { forces, fatigue, .. } = &self.people[person];
            let asked = SharedTorques { forces, ..self.share.asked(muscles) };
            if let Some(failed) = state.failed[person] {
                return Some(failed);
            }
            let mut fatigue = fatigue.clone();
            let held = hold_on(&mut fatigue, &asked, LONGEST_HOLD, |_, _| {}).ok()?;
            let who = first_of(&held.limit, &asked, &self.coordinates);
            held.failed.then_some(MuscleFailure { time: time + held.seconds, who })
        };
        let takes_breaks = self.people.len() > WITHOUT_BREAKS;
        let with_breaks = |person: usize| self.failure_with_breaks(muscles, time, state, WITHOUT_BREAKS + person);
        MuscleOutcome {
            muscles: state.muscles.clone(),
            failures: [0, 1, 2].map(failure),
            with_breaks: takes_breaks.then(|| [0, 1].map(with_breaks)),
            coordinates: self.coordinates.clone(),
        }
    }

    /// Time at which the muscles of a person who takes breaks fail, s of work and breaks; a person who has not failed at the end of the run, `time` s of work
    /// after its start, holds the last posture on.
    fn failure_with_breaks(
        &self,
        muscles: &JointMuscles,
        time: f64,
        state: &MuscleState,
        person: usize,
    ) -> Option<f64> {
        if let Some(failed) = state.failed[person] {
            return Some(failed.time);
        }
        let Person { forces, fatigue, .. } = &self.people[person];
        let asked = SharedTorques { forces, ..self.share.asked(muscles) };
        let (mut fatigue, taken) = (fatigue.clone(), breaks_until(time));
        let until = (taken + 1.0) * Breaks::SUGGESTED.work - time;
        let held = hold_with_breaks(&mut fatigue, &asked, (until, Breaks::SUGGESTED), LONGEST_HOLD).ok()?;
        held.map(|seconds| time + taken * Breaks::SUGGESTED.rest + seconds)
    }
}

/// Number of breaks in so much work, s.
fn breaks_until(work: f64) -> f64 {
    (work / Breaks::SUGGESTED.work + PERIOD_ROUNDING).floor()
}

impl MuscleState {
    /// Every muscle of the mean person so far.
    pub(super) fn muscles(&self) -> &[MuscleSummary] {
        &self.muscles
    }

    /// Takes in the muscles of a person; `missed`: the torques that they could not give, and the coordinate of each.
    fn take(
        &mut self,
        person: usize,
        time: f64,
        missed: Option<(&SharedTorques<'_>, &Vec<usize>)>,
        fatigue: &MuscleFatigue,
    ) {
        self.people[person].clear();
        self.people[person].extend_from_slice(fatigue.states());
        if let (Some((asked, coordinates)), None) = (missed, self.failed[person]) {
            let capacities: Vec<f64> = fatigue.capacities().collect();
            let who = first_of(&asked.limit(&capacities), asked, coordinates);
            self.failed[person] = Some(MuscleFailure { time, who });
        }
    }

    /// Whether there is an entry for each of so many muscles and rates, and every number is finite.
    pub(super) fn fits(&self, course: &MuscleCourse) -> bool {
        let (muscles, rates) = (course.share.laws.len(), course.coordinates.len());
        let people = course.people.len();
        let shares =
            |c: &Compartments| [c.active, c.resting, c.fatigued].iter().all(|share| (0.0..=1.0).contains(share));
        self.people.len() == people
            && self.failed.len() == people
            && self.people.iter().all(|states| states.len() == muscles && states.iter().all(shares))
            && self.muscles.len() == muscles
            && self.groups.len() == rates
            && self.groups.iter().flatten().flatten().all(|number| number.is_finite())
            && self.failed.iter().flatten().all(|failed| failed.time.is_finite())
    }
}

/// The group with the greatest share in a limit.
fn first_of(limit: &TorqueLimit, asked: &SharedTorques<'_>, coordinates: &[usize]) -> Option<(usize, Side)> {
    let shares = &limit.of_torques;
    let first = (0..shares.len()).max_by(|&a, &b| shares[a].total_cmp(&shares[b]));
    first.filter(|&k| shares[k] > LEAST_SHARE_IN_LIMIT).map(|k| (coordinates[k], Side::of(asked.torques[k])))
}

/// Strengths of muscles of given capacities beside the other torques; where they cannot give all of these, beside as much of them as they can.
fn strengths(asked: &SharedTorques<'_>, capacities: &[f64], held: bool) -> Vec<CoupledStrength> {
    let times = if held { 1.0 } else { asked.limit(capacities).times.min(1.0) };
    let torques: Vec<f64> = asked.torques.iter().map(|torque| times * torque).collect();
    asked.strengths_beside(&torques, capacities)
}
