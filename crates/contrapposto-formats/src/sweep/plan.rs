//! Reads the file of a plan: a base scenario, the keys that vary, their distributions, and how rows are chosen.

use std::fmt;

use nalgebra::DMatrix;

use super::plan_text::{DesignText, ParameterText, PlanText, ValueText};
use crate::input_error::{InputError, suggestion};
use crate::toml_file::{Located, read_toml, shown};

/// Most rows of a plan.
const MOST_ROWS: usize = 10_000_000;
/// Most rows of a part: one thread holds the results of a part in memory.
const MOST_ROWS_PER_PART: usize = 100_000;
/// Rows of a part where the plan does not say.
const ROWS_PER_PART: u32 = 100;
/// Most parameters: so many directions the table of Sobol numbers has.
const MOST_PARAMETERS: usize = 64;

/// A plan of many runs of one scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Path of the base scenario, as seen from the plan's folder.
    pub base: String,
    /// Seed of the designs `shifted_sobol`, `latin_hypercube` and `random`.
    pub seed: u32,
    /// Choice of the rows.
    pub design: Design,
    /// Number of rows.
    pub rows: usize,
    /// Number of rows of every part but the last one.
    pub rows_per_part: usize,
    /// The keys that vary, in the order of the file.
    pub parameters: Vec<Parameter>,
    /// Lower triangle of the Cholesky factor of the correlation of normal scores; `None` for independent parameters.
    pub mixing: Option<Vec<Vec<f64>>>,
}

impl Plan {
    /// Number of parts.
    pub fn parts(&self) -> usize {
        self.rows.div_ceil(self.rows_per_part)
    }

    /// The rows of a part.
    pub fn rows_of(&self, part: usize) -> std::ops::Range<usize> {
        let first = part * self.rows_per_part;
        first..(first + self.rows_per_part).min(self.rows)
    }
}

/// Choice of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// The unscrambled Sobol sequence, without its first point, the origin.
    Sobol,
    /// The Sobol sequence with the digits of every coordinate changed by random ones of the seed.
    ShiftedSobol,
    /// All combinations of the values of the parameters.
    Grid,
    /// One value of every parameter in each of as many equally likely strata as there are rows.
    LatinHypercube,
    /// Independent values.
    Random,
}

impl Design {
    /// `sobol`, `shifted_sobol`, `grid`, `latin_hypercube`, `random`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Sobol => "sobol",
            Self::ShiftedSobol => "shifted_sobol",
            Self::Grid => "grid",
            Self::LatinHypercube => "latin_hypercube",
            Self::Random => "random",
        }
    }
}

/// A key of the scenario that varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Path of the key in the scenario file: `model.adult.stature_m`, `load.0.mass_kg`.
    pub key: String,
    /// Values of the parameter.
    pub distribution: Distribution,
    /// Least and greatest value of a normal or lognormal distribution, which has none beyond: its probability between them is scaled to 1.
    pub within: Option<[f64; 2]>,
    /// Number of values in the design `grid`.
    pub levels: usize,
}

/// The values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// A normal distribution.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
    /// A distribution whose logarithm is normal.
    Lognormal {
        /// Median.
        median: f64,
        /// Standard deviation of the natural logarithm.
        deviation: f64,
    },
    /// All values between two numbers, equally likely.
    Range {
        /// Least.
        low: f64,
        /// Greatest.
        high: f64,
    },
    /// Given values, equally likely.
    List(Vec<Value>),
}

/// A value of a parameter. It prints as TOML.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
    /// `true` or `false`.
    Bool(bool),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => write!(f, "{}", serde_json::Value::String(text.clone())),
            Self::Bool(value) => write!(f, "{value}"),
        }
    }
}

/// Reads a plan. `name` is the file's name for messages.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_plan(name: &str, bytes: &[u8]) -> Result<Plan, InputError> {
    read_toml(name, bytes, plan)
}

