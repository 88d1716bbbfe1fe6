//! Keeps samples of a run for its tables and pictures, in bounded memory.

use contrapposto::hybrid::Case;
use contrapposto::joint_torques::active_torque;
use contrapposto::simulation::{Contact, Sample, Scenario};
use serde::{Deserialize, Serialize};

/// Most numbers of one coordinate in all rows of all coordinates together: a longer run is written with every second sample,
/// every third, and so on.
const MOST_VALUES: f64 = 200_000.0;

/// Rows of samples, one after the other.
#[derive(Default, Serialize, Deserialize)]
pub(crate) struct Recording {
    /// Samples from one row to the next.
    every: u64,
    /// Coordinates, supports.
    coordinates: usize,
    supports: usize,
    times: Vec<f64>,
    posture: Vec<f64>,
    external: Vec<f64>,
    passive: Vec<f64>,
    load: Vec<f64>,
    fatigue: Vec<[f64; 2]>,
    /// Of muscles that tire one by one: load and tension, N.
    muscles: Vec<[f64; 2]>,
    asked: Vec<Option<(Case, Option<f64>)>>,
    /// By support: share of weight, force, where it acts, couple about that point.
    contacts: Vec<[f64; 10]>,
    centers: Vec<[f64; 3]>,
    /// The sample with the greatest relative load while no support is put elsewhere: its number, that load, and its row.
    hardest: Option<(u64, f64, Box<Self>)>,
}

/// One row.
#[derive(Clone, Copy)]
pub(crate) struct Row<'a> {
    pub(crate) time: f64,
    pub(crate) posture: &'a [f64],
    pub(crate) external: &'a [f64],
    pub(crate) passive: &'a [f64],
    pub(crate) load: &'a [f64],
    pub(crate) fatigue: &'a [[f64; 2]],
    /// Load and tension (N) of every muscle that tires by itself.
    pub(crate) muscles: &'a [[f64; 2]],
    pub(crate) asked: &'a [Option<(Case, Option<f64>)>],
    pub(crate) contacts: &'a [[f64; 10]],
    /// Of a body with supports or tasks.
    pub(crate) center_of_mass: Option<[f64; 3]>,
}

impl Recording {
    pub(crate) fn new(scenario: &Scenario) -> Self {
        let coordinates = scenario.model.coordinates().len();
        let samples = (scenario.run.steps() + 1) as f64;
        let rows = (MOST_VALUES / coordinates.max(1) as f64).max(1.0);
        Self {
            every: (samples / rows).ceil().max(1.0) as u64,
            coordinates,
            supports: scenario.supports.len(),
            times: vec![],
            posture: vec![],
            external: vec![],
            passive: vec![],
            load: vec![],
            fatigue: vec![],
            muscles: vec![],
            asked: vec![],
            contacts: vec![],
            centers: vec![],
            hardest: None,
        }
    }

    /// Without rows.
    fn emptied(&self) -> Self {
        let &Self { every, coordinates, supports, .. } = self;
        Self { every, coordinates, supports, ..Self::default() }
    }

    /// Takes in sample number `number`, counted from 0, if it is one of those that are kept.
    pub(crate) fn record(&mut self, number: u64, sample: &Sample) {
        let load = sample.load.iter().copied().fold(0.0, f64::max);
        if !sample.stepping && load > self.hardest.as_ref().map_or(0.0, |(_, hardest, _)| *hardest) {
            let mut row = Box::new(self.emptied());
            row.push(sample);
            self.hardest = Some((number, load, row));
        }
        if number.is_multiple_of(self.every) {
            self.push(sample);
        }
    }

    fn push(&mut self, sample: &Sample) {
        self.times.push(sample.time);
        self.posture.extend_from_slice(sample.posture);
        self.external.extend_from_slice(sample.external);
        self.passive.extend_from_slice(sample.passive);
        self.load.extend_from_slice(sample.load);
        self.fatigue.extend_from_slice(sample.fatigue);
        self.muscles.extend(load_and_tension(sample));
        self.asked.extend(sample.decisions.iter().map(|d| d.as_ref().map(|decision| (decision.case, decision.goal))));
        if let Some(standing) = sample.standing {
            self.contacts.extend(standing.contacts.iter().map(numbers));
            self.centers.push(standing.center_of_mass.into());
        }
    }

