//! Reads `data/passive.toml`: the passive curves of the joints.

use serde::Deserialize;

use super::reference::{Reference, Status};
use crate::passive::{
    CoupledTerm, DoubleExponential, End, Form, PassiveCurve, PassiveError, Reshape, RienerEdrich1999,
};

/// One row of `data/passive.toml`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurveRow {
    /// Name of the curve.
    pub name: String,
    /// The positive direction in clinical words.
    pub positive: String,
    /// The range it is meant for, deg.
    pub range_deg: [f64; 2],
    /// Mass of the body that has this torque, kg; that of the whole file when left out.
    pub(super) mass_kg: Option<f64>,
    double_exponential: Option<DoubleExponentialRow>,
    riener_edrich1999: Option<RienerEdrichRow>,
    /// Source of the curve.
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

    /// The same curve with `times` the torque at every angle.
    pub(super) fn scaled(&self, times: f64) -> Self {
        let mut row = self.clone();
        if let Some(law) = &mut row.double_exponential {
            law.lower.torque_nm *= times;
            law.upper.torque_nm *= times;
            law.stiffness_nm_per_rad *= times;
        }
        if let Some(law) = &mut row.riener_edrich1999 {
            for [_, c0, ..] in &mut law.terms {
                *c0 += libm::log(times);
            }
            law.constant_nm *= times;
        }
        row
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
pub(crate) struct PassiveFile {
    pub(super) reshape: ReshapeRow,
    pub(super) scale: ScaleRow,
    pub(super) curve: Vec<CurveRow>,
}

/// Law by which torque follows the size of the body.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ScaleRow {
    /// Mass of the body whose torque the curves give.
    pub(super) mass_kg: f64,
    /// Of the torque in proportion to body mass.
    #[serde(rename = "reference")]
    _reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ReshapeRow {
    pub(super) zone_deg: f64,
    pub(super) end_torque_nm: f64,
    pub(super) status: Status,
    pub(super) source: String,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct EndRow {
    torque_nm: f64,
    rate_per_rad: f64,
    angle_deg: f64,
}

#[derive(Clone, Debug, Deserialize)]
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

#[derive(Clone, Debug, Deserialize)]
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
