//! Which muscle group fails first in a motion that is given, and what would relieve it?
//!
//! Nothing moves here: postures come from outside, at rest one after the other. At each of them muscles give
//! `tau_a = -(tau_p + tau_e)` (Eq. 1), contact forces of supports included; between two of them the relative load of every
//! group goes from one value to the next in a straight line, and the group tires under it by its own law. At the peaks of load
//! and of fatigue the hybrid minimisation says where relief would lie, if that joint alone moved.

use nalgebra::Vector3;

use crate::contact::{Balance, ContactForces, Support, SupportError, root_rates};
use crate::fatigue::FatigueState;
use crate::hybrid::{Decision, Problem, Strategy, explain, minimise};
use crate::joint_torques::{JointTorques, JointTorquesError, Quantities, relative_load};
use crate::kinematics::Kinematics;
use crate::model::{Model, Side};
use crate::posture::Posture;
use crate::statics::Load;

/// Longest piece of time under one load, s.
const PIECE: f64 = 0.25;
/// Most pieces between two postures.
const MOST_PIECES: f64 = 1000.0;
/// How often the piece in which a group fails is halved: to a part in a million.
const HALVINGS: usize = 20;
/// Longest motion, s: more than a day.
const LONGEST: f64 = 1e5;
/// Acceleration is judged over at least so much time before and after, s: noise of measured motion is not.
const REACH: f64 = 0.05;
/// Acceleration of the centre of mass, m/s^2, up to which a posture counts as held: a tenth of gravity.
const SLOW: f64 = 1.0;

/// What is asked of an assessment.
#[derive(Clone, Debug, PartialEq)]
pub struct AssessSettings {
    /// What carries the body at every instant. Without supports its root is held as if by hand.
    pub supports: Vec<Support>,
    /// By coordinate: the range (rad) outside of which its passive torque stays what it is at the nearer end; empty for none.
    pub passive_ranges: Vec<Option<(f64, f64)>>,
    /// `R_min` of the proposals, 0..=1.
    pub minimum_decrease_ratio: f64,
    /// `eps` of the proposals, N m.
    pub torque_tolerance: f64,
}

impl Default for AssessSettings {
    fn default() -> Self {
        Self { supports: vec![], passive_ranges: vec![], minimum_decrease_ratio: 0.9, torque_tolerance: 0.05 }
    }
}

/// One instant of the motion.
#[derive(Debug)]
pub struct Instant<'a> {
    /// Its number, counted from 0.
    pub index: usize,
    /// Time, s.
    pub time: f64,
    /// Posture and torques, contact forces included.
    pub torques: &'a JointTorques,
    /// Fatigue of the positive and negative group of every coordinate, 0..=1.
    pub fatigue: &'a [[f64; 2]],
    /// Active torque over strength of the same.
    pub load: &'a [[f64; 2]],
    /// What the supports give; none without supports.
    pub contact: Option<&'a ContactForces>,
}

/// A value and when it was there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// The value.
    pub value: f64,
    /// Number of the instant.
    pub index: usize,
    /// Its time, s.
    pub time: f64,
}

impl Peak {
    fn take(&mut self, value: f64, index: usize, time: f64) {
        if value > self.value {
            *self = Self { value, index, time };
        }
    }
}

/// What one group went through.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupAssessment {
    /// Index of its coordinate.
    pub coordinate: usize,
    /// Which of its two groups.
    pub side: Side,
    /// Greatest active torque over strength.
    pub peak_load: Peak,
    /// Greatest fatigue, 0..=1.
    pub peak_fatigue: Peak,
    /// Fatigue at the end.
    pub fatigue: f64,
    /// When it could first not give what was asked for, s.
    pub exhausted_at: Option<f64>,
    /// Where relief would lie at both peaks, by both strategies; where the group rested or has no falling passive curve, none.
    pub proposals: Vec<Proposal>,
}

/// Which peak a relief is proposed at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeakKind {
    /// Greatest load.
    Load,
    /// Greatest fatigue.
    Fatigue,
}

/// A relief that the hybrid minimisation proposes.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// At which peak.
    pub at: PeakKind,
    /// Its time, s.
    pub time: f64,
    /// Value of the coordinate there, rad.
    pub angle: f64,
    /// The strategy asked for.
    pub strategy: Strategy,
    /// Case, goal and outcome.
    pub decision: Decision,
    /// The same in a plain sentence.
    pub sentence: String,
}

