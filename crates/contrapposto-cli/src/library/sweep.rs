//! Computes the parts of a plan of many runs, here or elsewhere, and keeps them in a folder.

use std::num::NonZero;
use std::path::Path;

use contrapposto_sweep::Study;
use serde::{Deserialize, Serialize};

use super::failure::{Failure, Note, with_notes};
use super::jobs::ScenarioSource;
use super::population::PopulationSource;
use crate::commands::population::ROWS;
use crate::commands::sweep::parts::{Filling, Others, Watch};
use crate::commands::sweep::{LIST, PlanSource};
use crate::fail::Fail;

/// A plan with its base scenario, or the bodies of a population with theirs.
pub struct Sweep {
    source: Source,
    study: Study,
}

#[derive(Serialize, Deserialize)]
enum Source {
    Plan(PlanSource),
    Population(PopulationSource),
}

impl Source {
    fn open(self) -> Result<Sweep, Fail> {
        let study = match &self {
            Self::Plan(source) => source.open()?,
            Self::Population(source) => source.open()?.study,
        };
        Ok(Sweep { source: self, study })
    }
}

impl Sweep {
    /// The plan of a file, or of a text whose base is seen from the present folder.
    ///
    /// # Errors
    /// [`Failure`] as the program prints it.
    pub fn open(plan: &ScenarioSource) -> Result<(Self, Vec<Note>), Failure> {
        with_notes(|| {
            let source = match plan {
                ScenarioSource::File(path) => PlanSource::read(path)?,
                ScenarioSource::Text(text) => {
                    PlanSource::of(("plan".to_owned(), text.clone().into_bytes()), Path::new("."))?
                }
            };
            Source::Plan(source).open()
        })
    }

    /// The bodies of [`Populated::new`](super::Populated::new) with these arguments.
    ///
    /// # Errors
    /// [`Failure`] as the program prints it.
    pub fn of_population(scenario: &ScenarioSource, rows: usize, seed: u32) -> Result<(Self, Vec<Note>), Failure> {
        with_notes(|| Source::Population(PopulationSource::read(scenario, rows, seed)?).open())
    }

    /// All that the sweep is made of, for [`Sweep::from_bytes`] elsewhere.
    ///
    /// # Errors
    /// A text about a value that has no place in JSON.
    pub fn to_bytes(&self) -> Result<Vec<u8>, String> {
        serde_json::to_vec(&self.source).map_err(|error| error.to_string())
    }

    /// From the bytes of [`Sweep::to_bytes`].
    ///
    /// # Errors
    /// [`Failure`] of bytes that are no sweep.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Failure> {
        let source: Source = serde_json::from_slice(bytes).map_err(|error| Failure::refused(error.to_string()))?;
        with_notes(|| source.open()).map(|(sweep, _)| sweep)
    }

    /// Number of rows of a part; 0 of a number that is no part.
    pub fn rows_of(&self, part: usize) -> usize {
        if part < self.study.parts() { self.study.rows_of(part).len() } else { 0 }
    }

    /// The bytes of a part, while `go_on` says yes; `None` where it says no, and of a number that is no part.
    pub fn part(&self, part: usize, go_on: impl Fn() -> bool) -> Option<Vec<u8>> {
        (part < self.study.parts()).then(|| self.study.part(part, go_on, || ()))?
    }

    /// Locks the folder for the parts: `out`, or of a population the folder in it from which [`Populated::new`](super::Populated::new) takes those that
    /// are there, with `resume`.
    ///
    /// # Errors
    /// [`Failure`] of a folder that has parts, without `resume`, and of one in which another sweep writes.
    pub fn folder(&self, out: &Path, resume: bool) -> Result<SweepFolder, Failure> {
        let place = match self.source {
            Source::Plan(_) => (out.to_owned(), Others::Removed),
            Source::Population(_) => (out.join(ROWS), Others::Kept),
        };
        Ok(SweepFolder(Filling::open(&self.study, (&place.0, place.1), resume)?))
    }
}

/// A folder that takes the parts of a sweep.
pub struct SweepFolder(Filling);

impl SweepFolder {
    /// Numbers of the parts that the folder lacked when it was opened.
    pub fn missing(&self) -> &[usize] {
        &self.0.missing
    }

    /// Writes a part, whole or not at all.
    ///
    /// # Errors
    /// [`Failure`] of a file that cannot be written.
    pub fn write(&self, part: usize, bytes: &[u8]) -> Result<(), Failure> {
        Ok(self.0.write(part, bytes)?)
    }

    /// Computes the missing parts in threads, all cores without their number, while `go_on` says yes. `begin` gets the number of rows, `done`
    /// is called after each of them.
    ///
    /// # Errors
    /// [`Failure`] after an end before all parts were there, and of files that cannot be written.
    pub fn fill(
        &self,
        sweep: &Sweep,
        threads: Option<NonZero<usize>>,
        go_on: &(dyn Fn() -> bool + Sync),
        (begin, done): (&(dyn Fn(usize) + Sync), &(dyn Fn() + Sync)),
    ) -> Result<(), Failure> {
        Ok(self.0.fill(&sweep.study, threads, &Watch { begin, go_on, done })?)
    }

    /// Writes `sweep.json`, and removes parts of other plans; nothing of a population.
    ///
    /// # Errors
    /// [`Failure`] of files that cannot be written or removed.
    pub fn finish(&self, sweep: &Sweep) -> Result<(), Failure> {
        if let Source::Plan(source) = &sweep.source {
            self.0.finish(LIST, &source.list(&sweep.study, &self.0.names)?)?;
        }
        Ok(())
    }
}
