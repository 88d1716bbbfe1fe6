//! Holds an obstacle as the scenario file writes it.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::toml_file::numbers;

/// A thing that no part of the body passes through: a block, or a wall.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObstacleText {
    /// Name of the thing.
    pub(crate) name: String,
    /// Middle of a block, ground, m.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) middle_m: Option<[f64; 3]>,
    /// Lengths of a block along x, y and z, m.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) size_m: Option<[f64; 3]>,
    /// Angle by which a block is turned to the left about its vertical axis, deg.
    pub(crate) turn_deg: Option<f64>,
    /// Direction out of a wall, ground.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) normal: Option<[f64; 3]>,
    /// A point of a wall's surface, ground, m.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) point_m: Option<[f64; 3]>,
}