fn plan(at: &Located, text: &PlanText) -> Result<Plan, InputError> {
    if text.base.is_empty() || text.base.chars().any(char::is_control) {
        return Err(at.error(&["base"], "`base` is no name of a file", None));
    }
    let design = match text.design {
        DesignText::Sobol => Design::Sobol,
        DesignText::ShiftedSobol => Design::ShiftedSobol,
        DesignText::Grid => Design::Grid,
        DesignText::LatinHypercube => Design::LatinHypercube,
        DesignText::Random => Design::Random,
    };
    let keys = at.keys(&["parameters"]);
    if !(1..=MOST_PARAMETERS).contains(&keys.len()) {
        let message = format!("{} parameters; there must be 1 to {MOST_PARAMETERS}", keys.len());
        return Err(at.error(&["parameters"], message, None));
    }
    let parameters = keys.iter().map(|key| parameter(at, key, &text.parameters[*key], design));
    let parameters = parameters.collect::<Result<Vec<_>, _>>()?;
    let rows = rows(at, text, design, &parameters)?;
    let rows_per_part = text.rows_per_part.unwrap_or(ROWS_PER_PART) as usize;
    if !(1..=MOST_ROWS_PER_PART).contains(&rows_per_part) {
        let message = format!("`rows_per_part` is {rows_per_part}; it must lie in 1..{MOST_ROWS_PER_PART}");
        return Err(at.error(&["rows_per_part"], message, None));
    }
    let mixing = mixing(at, text, &keys, design)?;
    Ok(Plan { base: text.base.clone(), seed: text.seed, design, rows, rows_per_part, parameters, mixing })
}

/// Number of rows: of a grid the number of combinations.
fn rows(at: &Located, text: &PlanText, design: Design, parameters: &[Parameter]) -> Result<usize, InputError> {
    if design == Design::Grid {
        let product = |rows: usize, parameter: &Parameter| rows.checked_mul(parameter.levels);
        let rows = parameters.iter().try_fold(1, product).filter(|rows| *rows <= MOST_ROWS);
        let Some(rows) = rows else {
            return Err(at.error(&["parameters"], format!("the grid has more than {MOST_ROWS} combinations"), None));
        };
        if let Some(given) = text.rows.filter(|given| *given as usize != rows) {
            let help = Some(format!("leave it out, or write {rows}"));
            return Err(at.error(&["rows"], format!("`rows` is {given}; the grid has {rows} combinations"), help));
        }
        return Ok(rows);
    }
    let Some(rows) = text.rows else {
        return Err(at.error(&[], "the key `rows` is missing", Some("rows = 100".to_owned())));
    };
    if !(1..=MOST_ROWS).contains(&(rows as usize)) {
        return Err(at.error(&["rows"], format!("`rows` is {rows}; it must lie in 1..{MOST_ROWS}"), None));
    }
    Ok(rows as usize)
}

fn parameter(at: &Located, key: &str, text: &ParameterText, design: Design) -> Result<Parameter, InputError> {
    let path = ["parameters", key];
    if key.is_empty() || key.split('.').any(str::is_empty) || key.chars().any(char::is_control) {
        let help =
            Some("a path of keys and numbers from 0 on: \"model.adult.stature_m\", \"load.0.mass_kg\"".to_owned());
        return Err(at.key_error(&path, format!("`{key}` is no path of a key"), help));
    }
    let distribution = distribution(at, key, text)?;
    let within = within(at, key, text, &distribution)?;
    let count = if let Distribution::List(list) = &distribution { Some(list.len()) } else { None };
    let levels = match (design, text.levels, count) {
        (_, Some(_), Some(_)) => {
            let help = Some("leave `levels` out: a list has its own number of values".to_owned());
            return Err(at.error(
                &["parameters", key, "levels"],
                "`levels` goes with normal, lognormal and range",
                help,
            ));
        }
        (Design::Grid, levels, count) => match count.or(levels.map(|levels| levels as usize)) {
            Some(levels) if (1..=MOST_ROWS).contains(&levels) => levels,
            Some(levels) => {
                let message = format!("`levels` is {levels}; it must lie in 1..{MOST_ROWS}");
                return Err(at.error(&["parameters", key, "levels"], message, None));
            }
            None => {
                let help = Some("add `levels = 5`, or write a list".to_owned());
                return Err(at.error(&path, "a grid needs the number of values", help));
            }
        },
        (_, Some(_), None) => {
            let help = Some("leave it out, or write design = \"grid\"".to_owned());
            return Err(at.error(&["parameters", key, "levels"], "`levels` goes with the design \"grid\"", help));
        }
        (_, None, count) => count.unwrap_or(0),
    };
    Ok(Parameter { key: key.to_owned(), distribution, within, levels })
}

