//! Runs a scenario from its start, or from a snapshot, to its end.

use serde::{Deserialize, Serialize};

use super::relief_log::ReliefLog;
use super::state::State;
use super::step::TIME_TOLERANCE;
use super::{CoordinateSummary, Fall, Sample, Scenario, ScenarioError, Simulation, Standing, StopReason, Summary};
use crate::contact::Slip;
use crate::joint_torques::GroupLoad;
use crate::model::Side;

/// Supports that slide for so long, s, are not put back by a recovery of balance (assumed).
const LONGEST_SLIDE: f64 = 1.0;
/// Steps between two snapshots.
const SNAPSHOT_STEPS: u64 = 900;

/// A moment from which a run can be resumed. A resumed run gives the same bytes as one that was never interrupted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Samples taken before.
    pub samples: u64,
    state: State,
    end_time: f64,
    coordinates: Vec<CoordinateSummary>,
    reliefs: ReliefLog,
    effort_at_start: Option<f64>,
    hardest: Option<(GroupLoad, f64)>,
    slip: Option<(Slip, f64)>,
    sliding_since: Option<f64>,
    errors: Errors,
}

/// Errors of the tasks of each priority, in their units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Errors {
    /// The greatest of those that count so far.
    counted: Vec<f64>,
    /// In the last sample.
    last: Vec<f64>,
    /// Events that have happened.
    events: usize,
}

impl Errors {
    /// Counts the last errors: all of them, or those of tasks above relief.
    fn count(&mut self, scenario: &Scenario, all: bool) {
        self.counted.resize(self.last.len(), 0.0);
        for ((counted, last), task) in self.counted.iter_mut().zip(&self.last).zip(&scenario.tasks) {
            if all || task.above_relief {
                *counted = counted.max(*last);
            }
        }
    }

    /// Counts the errors before each event that happens until `time`.
    fn count_before_events(&mut self, scenario: &Scenario, time: f64) {
        let happened = scenario.events.partition_point(|event| event.time <= time + TIME_TOLERANCE);
        if happened > self.events {
            self.events = happened;
            self.count(scenario, false);
        }
    }
}

/// A scenario under way, sample by sample.
#[derive(Debug)]
pub struct Run<'a> {
    scenario: &'a Scenario,
    simulation: Simulation<'a>,
    /// All samples so far; its `state` is that of the last snapshot.
    so_far: Snapshot,
    snapshot: Snapshot,
    /// Samples in all.
    samples: u64,
    reason: Option<StopReason>,
    fall: Option<Fall>,
    /// In the last sample.
    standing: Option<Standing>,
    stop_when_settled: bool,
    /// Time of the last event, s.
    last_event: f64,
}

impl<'a> Run<'a> {
    /// From the start.
    ///
    /// # Errors
    /// [`ScenarioError`] when the scenario is not in order.
    pub fn new(scenario: &'a Scenario) -> Result<Self, ScenarioError> {
        let mut simulation = Simulation::new(scenario)?;
        let n = scenario.model.coordinates().len();
        let start = Snapshot {
            samples: 0,
            state: simulation.state(),
            end_time: 0.0,
            coordinates: vec![CoordinateSummary::default(); n],
            reliefs: ReliefLog::new(n),
            effort_at_start: None,
            hardest: None,
            slip: None,
            sliding_since: None,
            errors: Errors::default(),
        };
        Ok(Self::with(scenario, simulation, start))
    }

    /// From the snapshot of another run of the same scenario.
    ///
    /// # Errors
    /// [`ScenarioError::Snapshot`] if the snapshot is that of another body or run.
    pub fn resume(scenario: &'a Scenario, snapshot: Snapshot) -> Result<Self, ScenarioError> {
        let n = scenario.model.coordinates().len();
        if snapshot.coordinates.len() != n || !snapshot.reliefs.fits(n) || snapshot.samples != snapshot.state.steps {
            return Err(ScenarioError::Snapshot);
        }
        let simulation = Simulation::resume(scenario, snapshot.state.clone())?;
        Ok(Self::with(scenario, simulation, snapshot))
    }

    fn with(scenario: &'a Scenario, simulation: Simulation<'a>, start: Snapshot) -> Self {
        Self {
            scenario,
            simulation,
            snapshot: start.clone(),
            so_far: start,
            samples: scenario.run.steps() + 1,
            reason: None,
            fall: None,
            standing: None,
            stop_when_settled: scenario.run.stop_when_settled,
            last_event: scenario.events.last().map_or(0.0, |event| event.time),
        }
    }

