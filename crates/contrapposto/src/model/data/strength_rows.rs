//! Reads `data/strength.toml`: the strength of the muscle groups.

use serde::Deserialize;

use super::reference::{Reference, Status};
use crate::model::adult_size::{Adult, Sex};
use crate::strength::{EVERY_ANGLE, Strength};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StrengthFile {
    floor: FloorRow,
    pub(super) variation: Vec<VariationRow>,
    group: Vec<GroupRow>,
    anderson2007: AndersonTable,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "status and source stand in the file for its readers")]
struct FloorRow {
    share: f64,
    status: Status,
    source: String,
}

/// Spread of strength between people: standard deviation over mean.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct VariationRow {
    pub(super) coefficient: f64,
    pub(super) movements: Vec<String>,
    pub(super) reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GroupRow {
    id: String,
    male: MeasuredRow,
    female: MeasuredRow,
    at_deg: Option<f64>,
    shape: ShapeRow,
    reference: Reference,
}

/// Mean torque of the people measured, and their mean body mass.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MeasuredRow {
    torque_nm: f64,
    mass_kg: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ShapeRow {
    best_deg: f64,
    narrowness_per_rad: f64,
    tested_deg: Option<[f64; 2]>,
    reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AndersonTable {
    movement: Vec<MovementRow>,
    row: Vec<AndersonRow>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MovementRow {
    id: String,
    tested_deg: [f64; 2],
    floor: Option<f64>,
    reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AndersonRow {
    id: String,
    sex: Sex,
    age: String,
    c1: f64,
    c2_per_rad: f64,
    c3_rad: f64,
}

/// Sources of the strength of a muscle group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrengthSources<'a> {
    /// Of its size.
    pub size: &'a Reference,
    /// Of its dependence on the angle.
    pub shape: &'a Reference,
}

impl StrengthSources<'_> {
    /// Trust in the strength at `angle` (rad): `extrapolated` outside the tested angles, and no better than that in the shape.
    pub fn status_at(&self, strength: &Strength, angle: f64) -> Status {
        match (self.size.status, self.shape.status) {
            _ if strength.is_extrapolated(angle) => Status::Extrapolated,
            (Status::Measured | Status::Derived, Status::Assumed) => Status::DerivedPartlyAssumed,
            (Status::Measured, Status::Derived) => Status::Derived,
            (size, _) => size,
        }
    }
}

/// Age group of Anderson et al. 2007 that the built-in adult belongs to.
const YOUNG: &str = "18-25";

/// Gravity in Anderson's normalisation and of the built-in adult, m/s^2.
pub(in crate::model) const GRAVITY: f64 = 9.81;

impl StrengthFile {
    /// Strength of a movement for an adult; `sign` -1 where the coordinate runs against the data. Hip and knee flexion and
    /// extension and the ankle's follow Anderson et al. 2007, young adults.
    pub(super) fn strength(&self, id: &str, size: &Adult, sign: f64) -> Option<(Strength, StrengthSources<'_>)> {
        let (strength, sources) = self.anderson(id, size).or_else(|| self.group(id, size))?;
        Some((if sign < 0.0 { strength.mirrored() } else { strength }, sources))
    }

    fn anderson(&self, id: &str, size: &Adult) -> Option<(Strength, StrengthSources<'_>)> {
        let table = &self.anderson2007;
        let movement = table.movement.iter().find(|movement| movement.id == id)?;
        let row = table.row.iter().find(|r| r.id == id && r.sex == size.sex && r.age == YOUNG)?;
        let strength = Strength {
            peak: row.c1 * size.mass * GRAVITY * size.stature,
            best: row.c3_rad,
            narrowness: row.c2_per_rad,
            floor: movement.floor.unwrap_or(self.floor.share),
            tested: radians(movement.tested_deg),
            table: None,
        };
        Some((strength, StrengthSources { size: &movement.reference, shape: &movement.reference }))
    }

    fn group(&self, id: &str, size: &Adult) -> Option<(Strength, StrengthSources<'_>)> {
        let row = self.group.iter().find(|row| row.id == id)?;
        let measured = if size.sex == Sex::Male { &row.male } else { &row.female };
        let mut strength = Strength {
            peak: measured.torque_nm * size.mass / measured.mass_kg,
            best: row.shape.best_deg.to_radians(),
            narrowness: row.shape.narrowness_per_rad,
            floor: self.floor.share,
            tested: row.shape.tested_deg.map_or(EVERY_ANGLE, radians),
            table: None,
        };
        if let Some(angle) = row.at_deg {
            strength.peak *= strength.peak / strength.torque(angle.to_radians());
        }
        Some((strength, StrengthSources { size: &row.reference, shape: &row.shape.reference }))
    }
}

fn radians([least, greatest]: [f64; 2]) -> (f64, f64) {
    (least.to_radians(), greatest.to_radians())
}
