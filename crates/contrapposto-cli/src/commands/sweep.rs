//! `contrapposto sweep`: a plan in, many runs of one scenario, parts of a table out.

pub(crate) mod parts;

use std::path::Path;

use contrapposto_formats::{Design, Distribution, MOST_BYTES, Parameter, Value, read_plan, read_run, scenario_model};
use contrapposto_sweep::Study;
use serde::{Deserialize, Serialize};
use serde_json::json;

use self::parts::{Filling, Others, watched};
use crate::args::SweepArgs;
use crate::fail::Fail;
use crate::input::{confined, read};
use crate::output::{json_text, print};

/// The file that lists the parts of a finished sweep.
pub(crate) const LIST: &str = "sweep.json";
/// Rows of which one at least must be a scenario.
const FIRST_ROWS: usize = 64;

pub(crate) fn sweep(args: &SweepArgs) -> Result<(), Fail> {
    let source = PlanSource::read(&args.plan)?;
    let study = source.open()?;
    let filling = Filling::open(&study, (&args.out, Others::Removed), args.resume)?;
    watched(|watch| filling.fill(&study, args.threads, watch))?;
    filling.finish(LIST, &source.list(&study, &filling.names)?)?;
    let kept = if filling.kept() > 0 { format!(", {} of them kept", filling.kept()) } else { String::new() };
    print(&format!("{} rows in {} parts{kept}: {}\n", study.rows(), filling.names.len(), args.out.display()))
}

/// The bytes of a plan and of its base scenario, with their names for messages.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PlanSource {
    plan: (String, Vec<u8>),
    base: (String, Vec<u8>),
}

impl PlanSource {
    /// The plan of a file.
    pub(crate) fn read(path: &Path) -> Result<Self, Fail> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Self::of((path.display().to_string(), read(path, MOST_BYTES)?), folder)
    }

    /// The plan of these bytes, whose base is seen from a folder.
    pub(crate) fn of((name, bytes): (String, Vec<u8>), folder: &Path) -> Result<Self, Fail> {
        let plan = read_plan(&name, &bytes)?;
        // A plan may stand in a folder beside the scenarios.
        let base = folder.join(&plan.base);
        let base = match folder.join("..").canonicalize() {
            Ok(above) if base.canonicalize().is_ok_and(|base| base.starts_with(&above)) => base,
            _ => confined(folder, &plan.base)
                .map_err(|why| Fail::Refused(format!("{name}: base = {:?}: {why}", plan.base)))?,
        };
        let base = (base.display().to_string(), read(&base, MOST_BYTES)?);
        Ok(Self { plan: (name, bytes), base })
    }

    /// The rows of the plan over its base scenario. Scenarios of rows are read until one is a scenario, so that a wrong key ends the command before
    /// anything is written.
    pub(crate) fn open(&self) -> Result<Study, Fail> {
        let (name, bytes) = &self.base;
        let plan = read_plan(&self.plan.0, &self.plan.1)?;
        if scenario_model(name, bytes)?.is_some() {
            let why = "the scenario names a model file; a sweep takes scenarios of the built-in adult";
            return Err(Fail::Refused(format!("{name}: {why}")));
        }
        let study = Study::new(name, bytes, &plan)?;
        let read = |row: usize| {
            let name = format!("{name} with the values of row {row}");
            read_run(&name, study.scenario(row).as_bytes(), None)
        };
        let first = read(0);
        if first.is_err() && !(1..study.rows().min(FIRST_ROWS)).any(|row| read(row).is_ok()) {
            first?;
        }
        Ok(study)
    }

    /// The text of `sweep.json`.
    pub(crate) fn list(&self, study: &Study, parts: &[String]) -> Result<String, Fail> {
        let plan = read_plan(&self.plan.0, &self.plan.1)?;
        json_text(
            LIST,
            &ListText {
                program: concat!("contrapposto ", env!("CARGO_PKG_VERSION")),
                base: &plan.base,
                design: plan.design.word(),
                seed: plan.seed,
                rows: plan.rows,
                rows_per_part: plan.rows_per_part,
                parameters: plan.parameters.iter().map(|parameter| distribution(plan.design, parameter)).collect(),
                columns: study.meanings().map(|(name, meaning)| ColumnText { name, meaning }).collect(),
                plan: &String::from_utf8_lossy(&self.plan.1),
                scenario: &String::from_utf8_lossy(&self.base.1),
                parts,
            },
        )
    }
}

/// The file `sweep.json`.
#[derive(Serialize)]
struct ListText<'a> {
    program: &'static str,
    base: &'a str,
    design: &'static str,
    seed: u32,
    rows: usize,
    rows_per_part: usize,
    parameters: Vec<serde_json::Value>,
    columns: Vec<ColumnText<'a>>,
    /// The text of the plan, and of the base scenario.
    plan: &'a str,
    scenario: &'a str,
    parts: &'a [String],
}

/// A column and its meaning, the unit first.
#[derive(Serialize)]
struct ColumnText<'a> {
    name: &'a str,
    meaning: &'a str,
}

/// A parameter with its distribution in the words of a plan. The correlation of parameters is in the text of the plan.
fn distribution(design: Design, parameter: &Parameter) -> serde_json::Value {
    let value = |value: &Value| match value {
        Value::Number(number) => json!(number),
        Value::Text(text) => json!(text),
        Value::Bool(value) => json!(value),
    };
    let mut json = match &parameter.distribution {
        Distribution::Normal { mean, deviation } => json!({ "normal": [mean, deviation] }),
        Distribution::Lognormal { median, deviation } => json!({ "lognormal": [median, deviation] }),
        Distribution::Range { low, high } => json!({ "range": [low, high] }),
        Distribution::List(list) => json!({ "list": list.iter().map(value).collect::<Vec<_>>() }),
    };
    json["key"] = json!(parameter.key);
    if let Some(within) = parameter.within {
        json["within"] = json!(within);
    }
    if design == Design::Grid && !matches!(parameter.distribution, Distribution::List(_)) {
        json["levels"] = json!(parameter.levels);
    }
    json
}
