//! Multiplies strength and passive torque of a body, for people who are weaker, stronger, stiffer or more supple than the mean.

use std::collections::BTreeMap;
use std::fmt;

use contrapposto::model::data::library;
use contrapposto::model::{Model, MuscleGroup};
use schemars::JsonSchema;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::input_error::InputError;
use crate::passive_law::PassiveText;
use crate::toml_file::{Located, shown};

/// Factors of strength and of passive torque that are accepted: beyond every person (assumed; it only catches wrong units).
const FACTORS: std::ops::RangeInclusive<f64> = 0.05..=5.0;
/// Standard deviations from the mean strength that are accepted: with the greatest coefficient of variation of the data, 0.277, the
/// weakest person keeps 3 % of the mean strength.
pub const STRENGTH_DEVIATIONS: std::ops::RangeInclusive<f64> = -3.5..=3.5;

/// Strength of the person beside the mean of people of that sex and size.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct StrengthText {
    /// Factor of the strength of every muscle group, 0.05 to 5.
    pub(crate) spread: f64,
    /// Standard deviations from the mean, -3.5 to 3.5: the factor of a muscle group is 1 + deviations times its coefficient of variation.
    pub(crate) deviations: f64,
}

impl Default for StrengthText {
    fn default() -> Self {
        Self { spread: 1.0, deviations: 0.0 }
    }
}

/// Passive curves by coordinate, and a factor of the passive torque of all coordinates.
#[derive(Debug, Default, JsonSchema)]
pub(crate) struct PassiveTable {
    /// Factor of the passive torque of every coordinate, 0.05 to 5; 1 when left out.
    #[schemars(default)]
    pub(crate) spread: Option<f64>,
    /// Curves by coordinate.
    #[schemars(flatten)]
    pub(crate) curves: BTreeMap<String, PassiveText>,
}

impl<'de> Deserialize<'de> for PassiveTable {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_map(Keys)
    }
}

/// Reads the keys of `[passive]` one by one, so that errors keep their places.
struct Keys;

impl<'de> Visitor<'de> for Keys {
    type Value = PassiveTable;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table of passive curves by coordinate")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<PassiveTable, A::Error> {
        let mut table = PassiveTable::default();
        while let Some(key) = map.next_key::<String>()? {
            if key == "spread" {
                table.spread = Some(map.next_value()?);
            } else {
                table.curves.insert(key, map.next_value()?);
            }
        }
        Ok(table)
    }
}

/// The body with the strength and the passive torque of the person.
pub(super) fn with_spread(
    at: &Located,
    mut model: Model,
    strength: &StrengthText,
    passive: &PassiveTable,
) -> Result<Model, InputError> {
    let in_range = |path: [&str; 2], value: f64, accepted: std::ops::RangeInclusive<f64>| {
        let (key, low, high) = (path.join("."), accepted.start(), accepted.end());
        let message = || format!("`{key}` is {}; it must lie in {low}..{high}", shown(value));
        if accepted.contains(&value) { Ok(value) } else { Err(at.error(&path, message(), None)) }
    };
    let spread = in_range(["strength", "spread"], strength.spread, FACTORS)?;
    let deviations = in_range(["strength", "deviations"], strength.deviations, STRENGTH_DEVIATIONS)?;
    let stiffness = in_range(["passive", "spread"], passive.spread.unwrap_or(1.0), FACTORS)?;
    let factor = |group: &MuscleGroup| {
        let variation = library().strength_variation(&group.name).map_or(0.0, |(coefficient, _)| coefficient);
        spread * (1.0 + deviations * variation)
    };
    for index in 0..model.coordinates().len() {
        let coordinate = &model.coordinates()[index];
        if let Some(groups) = &coordinate.groups {
            let groups = groups.clone().map(|mut group| {
                let times = factor(&group);
                group.strength = group.strength.scaled(times);
                group
            });
            model = model.with_groups(index, groups);
        }
        if stiffness == 1.0 {
            continue;
        }
        if let Some(law) = &model.coordinates()[index].passive {
            let name = &model.coordinates()[index].name;
            let refuse = |error| at.error(&["passive", "spread"], format!("passive torque of `{name}`: {error}"), None);
            let law = law.scaled(stiffness).map_err(refuse)?;
            model = model.with_passive_law(index, Some(law));
        }
    }
    Ok(model)
}