/// What came of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// Every group of known strength: those that fail first, then by fatigue, then by load.
    pub groups: Vec<GroupAssessment>,
    /// Greatest force that the root lacked, N: what neither loads nor supports gave.
    pub residual_force: Peak,
    /// Greatest moment that it lacked, N m.
    pub residual_moment: Peak,
    /// Number of instants in which the supports could not hold the root.
    pub unheld: usize,
    /// Greatest acceleration of the centre of mass, m/s^2.
    pub acceleration: Peak,
    /// Share of the instants in which it was above 1 m/s^2, so that a posture at rest says little.
    pub fast_share: f64,
}

/// Why a motion was not assessed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AssessError {
    /// A support does not fit the model.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// A posture or a load does not fit the model, or a passive law gives no torque.
    #[error("instant {index}: {error}")]
    Torques {
        /// Its number, counted from 0.
        index: usize,
        /// Why.
        error: JointTorquesError,
    },
    /// Times fall, or are no numbers.
    #[error("instant {index} is at {time} s; times must be finite and not fall")]
    Order {
        /// Number of the instant.
        index: usize,
        /// Its time, s.
        time: f64,
    },
    /// It lasts for days.
    #[error("the motion lasts {0} s; 1e5 s at most")]
    TooLong(f64),
}

/// Assesses postures at rising times (s). `loads` adds what pulls on the body besides its weight at a time, in the posture that
/// the kinematics hold; every instant is shown to `record`.
///
/// # Errors
/// [`AssessError`] names the first instant that is not in order.
pub fn assess(
    model: &Model,
    motion: &[(f64, Posture)],
    mut loads: impl FnMut(f64, &Kinematics, &mut Vec<Load>),
    settings: &AssessSettings,
    mut record: impl FnMut(&Instant),
) -> Result<Assessment, AssessError> {
    if let (Some((first, _)), Some((last, _))) = (motion.first(), motion.last())
        && last - first > LONGEST
    {
        return Err(AssessError::TooLong(last - first));
    }
    let mut statics = Statics::new(model, settings)?;
    let mut groups = Groups::new(model);
    let mut found = Assessment {
        groups: vec![],
        residual_force: Peak::default(),
        residual_moment: Peak::default(),
        unheld: 0,
        acceleration: Peak::default(),
        fast_share: 0.0,
    };
    let mut centers: Vec<Vector3<f64>> = vec![];
    let mut before: Option<f64> = None;
    for (index, (time, posture)) in motion.iter().enumerate() {
        if !time.is_finite() || before.is_some_and(|before| *time < before) {
            return Err(AssessError::Order { index, time: *time });
        }
        statics.update(index, *time, posture, &mut loads)?;
        groups.take(&statics, index, *time, before.map_or(0.0, |before| time - before));
        let (force, moment) = statics.residual();
        found.residual_force.take(force, index, *time);
        found.residual_moment.take(moment, index, *time);
        found.unheld += usize::from(statics.unheld());
        centers.extend(statics.torques.kinematics().center_of_mass(model));
        record(&Instant {
            index,
            time: *time,
            torques: &statics.torques,
            fatigue: &groups.fatigue,
            load: &groups.load,
            contact: statics.contact.as_ref(),
        });
        before = Some(*time);
    }
    (found.acceleration, found.fast_share) = acceleration(motion, &centers);
    found.groups = groups.summaries;
    for group in &mut found.groups {
        for (at, peak) in [(PeakKind::Load, group.peak_load), (PeakKind::Fatigue, group.peak_fatigue)] {
            if peak.value > 0.0 && (at == PeakKind::Load || peak.index != group.peak_load.index) {
                let (time, posture) = &motion[peak.index];
                statics.update(peak.index, *time, posture, &mut loads)?;
                statics.propose(group, at, *time, settings);
            }
        }
    }
    let rank = |group: &GroupAssessment| group.exhausted_at.unwrap_or(f64::INFINITY);
    found.groups.sort_by(|a, b| {
        let worse = |of: fn(&GroupAssessment) -> f64| of(b).total_cmp(&of(a));
        rank(a).total_cmp(&rank(b)).then(worse(|g| g.peak_fatigue.value)).then(worse(|g| g.peak_load.value))
    });
    Ok(found)
}