fn distribution(at: &Located, key: &str, text: &ParameterText) -> Result<Distribution, InputError> {
    let refuse = |kind: &str, message: String| Err(at.error(&["parameters", key, kind], message, None));
    match (text.normal, text.lognormal, text.range, &text.list) {
        (Some([mean, deviation]), None, None, None) if deviation > 0.0 => Ok(Distribution::Normal { mean, deviation }),
        (Some([_, deviation]), None, None, None) => {
            refuse("normal", format!("the standard deviation is {}; it must be positive", shown(deviation)))
        }
        (None, Some([median, deviation]), None, None) if median > 0.0 && deviation > 0.0 => {
            Ok(Distribution::Lognormal { median, deviation })
        }
        (None, Some([median, deviation]), None, None) => {
            let (median, deviation) = (shown(median), shown(deviation));
            let message = "median and standard deviation of the logarithm";
            refuse("lognormal", format!("{message} are {median} and {deviation}; both must be positive"))
        }
        (None, None, Some([low, high]), None) if low < high => Ok(Distribution::Range { low, high }),
        (None, None, Some([low, high]), None) => {
            refuse("range", format!("the range goes from {} to {}; it must rise", shown(low), shown(high)))
        }
        (None, None, None, Some(list)) if list.is_empty() => refuse("list", "the list is empty".to_owned()),
        (None, None, None, Some(list)) => Ok(Distribution::List(list.iter().map(Value::from).collect())),
        (None, None, None, None) => {
            let help = Some(
                "write one of normal = [mean, standard deviation], lognormal, range = [low, high], list".to_owned(),
            );
            Err(at.error(&["parameters", key], format!("`{key}` has no values"), help))
        }
        _ => {
            let help = Some("keep one of normal, lognormal, range, list".to_owned());
            Err(at.error(&["parameters", key], format!("`{key}` has more than one distribution"), help))
        }
    }
}

/// The ends of a normal or lognormal distribution, its middle between them.
fn within(
    at: &Located,
    key: &str,
    text: &ParameterText,
    values: &Distribution,
) -> Result<Option<[f64; 2]>, InputError> {
    let Some([low, high]) = text.within else { return Ok(None) };
    let refuse = |message: String| Err(at.error(&["parameters", key, "within"], message, None));
    let (name, middle) = match values {
        Distribution::Normal { mean, .. } => ("mean", *mean),
        Distribution::Lognormal { median, .. } => ("median", *median),
        _ => return refuse("`within` goes with normal and lognormal".to_owned()),
    };
    if !(low < middle && middle < high) {
        let [low, high, middle] = [low, high, middle].map(shown);
        return refuse(format!("`within` goes from {low} to {high}; the {name} {middle} must lie between them"));
    }
    Ok(Some([low, high]))
}

impl From<&ValueText> for Value {
    fn from(text: &ValueText) -> Self {
        match text {
            ValueText::Bool(value) => Self::Bool(*value),
            ValueText::Number(number) => Self::Number(*number),
            ValueText::Text(text) => Self::Text(text.clone()),
        }
    }
}

/// Cholesky factor of the correlation of normal scores; `None` where no parameter is correlated.
fn mixing(at: &Located, text: &PlanText, keys: &[&str], design: Design) -> Result<Option<Vec<Vec<f64>>>, InputError> {
    let mut correlation = DMatrix::identity(keys.len(), keys.len());
    let mut last = None;
    for (i, key) in keys.iter().enumerate() {
        for (other, &value) in &text.parameters[*key].correlate {
            let path = ["parameters", key, "correlate", other];
            let Some(j) = keys.iter().position(|key| key == other) else {
                let help = suggestion(other, keys.iter().copied());
                return Err(at.key_error(&path, format!("there is no parameter `{other}`"), help));
            };
            if i == j || correlation[(i, j)] != 0.0 {
                let help = Some("state every pair once".to_owned());
                return Err(at.key_error(&path, format!("`{key}` and `{other}` are correlated already"), help));
            }
            if !(value > -1.0 && value < 1.0) {
                let message = format!("the correlation is {}; it must lie between -1 and 1", shown(value));
                return Err(at.error(&path, message, None));
            }
            if design == Design::Grid {
                let help = Some("leave `correlate` out, or choose another design".to_owned());
                return Err(at.key_error(&path, "a grid has no correlation", help));
            }
            (correlation[(i, j)], correlation[(j, i)]) = (value, value);
            last = Some([*key, other.as_str()]);
        }
    }
    let Some([key, other]) = last else { return Ok(None) };
    let Some(factor) = correlation.cholesky() else {
        let message = "no parameters have all of these correlations at once: their matrix is not positive definite";
        return Err(at.error(&["parameters", key, "correlate", other], message, None));
    };
    let factor = factor.l();
    Ok(Some((0..keys.len()).map(|i| (0..=i).map(|j| factor[(i, j)]).collect()).collect()))
}
