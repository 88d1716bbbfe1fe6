//! Reads `data/hazards.toml`: the joint angles at which passive tissue that carries a joint is a hazard.

use serde::Deserialize;

use super::reference::Reference;
use crate::model::Coordinate;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HazardFile {
    pub(super) hazard: Vec<HazardRow>,
}

/// Angles of some coordinates beyond which passive tissue that carries them is a hazard.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HazardRow {
    coordinates: Vec<String>,
    positive: String,
    /// The positive sense of a coordinate that runs against the row.
    #[serde(default)]
    negative: String,
    below_deg: Option<f64>,
    above_deg: Option<f64>,
    least_carried: f64,
    seconds: Option<f64>,
    /// Finding of a study, as the second half of a sentence.
    pub finding: String,
    /// Source of the angles.
    pub angle_reference: Reference,
    /// Source of the finding.
    pub finding_reference: Reference,
}

impl HazardRow {
    /// Whether a coordinate is in this hazard: its angle, rad, and the share of its external torque that passive tissue carries.
    pub fn applies(&self, coordinate: &Coordinate, angle: f64, carried: f64) -> bool {
        let same_sense = self.positive.is_empty() || coordinate.positive == self.positive;
        let opposite = !self.negative.is_empty() && coordinate.positive == self.negative;
        let degrees = if opposite { -angle.to_degrees() } else { angle.to_degrees() };
        let beyond = self.below_deg.is_some_and(|limit| degrees <= limit)
            || self.above_deg.is_some_and(|limit| degrees >= limit);
        let senses = same_sense || opposite;
        self.coordinates.contains(&coordinate.name) && senses && beyond && carried >= self.least_carried
    }

    /// Longest time for which the study kept people there, s.
    pub fn seconds(&self) -> Option<f64> {
        self.seconds
    }
}
