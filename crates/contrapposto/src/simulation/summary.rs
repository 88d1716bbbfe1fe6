//! Summarises a run: its end, and what every coordinate went through.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{FootStep, MuscleOutcome, ReliefLog, Sample, Standing};
use crate::contact::{Missing, Slip};
use crate::fatigue::LoadHistory;
use crate::hybrid::{Case, Decision};
use crate::joint_torques::{GroupLoad, Hazard};
use crate::model::{Coordinate, Side};

/// Most changes of case that are recorded in order; a run whose cases alternate has thousands.
const MOST_CHANGES: usize = 200;

/// The reason for which a run stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// The whole duration was simulated.
    Duration,
    /// Relief no longer moved anything.
    Settled,
    /// The run was left before its end.
    Interrupted,
    /// An event has thrown the body off balance: [`Summary::fall`].
    Fell,
    /// Supports slid by more than [`Slip::GREATEST`] for a second: [`Summary::sliding_since`].
    Slid,
}

/// The end of a body that an event has thrown off balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fall {
    /// Time of the event, s.
    pub time: f64,
    /// Force and moment that the supports lacked, in the posture in which the event met the body.
    pub missing: Missing,
}

impl fmt::Display for Fall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, missing } = self;
        write!(
            f,
            "the event at {time} s throws the body off balance, and no posture nearby restores balance: {missing}"
        )
    }
}

impl StopReason {
    /// `duration`, `settled`, `interrupted`, `fell` or `slid`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Duration => "duration",
            Self::Settled => "settled",
            Self::Interrupted => "interrupted",
            Self::Fell => "fell",
            Self::Slid => "slid",
        }
    }
}

/// A muscle group at the end of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GroupAtEnd {
    /// Relative load.
    pub load: f64,
    /// Fatigue, 0..=1.
    pub fatigue: f64,
    /// For how long it could go on to hold its load, s; `None` for ever.
    pub seconds_left: Option<f64>,
}

/// Time for which ligaments carried a coordinate at an angle where that is a hazard, and the moment when they carried most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hazardous {
    /// Number of samples.
    pub samples: u64,
    /// The moment, s.
    pub time: f64,
    /// Angle there, rad: of a three-axis joint that about the axis.
    pub angle: f64,
    /// External and passive torque there, N m.
    pub torques: [f64; 2],
}

impl Hazardous {
    /// Time from sample to sample, s, of samples that are `step` seconds apart.
    pub fn seconds(&self, step: f64) -> f64 {
        self.samples.saturating_sub(1) as f64 * step
    }
}

/// Results of one coordinate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CoordinateSummary {
    /// Cases in the order they came, repetitions left out; the first two hundred changes.
    pub cases: Vec<Case>,
    /// Number of all changes of the case.
    pub case_changes: u64,
    /// Number of decisions of each case, in the order of [`Case::ALL`].
    pub iterations: [u64; 10],
    /// Last value, rad or m.
    pub final_value: f64,
    /// Last torques: external, passive, active, N m.
    pub final_torques: [f64; 3],
    /// Greatest relative load while no support was put elsewhere.
    pub peak_load: f64,
    /// Greatest fatigue of the positive and negative group while no support was put elsewhere.
    pub peak_fatigue: [f64; 2],
    /// The positive and negative group in the last sample in which no support was put elsewhere.
    pub final_groups: [GroupAtEnd; 2],
    /// Time at which each group could first no longer hold its load, s; groups are not judged while a support is put elsewhere.
    pub exhausted_at: [Option<f64>; 2],
    /// The last decision.
    pub last_decision: Option<Decision>,
    /// Hazard by ligaments while no support was put elsewhere.
    pub hazardous: Option<Hazardous>,
    /// Relative load of the positive and negative group over the run; while a support is put elsewhere the load before goes on.
    pub loads: [LoadHistory; 2],
}

/// Results of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The reason for which the run stopped.
    pub reason: StopReason,
    /// The fall, if nothing holds the body any more.
    pub fall: Option<Fall>,
    /// Time of the last sample, s.
    pub end_time: f64,
    /// Number of samples.
    pub samples: u64,
    /// One entry a coordinate.
    pub coordinates: Vec<CoordinateSummary>,
    /// The greatest relative load while no support was put elsewhere, and when that was, s.
    pub hardest: Option<(GroupLoad, f64)>,
    /// Error of the tasks of each priority, in their units, where it counts: the greatest of those in the first sample, before each
    /// event and at the end; of tasks below relief only that in the first sample.
    pub errors: Vec<f64>,
    /// Every relief.
    pub reliefs: ReliefLog,
    /// Effort of a body with supports or tasks in the first sample.
    pub effort_at_start: Option<f64>,
    /// A search for an easier posture ended at its budget of solver steps, or was not begun since that of the run is spent.
    pub search_cut: bool,
    /// Supports that were put elsewhere.
    pub foot_steps: Vec<FootStep>,
    /// Numbers of the supports in use at the end, ascending.
    pub in_use: Vec<usize>,
    /// The greatest distance of the supports from their places, and when that was, s; `None` without supports.
    pub slip: Option<(Slip, f64)>,
    /// Since when the supports of the last sample have been farther away than [`Slip::GREATEST`], s.
    pub sliding_since: Option<f64>,
    /// Balance, tasks and effort of the body in the last sample.
    pub standing: Option<Standing>,
    /// The muscles, where they tire one by one.
    pub muscles: Option<MuscleOutcome>,
}

impl CoordinateSummary {
    pub(super) fn take(&mut self, i: usize, coordinate: &Coordinate, sample: &Sample) {
        self.final_value = sample.posture[i];
        self.final_torques = [sample.external[i], sample.passive[i], sample.active[i]];
        if !sample.stepping {
            self.take_load(i, sample);
            self.take_hazard(i, coordinate, sample);
        }
        let Some(decision) = &sample.decisions[i] else { return };
        self.iterations[decision.case as usize] += 1;
        if self.last_decision.is_none_or(|last| last.case != decision.case) {
            self.case_changes += 1;
            if self.cases.len() < MOST_CHANGES {
                self.cases.push(decision.case);
            }
        }
        self.last_decision = Some(*decision);
    }

    fn take_hazard(&mut self, i: usize, coordinate: &Coordinate, sample: &Sample) {
        let (angle, torques) = (sample.angles[i], [sample.external[i], sample.passive[i]]);
        if Hazard::at(coordinate, angle, torques[0], torques[1]).is_none() {
            return;
        }
        let now = Hazardous { samples: 1, time: sample.time, angle, torques };
        let hazardous = self.hazardous.get_or_insert(Hazardous { samples: 0, ..now });
        let samples = hazardous.samples + 1;
        if torques[1].abs() > hazardous.torques[1].abs() {
            *hazardous = now;
        }
        hazardous.samples = samples;
    }

    /// Loads, fatigue and exhaustion; not of a sample in which a support is put elsewhere.
    fn take_load(&mut self, i: usize, sample: &Sample) {
        self.peak_load = self.peak_load.max(sample.load[i]);
        for side in Side::BOTH.map(Side::index) {
            self.peak_fatigue[side] = self.peak_fatigue[side].max(sample.fatigue[i][side]);
            let load = sample.group_load[i][side];
            self.loads[side].push(sample.time, load);
            let left = sample.seconds_left[i][side];
            self.final_groups[side] =
                GroupAtEnd { load, fatigue: sample.fatigue[i][side], seconds_left: left.is_finite().then_some(left) };
            if sample.exhausted[i][side] && self.exhausted_at[side].is_none() {
                self.exhausted_at[side] = Some(sample.time);
            }
        }
    }
}
