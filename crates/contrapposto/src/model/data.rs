//! Which numbers of the human body does this crate hold, and where do they come from?
//!
//! The TOML files of `data/`, embedded at compile time and parsed once. Every number carries a [`Reference`]: a status and
//! a source. Nothing of the body is written in code.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use super::{Adult, Sex};
use crate::fatigue::{Endurance, EnduranceCurve, EnduranceForm, FatigueLaw, ThreeCompartment};
use crate::passive::{
    CoupledTerm, DoubleExponential, End, Form, PassiveCurve, PassiveError, Reshape, RienerEdrich1999,
};
use crate::strength::Strength;

/// How far a number can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Status {
    /// Read in the named source.
    #[serde(rename = "verified")]
    Verified,
    /// Computed from verified numbers.
    #[serde(rename = "derived")]
    Derived,
    /// Verified size, assumed shape.
    #[serde(rename = "derived (partly assumed)")]
    DerivedPartlyAssumed,
    /// From memory; never cite as verified.
    #[serde(rename = "recalled (unverified)")]
    Recalled,
    /// A design choice without a measurement behind it.
    #[serde(rename = "assumed")]
    Assumed,
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Verified => "verified",
            Self::Derived => "derived",
            Self::DerivedPartlyAssumed => "derived (partly assumed)",
            Self::Recalled => "recalled (unverified)",
            Self::Assumed => "assumed",
        })
    }
}

/// Where a number comes from.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// How far it can be trusted.
    pub status: Status,
    /// Author, year, place; or the reason of an assumption.
    pub source: String,
    /// What else to know.
    #[serde(default)]
    pub note: String,
}

/// All embedded data.
#[derive(Debug)]
pub struct Library {
    pub(super) passive: PassiveFile,
    pub(super) strength: StrengthFile,
    pub(super) fatigue: FatigueFile,
    pub(super) anthropometry: AnthropometryFile,
    pub(super) adult: AdultFile,
}

