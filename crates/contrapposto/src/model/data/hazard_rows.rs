//! Reads `data/hazards.toml`: the joint angles at which passive tissue that carries a joint is a hazard.

use std::collections::BTreeMap;

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
    /// Coordinates, each with the posture in words, before the size of its angle.
    coordinates: BTreeMap<String, String>,
    /// The part of the body.
    pub part: String,
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
        self.limit(coordinate, angle).is_some() && carried >= self.least_carried
    }

    /// The angle from which on a coordinate at this one is in hazard, rad; `None` where it is not.
    pub(crate) fn limit(&self, coordinate: &Coordinate, angle: f64) -> Option<f64> {
        let sense = self.sense(coordinate)?;
        let degrees = sense * angle.to_degrees();
        let below = self.below_deg.filter(|limit| degrees <= *limit);
        let limit = below.or(self.above_deg.filter(|limit| degrees >= *limit));
        limit.map(|limit| sense * limit.to_radians())
    }

    /// Whether the row is about a coordinate of this name.
    pub(crate) fn concerns(&self, coordinate: &str) -> bool {
        self.coordinates.contains_key(coordinate)
    }

    /// `low back bent forward by 60°`: a coordinate of the row at an angle, rad.
    pub(crate) fn posture_in_words(&self, coordinate: &str, angle: f64) -> String {
        let posture = self.coordinates.get(coordinate).map_or(coordinate, String::as_str);
        format!("{posture} {:.0}°", angle.to_degrees().abs())
    }

    /// 1 for a coordinate of the row that counts as the row does, -1 for one that runs against it; `None` of all others.
    pub(crate) fn sense(&self, coordinate: &Coordinate) -> Option<f64> {
        let same_sense = self.positive.is_empty() || coordinate.positive == self.positive;
        let opposite = !self.negative.is_empty() && coordinate.positive == self.negative;
        let sense = if opposite { -1.0 } else { 1.0 };
        (self.concerns(&coordinate.name) && (same_sense || opposite)).then_some(sense)
    }

    /// Longest time for which the study kept people there, s.
    pub fn seconds(&self) -> Option<f64> {
        self.seconds
    }
}
