//! Selects the moments of a run that a page shows: some hundred frames, those of decisions, of failures and of the greatest load among
//! them.

use contrapposto::hybrid::Decision;
use contrapposto::simulation::{Scenario, Summary};

use super::frame::Frame;
use super::recording::Recording;

/// Most frames besides those of decisions.
pub(crate) const MOST_FRAMES: usize = 600;
/// Most events that are listed.
const MOST_EVENTS: usize = 120;

/// One event of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    pub(crate) time: f64,
    pub(crate) coordinate: usize,
    pub(crate) kind: EventKind,
}

/// The kind of an event.
#[derive(Clone, Copy, Debug)]
pub(crate) enum EventKind {
    /// A tired group needed relief, and this was decided.
    Decided(Decision),
    /// A tired group needed relief, but supports, tasks or a more tired group prevent it, or relief was reversed too often.
    Waits,
    /// No group of it needs relief any more.
    Recovered,
}

/// A run, as far as a page shows it.
#[derive(Debug)]
pub(crate) struct RunExcerpt {
    /// Moments of the run, the first and the last among them.
    pub(crate) frames: Vec<Frame>,
    /// Events in the order of time; the first ones of a long list.
    pub(crate) events: Vec<Event>,
    /// Number of all events.
    pub(crate) happened: u64,
}

impl RunExcerpt {
    pub(crate) fn new(scenario: &Scenario, recording: &Recording, summary: &Summary) -> Self {
        let times = recording.times();
        let row_of = |time: f64| times.partition_point(|&t| t < time).min(times.len().saturating_sub(1));
        let mut events = vec![];
        let records = &summary.reliefs.records;
        for record in records {
            let (time, coordinate) = (record.time.0, record.coordinate);
            events.push(Event { time, coordinate, kind: record.decision.map_or(EventKind::Waits, EventKind::Decided) });
            let next = records.iter().find(|r| r.coordinate == coordinate && r.time.0 >= record.time.1);
            let until = next.map_or(times.len(), |next| times.partition_point(|&t| t < next.time.0));
            // A joint may need no relief long before it has recovered.
            let rested = |row: &usize| {
                let fatigue = recording.row(*row).fatigue[coordinate];
                fatigue.iter().all(|level| *level <= scenario.hysteresis.recovery_level)
            };
            if let Some(row) = (times.partition_point(|&t| t < record.time.1)..until).find(rested) {
                events.push(Event { time: times[row], coordinate, kind: EventKind::Recovered });
            }
        }
        events.sort_by(|a, b| a.time.total_cmp(&b.time));
        let happened = events.len() as u64 + (summary.reliefs.count - records.len() as u64);
        events.truncate(MOST_EVENTS);
        let stride = times.len().div_ceil(MOST_FRAMES).max(1);
        let mut rows: Vec<usize> = (0..times.len()).filter(|row| row % stride == 0 || row + 1 == times.len()).collect();
        rows.extend(events.iter().map(|event| row_of(event.time)));
        let failures = summary.coordinates.iter().flat_map(|coordinate| coordinate.exhausted_at).flatten();
        rows.extend(failures.map(row_of));
        rows.sort_unstable();
        rows.dedup();
        let mut frames: Vec<Frame> =
            rows.into_iter().map(|row| Frame::of_row(&scenario.model, recording.row(row))).collect();
        if let Some(hardest) = recording.hardest().map(|row| Frame::of_row(&scenario.model, row))
            && let Err(place) = frames.binary_search_by(|frame| frame.time.total_cmp(&hardest.time))
        {
            frames.insert(place, hardest);
        }
        Self { frames, events, happened }
    }

    /// The frame nearest to a time.
    pub(crate) fn nearest(&self, time: f64) -> usize {
        let away = |i: &usize| (self.frames[*i].time - time).abs();
        (0..self.frames.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0)
    }
}