    /// The rows before sample number `samples`; none if they are not those of `scenario`.
    pub(crate) fn up_to(mut self, scenario: &Scenario, samples: u64) -> Option<Self> {
        let new = Self::new(scenario);
        let same = (self.every, self.coordinates, self.supports) == (new.every, new.coordinates, new.supports);
        let rows = usize::try_from(samples.div_ceil(new.every)).ok()?;
        if !same || self.times.len() < rows {
            return None;
        }
        self.truncate(rows);
        self.hardest.take_if(|(number, ..)| *number >= samples);
        let one = |(_, load, row): &(u64, f64, Box<Self>)| {
            let same = (row.every, row.coordinates, row.supports) == (new.every, new.coordinates, new.supports);
            same && load.is_finite() && row.hardest.is_none() && row.fits(scenario, 1)
        };
        (self.fits(scenario, rows) && self.hardest.as_ref().is_none_or(one)).then_some(self)
    }

    /// Number of muscles that tire one by one.
    fn muscles_of_a_row(&self) -> usize {
        self.muscles.len() / self.times.len().max(1)
    }

    /// Forgets all rows but the first `rows`.
    fn truncate(&mut self, rows: usize) {
        let (n, muscles) = (self.coordinates, self.muscles_of_a_row());
        self.times.truncate(rows);
        for column in [&mut self.posture, &mut self.external, &mut self.passive, &mut self.load] {
            column.truncate(rows * n);
        }
        self.muscles.truncate(rows * muscles);
        self.fatigue.truncate(rows * n);
        self.asked.truncate(rows * n);
        self.contacts.truncate(rows * self.supports);
        self.centers.truncate(rows);
    }

    /// Whether every column has as many rows as `scenario` gives, of finite numbers and rising times.
    fn fits(&self, scenario: &Scenario, rows: usize) -> bool {
        let n = self.coordinates;
        let standing = if scenario.has_supports_or_tasks() { rows } else { 0 };
        let by_coordinate = [&self.posture, &self.external, &self.passive, &self.load];
        self.times.len() == rows
            && by_coordinate.iter().all(|column| column.len() == rows * n)
            && self.fatigue.len() == rows * n
            && self.muscles.len() == rows * scenario.tiring_muscles()
            && self.asked.len() == rows * n
            && self.contacts.len() == standing * self.supports
            && self.centers.len() == standing
            && self.times.windows(2).all(|pair| pair[0] <= pair[1])
            && by_coordinate.into_iter().flatten().all(|v| v.is_finite())
            && self
                .fatigue
                .iter()
                .flatten()
                .chain(self.muscles.iter().flatten())
                .chain(self.contacts.iter().flatten())
                .chain(self.centers.iter().flatten())
                .all(|v| v.is_finite())
    }

    /// The sample with the greatest relative load.
    pub(crate) fn hardest(&self) -> Option<Row<'_>> {
        self.hardest.as_ref().map(|(_, _, row)| row.row(0))
    }

    pub(crate) fn times(&self) -> &[f64] {
        &self.times
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        (0..self.times.len()).map(|row| self.row(row))
    }

    pub(crate) fn row(&self, row: usize) -> Row<'_> {
        let columns = row * self.coordinates..(row + 1) * self.coordinates;
        let count = self.muscles_of_a_row();
        let supports = if self.contacts.is_empty() { 0..0 } else { row * self.supports..(row + 1) * self.supports };
        Row {
            time: self.times[row],
            posture: &self.posture[columns.clone()],
            external: &self.external[columns.clone()],
            passive: &self.passive[columns.clone()],
            load: &self.load[columns.clone()],
            fatigue: &self.fatigue[columns.clone()],
            muscles: &self.muscles[row * count..(row + 1) * count],
            asked: &self.asked[columns],
            contacts: &self.contacts[supports],
            center_of_mass: self.centers.get(row).copied(),
        }
    }
}

impl Row<'_> {
    /// Active torque of a coordinate (Eq. 1), N m.
    pub(crate) fn active(&self, coordinate: usize) -> f64 {
        active_torque(self.external[coordinate], self.passive[coordinate])
    }
}

fn numbers(contact: &Contact) -> [f64; 10] {
    let at = contact.center_of_pressure.unwrap_or_default();
    let [f, p, c] = [contact.force, at, contact.couple];
    [contact.share, f.x, f.y, f.z, p.x, p.y, p.z, c.x, c.y, c.z]
}

/// Load and tension (N) of every muscle that tires by itself.
pub(crate) fn load_and_tension(sample: &Sample) -> impl Iterator<Item = [f64; 2]> {
    sample.muscles.iter().map(|muscle| [muscle.load, muscle.tension])
}
