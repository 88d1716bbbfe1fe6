//! Describes the built-in adult: sex, stature, mass and measured lengths.

use std::ops::RangeInclusive;

use serde::Deserialize;

/// Sex, as the body tables distinguish it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sex {
    /// De Leva's women.
    Female,
    /// De Leva's men.
    Male,
}

/// Part of the body that is modelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    Whole,
    /// The right arm, on a trunk and head that are fixed in ground.
    RightArm,
}

/// Size of the built-in adult.
#[derive(Clone, Debug, PartialEq)]
pub struct Adult {
    /// Sex whose proportions the body has.
    pub sex: Sex,
    /// Stature, m, one of [`Adult::STATURES`].
    pub stature: f64,
    /// Mass, kg, one of [`Adult::MASSES`].
    pub mass: f64,
    /// Part of the body that is modelled.
    pub part: Part,
    /// Measured segment lengths, m, by segment name without side (`femur`, `tibia`, `humerus`, `radius`, `hand`, ...); the
    /// others follow stature. Masses stay shares of body mass.
    pub lengths: Vec<(String, f64)>,
}

impl Default for Adult {
    /// De Leva's reference man, 73.0 kg and 1.741 m, whole.
    fn default() -> Self {
        Self { sex: Sex::Male, stature: 1.741, mass: 73.0, part: Part::Whole, lengths: vec![] }
    }
}

impl Adult {
    /// Masses that are an adult's, kg.
    pub const MASSES: RangeInclusive<f64> = 30.0..=250.0;
    /// Statures that are an adult's, m.
    pub const STATURES: RangeInclusive<f64> = 1.2..=2.3;

    /// De Leva's reference woman or man.
    pub fn reference(sex: Sex) -> Self {
        match sex {
            Sex::Female => Self { sex, stature: 1.735, mass: 61.9, ..Self::default() },
            Sex::Male => Self::default(),
        }
    }

    /// The right arm of the reference man.
    pub fn right_arm() -> Self {
        Self { part: Part::RightArm, ..Self::default() }
    }
}
