//! Reads `data/people.toml`: sizes of people of either sex, and how passive torque differs between people.

use serde::Deserialize;

use super::reference::Reference;
use crate::math::normal::{cumulative, quantile};
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

impl PeopleOfSex {
    /// Stature (m) and mass (kg) that a `share` of these people, above 0 and below 1, do not exceed, each alone.
    pub fn size_at(&self, share: f64) -> (f64, f64) {
        let (score, stature, mass) = (quantile(share), self.stature_m, self.mass_kg);
        (stature.mean + score * stature.deviation, mass.median * libm::exp(score * mass.deviation_of_logarithm))
    }

    /// Shares of these people who do not exceed a stature (m), and who do not exceed a mass (kg).
    pub fn shares_up_to(&self, stature: f64, mass: f64) -> [f64; 2] {
        let of_stature = (stature - self.stature_m.mean) / self.stature_m.deviation;
        let of_mass = libm::log(mass / self.mass_kg.median) / self.mass_kg.deviation_of_logarithm;
        [of_stature, of_mass].map(cumulative)
    }
}

impl PeopleRow {
    /// People of that sex.
    pub fn of_sex(&self, sex: Sex) -> &PeopleOfSex {
        if sex == Sex::Female { &self.female } else { &self.male }
    }
}

#[cfg(test)]
mod tests {
    use crate::model::Sex;
    use crate::model::data::library;

    #[test]
    fn a_size_at_a_share_of_people_is_up_to_that_share() {
        for sex in [Sex::Female, Sex::Male] {
            let people = library().people().of_sex(sex);
            let (stature, mass) = people.size_at(0.5);
            assert!((stature - people.stature_m.mean).abs() < 1e-15 && (mass - people.mass_kg.median).abs() < 1e-12);
            for share in [0.01, 0.05, 0.3, 0.5, 0.84, 0.99] {
                let (stature, mass) = people.size_at(share);
                let found = people.shares_up_to(stature, mass);
                assert!(found.iter().all(|found| (found - share).abs() < 1e-12), "{share}: {found:?}");
            }
            // One standard deviation below the mean: 15.87 % of people (tables of the normal distribution).
            let below = people.shares_up_to(people.stature_m.mean - people.stature_m.deviation, mass)[0];
            assert!((below - 0.158_655_253_931_457).abs() < 1e-12, "{below}");
        }
    }
}
