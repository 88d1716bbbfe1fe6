//! Records each relief, from the first request of a group to the next change of its decision.

use serde::{Deserialize, Serialize};

use super::sample::{Attempt, Relief, Sample};
use crate::hybrid::{Case, Decision, Outcome, Strategy};
use crate::model::Side;

/// Most reliefs that are recorded; a run whose decisions alternate has more.
const MOST_RECORDS: usize = 10_000;

/// One relief of one coordinate: a run of decisions of the same case and outcome.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReliefRecord {
    /// Coordinate.
    pub coordinate: usize,
    /// The muscle group that requested relief.
    pub side: Side,
    /// Fatigue of the group at the first request, 0..=1.
    pub fatigue: f64,
    /// The strategy of its coordinate.
    pub strategy: Strategy,
    /// The attempt by which relief was sought.
    pub attempt: Attempt,
    /// The first decision; `None` where the joint could not move, another joint moved or nothing was left to try.
    pub decision: Option<Decision>,
    /// Begin and end, s.
    pub time: (f64, f64),
    /// The coordinate at begin and end, rad or m.
    pub value: (f64, f64),
    /// Active torque at begin and end, N m.
    pub active: (f64, f64),
    /// Sum over its steps of the predicted change of active torque, N m.
    pub predicted: f64,
    /// Sum of the actual changes, N m.
    pub actual: f64,
    /// Steps that were carried out.
    pub done: u64,
    /// Steps that something more important did not allow.
    pub deferred: u64,
    /// Steps that were taken back.
    pub taken_back: u64,
    /// Steps in which the joint could not move or nothing was left to try.
    pub idle: u64,
}

/// All reliefs of a run, in the order in which they began.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReliefLog {
    /// The first ten thousand.
    pub records: Vec<ReliefRecord>,
    /// Number of all reliefs.
    pub count: u64,
    /// By coordinate: the record that continues.
    open: Vec<Option<usize>>,
}

impl ReliefLog {
    pub(super) fn new(coordinates: usize) -> Self {
        Self { open: vec![None; coordinates], ..Self::default() }
    }

    /// Whether every record that it names is there.
    pub(super) fn fits(&self, coordinates: usize) -> bool {
        self.open.len() == coordinates
            && self.open.iter().flatten().all(|&place| place < self.records.len())
            && self.records.iter().all(|record| record.coordinate < coordinates)
    }

    /// Takes in the next sample.
    pub(super) fn take(&mut self, sample: &Sample) {
        for i in 0..self.open.len() {
            if let Some(record) = self.open[i].and_then(|place| self.records.get_mut(place)) {
                record.add(sample);
            }
            let (Some(side), Some(attempt)) = (sample.asking[i], sample.attempts[i]) else {
                self.open[i] = None;
                continue;
            };
            let goes_on = self.open[i].is_some_and(|place| {
                let record = &self.records[place];
                (record.side, record.attempt) == (side, attempt) && record.kind() == sample.decisions[i].map(kind)
            });
            if goes_on {
                continue;
            }
            self.count += 1;
            self.open[i] = None;
            if self.records.len() < MOST_RECORDS {
                self.open[i] = Some(self.records.len());
                self.records.push(ReliefRecord::new(i, side, attempt, sample));
            }
        }
    }
}

impl ReliefRecord {
    fn new(coordinate: usize, side: Side, attempt: Attempt, sample: &Sample) -> Self {
        let (value, active) = (sample.posture[coordinate], sample.active[coordinate]);
        let mut record = Self {
            coordinate,
            side,
            fatigue: sample.fatigue[coordinate][side.index()],
            strategy: sample.strategies[coordinate],
            attempt,
            decision: sample.decisions[coordinate],
            time: (sample.time, sample.time),
            value: (value, value),
            active: (active, active),
            predicted: 0.0,
            actual: 0.0,
            done: 0,
            deferred: 0,
            taken_back: 0,
            idle: 0,
        };
        record.idle = u64::from(record.is_idle());
        record
    }

    /// The step that led to the sample.
    fn add(&mut self, sample: &Sample) {
        let i = self.coordinate;
        self.time.1 = sample.time;
        self.value.1 = sample.posture[i];
        self.active.1 = sample.active[i];
        match sample.reliefs[i] {
            Some(Relief::Done { predicted, actual }) => {
                self.predicted += predicted;
                self.actual += actual;
                self.done += 1;
            }
            Some(Relief::Deferred) => self.deferred += 1,
            Some(Relief::TakenBack) => self.taken_back += 1,
            None => {}
        }
        self.idle += u64::from(self.is_idle());
    }

    fn is_idle(&self) -> bool {
        self.decision.is_none() && !matches!(self.attempt, Attempt::OtherJoint { .. })
    }

    fn kind(&self) -> Option<(Case, Outcome)> {
        self.decision.map(kind)
    }
}

fn kind(decision: Decision) -> (Case, Outcome) {
    (decision.case, decision.outcome)
}
