//! `contrapposto sweep`: a plan in, many runs of one scenario, parts of a table out.

pub(crate) mod parts;

use std::path::Path;

use contrapposto_formats::{
    Design, Distribution, MOST_BYTES, Parameter, Plan, Value, read_plan, read_run, scenario_model,
};
use contrapposto_sweep::{COLUMNS, Study};
use serde::Serialize;
use serde_json::json;

use self::parts::{Others, fill};
use crate::args::SweepArgs;
use crate::fail::Fail;
use crate::input::{confined, read};
use crate::output::{json_text, print};

/// The file that lists the parts of a finished sweep.
const LIST: &str = "sweep.json";

pub(crate) fn sweep(args: &SweepArgs) -> Result<(), Fail> {
    let (study, plan) = open(&args.plan)?;
    let whole = fill(&study, (&args.out, Others::Removed(LIST)), args.resume, args.threads)?;
    whole.folder.write(&[(LIST, list(&plan, &whole.names)?)])?;
    let kept = if whole.kept > 0 { format!(", {} of them kept", whole.kept) } else { String::new() };
    print(&format!("{} rows in {} parts{kept}: {}\n", plan.rows, whole.names.len(), args.out.display()))
}

/// The plan of a file with its base scenario. The scenario of the first row is read, so that a wrong key ends the command before anything
/// is written.
fn open(path: &Path) -> Result<(Study, Plan), Fail> {
    let plan = read_plan(&path.display().to_string(), &read(path, MOST_BYTES)?)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // A plan may stand in a folder beside the scenarios.
    let base = folder.join(&plan.base);
    let base = match folder.join("..").canonicalize() {
        Ok(above) if base.canonicalize().is_ok_and(|base| base.starts_with(&above)) => base,
        _ => confined(folder, &plan.base)
            .map_err(|why| Fail::Refused(format!("{}: base = {:?}: {why}", path.display(), plan.base)))?,
    };
    let (name, bytes) = (base.display().to_string(), read(&base, MOST_BYTES)?);
    if scenario_model(&name, &bytes)?.is_some() {
        let why = "the scenario names a model file; a sweep takes scenarios of the built-in adult";
        return Err(Fail::Refused(format!("{name}: {why}")));
    }
    let study = Study::new(&name, &bytes, &plan)?;
    read_run(&name, study.scenario(0).as_bytes(), None)?;
    Ok((study, plan))
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
    parts: &'a [String],
}

/// A column and its meaning, the unit first.
#[derive(Serialize)]
struct ColumnText<'a> {
    name: &'a str,
    meaning: String,
}

fn list(plan: &Plan, parts: &[String]) -> Result<String, Fail> {
    let row = ColumnText { name: "row", meaning: "number of the row in the plan, from 0".to_owned() };
    let parameters = plan.parameters.iter().map(|parameter| ColumnText {
        name: &parameter.key,
        meaning: "key of the scenario, in the unit that its name ends in".to_owned(),
    });
    let answer = COLUMNS.iter().map(|(name, meaning)| ColumnText { name, meaning: (*meaning).to_owned() });
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
            columns: std::iter::once(row).chain(parameters).chain(answer).collect(),
            parts,
        },
    )
}

/// A parameter with its distribution in the words of a plan. The correlation of parameters is in the plan alone.
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
    if design == Design::Grid && !matches!(parameter.distribution, Distribution::List(_)) {
        json["levels"] = json!(parameter.levels);
    }
    json
}
