//! From the text of a scenario file to a checked experiment, or to a complaint with file, line and column.

mod convert;
mod pose;
mod relax;
mod support;
mod task;
mod task_text;
mod text;

pub(crate) use convert::{double_exponential, passive_curve};
pub use pose::{ModelFile, PoseScenario, read_pose, scenario_model};
pub use relax::{RelaxScenario, read_relax};
pub use text::ScenarioText;
pub(crate) use text::{CoordinateLimitForceText, DoubleExponentialText, PassiveText, ReshapeText, StrategyKindText};

use std::ops::Range;

use contrapposto::model::Model;
use contrapposto::simulation::Scenario;
use toml::de::{DeTable, DeValue};

use crate::input_error::{InputError, Source, suggestion, utf8};

/// Largest scenario file, bytes.
pub const MOST_BYTES: u64 = 1 << 20;

/// Reads a scenario of a run. `name` is the file's name for messages; `model` is what [`scenario_model`] asked for.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_scenario(name: &str, bytes: &[u8], model: Option<Model>) -> Result<Scenario, InputError> {
    read_toml(name, bytes, |at, text| convert::scenario(at, text, model))
}

/// Does a scenario ask for time, as a run does and a pose does not? `name` is its file's name for messages.
///
/// # Errors
/// [`InputError`] when it is no scenario.
pub fn scenario_runs(name: &str, bytes: &[u8]) -> Result<bool, InputError> {
    read_toml(name, bytes, |_, text: &ScenarioText| Ok(text.run.is_some()))
}

/// Reads a TOML file of ours: known keys, finite numbers, and whatever else `convert` asks of it.
pub(crate) fn read_toml<T: serde::de::DeserializeOwned, R>(
    name: &str,
    bytes: &[u8],
    convert: impl FnOnce(&Located, &T) -> Result<R, InputError>,
) -> Result<R, InputError> {
    let text = utf8(name, bytes)?;
    let source = Source { name, text };
    let tree = DeTable::parse(text)
        .map_err(|error| source.error(placed(error.span()), format!("not TOML: {}", error.message()), "here", None))?;
    refuse_non_finite(&source, tree.get_ref())?;
    let parsed: T = toml::from_str(text).map_err(|error| complaint(&source, &error))?;
    convert(&Located { source, tree: tree.get_ref() }, &parsed)
}

/// JSON Schema of the scenario file.
pub fn scenario_schema() -> serde_json::Value {
    schemars::schema_for!(ScenarioText).to_value()
}

/// What has no place of its own stands at the beginning of the file, so that the file is named.
fn placed(span: Option<Range<usize>>) -> Option<Range<usize>> {
    span.or(Some(0..0))
}

/// A parsed file in which a value's place can be looked up by its path.
pub(crate) struct Located<'a> {
    source: Source<'a>,
    tree: &'a DeTable<'a>,
}

impl Located<'_> {
    /// A complaint about the value at `path` (keys and array indices), or its nearest table that exists.
    pub(crate) fn error(&self, path: &[&str], message: impl Into<String>, help: Option<String>) -> InputError {
        self.source.error(placed(self.span(path, false)), message, "here", help)
    }

    /// A complaint about the key at the end of `path`.
    pub(crate) fn key_error(&self, path: &[&str], message: impl Into<String>, help: Option<String>) -> InputError {
        self.source.error(placed(self.span(path, true)), message, "here", help)
    }

    /// Is there a table of that name?
    pub(crate) fn has(&self, table: &str) -> bool {
        self.tree.get(table).is_some()
    }

    /// Does the table of that name have keys beside these?
    pub(crate) fn has_beside(&self, table: &str, keys: &[&str]) -> bool {
        let table = self.tree.get(table).and_then(|value| value.get_ref().as_table());
        table.is_some_and(|table| table.keys().any(|key| !keys.contains(&key.get_ref().as_ref())))
    }

    fn span(&self, path: &[&str], key: bool) -> Option<Range<usize>> {
        let (first, rest) = path.split_first()?;
        let (name, mut value) = self.tree.get_key_value(*first)?;
        let mut span = if key && rest.is_empty() { name.span() } else { value.span() };
        for (i, step) in rest.iter().enumerate() {
            let last = i + 1 == rest.len();
            let found = match value.get_ref() {
                DeValue::Table(table) => table.get_key_value(*step).map(|(k, v)| (k.span(), v)),
                DeValue::Array(array) => step.parse().ok().and_then(|i: usize| array.get(i)).map(|v| (v.span(), v)),
                _ => None,
            };
            let Some((key_span, next)) = found else { break };
            value = next;
            span = if key && last { key_span } else { value.span() };
        }
        Some(span)
    }
}

/// A message of the TOML reader, with a suggestion where it lists what it expected.
fn complaint(source: &Source, error: &toml::de::Error) -> InputError {
    let message = error.message();
    let words: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let all_keys = || Some("`contrapposto schema` lists all keys".to_owned());
    let (message, help) = match words.split_first() {
        Some((given, expected)) if message.starts_with("unknown") => {
            let kind = if message.starts_with("unknown variant") { "value" } else { "key" };
            (format!("unknown {kind} `{given}`"), suggestion(given, expected.iter().copied()))
        }
        Some((key, _)) if message.starts_with("missing field") => (format!("the key `{key}` is missing"), all_keys()),
        _ if message.ends_with("untagged enum ReshapeText") => {
            let help = "write true, false, or { zone_deg = 5, end_torque_nm = 20 }".to_owned();
            ("not a way to reshape".to_owned(), Some(help))
        }
        _ if message.ends_with("untagged enum OnText") => {
            let help = Some("write \"ground\", or { normal = [x, y, z], point_m = [x, y, z] }".to_owned());
            ("neither the ground nor a plane".to_owned(), help)
        }
        _ => {
            let plain =
                [("expected f64", "expected a number"), ("expected u32", "expected a whole number, not negative")];
            (plain.iter().fold(message.to_owned(), |text, (from, to)| text.replace(from, to)), None)
        }
    };
    source.error(placed(error.span()), message, "here", help)
}

/// TOML knows `nan` and `inf`; no scenario does.
fn refuse_non_finite(source: &Source, table: &DeTable) -> Result<(), InputError> {
    let mut open: Vec<&toml::Spanned<DeValue>> = table.values().collect();
    while let Some(value) = open.pop() {
        match value.get_ref() {
            DeValue::Table(table) => open.extend(table.values()),
            DeValue::Array(array) => open.extend(array.iter()),
            DeValue::Float(float) => {
                let digits = float.as_str().replace('_', "");
                if !digits.parse::<f64>().is_ok_and(f64::is_finite) {
                    let message = format!("`{:.40}` is not a finite number", float.as_str());
                    return Err(source.error(
                        Some(value.span()),
                        message,
                        "here",
                        Some("write a finite number".into()),
                    ));
                }
            }
            _ => {}
        }
    }
    Ok(())
}
