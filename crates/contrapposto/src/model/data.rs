//! Holds the numbers of the human body, each with its source.
//!
//! The TOML files of the folder `data/` are embedded at compile time and parsed once. Every number carries a [`Reference`]: a
//! status and a source. No number of the body is written in code.

mod body_rows;
mod fatigue_parameters;
mod fatigue_rows;
mod grip_rows;
mod hazard_rows;
mod passive_rows;
mod people_rows;
mod reference;
mod shape_rows;
mod strength_rows;

use std::sync::LazyLock;

use super::adult_size::Adult;
use crate::strength::Strength;
use crate::toml_value::typed;
use body_rows::{AdultFile, AnthropometryFile};
pub(super) use body_rows::{Along, CoordinateRow, InRightArm, SegmentRow};
pub use fatigue_parameters::FatigueSet;
use fatigue_rows::FatigueFile;
pub use grip_rows::GripRow;
use hazard_rows::HazardFile;
pub use hazard_rows::HazardRow;
use passive_rows::PassiveFile;
pub use passive_rows::{CurveRow, reshaped};
pub use people_rows::{Lognormal, PeopleOfSex, PeopleRow};
pub use reference::{Reference, Status};
use shape_rows::ShapeFile;
pub(super) use shape_rows::ShapeRow;
pub(super) use strength_rows::GRAVITY;
use strength_rows::StrengthFile;
pub use strength_rows::StrengthSources;
use toml::de::DeTable;

/// All embedded data.
#[derive(Debug)]
pub struct Library {
    pub(super) passive: PassiveFile,
    pub(super) strength: StrengthFile,
    pub(super) fatigue: FatigueFile,
    pub(super) anthropometry: AnthropometryFile,
    pub(super) adult: AdultFile,
    pub(super) shapes: ShapeFile,
    hazards: HazardFile,
    grip: GripRow,
    people: PeopleRow,
}

static LIBRARY: LazyLock<Library> = LazyLock::new(|| {
    // The files are part of the program; the test `embedded_data_parse` reads every one.
    fn parse<T: serde::de::DeserializeOwned>(name: &str, text: &str) -> T {
        let refused = |error: &dyn std::fmt::Display| -> T { panic!("embedded data/{name}.toml: {error}") };
        match DeTable::parse(text) {
            Ok(table) => typed(table.get_ref()).unwrap_or_else(|error| refused(&error)),
            Err(error) => refused(&error),
        }
    }
    Library {
        passive: parse("passive", include_str!("../../data/passive.toml")),
        strength: parse("strength", include_str!("../../data/strength.toml")),
        fatigue: parse("fatigue", include_str!("../../data/fatigue.toml")),
        anthropometry: parse("anthropometry", include_str!("../../data/anthropometry.toml")),
        adult: parse("adult", include_str!("../../data/adult.toml")),
        shapes: parse("shapes", include_str!("../../data/shapes.toml")),
        hazards: parse("hazards", include_str!("../../data/hazards.toml")),
        grip: parse("grip", include_str!("../../data/grip.toml")),
        people: parse("people", include_str!("../../data/people.toml")),
    }
});

/// The embedded data.
pub fn library() -> &'static Library {
    &LIBRARY
}

impl Library {
    /// The passive curve of that name.
    pub fn curve(&self, name: &str) -> Option<&CurveRow> {
        self.passive.curve.iter().find(|row| row.name == name)
    }

    /// The passive curve of that name for an adult of that size: its torque grows with body mass.
    pub fn curve_of_size(&self, name: &str, size: &Adult) -> Option<CurveRow> {
        let row = self.curve(name)?;
        Some(row.scaled(size.mass / row.mass_kg.unwrap_or(self.passive.scale.mass_kg)))
    }

    /// Names of all passive curves, in the file's order.
    pub fn curve_names(&self) -> impl Iterator<Item = &str> {
        self.passive.curve.iter().map(|row| row.name.as_str())
    }

    /// The default of `reshape = true`: zone width (rad), torque to reach at the limits (N m), reference.
    pub fn reshape(&self) -> (f64, f64, Reference) {
        let row = &self.passive.reshape;
        let reference = Reference { status: row.status, source: row.source.clone(), note: String::new() };
        (row.zone_deg.to_radians(), row.end_torque_nm, reference)
    }

    /// Angles at which passive tissue that carries a joint is a hazard.
    pub fn hazards(&self) -> &[HazardRow] {
        &self.hazards.hazard
    }

    /// Rise of the shoulder joint along the thorax from the hanging arm to the arm overhead, as a share of the upper end of its range.
    pub(crate) fn shoulder_rise(&self) -> f64 {
        self.adult.shoulder_rhythm.rise_of_range
    }

    /// Strength of the grip of a hand.
    pub fn grip(&self) -> &GripRow {
        &self.grip
    }

    /// Sizes of people, and the spread of their passive torque.
    pub fn people(&self) -> &PeopleRow {
        &self.people
    }

    /// Strength of a movement for an adult, with its sources; `sign` -1 where the coordinate runs against the data.
    pub(super) fn strength(&self, id: &str, size: &Adult, sign: f64) -> Option<(Strength, StrengthSources<'_>)> {
        self.strength.strength(id, size, sign)
    }
}

#[cfg(test)]
mod tests {
    use super::library;

    #[test]
    fn embedded_data_parse() {
        let library = library();
        for row in &library.passive.curve {
            let range = (row.range_deg[0].to_radians(), row.range_deg[1].to_radians());
            row.over(range, 1.0).unwrap_or_else(|error| panic!("{}: {error}", row.name));
            row.over((-range.1, -range.0), -1.0).unwrap_or_else(|error| panic!("{} mirrored: {error}", row.name));
        }
        for row in &library.fatigue.endurance {
            assert!(library.endurance(&row.name).is_some(), "{} has no form", row.name);
        }
    }
}
