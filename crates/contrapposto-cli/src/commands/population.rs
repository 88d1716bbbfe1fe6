//! `contrapposto population`: a scenario in, the share of women and of men who can hold it out.

use std::collections::BTreeMap;
use std::num::NonZero;
use std::path::Path;

use contrapposto_formats::{MOST_BYTES, read_run, scenario_model};
use contrapposto_sweep::{Answer, Population, Study, population as plans};

use super::sweep::parts::{Filling, Others, Watch, compute, watched};
use crate::args::PopulationArgs;
use crate::fail::Fail;
use crate::input::read;
use crate::output::{ResultSet, json_text, print};
use crate::view::population::{Asked, PopulationText};
use crate::view::report::population::report_of_population;
use crate::view::text::population::report;

const POPULATION_FILES: [&str; 3] = ["population.json", "population.csv", "population.html"];
/// The folder of the parts, inside that of the results.
pub(crate) const ROWS: &str = "rows";

pub(crate) fn population(args: &PopulationArgs) -> Result<(), Fail> {
    let (name, bytes) = (args.scenario.display().to_string(), read(&args.scenario, MOST_BYTES)?);
    let job = Job::open(name, &bytes, args.rows, args.seed)?;
    let place = Place { out: args.out.as_deref(), resume: args.resume, threads: args.threads };
    let counted = watched(|watch| job.carry_out(place, watch))?;
    print(&if args.json { counted.json } else { report(&counted.text, &counted.found, counted.folder.as_ref()) })
}

/// A population that is asked to do a job.
pub(crate) struct Job {
    pub(crate) study: Study,
    asked: Asked,
    seed: u32,
}

/// The folder for the results, if any, and how they are computed.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub(crate) out: Option<&'a Path>,
    pub(crate) resume: bool,
    pub(crate) threads: Option<NonZero<usize>>,
}

/// The counted answers of a population.
pub(crate) struct Counted {
    pub(crate) text: PopulationText,
    pub(crate) found: Population,
    /// `population.json`.
    pub(crate) json: String,
    /// `population.csv`.
    pub(crate) table: String,
    folder: Option<ResultSet>,
}

impl Counted {
    /// The page `population.html`.
    pub(crate) fn page(&self) -> String {
        report_of_population(&self.text, &self.found)
    }
}

/// A part of the table.
struct Part {
    /// The path of the file, or a name for messages.
    place: String,
    bytes: Vec<u8>,
}

impl Job {
    /// The plans of the population over the scenario. The scenario is read as it stands, so that one that is none ends the command before
    /// anything is written.
    pub(crate) fn open(name: String, bytes: &[u8], rows: usize, seed: u32) -> Result<Self, Fail> {
        if let Some(file) = scenario_model(&name, bytes)? {
            let why = "a population takes scenarios of the built-in adult, `adult = { ... }` in [model], whose size, strength and passive torque \
                are known for women and men";
            return Err(Fail::Refused(format!("{name}: [model] names the model file {:?}; {why}", file.file)));
        }
        let scenario = read_run(&name, bytes, None)?.scenario;
        let study = Study::in_turn(&name, bytes, &plans(&name, rows, seed))?;
        let asked = Asked { scenario: name, title: scenario.title, seconds: scenario.run.duration };
        Ok(Self { study, asked, seed })
    }

    /// Computes and counts all bodies.
    ///
    /// # Errors
    /// A folder that is refused, an interruption, and a job of which no body can be judged.
    pub(crate) fn carry_out(&self, place: Place<'_>, watch: &Watch<'_>) -> Result<Counted, Fail> {
        let folder = place.out.map(|out| ResultSet::open(out, &POPULATION_FILES)).transpose()?;
        let parts = match place.out {
            Some(out) => self.kept(out, place, watch)?,
            None => self.computed(place, watch)?,
        };
        let answers = self.answers(&parts)?;
        let found = Population::new(&self.study, &answers, self.asked.seconds / 60.0, self.seed);
        if found.sexes.iter().all(|people| people.number == 0) {
            let why = found.first_note.as_deref().unwrap_or("no reason is known");
            return Err(Fail::Job(format!("none of the {} bodies could be judged; the first: {why}", answers.len())));
        }
        let files = folder.as_ref().map_or(vec![], |_| POPULATION_FILES.map(str::to_owned).to_vec());
        let text = PopulationText::new(&self.asked, &self.study, &found, self.seed, files);
        let json = json_text(POPULATION_FILES[0], &text)?;
        let counted = Counted { text, found, json, table: self.study.csv(&answers), folder };
        if let Some(folder) = &counted.folder {
            let page = counted.page();
            let contents = [counted.json.as_bytes(), counted.table.as_bytes(), page.as_bytes()];
            folder.write(&POPULATION_FILES.into_iter().zip(contents).collect::<Vec<_>>())?;
        }
        Ok(counted)
    }

    fn answers(&self, parts: &[Part]) -> Result<Vec<Answer>, Fail> {
        let mut answers: Vec<Answer> = vec![];
        for (i, part) in parts.iter().enumerate() {
            let rows = self.study.rows_of(i);
            let why = || {
                let (first, last) = (rows.start, rows.end - 1);
                format!("rows {first} to {last} are expected, each whole; remove this file and use --resume")
            };
            answers.extend(self.study.read(i, &part.bytes).ok_or_else(|| Fail::job(&part.place, why()))?);
        }
        Ok(answers)
    }

    /// All parts, which are kept in a folder.
    fn kept(&self, out: &Path, place: Place<'_>, watch: &Watch<'_>) -> Result<Vec<Part>, Fail> {
        let filling = Filling::open(&self.study, (&out.join(ROWS), Others::Kept), place.resume)?;
        filling.fill(&self.study, place.threads, watch)?;
        let part = |name: &String| {
            let path = filling.folder.path(name);
            let bytes = std::fs::read(&path).map_err(|error| Fail::job(path.display(), error))?;
            Ok(Part { place: path.display().to_string(), bytes })
        };
        filling.names.iter().map(part).collect()
    }

    /// All parts, of which nothing is written.
    fn computed(&self, place: Place<'_>, watch: &Watch<'_>) -> Result<Vec<Part>, Fail> {
        let all: Vec<usize> = (0..self.study.parts()).collect();
        let mut parts = BTreeMap::new();
        let done = compute(&self.study, &all, place.threads, watch, |part, bytes| {
            parts.insert(part, Part { place: format!("part {part}"), bytes });
            Ok(())
        })?;
        if done < all.len() {
            let why = "nothing was written; with --out DIR the bodies that are done are kept, and --resume continues";
            return Err(Fail::Job(format!("interrupted: {done} of {} parts were done; {why}", all.len())));
        }
        Ok(parts.into_values().collect())
    }
}