    /// The next sample; `None` at the end.
    ///
    /// # Errors
    /// For a scenario that was checked only [`ScenarioError::Falls`], by an event at its very start.
    pub fn next_sample(&mut self) -> Result<Option<Sample<'_>>, ScenarioError> {
        if self.reason.is_none() && self.so_far.samples >= self.samples {
            self.reason = Some(StopReason::Duration);
        }
        if self.reason.is_some() {
            return Ok(None);
        }
        if self.so_far.samples.is_multiple_of(SNAPSHOT_STEPS) && self.so_far.samples > self.snapshot.samples {
            self.so_far.state = self.simulation.state();
            self.snapshot.clone_from(&self.so_far);
        }
        let time = self.so_far.samples as f64 * self.scenario.run.step;
        self.so_far.errors.count_before_events(self.scenario, time);
        let sample = match self.simulation.step() {
            Err(ScenarioError::Falls(fall)) if self.so_far.samples > 0 => {
                (self.reason, self.fall) = (Some(StopReason::Fell), Some(fall));
                return Ok(None);
            }
            stepped => stepped?,
        };
        self.so_far.samples += 1;
        self.so_far.end_time = sample.time;
        let coordinates = self.scenario.model.coordinates();
        for (i, summary) in self.so_far.coordinates.iter_mut().enumerate() {
            summary.take(i, &coordinates[i], &sample);
        }
        self.so_far.reliefs.take(&sample);
        if !sample.stepping {
            take_hardest(&mut self.so_far.hardest, &sample);
        }
        if let Some(standing) = sample.standing {
            self.so_far.errors.last.clone_from(&standing.errors);
            if self.so_far.samples == 1 {
                self.so_far.errors.count(self.scenario, true);
            }
            self.so_far.effort_at_start.get_or_insert(standing.effort);
            self.standing.get_or_insert_default().clone_from(standing);
            take_slip(&mut self.so_far.slip, standing, sample.time);
            let since = self.so_far.sliding_since.unwrap_or(sample.time);
            self.so_far.sliding_since = standing.slip.exceeds(Slip::GREATEST).then_some(since);
            if self.so_far.sliding_since.is_some_and(|since| sample.time - since + TIME_TOLERANCE >= LONGEST_SLIDE) {
                self.reason = Some(StopReason::Slid);
                return Ok(Some(sample));
            }
        }
        if sample.settled && self.stop_when_settled && sample.time + TIME_TOLERANCE >= self.last_event {
            self.reason = Some(StopReason::Settled);
        }
        Ok(Some(sample))
    }

    /// The last snapshot.
    pub fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// Solver steps so far: one a sample, and those of the searches.
    pub fn solver_steps(&self) -> usize {
        self.simulation.searched() + self.so_far.samples as usize
    }

    /// The results so far.
    pub fn summary(&self) -> Summary {
        let mut errors = self.so_far.errors.clone();
        errors.count(self.scenario, false);
        let end = self.so_far.end_time;
        let muscles = self.simulation.muscle_outcome(end);
        let mut coordinates = self.so_far.coordinates.clone();
        for (outcome, i) in muscles.iter().flat_map(|outcome| outcome.coordinates.iter().map(move |&i| (outcome, i))) {
            for side in Side::BOTH {
                let left = &mut coordinates[i].final_groups[side.index()].seconds_left;
                *left = outcome.seconds_left((i, side), end, *left);
            }
        }
        Summary {
            hardest: self.so_far.hardest,
            slip: self.so_far.slip,
            sliding_since: self.so_far.sliding_since,
            errors: errors.counted,
            reason: self.reason.unwrap_or(StopReason::Interrupted),
            fall: self.fall,
            end_time: self.so_far.end_time,
            samples: self.so_far.samples,
            coordinates,
            reliefs: self.so_far.reliefs.clone(),
            effort_at_start: self.so_far.effort_at_start,
            search_cut: self.simulation.state.search_cut,
            foot_steps: self.simulation.foot_steps().to_vec(),
            in_use: self.simulation.state.in_use.clone(),
            standing: self.standing.clone(),
            muscles,
        }
    }
}

/// Takes in the greatest relative load of a sample.
fn take_hardest(hardest: &mut Option<(GroupLoad, f64)>, sample: &Sample) {
    let (mut coordinate, mut load) = (0, 0.0);
    for (i, &other) in sample.load.iter().enumerate() {
        if other > load {
            (coordinate, load) = (i, other);
        }
    }
    if load > hardest.map_or(0.0, |(hardest, _)| hardest.load) {
        let torque = sample.active[coordinate];
        *hardest = Some((GroupLoad { coordinate, side: Side::of(torque), torque, load }, sample.time));
    }
}

/// Takes in the slip of a sample.
fn take_slip(greatest: &mut Option<(Slip, f64)>, standing: &Standing, time: f64) {
    let share = |slip: Slip| slip.share_of(Slip::NOTICED);
    if !standing.contacts.is_empty() && greatest.is_none_or(|(greatest, _)| share(standing.slip) > share(greatest)) {
        *greatest = Some((standing.slip, time));
    }
}

/// Runs a scenario, showing every sample to `record`. Memory grows with the number of changes of load, not with the length of the run.
///
/// # Errors
/// [`ScenarioError`] when the scenario is not in order.
pub fn run(scenario: &Scenario, mut record: impl FnMut(&Sample)) -> Result<Summary, ScenarioError> {
    let mut run = Run::new(scenario)?;
    while let Some(sample) = run.next_sample()? {
        record(&sample);
    }
    Ok(run.summary())
}
