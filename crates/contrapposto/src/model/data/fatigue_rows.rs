//! Reads `data/fatigue.toml`: the parameters of the fatigue laws.

use serde::Deserialize;

use super::reference::{Reference, Status};
use crate::fatigue::EnduranceForm;
use crate::model::adult_size::Sex;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FatigueFile {
    pub(super) recovery: RecoveryRow,
    pub(super) three_compartment: Vec<ThreeCompartmentRow>,
    pub(super) joint_use: Vec<JointUseRow>,
    pub(super) muscle_group_set: MuscleGroupSetRow,
    pub(super) muscle_group: Vec<MuscleGroupRow>,
    pub(super) muscle_group_use: Vec<MuscleGroupUseRow>,
    pub(super) endurance: Vec<EnduranceRow>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "status and source stand in the file for its readers")]
pub(super) struct RecoveryRow {
    pub(super) rate_per_s: f64,
    pub(super) status: Status,
    pub(super) source: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ThreeCompartmentRow {
    pub(super) class: String,
    pub(super) fatigue_per_s: f64,
    pub(super) recovery_per_s: f64,
    pub(super) rest_multiplier: f64,
    pub(super) rest_multiplier_status: Status,
    pub(super) reference: Reference,
}

/// The class of some movements.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JointUseRow {
    pub(super) class: String,
    pub(super) movements: Vec<String>,
    pub(super) reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MuscleGroupSetRow {
    pub(super) rest_multiplier: f64,
    pub(super) rest_multiplier_status: Status,
    pub(super) rest_multiplier_source: String,
    pub(super) reference: Reference,
}

/// Parameters of a functional muscle group; `rest_multiplier` where the source gives one.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MuscleGroupRow {
    pub(super) group: String,
    pub(super) sex: SexOfRow,
    pub(super) fatigue_per_s: f64,
    pub(super) recovery_per_s: f64,
    pub(super) rest_multiplier: Option<f64>,
}

/// Sex of the people that a row was fitted to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SexOfRow {
    Female,
    Male,
    Any,
}

impl SexOfRow {
    pub(super) fn of(sex: Option<Sex>) -> Self {
        match sex {
            Some(Sex::Female) => Self::Female,
            Some(Sex::Male) => Self::Male,
            None => Self::Any,
        }
    }

    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Female => "female",
            Self::Male => "male",
            Self::Any => "any sex",
        }
    }
}

/// The functional muscle group of some movements.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MuscleGroupUseRow {
    pub(super) group: String,
    pub(super) movements: Vec<String>,
    pub(super) reference: Reference,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EnduranceRow {
    pub(super) name: String,
    #[expect(dead_code, reason = "stands in the file for its readers")]
    pub(super) class: String,
    power: Option<PowerRow>,
    exponential: Option<ExponentialRow>,
    shifted_power: Option<ShiftedRow>,
    inverse_polynomial: Option<PolynomialRow>,
    huijgens: Option<ShiftedRow>,
    consumed_endurance: Option<ConsumedRow>,
    ma: Option<MaRow>,
    pub(super) reference: Reference,
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
    pub(super) fn form(&self) -> Option<EnduranceForm> {
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
