//! Follows load and fatigue of every muscle group through a motion.

use super::evaluation::Evaluation;
use super::result::{AngleInDoubt, GroupAssessment, Peak, PeakTorques};
use crate::fatigue::{FatigueLaw, FatigueState, LoadHistory};
use crate::joint_torques::relative_load;
use crate::model::{Model, Side};

/// Longest piece of time under one load, s.
const PIECE: f64 = 0.25;
/// Most pieces between two postures.
const MOST_PIECES: f64 = 1000.0;
/// Bisections of the piece in which a group fails: to a part in a million.
const BISECTIONS: usize = 20;

/// All groups of known strength over time.
pub(super) struct Groups {
    pub(super) summaries: Vec<GroupAssessment>,
    states: Vec<FatigueState>,
    /// By coordinate.
    pub(super) fatigue: Vec<[f64; 2]>,
    pub(super) load: Vec<[f64; 2]>,
}

/// The time between two postures for one group; its relative load changes in a straight line.
struct Interval<'l> {
    law: &'l FatigueLaw,
    /// Relative load before and after.
    load: (f64, f64),
    /// Length, s.
    seconds: f64,
    /// Number of pieces under one load each.
    pieces: f64,
}

impl Interval<'_> {
    /// Relative load at a share of the interval.
    fn load_at(&self, share: f64) -> f64 {
        self.load.0 + share * (self.load.1 - self.load.0)
    }

    /// State and fatigue at the share `to`, from the state `start` at the share `from`.
    fn advance(&self, start: FatigueState, from: f64, to: f64) -> (FatigueState, f64) {
        if self.seconds <= 0.0 {
            return (start, start.level(self.load.1));
        }
        let state = self.law.advance(start, self.load_at(f64::midpoint(from, to)), (to - from) * self.seconds);
        (state, state.level(self.load_at(to)))
    }

    /// The share at which fatigue reaches 1, between the shares `from` (state `start`) and `to`.
    fn exhaustion(&self, start: FatigueState, from: f64, to: f64) -> f64 {
        let (mut held, mut failed) = (from, to);
        for _ in 0..BISECTIONS {
            let middle = f64::midpoint(held, failed);
            if self.advance(start, from, middle).1 >= 1.0 { failed = middle } else { held = middle }
        }
        failed
    }
}

impl Groups {
    pub(super) fn new(model: &Model) -> Self {
        let known = |i: &usize| {
            let coordinate = &model.coordinates()[*i];
            coordinate.groups.is_some() && coordinate.rate.is_some() && !model.is_dependent(*i)
        };
        let coordinates = (0..model.coordinates().len()).filter(known);
        let summary = |(coordinate, side)| GroupAssessment {
            coordinate,
            side,
            peak_load: Peak::default(),
            peak_torque: 0.0,
            at_peak: PeakTorques::default(),
            loads: LoadHistory::default(),
            peak_fatigue: Peak::default(),
            fatigue: 0.0,
            load: 0.0,
            exhausted_at: None,
            in_doubt: None,
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

    /// Adds the next instant, `seconds` after the one before: load, peak and fatigue of every group.
    pub(super) fn add(&mut self, evaluation: &mut Evaluation<'_>, index: usize, time: f64, seconds: f64) {
        let pieces = (seconds / PIECE).ceil().clamp(1.0, MOST_PIECES);
        for (place, summary) in self.summaries.iter_mut().enumerate() {
            let (i, side) = (summary.coordinate, summary.side);
            let eased = evaluation.eased_passive(i);
            let coordinate = &evaluation.model.coordinates()[i];
            // Present: `new` takes no other coordinates.
            let (Some(groups), Some(rate)) = (&coordinate.groups, coordinate.rate) else { continue };
            let (active, angle) = (evaluation.active(rate), evaluation.torques.angles()[i]);
            let (external, passive) = evaluation.torques.external_and_passive(rate);
            let judged = active - eased;
            let load_of =
                |torque| if Side::of(torque) == side { relative_load(coordinate, angle, torque) } else { 0.0 };
            let load = load_of(judged);
            let before = std::mem::replace(&mut self.load[i][side.index()], load);
            let law = &groups[side.index()].fatigue;
            if index == 0 {
                self.states.push(law.start(0.0, load));
            }
            if load > summary.peak_load.value {
                summary.peak_torque = judged;
                let passive = passive + eased;
                let strength = groups[side.index()].strength.torque(angle);
                let inertia = evaluation.inertia_about_axis(rate);
                summary.at_peak = PeakTorques { angle, external, passive, inertia, strength };
            }
            AngleInDoubt::take(&mut summary.in_doubt, (load_of(active), load), || AngleInDoubt {
                time,
                angle,
                recorded_load: load_of(active),
                judged_load: load,
                recorded_torque: active,
                judged_torque: judged,
            });
            summary.peak_load.take(load, index, time);
            summary.loads.push(time, load);
            summary.load = load;
            let interval = Interval { law, load: (before, load), seconds, pieces };
            tire(summary, &mut self.states[place], &interval, index, time);
            self.fatigue[i][side.index()] = summary.fatigue;
        }
    }
}

/// Advances the fatigue of one group through an interval that ends at `time`.
fn tire(summary: &mut GroupAssessment, state: &mut FatigueState, interval: &Interval<'_>, index: usize, time: f64) {
    let Interval { seconds, pieces, .. } = *interval;
    for piece in 0..pieces as u64 {
        let (from, to) = (piece as f64 / pieces, (piece + 1) as f64 / pieces);
        let start = *state;
        (*state, summary.fatigue) = interval.advance(start, from, to);
        summary.peak_fatigue.take(summary.fatigue, index, time - (1.0 - to) * seconds);
        if summary.fatigue >= 1.0 && summary.exhausted_at.is_none() {
            let exhaustion = interval.exhaustion(start, from, to);
            summary.exhausted_at = Some(time - (1.0 - exhaustion) * seconds);
        }
    }
}
