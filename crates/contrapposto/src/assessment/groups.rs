//! Follows load and fatigue of every muscle group through a motion.

use super::evaluation::Evaluation;
use super::result::{AngleInDoubt, GroupAssessment, Peak, PeakTorques};
use crate::fatigue::{FatigueLaw, FatigueState, Interval, LoadCycle, LoadHistory};
use crate::joint_torques::relative_load;
use crate::model::{Model, Side};

/// All groups of known strength over time.
pub(super) struct Groups {
    pub(super) summaries: Vec<GroupAssessment>,
    states: Vec<FatigueState>,
    /// By coordinate.
    pub(super) fatigue: Vec<[f64; 2]>,
    pub(super) load: Vec<[f64; 2]>,
    /// Keeps the load of every instant.
    cyclic: bool,
}

impl Groups {
    pub(super) fn new(model: &Model, cyclic: bool) -> Self {
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
            cycle: LoadCycle::default(),
            repeated: None,
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
            cyclic,
        }
    }

    /// Adds the next instant, `seconds` after the one before: load, peak and fatigue of every group.
    pub(super) fn add(&mut self, evaluation: &mut Evaluation<'_>, index: usize, time: f64, seconds: f64) {
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
            if self.cyclic {
                summary.cycle.push(time, load);
            }
            summary.load = load;
            let interval = Interval { load: (before, load), seconds };
            tire(summary, law, &mut self.states[place], (index, time), interval);
            self.fatigue[i][side.index()] = summary.fatigue;
        }
    }
}

/// Advances the fatigue of one group through an interval that ends at an instant.
fn tire(
    summary: &mut GroupAssessment,
    law: &FatigueLaw,
    state: &mut FatigueState,
    (index, time): (usize, f64),
    interval: Interval,
) {
    let seconds = interval.seconds;
    for piece in interval.pieces() {
        let start = *state;
        (*state, summary.fatigue) = interval.advance(law, start, piece);
        summary.peak_fatigue.take(summary.fatigue, index, time - (1.0 - piece.1) * seconds);
        if summary.fatigue >= 1.0 && summary.exhausted_at.is_none() {
            let exhaustion = interval.share_of(law, start, piece, 1.0);
            summary.exhausted_at = Some(time - (1.0 - exhaustion) * seconds);
        }
    }
}
