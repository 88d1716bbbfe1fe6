//! A run as a page shows it: some hundred moments, those of decisions among them.

use contrapposto::hybrid::Decision;
use contrapposto::simulation::{Scenario, Summary};

use super::frame::Frame;
use super::recording::Recording;

/// Most frames besides those of decisions.
pub(crate) const MOST_FRAMES: usize = 600;
/// Most decisions that are told.
const MOST_EVENTS: usize = 120;

/// What was decided.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    pub(crate) time: f64,
    pub(crate) coordinate: usize,
    pub(crate) what: What,
}

/// What happened to a coordinate.
#[derive(Clone, Copy, Debug)]
pub(crate) enum What {
    /// A tired group asked for relief, and this is the answer.
    Decided(Decision),
    /// It asked, but something more important holds the joint, or relief was taken back too often.
    Waits,
    /// No group of it needs relief any more.
    Recovered,
}

/// A run, as far as a page shows it.
#[derive(Debug)]
pub(crate) struct Film {
    /// Its moments, the first and the last among them.
    pub(crate) frames: Vec<Frame>,
    /// What was decided, in the order of time; the first ones of a long list.
    pub(crate) events: Vec<Event>,
    /// How much was decided in all.
    pub(crate) happened: u64,
}

impl Film {
    pub(crate) fn new(scenario: &Scenario, recording: &Recording, summary: &Summary) -> Self {
        let times = recording.times();
        let row_of = |time: f64| times.partition_point(|&t| t < time).min(times.len().saturating_sub(1));
        let mut events = vec![];
        let records = &summary.reliefs.records;
        for record in records {
            let (time, coordinate) = (record.time.0, record.coordinate);
            events.push(Event { time, coordinate, what: record.decision.map_or(What::Waits, What::Decided) });
            let next = records.iter().find(|r| r.coordinate == coordinate && r.time.0 >= record.time.1);
            let until = next.map_or(times.len(), |next| times.partition_point(|&t| t < next.time.0));
            // A joint may have nothing to ask for long before it has recovered.
            let rested = |row: &usize| {
                let fatigue = recording.row(*row).fatigue[coordinate];
                fatigue.iter().all(|level| *level <= scenario.hysteresis.recovery_level)
            };
            if let Some(row) = (times.partition_point(|&t| t < record.time.1)..until).find(rested) {
                events.push(Event { time: times[row], coordinate, what: What::Recovered });
            }
        }
        events.sort_by(|a, b| a.time.total_cmp(&b.time));
        let happened = events.len() as u64 + (summary.reliefs.count - records.len() as u64);
        events.truncate(MOST_EVENTS);
        let stride = times.len().div_ceil(MOST_FRAMES).max(1);
        let mut rows: Vec<usize> = (0..times.len()).filter(|row| row % stride == 0 || row + 1 == times.len()).collect();
        rows.extend(events.iter().map(|event| row_of(event.time)));
        rows.sort_unstable();
        rows.dedup();
        Self { frames: rows.into_iter().map(|row| Frame::of_row(recording.row(row))).collect(), events, happened }
    }
}
