//! Answers for a population of women and men.

use std::num::NonZero;
use std::path::Path;

use contrapposto_formats::MOST_BYTES;
use serde::{Deserialize, Serialize};

use super::failure::{Failure, Note, with_notes};
use super::jobs::ScenarioSource;
use crate::commands::population::{Counted, Job, Place};
use crate::commands::sweep::parts::Watch;
use crate::fail::Fail;
use crate::input::read;

/// The bytes of the scenario of a population, its name for messages, and its bodies.
#[derive(Serialize, Deserialize)]
pub(super) struct PopulationSource {
    scenario: (String, Vec<u8>),
    rows: usize,
    seed: u32,
}

impl PopulationSource {
    pub(super) fn read(scenario: &ScenarioSource, rows: usize, seed: u32) -> Result<Self, Fail> {
        let scenario = match scenario {
            ScenarioSource::File(path) => (path.display().to_string(), read(path, MOST_BYTES)?),
            ScenarioSource::Text(text) => ("scenario".to_owned(), text.clone().into_bytes()),
        };
        Ok(Self { scenario, rows, seed })
    }

    pub(super) fn open(&self) -> Result<Job, Fail> {
        Job::open(self.scenario.0.clone(), &self.scenario.1, self.rows, self.seed)
    }
}

/// The counted answers of a population.
pub struct Populated(Counted);

impl Populated {
    /// Carries out `population` of the program with `rows` bodies, an even number, while `go_on` says yes; into the folder `out` if there is one.
    /// `begin` gets the number of bodies to compute, `done` is called after each of them.
    ///
    /// # Errors
    /// [`Failure`] as the program prints it.
    pub fn new(
        scenario: &ScenarioSource,
        (rows, seed): (usize, u32),
        (out, resume, threads): (Option<&Path>, bool, Option<NonZero<usize>>),
        go_on: &(dyn Fn() -> bool + Sync),
        (begin, done): (&(dyn Fn(usize) + Sync), &(dyn Fn() + Sync)),
    ) -> Result<(Self, Vec<Note>), Failure> {
        with_notes(|| {
            let job = PopulationSource::read(scenario, rows, seed)?.open()?;
            let counted = job.carry_out(Place { out, resume, threads }, &Watch { begin, go_on, done })?;
            Ok::<_, Fail>(Self(counted))
        })
    }

    /// The text of `population.json`.
    pub fn json(&self) -> &str {
        &self.0.json
    }

    /// The text of `population.csv`, a row a body.
    pub fn table(&self) -> &str {
        &self.0.table
    }

    /// The page `population.html`.
    pub fn report(&self) -> String {
        self.0.page()
    }
}
