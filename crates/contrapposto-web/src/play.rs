//! Lets time run: a run of the scenario, some samples a call, with its log and its verdict so far.

use contrapposto::hybrid::Strategy;
use contrapposto::model::plain_group_name;
use contrapposto::simulation::{Event, ReliefRecord, Run, Scenario, StopReason, Summary};
use contrapposto::statics::Load;
use contrapposto::verdict::Verdict;
use contrapposto_formats::{RunScenario, Thing, VerdictText, relief_sentence};
use self_cell::self_cell;

use crate::body::{Body, read_play};
use crate::document::Document;
use crate::drawn::Motion;
use crate::error::Refusal;
use crate::message::{LogLine, Played};
use crate::report::Moment;
use crate::sample::LastSample;
use crate::shown;

/// An event happens at a sample that is earlier by less, s.
const TIME_TOLERANCE: f64 = 1e-9;
/// Most samples of the past that are kept, for looking back.
const MOST_KEPT: usize = 1_000;
/// About so many moments are in a report.
const MOST_MOMENTS: usize = 200;
/// Lines of the log that are given with every answer.
const MOST_LINES: usize = 40;

self_cell!(
    struct Course {
        owner: Scenario,
        #[covariant]
        dependent: Run,
    }

    impl {Debug}
);

/// A run under way.
#[derive(Debug)]
pub(crate) struct Play {
    course: Course,
    /// Things around the body and in its hands, with the times at which they are put down.
    things: Vec<Thing>,
    pub(crate) last: LastSample,
    /// Samples that have passed, one of so many, so that there are never more than [`MOST_KEPT`].
    past: Vec<LastSample>,
    every: u64,
}

impl Play {
    /// A run of a document from its start.
    pub(crate) fn new(document: &Document) -> Result<Self, Refusal> {
        let RunScenario { scenario, things, .. } = read_play(document)?;
        let course = Course::try_new(scenario, |scenario| Run::new(scenario)).map_err(Refusal::of)?;
        Ok(Self { course, things, last: LastSample::default(), past: vec![], every: 1 })
    }

    /// The next samples.
    pub(crate) fn advance(&mut self, body: &Body, samples: u32) -> Result<Played, Refusal> {
        let Self { course, last, past, every, .. } = self;
        let mut ended = false;
        course.with_dependent_mut(|_, run| {
            for _ in 0..samples {
                match run.next_sample().map_err(Refusal::of)? {
                    Some(sample) => {
                        last.take(&sample);
                        keep(past, every, last);
                    }
                    None => {
                        ended = true;
                        break;
                    }
                }
            }
            Ok::<(), Refusal>(())
        })?;
        self.played(body, &self.last, ended)
    }

    /// The run at a moment that has passed, s: of the samples that are kept, the last one until then.
    pub(crate) fn look(&self, body: &Body, time: f64) -> Result<Played, Refusal> {
        let until = |sample: &&LastSample| sample.time <= time + TIME_TOLERANCE;
        let sample = if time >= self.last.time { Some(&self.last) } else { self.past.iter().rev().find(until) };
        let sample = sample.or(self.past.first()).ok_or_else(|| Refusal::of("nothing has passed yet"))?;
        self.played(body, sample, false)
    }