/// All torques of a posture.
struct Statics<'a> {
    model: &'a Model,
    ranges: &'a [Option<(f64, f64)>],
    torques: JointTorques,
    contact: Option<ContactForces>,
    root: Vec<usize>,
    loads: Vec<Load>,
}

impl<'a> Statics<'a> {
    fn new(model: &'a Model, settings: &'a AssessSettings) -> Result<Self, SupportError> {
        let supports = &settings.supports;
        let contact = (!supports.is_empty()).then(|| ContactForces::new(model, supports.clone())).transpose()?;
        Ok(Self {
            model,
            ranges: &settings.passive_ranges,
            torques: JointTorques::with_passive_ranges(model, &settings.passive_ranges),
            contact,
            root: root_rates(model),
            loads: vec![],
        })
    }

    /// Computes everything in the posture of one instant.
    fn update(
        &mut self,
        index: usize,
        time: f64,
        posture: &Posture,
        loads: &mut impl FnMut(f64, &Kinematics, &mut Vec<Load>),
    ) -> Result<(), AssessError> {
        let Self { model, torques, .. } = self;
        let refused = |error: JointTorquesError| AssessError::Torques { index, error };
        torques.place(model, posture).map_err(|error| refused(error.into()))?;
        self.loads.clear();
        loads(time, torques.kinematics(), &mut self.loads);
        match &mut self.contact {
            Some(contact) => torques.apply_with_contact(model, &self.loads, contact, Quantities::TORQUES),
            None => torques.apply(model, &self.loads, Quantities::TORQUES),
        }
        .map_err(refused)
    }

    /// Active torque of a rate, N m.
    fn active(&self, rate: usize) -> f64 {
        self.torques.active_torque()[rate]
    }

    /// What the root would need of muscles that it has not: force (N) and moment (N m).
    fn residual(&self) -> (f64, f64) {
        let size = |turns: bool| {
            let rates = self.root.iter().filter(|&&rate| self.model.rates()[rate].rotational == turns);
            rates.map(|&rate| self.active(rate).powi(2)).sum::<f64>().sqrt()
        };
        (size(false), size(true))
    }

    fn unheld(&self) -> bool {
        self.contact.as_ref().is_some_and(|contact| contact.balance() != Balance::Held)
    }

    /// Adds what both strategies propose to a group in the posture that is seen.
    fn propose(&self, group: &mut GroupAssessment, at: PeakKind, time: f64, settings: &AssessSettings) {
        let i = group.coordinate;
        let coordinate = &self.model.coordinates()[i];
        let (Some(law), Some(rate)) = (&coordinate.passive, coordinate.rate) else { return };
        if Side::of(self.active(rate)) != group.side {
            return;
        }
        let range = self.ranges.get(i).copied().flatten().unwrap_or(coordinate.range);
        let values = self.torques.passive_torque().values();
        let Some(curve) = law.curve_at(i, values, range) else { return };
        let external = self.torques.external_torque();
        let slope = external.own_slope(self.torques.kinematics(), self.model, rate);
        for strategy in [Strategy::Active, Strategy::Passive] {
            let problem = Problem {
                curve: &curve,
                angle: values[i].max(curve.range().0).min(curve.range().1),
                external_torque: external.torques()[rate],
                external_slope: slope,
                strategy,
                minimum_decrease_ratio: settings.minimum_decrease_ratio,
                torque_tolerance: settings.torque_tolerance,
                accepted: None,
            };
            if let Ok(decision) = minimise(&problem) {
                let (angle, sentence) = (values[i], explain(&problem, &decision));
                group.proposals.push(Proposal { at, time, angle, strategy, decision, sentence });
            }
        }
    }
}

/// All groups of known strength over time.
struct Groups {
    summaries: Vec<GroupAssessment>,
    states: Vec<FatigueState>,
    /// By coordinate.
    fatigue: Vec<[f64; 2]>,
    load: Vec<[f64; 2]>,
}

