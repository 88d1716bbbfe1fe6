//! Reads `data/shapes.toml`: the capsules of the adult's parts.

use serde::Deserialize;

use super::reference::Reference;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ShapeFile {
    pub(crate) density: DensityRow,
    pub(crate) shape: Vec<ShapeRow>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DensityRow {
    pub(crate) kg_per_m3: f64,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ShapeRow {
    pub(crate) name: String,
    pub(crate) segment: String,
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) mass_share: f64,
    pub(crate) across: Option<f64>,
    #[serde(default)]
    pub(crate) inset: [bool; 2],
    #[serde(default)]
    pub(crate) sole: bool,
    #[serde(default)]
    pub(crate) meets: Vec<String>,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    reference: Reference,
}
