//! Reads `data/strength.toml`: the strength of the muscle groups.

use serde::Deserialize;

use super::reference::{Reference, Status};
use crate::model::adult_size::Sex;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StrengthFile {
    pub(super) floor: FloorRow,
    pub(super) group: Vec<GroupRow>,
    pub(super) anderson2007: AndersonTable,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "status and source stand in the file for its readers")]
pub(super) struct FloorRow {
    pub(super) share: f64,
    pub(super) status: Status,
    pub(super) source: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GroupRow {
    pub(super) id: String,
    pub(super) male_nm: f64,
    pub(super) female_factor: f64,
    pub(super) shape: ShapeRow,
    pub(super) reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "status and source stand in the file for its readers")]
pub(super) struct ShapeRow {
    pub(super) best_deg: f64,
    pub(super) narrowness_per_rad: f64,
    pub(super) status: Status,
    pub(super) source: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AndersonTable {
    pub(super) reference: Reference,
    pub(super) row: Vec<AndersonRow>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AndersonRow {
    pub(super) id: String,
    pub(super) sex: Sex,
    pub(super) age: String,
    pub(super) c1: f64,
    pub(super) c2_per_rad: f64,
    pub(super) c3_rad: f64,
}
