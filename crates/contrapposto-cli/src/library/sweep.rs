//! Computes the parts of a plan of many runs, here or elsewhere, and keeps them in a folder.

use std::num::NonZero;
use std::path::Path;

use contrapposto_formats::Plan;
use contrapposto_sweep::Study;

use super::failure::{Failure, Note, with_notes};
use super::jobs::ScenarioSource;
use crate::commands::sweep::parts::{Filling, Others, Watch};
use crate::commands::sweep::{LIST, PlanSource};

/// A plan with its base scenario.
pub struct Sweep {
    source: PlanSource,
    study: Study,
    plan: Plan,
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
            let (study, plan) = source.open()?;
            Ok(Self { source, study, plan })
        })
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
        let source: PlanSource = serde_json::from_slice(bytes).map_err(|error| Failure::refused(error.to_string()))?;
        let ((study, plan), _) = with_notes(|| source.open())?;
        Ok(Self { source, study, plan })
    }

    /// Number of rows of the plan.
    pub fn rows(&self) -> usize {
        self.study.rows()
    }

    /// The bytes of a part, while `go_on` says yes; `None` where it says no, and of a number that is no part.
    pub fn part(&self, part: usize, go_on: impl Fn() -> bool) -> Option<Vec<u8>> {
        (part < self.study.parts()).then(|| self.study.part(part, go_on, || ()))?
    }

    /// Locks the folder `out` for the parts.
    ///
    /// # Errors
    /// [`Failure`] of a folder that has parts, without `resume`, and of one in which another sweep writes.
    pub fn folder(&self, out: &Path, resume: bool) -> Result<SweepFolder, Failure> {
        Ok(SweepFolder(Filling::open(&self.study, (out, Others::Removed), resume)?))
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

    /// Writes `sweep.json`, and removes parts of other plans.
    ///
    /// # Errors
    /// [`Failure`] of files that cannot be written or removed.
    pub fn finish(&self, sweep: &Sweep) -> Result<(), Failure> {
        let list = sweep.source.list((&sweep.study, &sweep.plan), &self.0.names)?;
        Ok(self.0.finish(LIST, &list)?)
    }
}