static LIBRARY: LazyLock<Library> = LazyLock::new(|| {
    // The files are part of the program; the test `embedded_data_parse` reads every one.
    fn parse<T: serde::de::DeserializeOwned>(name: &str, text: &str) -> T {
        toml::from_str(text).unwrap_or_else(|error| panic!("embedded data/{name}.toml: {error}"))
    }
    Library {
        passive: parse("passive", include_str!("../../data/passive.toml")),
        strength: parse("strength", include_str!("../../data/strength.toml")),
        fatigue: parse("fatigue", include_str!("../../data/fatigue.toml")),
        anthropometry: parse("anthropometry", include_str!("../../data/anthropometry.toml")),
        adult: parse("adult", include_str!("../../data/adult.toml")),
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

    /// 3CC-r of a fatigue class (`elbow`, `shoulder`, ...), with its reference.
    pub fn three_compartment(&self, class: &str) -> Option<(FatigueLaw, &Reference)> {
        let row = self.fatigue.three_compartment.iter().find(|row| row.class == class)?;
        let law = ThreeCompartment {
            fatigue_rate: row.fatigue_per_s,
            recovery_rate: row.recovery_per_s,
            rest_multiplier: row.rest_multiplier,
        };
        Some((FatigueLaw::ThreeCompartment(law), &row.reference))
    }

    /// The endurance integral with the curve of that name, with the curve's reference.
    pub fn endurance(&self, name: &str) -> Option<(FatigueLaw, &Reference)> {
        let row = self.fatigue.endurance.iter().find(|row| row.name == name)?;
        let curve = EnduranceCurve { name: row.name.clone(), form: row.form()? };
        let law = Endurance { curve, recovery_rate: self.fatigue.recovery.rate_per_s };
        Some((FatigueLaw::Endurance(law), &row.reference))
    }

    /// Names of all endurance curves.
    pub fn endurance_names(&self) -> impl Iterator<Item = &str> {
        self.fatigue.endurance.iter().map(|row| row.name.as_str())
    }

    /// The default endurance curve of a fatigue class: Frey-Law & Avin 2010.
    pub fn default_endurance(&self, class: &str) -> String {
        format!("freylaw_avin_2010_{class}")
    }

    /// Strength of a movement for an adult; `sign` -1 where the coordinate runs against the data. Hip and knee flexion and
    /// extension and the ankle's follow Anderson et al. 2007, young adults.
    pub(super) fn strength(&self, id: &str, size: &Adult, sign: f64) -> Option<(Strength, &Reference)> {
        let floor = self.strength.floor.share;
        let measured =
            self.strength.anderson2007.row.iter().find(|r| r.id == id && r.sex == size.sex && r.age == YOUNG);
        if let Some(row) = measured {
            let peak = row.c1 * size.mass * GRAVITY * size.stature;
            let strength = Strength { peak, best: sign * row.c3_rad, narrowness: row.c2_per_rad, floor };
            return Some((strength, &self.strength.anderson2007.reference));
        }
        let row = self.strength.group.iter().find(|row| row.id == id)?;
        let factor = if size.sex == Sex::Female { row.female_factor } else { 1.0 };
        let strength = Strength {
            peak: row.male_nm * factor,
            best: sign * row.shape.best_deg.to_radians(),
            narrowness: row.shape.narrowness_per_rad,
            floor,
        };
        Some((strength, &row.reference))
    }
}

/// Age group of Anderson et al. 2007 that the built-in adult belongs to.
const YOUNG: &str = "18-25";

/// Gravity in Anderson's normalisation and of the built-in adult, m/s^2.
pub(super) const GRAVITY: f64 = 9.81;

/// One row of `data/passive.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurveRow {
    /// Its name.
    pub name: String,
    /// The positive direction in clinical words.
    pub positive: String,
    /// The range it is meant for, deg.
    pub range_deg: [f64; 2],
    double_exponential: Option<DoubleExponentialRow>,
    riener_edrich1999: Option<RienerEdrichRow>,
    /// Where it comes from.
    pub reference: Reference,
}

impl CurveRow {
    /// The curve over `range` (rad, in the coordinate's direction), which runs against the data's with `sign` -1. A law
    /// coupled to neighbouring joints is taken with them at zero.
    ///
    /// # Errors
    /// [`PassiveError`] where the range does not suit the curve.
    pub fn over(&self, range: (f64, f64), sign: f64) -> Result<PassiveCurve, PassiveError> {
        let form = match (&self.double_exponential, &self.riener_edrich1999) {
            (Some(row), _) => row.form(sign)?,
            (None, Some(row)) => Form::Exponentials(row.law().held([0.0; 3], sign < 0.0)?),
            (None, None) => return Err(PassiveError::Table { row: 0, problem: "the data row holds no law" }),
        };
        PassiveCurve::new(form, range, None)
    }

    /// The coupled law, where it is one.
    pub fn coupled(&self) -> Option<RienerEdrich1999> {
        self.riener_edrich1999.as_ref().map(RienerEdrichRow::law)
    }
}

/// `curve` reshaped near both limits so that the torque there reaches `end_torque` (N m) at least, over zones of width
/// `zone` (rad).
///
/// # Errors
/// [`PassiveError`] for a zone wider than half the range.
pub fn reshaped(curve: &PassiveCurve, zone: f64, end_torque: f64) -> Result<PassiveCurve, PassiveError> {
    let (min, max) = curve.range();
    let reshape = Reshape::reaching(end_torque, zone, (curve.torque(min), curve.torque(max)));
    PassiveCurve::new(curve.form().clone(), curve.range(), Some(reshape))
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PassiveFile {
    reshape: ReshapeRow,
    curve: Vec<CurveRow>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReshapeRow {
    zone_deg: f64,
    end_torque_nm: f64,
    status: Status,
    source: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct EndRow {
    torque_nm: f64,
    rate_per_rad: f64,
    angle_deg: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DoubleExponentialRow {
    lower: EndRow,
    upper: EndRow,
    stiffness_nm_per_rad: f64,
    neutral_deg: f64,
}

impl DoubleExponentialRow {
    fn form(&self, sign: f64) -> Result<Form, PassiveError> {
        let end = |row: &EndRow| End {
            torque: row.torque_nm,
            rate: row.rate_per_rad,
            angle: sign * row.angle_deg.to_radians(),
        };
        let (lower, upper) = (end(&self.lower), end(&self.upper));
        let (lower, upper) = if sign < 0.0 { (upper, lower) } else { (lower, upper) };
        let neutral = sign * self.neutral_deg.to_radians();
        DoubleExponential { lower, upper, stiffness: self.stiffness_nm_per_rad, neutral }.form()
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RienerEdrichRow {
    joint: String,
    terms: Vec<[f64; 5]>,
    constant_nm: f64,
}

impl RienerEdrichRow {
    fn law(&self) -> RienerEdrich1999 {
        let per_rad = |per_deg: f64| per_deg * 180.0 / std::f64::consts::PI;
        let term = |&[sign, c0, hip, knee, ankle]: &[f64; 5]| CoupledTerm {
            sign,
            c0,
            rates: [per_rad(hip), per_rad(knee), per_rad(ankle)],
        };
        let joint = match self.joint.as_str() {
            "hip" => 0,
            "knee" => 1,
            _ => 2,
        };
        RienerEdrich1999 { joint, terms: self.terms.iter().map(term).collect(), constant: self.constant_nm }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StrengthFile {
    floor: FloorRow,
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

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GroupRow {
    id: String,
    male_nm: f64,
    female_factor: f64,
    shape: ShapeRow,
    reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "status and source stand in the file for its readers")]
struct ShapeRow {
    best_deg: f64,
    narrowness_per_rad: f64,
    status: Status,
    source: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AndersonTable {
    reference: Reference,
    row: Vec<AndersonRow>,
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

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FatigueFile {
    recovery: RecoveryRow,
    three_compartment: Vec<ThreeCompartmentRow>,
    endurance: Vec<EnduranceRow>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "status and source stand in the file for its readers")]
struct RecoveryRow {
    rate_per_s: f64,
    status: Status,
    source: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ThreeCompartmentRow {
    class: String,
    fatigue_per_s: f64,
    recovery_per_s: f64,
    rest_multiplier: f64,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    rest_multiplier_status: Status,
    reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct EnduranceRow {
    name: String,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    class: String,
    power: Option<PowerRow>,
    exponential: Option<ExponentialRow>,
    shifted_power: Option<ShiftedRow>,
    inverse_polynomial: Option<PolynomialRow>,
    huijgens: Option<ShiftedRow>,
    consumed_endurance: Option<ConsumedRow>,
    ma: Option<MaRow>,
    reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PowerRow {
    b0_s: f64,
    b1: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ExponentialRow {
    a_s: f64,
    k: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ShiftedRow {
    a_s: f64,
    f0: f64,
    p: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PolynomialRow {
    c_s: [f64; 4],
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ConsumedRow {
    a_s: f64,
    p: f64,
    c_s: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MaRow {
    m_min: f64,
}

impl EnduranceRow {
    fn form(&self) -> Option<EnduranceForm> {
        let power = self.power.as_ref().map(|r| EnduranceForm::Power { b0: r.b0_s, b1: r.b1 });
        let exponential = self.exponential.as_ref().map(|r| EnduranceForm::Exponential { a: r.a_s, k: r.k });
        let shifted = self.shifted_power.as_ref().map(|r| EnduranceForm::ShiftedPower { a: r.a_s, f0: r.f0, p: r.p });
        let polynomial = self.inverse_polynomial.as_ref().map(|r| EnduranceForm::InversePolynomial { c: r.c_s });
        let huijgens = self.huijgens.as_ref().map(|r| EnduranceForm::Huijgens { a: r.a_s, f0: r.f0, p: r.p });
        let consumed =
            self.consumed_endurance.as_ref().map(|r| EnduranceForm::ConsumedEndurance { a: r.a_s, p: r.p, c: r.c_s });
        let ma = self.ma.as_ref().map(|r| EnduranceForm::Ma { m: r.m_min });
        power.or(exponential).or(shifted).or(polynomial).or(huijgens).or(consumed).or(ma)
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AnthropometryFile {
    #[expect(dead_code, reason = "stands in the file for its readers")]
    reference: Reference,
    pub(super) segment: Vec<AnthropometryRow>,
    #[expect(dead_code, reason = "stands in the file for its readers; adult.toml quotes what it uses")]
    proportions: toml::Table,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AnthropometryRow {
    pub(super) id: String,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    meaning: String,
    male: Shares,
    female: Shares,
}

impl AnthropometryRow {
    pub(super) fn of(&self, sex: Sex) -> &Shares {
        if sex == Sex::Male { &self.male } else { &self.female }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Shares {
    pub(super) mass: f64,
    pub(super) length: f64,
    pub(super) com: f64,
    pub(super) r_ap: f64,
    pub(super) r_ml: f64,
    pub(super) r_long: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AdultFile {
    pub(super) segment: Vec<SegmentRow>,
    pub(super) coordinate: Vec<CoordinateRow>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SegmentRow {
    pub(super) name: String,
    pub(super) parent: Option<String>,
    pub(super) anthropometry: Option<String>,
    pub(super) length_of: Option<String>,
    pub(super) along: Along,
    pub(super) joint: String,
    #[serde(default)]
    pub(super) at_parent: f64,
    #[serde(default)]
    pub(super) at_lengths: BTreeMap<String, f64>,
    #[serde(default)]
    pub(super) at_stature: [f64; 3],
    #[serde(default)]
    pub(super) proximal_at_stature: [f64; 3],
    #[serde(default)]
    pub(super) mirrored: bool,
    pub(super) right_arm: Option<InRightArm>,
    #[serde(default)]
    pub(super) motions: Vec<MotionRow>,
    pub(super) patch: Option<PatchRow>,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PatchRow {
    pub(super) at_stature: Vec<[f64; 3]>,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    reference: Reference,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Along {
    Up,
    Down,
    Forward,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum InRightArm {
    Fixed,
    Moving,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MotionRow {
    #[serde(default)]
    pub(super) slide: bool,
    pub(super) axis: [f64; 3],
    pub(super) coordinate: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CoordinateRow {
    pub(super) name: String,
    pub(super) positive: String,
    /// The left side has one, too.
    #[serde(default)]
    pub(super) mirrored: bool,
    pub(super) range_deg: Option<[f64; 2]>,
    pub(super) range_m: Option<[f64; 2]>,
    pub(super) range_reference: Reference,
    pub(super) default: Option<DefaultRow>,
    pub(super) passive: Option<PassiveUse>,
    pub(super) strength: Option<StrengthUse>,
    pub(super) fatigue: Option<String>,
    pub(super) region: String,
}

/// A default distance: a share of stature and lengths of segments.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DefaultRow {
    pub(super) stature: f64,
    pub(super) lengths: BTreeMap<String, f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PassiveUse {
    pub(super) curve: String,
    pub(super) female_curve: Option<String>,
    pub(super) sign: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StrengthUse {
    pub(super) positive: String,
    pub(super) negative: String,
    pub(super) sign: f64,
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
        for coordinate in &library.adult.coordinate {
            let Some(class) = &coordinate.fatigue else { continue };
            assert!(library.three_compartment(class).is_some(), "no class {class}");
            assert!(library.endurance(&library.default_endurance(class)).is_some(), "no curve for {class}");
        }
    }
}
