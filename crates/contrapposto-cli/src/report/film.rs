//! A run as a page shows it: some hundred moments, those of decisions among them.

use contrapposto::assessment::Instant;
use contrapposto::contact::ContactForces;
use contrapposto::hybrid::Decision;
use contrapposto::model::{Model, Side};
use contrapposto::simulation::{Contact, Scenario, Standing, Summary};
use nalgebra::Vector3;

use crate::simulate::{Recording, Row};

/// Most frames besides those of decisions.
pub(super) const MOST_FRAMES: usize = 600;
/// Most decisions that are told.
const MOST_EVENTS: usize = 120;

/// One moment.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) time: f64,
    pub(crate) posture: Vec<f64>,
    pub(crate) external: Vec<f64>,
    pub(crate) passive: Vec<f64>,
    pub(crate) load: Vec<f64>,
    /// Where it is known.
    pub(crate) fatigue: Option<Vec<[f64; 2]>>,
    pub(crate) standing: Option<Standing>,
}

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

impl Frame {
    pub(super) fn of_row(row: Row) -> Self {
        let contact = |numbers: &[f64; 10]| {
            let [share, fx, fy, fz, px, py, pz, cx, cy, cz] = *numbers;
            let (force, at, couple) = ([fx, fy, fz].into(), [px, py, pz].into(), [cx, cy, cz].into());
            Contact { force, share, center_of_pressure: (share > 0.0).then_some(at), couple }
        };
        let standing = row.center_of_mass.map(|center| Standing {
            contacts: row.contacts.iter().map(contact).collect(),
            center_of_mass: center.into(),
            ..Standing::default()
        });
        Self {
            time: row.time,
            posture: row.posture.to_vec(),
            external: row.external.to_vec(),
            passive: row.passive.to_vec(),
            load: row.load.to_vec(),
            fatigue: Some(row.fatigue.to_vec()),
            standing,
        }
    }

    /// A posture with its torques by rate.
    pub(super) fn at(model: &Model, time: f64, posture: &[f64], [external, passive]: [&[f64]; 2]) -> Self {
        let of = |torques: &[f64]| -> Vec<f64> {
            model.coordinates().iter().map(|coordinate| coordinate.rate.map_or(0.0, |rate| torques[rate])).collect()
        };
        let (external, passive) = (of(external), of(passive));
        let load = |(i, coordinate): (usize, &contrapposto::model::Coordinate)| {
            let (active, known) = (-(passive[i] + external[i]), !model.is_dependent(i));
            let groups = coordinate.groups.as_ref().filter(|_| known && coordinate.rate.is_some());
            groups.map_or(0.0, |groups| active.abs() / groups[Side::of(active).index()].strength.torque(posture[i]))
        };
        let load = model.coordinates().iter().enumerate().map(load).collect();
        Self { time, posture: posture.to_vec(), external, passive, load, fatigue: None, standing: None }
    }

    /// A posture that was given, held at rest.
    pub(crate) fn of_instant(model: &Model, instant: &Instant) -> Self {
        let torques = [instant.external, instant.passive];
        let contact = |contact: &ContactForces, i: usize| Contact {
            force: contact.force(i),
            share: contact.share(i),
            center_of_pressure: contact.center_of_pressure(model, instant.kinematics, i),
            couple: Vector3::zeros(),
        };
        let standing = instant.contact.map(|forces| Standing {
            contacts: (0..forces.supports().len()).map(|i| contact(forces, i)).collect(),
            center_of_mass: instant.kinematics.center_of_mass(model).unwrap_or_default(),
            ..Standing::default()
        });
        Self { standing, ..Self::at(model, instant.time, instant.values, torques) }
    }

    /// Active torque of a coordinate, N m.
    pub(crate) fn active(&self, i: usize) -> f64 {
        -(self.passive[i] + self.external[i])
    }

    /// Sum of squares of relative loads.
    pub(crate) fn effort(&self) -> f64 {
        self.load.iter().map(|load| load * load).sum()
    }

    /// How much of what pulls on a coordinate passive tissue carries, 0..=1; `None` where next to nothing pulls.
    pub(crate) fn carried(&self, i: usize) -> Option<f64> {
        let external = self.external[i];
        (external.abs() > 0.5).then(|| (-self.passive[i] / external).clamp(0.0, 1.0))
    }
}
