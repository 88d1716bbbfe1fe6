//! `contrapposto population`: a scenario in, the share of women and of men who can hold it out.

use std::collections::BTreeMap;
use std::path::Path;

use contrapposto_formats::{MOST_BYTES, read_run, scenario_model};
use contrapposto_sweep::{Answer, Population, Study, population as plans, read_part};

use super::sweep::parts::{Others, compute, fill};
use crate::args::PopulationArgs;
use crate::fail::Fail;
use crate::input::read;
use crate::output::{ResultSet, json_text, print};
use crate::view::population::{Asked, PopulationText};
use crate::view::report::population::report_of_population;
use crate::view::text::population::report;

const POPULATION_FILES: [&str; 3] = ["population.json", "population.csv", "population.html"];
/// The folder of the parts, inside that of the results.
const ROWS: &str = "rows";

pub(crate) fn population(args: &PopulationArgs) -> Result<(), Fail> {
    let (study, asked) = open(args)?;
    let folder = args.out.as_deref().map(|out| ResultSet::open(out, &POPULATION_FILES)).transpose()?;
    let parts = match &args.out {
        Some(out) => kept(&study, out, args)?,
        None => computed(&study, args)?,
    };
    let mut answers: Vec<Answer> = vec![];
    for (i, part) in parts.iter().enumerate() {
        let rows = study.rows_of(i);
        let why = || {
            format!(
                "rows {} to {} are expected, each whole; remove this file and use --resume",
                rows.start,
                rows.end - 1
            )
        };
        answers.extend(read_part(&part.text, rows.clone()).ok_or_else(|| Fail::job(&part.place, why()))?);
    }
    let found = Population::new(&study, &answers, asked.seconds / 60.0, args.seed);
    if found.sexes.iter().all(|people| people.number == 0) {
        let why = found.first_note.as_deref().unwrap_or("no reason is known");
        return Err(Fail::Job(format!("none of the {} bodies could be judged; the first: {why}", answers.len())));
    }
    let files = folder.as_ref().map_or(vec![], |_| POPULATION_FILES.map(str::to_owned).to_vec());
    let text = PopulationText::new(&asked, &study, &found, args.seed, files);
    let json = json_text(POPULATION_FILES[0], &text)?;
    if let Some(folder) = &folder {
        let (table, page) = (table(&parts), report_of_population(&text, &found));
        let contents = [json.as_bytes(), table.as_bytes(), page.as_bytes()];
        folder.write(&POPULATION_FILES.into_iter().zip(contents).collect::<Vec<_>>())?;
    }
    print(&if args.json { json } else { report(&text, &found, folder.as_ref()) })
}

/// A part of the table.
struct Part {
    /// The path of the file, or a name for messages.
    place: String,
    text: String,
}

/// The plans of the population over the scenario. The scenario is read as it stands, so that one that is none ends the command before anything
/// is written.
fn open(args: &PopulationArgs) -> Result<(Study, Asked), Fail> {
    let (name, bytes) = (args.scenario.display().to_string(), read(&args.scenario, MOST_BYTES)?);
    if let Some(file) = scenario_model(&name, &bytes)? {
        let why = "a population takes scenarios of the built-in adult, `adult = { ... }` in [model], whose size, strength and passive torque \
            are known for women and men";
        return Err(Fail::Refused(format!("{name}: [model] names the model file {:?}; {why}", file.file)));
    }
    let scenario = read_run(&name, &bytes, None)?.scenario;
    let study = Study::in_turn(&name, &bytes, &plans(&name, args.rows, args.seed))?;
    let asked = Asked { scenario: name, title: scenario.title, seconds: scenario.run.duration };
    Ok((study, asked))
}

/// All parts, which are kept in a folder.
fn kept(study: &Study, out: &Path, args: &PopulationArgs) -> Result<Vec<Part>, Fail> {
    let whole = fill(study, (&out.join(ROWS), Others::Kept), args.resume, args.threads)?;
    let part = |name: &String| {
        let path = whole.folder.path(name);
        let text = std::fs::read_to_string(&path).map_err(|error| Fail::job(path.display(), error))?;
        Ok(Part { place: path.display().to_string(), text })
    };
    whole.names.iter().map(part).collect()
}

/// All parts, of which nothing is written.
fn computed(study: &Study, args: &PopulationArgs) -> Result<Vec<Part>, Fail> {
    let all: Vec<usize> = (0..study.parts()).collect();
    let mut parts = BTreeMap::new();
    let done = compute(study, &all, args.threads, |part, text| {
        parts.insert(part, Part { place: format!("part {part}"), text });
        Ok(())
    })?;
    if done < all.len() {
        let why = "nothing was written; with --out DIR the bodies that are done are kept, and --resume continues";
        return Err(Fail::Job(format!("interrupted: {done} of {} parts were done; {why}", all.len())));
    }
    Ok(parts.into_values().collect())
}

/// One table of all parts: the first line of each but the first is left out.
fn table(parts: &[Part]) -> String {
    let rows = |(i, part): (usize, &Part)| match part.text.split_once('\n') {
        Some((_, rows)) if i > 0 => rows.to_owned(),
        _ => part.text.clone(),
    };
    parts.iter().enumerate().map(rows).collect()
}
