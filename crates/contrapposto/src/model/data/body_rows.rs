//! Reads `data/anthropometry.toml` and `data/adult.toml`: segments, joints and coordinates of the adult.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::reference::Reference;
use crate::model::adult_size::Sex;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AnthropometryFile {
    #[expect(dead_code, reason = "stands in the file for its readers")]
    reference: Reference,
    pub(crate) segment: Vec<AnthropometryRow>,
    #[expect(dead_code, reason = "stands in the file for its readers; adult.toml quotes what it uses")]
    proportions: toml::Table,
    #[expect(dead_code, reason = "stands in the file for its readers; adult.toml quotes what it uses")]
    standing: toml::Table,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AnthropometryRow {
    pub(crate) id: String,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    meaning: String,
    male: Shares,
    female: Shares,
}

impl AnthropometryRow {
    pub(crate) fn of(&self, sex: Sex) -> &Shares {
        if sex == Sex::Male { &self.male } else { &self.female }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Shares {
    pub(crate) mass: f64,
    pub(crate) length: f64,
    pub(crate) com: f64,
    pub(crate) r_ap: f64,
    pub(crate) r_ml: f64,
    pub(crate) r_long: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AdultFile {
    pub(crate) segment: Vec<SegmentRow>,
    pub(crate) coordinate: Vec<CoordinateRow>,
    pub(crate) shoulder_rhythm: RhythmRow,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RhythmRow {
    pub(crate) rise_of_range: f64,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SegmentRow {
    pub(crate) name: String,
    pub(crate) parent: Option<String>,
    pub(crate) anthropometry: Option<String>,
    pub(crate) length_of: Option<String>,
    pub(crate) along: Along,
    pub(crate) joint: String,
    #[serde(default)]
    pub(crate) length_share: Option<BySex>,
    #[serde(default)]
    pub(crate) at_parent: BySex,
    #[serde(default)]
    pub(crate) at_stature: [f64; 3],
    #[serde(default)]
    pub(crate) proximal_at_stature: [f64; 3],
    #[serde(default)]
    pub(crate) mirrored: bool,
    pub(crate) right_arm: Option<InRightArm>,
    #[serde(default)]
    pub(crate) motions: Vec<MotionRow>,
    pub(crate) patch: Option<PatchRow>,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    reference: Reference,
}

/// A number, or one of women and one of men.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged)]
pub(crate) enum BySex {
    Same(f64),
    Each { female: f64, male: f64 },
}

impl BySex {
    pub(crate) fn of(self, sex: Sex) -> f64 {
        match (self, sex) {
            (Self::Same(value), _)
            | (Self::Each { female: value, .. }, Sex::Female)
            | (Self::Each { male: value, .. }, Sex::Male) => value,
        }
    }
}

impl Default for BySex {
    fn default() -> Self {
        Self::Same(0.0)
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PatchRow {
    pub(crate) at_stature: Vec<[f64; 3]>,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    reference: Reference,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Along {
    Up,
    Down,
    Forward,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum InRightArm {
    Fixed,
    Moving,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MotionRow {
    #[serde(default)]
    pub(crate) slide: bool,
    pub(crate) axis: [f64; 3],
    pub(crate) coordinate: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CoordinateRow {
    pub(crate) name: String,
    pub(crate) positive: String,
    /// The left side has one, too.
    #[serde(default)]
    pub(crate) mirrored: bool,
    pub(crate) range_deg: Option<[f64; 2]>,
    pub(crate) range_m: Option<[f64; 2]>,
    /// As shares of stature.
    pub(crate) range_stature: Option<[f64; 2]>,
    pub(crate) range_reference: Reference,
    pub(crate) default: Option<DefaultRow>,
    /// Of the whole body; a part of it has zero.
    pub(crate) default_deg: Option<f64>,
    pub(crate) passive: Option<PassiveUse>,
    pub(crate) strength: Option<StrengthUse>,
    pub(crate) region: String,
}

/// A default distance: a share of stature and lengths of segments.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DefaultRow {
    pub(crate) stature: f64,
    pub(crate) lengths: BTreeMap<String, f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PassiveUse {
    pub(crate) curve: String,
    pub(crate) female_curve: Option<String>,
    pub(crate) sign: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StrengthUse {
    pub(crate) positive: String,
    pub(crate) negative: String,
    pub(crate) sign: f64,
}