impl Groups {
    fn new(model: &Model) -> Self {
        let known = |i: &usize| {
            let coordinate = &model.coordinates()[*i];
            coordinate.groups.is_some() && coordinate.rate.is_some() && !model.is_dependent(*i)
        };
        let coordinates = (0..model.coordinates().len()).filter(known);
        let summary = |(coordinate, side)| GroupAssessment {
            coordinate,
            side,
            peak_load: Peak::default(),
            peak_fatigue: Peak::default(),
            fatigue: 0.0,
            exhausted_at: None,
            proposals: vec![],
        };
        let n = model.coordinates().len();
        Self {
            summaries: coordinates.flat_map(|i| Side::BOTH.map(|side| summary((i, side)))).collect(),
            states: vec![],
            fatigue: vec![[0.0; 2]; n],
            load: vec![[0.0; 2]; n],
        }
    }

    /// The next instant, `seconds` after the one before.
    fn take(&mut self, statics: &Statics<'_>, index: usize, time: f64, seconds: f64) {
        let pieces = (seconds / PIECE).ceil().clamp(1.0, MOST_PIECES);
        for (place, summary) in self.summaries.iter_mut().enumerate() {
            let (i, side) = (summary.coordinate, summary.side);
            let coordinate = &statics.model.coordinates()[i];
            let (Some(groups), Some(rate)) = (&coordinate.groups, coordinate.rate) else { continue };
            let group = &groups[side.index()];
            let active = statics.active(rate);
            let works = Side::of(active) == side;
            let value = statics.torques.kinematics().values()[i];
            let load = if works { relative_load(coordinate, value, active) } else { 0.0 };
            let before = std::mem::replace(&mut self.load[i][side.index()], load);
            let law = &group.fatigue;
            if index == 0 {
                self.states.push(law.start(0.0, load));
            }
            summary.peak_load.take(load, index, time);
            let state = &mut self.states[place];
            let at = |share: f64| before + share * (load - before);
            for piece in 0..pieces as u64 {
                let (from, to) = (piece as f64 / pieces, (piece + 1) as f64 / pieces);
                let start = *state;
                // State and fatigue at a share of the way to this instant.
                let then = |share: f64| {
                    let state = law.advance(start, at(f64::midpoint(from, share)), (share - from) * seconds);
                    (state, state.level(at(share)))
                };
                if seconds > 0.0 {
                    (*state, summary.fatigue) = then(to);
                } else {
                    summary.fatigue = state.level(load);
                }
                summary.peak_fatigue.take(summary.fatigue, index, time - (1.0 - to) * seconds);
                if summary.fatigue >= 1.0 && summary.exhausted_at.is_none() {
                    let (mut held, mut failed) = (from, to);
                    for _ in 0..HALVINGS {
                        let middle = f64::midpoint(held, failed);
                        if then(middle).1 >= 1.0 { failed = middle } else { held = middle }
                    }
                    summary.exhausted_at = Some(time - (1.0 - failed) * seconds);
                }
            }
            self.fatigue[i][side.index()] = summary.fatigue;
        }
    }
}

/// Greatest acceleration of the centre of mass (m/s^2, by second differences over [`REACH`] to both sides at least), and the
/// share of the instants in which it is above [`SLOW`].
fn acceleration(motion: &[(f64, Posture)], centers: &[Vector3<f64>]) -> (Peak, f64) {
    let mut peak = Peak::default();
    if centers.len() != motion.len() {
        return (peak, 0.0); // a body without mass
    }
    let time = |i: usize| motion[i].0;
    let (mut first, mut last, mut fast) = (0, 0, 0);
    for index in 0..motion.len() {
        let now = time(index);
        while first + 1 < index && now - time(first + 1) >= REACH {
            first += 1;
        }
        while last < motion.len() && time(last) - now < REACH {
            last += 1;
        }
        if last == motion.len() {
            break;
        }
        if now - time(first) < REACH {
            continue;
        }
        let (before, after) = (now - time(first), time(last) - now);
        let bend = (centers[last] - centers[index]) / after - (centers[index] - centers[first]) / before;
        let size = 2.0 * bend.norm() / (before + after);
        peak.take(size, index, now);
        fast += usize::from(size > SLOW);
    }
    (peak, fast as f64 / motion.len().max(1) as f64)
}
