//! Reads `data/people.toml`: sizes of people of either sex, and how passive torque differs between people.

use serde::Deserialize;

use super::reference::Reference;
use crate::model::Sex;

/// Sizes of people, and the spread of their passive torque.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeopleRow {
    female: PeopleOfSex,
    male: PeopleOfSex,
    /// Source of the sizes.
    pub reference: Reference,
    /// The factor of the passive torque of all joints of a person.
    pub passive_spread: PassiveSpread,
}

/// People of one sex.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeopleOfSex {
    /// Number of people measured.
    pub number: u32,
    /// Stature, m.
    pub stature_m: Normal,
    /// Body mass, kg.
    pub mass_kg: Lognormal,
    /// Correlation of stature and the logarithm of body mass.
    pub correlation: f64,
}

/// A normal distribution.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Normal {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
}

/// A distribution whose logarithm is normal.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lognormal {
    /// Median.
    pub median: f64,
    /// Standard deviation of the natural logarithm.
    pub deviation_of_logarithm: f64,
}

/// The spread of passive torque between people, with its source.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PassiveSpread {
    /// Median of the factor.
    pub median: f64,
    /// Standard deviation of its natural logarithm.
    pub deviation_of_logarithm: f64,
    /// Source of both.
    pub reference: Reference,
}

impl PeopleRow {
    /// People of that sex.
    pub fn of_sex(&self, sex: Sex) -> &PeopleOfSex {
        if sex == Sex::Female { &self.female } else { &self.male }
    }
}
