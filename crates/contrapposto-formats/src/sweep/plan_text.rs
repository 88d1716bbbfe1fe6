//! Holds the file of a plan as it is written: one struct a table, unknown keys refused. See `docs/sweeps.md`.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::toml_file::numbers;

/// A plan of many runs of one scenario.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlanText {
    pub(super) base: String,
    #[serde(default)]
    pub(super) seed: u32,
    pub(super) design: DesignText,
    pub(super) rows: Option<u32>,
    pub(super) rows_per_part: Option<u32>,
    pub(super) parameters: BTreeMap<String, ParameterText>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum DesignText {
    Sobol,
    ShiftedSobol,
    Grid,
    LatinHypercube,
    Random,
}

/// One of `normal`, `lognormal`, `range`, `list`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ParameterText {
    #[serde(default, deserialize_with = "numbers")]
    pub(super) normal: Option<[f64; 2]>,
    #[serde(default, deserialize_with = "numbers")]
    pub(super) lognormal: Option<[f64; 2]>,
    #[serde(default, deserialize_with = "numbers")]
    pub(super) range: Option<[f64; 2]>,
    pub(super) list: Option<Vec<ValueText>>,
    #[serde(default, deserialize_with = "numbers")]
    pub(super) within: Option<[f64; 2]>,
    pub(super) levels: Option<u32>,
    #[serde(default)]
    pub(super) correlate: BTreeMap<String, f64>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum ValueText {
    Bool(bool),
    Number(f64),
    Text(String),
}