    /// Times and postures of the samples that are kept, at even steps.
    pub(crate) fn motion(&self) -> Motion<'_> {
        let kept = if self.past.is_empty() { std::slice::from_ref(&self.last) } else { &self.past };
        kept.iter().map(|sample| (sample.time, sample.posture.as_slice())).unzip()
    }

    /// Things around the body and in its hands, with the times at which they are put down.
    pub(crate) fn things(&self) -> &[Thing] {
        &self.things
    }

    /// Number of the samples of the run so far.
    pub(crate) fn samples(&self) -> u64 {
        self.last.number + 1
    }

    /// The samples that are kept, and the last one; of many, some at even steps.
    pub(crate) fn moments(&self, body: &Body) -> Result<Vec<Moment>, Refusal> {
        let stride = self.past.len().div_ceil(MOST_MOMENTS).max(1);
        let kept = self.past.iter().step_by(stride).filter(|sample| sample.number < self.last.number);
        let moment = |sample: &LastSample| {
            let shown = self.played(body, sample, false)?.shown;
            Ok(Moment { time: sample.time, shown, fatigue: sample.fatigue.clone() })
        };
        kept.chain([&self.last]).map(moment).collect()
    }

    /// All decisions so far.
    pub(crate) fn decisions(&self) -> Vec<LogLine> {
        log(self.course.borrow_owner(), &self.course.borrow_dependent().summary(), f64::INFINITY, usize::MAX)
    }

    /// Fatigue at which relief begins and ends.
    pub(crate) fn levels(&self) -> [f64; 2] {
        let hysteresis = &self.course.borrow_owner().hysteresis;
        [hysteresis.critical_level, hysteresis.recovery_level]
    }

    /// The strategy of every coordinate with muscles, where an event has changed them.
    pub(crate) fn strategies(&self) -> Option<Vec<(String, Strategy)>> {
        let scenario = self.course.borrow_owner();
        let strategies = self.happened(self.last.time).filter_map(|event| event.strategies.as_ref()).last()?;
        let coordinates = scenario.model.coordinates().iter().zip(strategies);
        let with_muscles = coordinates.filter(|(coordinate, _)| coordinate.groups.is_some());
        Some(with_muscles.map(|(coordinate, strategy)| (coordinate.name.clone(), *strategy)).collect())
    }

    /// The loads of a sample.
    fn loads(&self, sample: &LastSample) -> &[Load] {
        let of_start = &self.course.borrow_owner().loads;
        self.happened(sample.time).filter_map(|event| event.loads.as_ref()).last().unwrap_or(of_start)
    }

    /// The events until a moment, s.
    fn happened(&self, time: f64) -> impl Iterator<Item = &Event> {
        let time = time + TIME_TOLERANCE;
        self.course.borrow_owner().events.iter().take_while(move |event| event.time <= time)
    }

    fn played(&self, body: &Body, last: &LastSample, ended: bool) -> Result<Played, Refusal> {
        let scenario = self.course.borrow_owner();
        let mut summary = self.course.borrow_dependent().summary();
        // What was run is all that is judged: a run as long as that, not one that was broken off.
        let reason = ended.then_some(summary.reason.word());
        if summary.reason == StopReason::Interrupted {
            summary.reason = StopReason::Duration;
        }
        let verdict = VerdictText::new(&scenario.model, &Verdict::of_run(scenario, &summary));
        let group = |&(i, side): &(usize, usize)| {
            let coordinate = &scenario.model.coordinates()[i];
            let groups = coordinate.groups.as_ref();
            groups.map_or_else(String::new, |groups| plain_group_name(&groups[side].name, &coordinate.name))
        };
        Ok(Played {
            time: last.time,
            samples: summary.samples,
            fatigue: last.fatigue.clone(),
            asking: last.asking.iter().map(group).collect(),
            log: log(scenario, &summary, last.time, MOST_LINES),
            decisions: summary.reliefs.count,
            put_down: (0..self.things.len()).filter(|&i| !self.things[i].is_there(last.time)).collect(),
            ended: reason,
            shown: shown::sample(body, last, self.loads(last), verdict)?,
        })
    }
}

/// Keeps a sample, unless it is one of those that are passed over.
fn keep(past: &mut Vec<LastSample>, every: &mut u64, sample: &LastSample) {
    if !sample.number.is_multiple_of(*every) {
        return;
    }
    if past.len() == MOST_KEPT {
        *every *= 2;
        past.retain(|sample| sample.number.is_multiple_of(*every));
    }
    if sample.number.is_multiple_of(*every) {
        past.push(sample.clone());
    }
}

/// The latest decisions until a moment, at most so many, in the order in which they came.
fn log(scenario: &Scenario, summary: &Summary, until: f64, most: usize) -> Vec<LogLine> {
    let records = &summary.reliefs.records;
    let records = &records[..records.partition_point(|record| record.time.0 <= until + TIME_TOLERANCE)];
    let latest = &records[records.len().saturating_sub(most)..];
    let line =
        |record: &ReliefRecord| LogLine { time: record.time.0, sentence: relief_sentence(&scenario.model, record) };
    latest.iter().map(line).collect()
}
