//! Reads `data/grip.toml`: the strength of the grip of a hand.

use serde::Deserialize;

use super::reference::Reference;
use crate::model::Sex;

/// Newtons of a pound of force.
const NEWTONS_PER_POUND: f64 = 4.448_221_615;

/// Strength of the grip, and the weight that a hand can hold.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GripRow {
    /// The greatest pull at a handle, over the strength of the grip.
    pub handle_factor: f64,
    /// Source of that factor.
    pub handle_reference: Reference,
    /// Share of the strength of the grip from which on a weight is reported.
    pub reported_share: f64,
    /// Source of that share.
    pub reported_reference: Reference,
    male: GripOfSex,
    female: GripOfSex,
    /// Source of the strengths.
    pub reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GripOfSex {
    right_lb: Vec<f64>,
    left_lb: Vec<f64>,
}

impl GripRow {
    /// Mean strength of the grip of a hand, N: over both hands and the ages of 20 to 64.
    pub fn strength(&self, sex: Sex) -> f64 {
        let GripOfSex { right_lb, left_lb } = if sex == Sex::Female { &self.female } else { &self.male };
        let count = right_lb.len() + left_lb.len();
        NEWTONS_PER_POUND * right_lb.iter().chain(left_lb).sum::<f64>() / count as f64
    }
}
