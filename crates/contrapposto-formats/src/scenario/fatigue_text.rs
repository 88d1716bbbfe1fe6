//! Holds the fatigue law and its parameters as the scenario file writes them.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

/// Law of fatigue of muscle groups.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct FatigueText {
    /// `three_compartment` (3CC-r) or `endurance`.
    pub(crate) law: LawText,
    /// Parameters of `three_compartment`: `joint` (Frey-Law et al. 2012) or `muscle_group` (Rakshit et al. 2021); `joint` when left
    /// out.
    pub(crate) parameters: Option<ParametersText>,
    /// Sex whose parameters `muscle_group` takes: `female`, `male` or `any`; that of the body when left out.
    pub(crate) sex: Option<FatigueSexText>,
    /// Endurance curve of every group, by name; each joint's own of Frey-Law & Avin 2010 when left out.
    pub(crate) curve: Option<String>,
    /// The things that tire: `muscle`, each muscle of the model on its own, or `joint`, the groups of each joint; `muscle` when left out where the model's muscles
    /// give strength and the law is 3CC-r.
    pub(crate) by: Option<TiresText>,
    /// Fatigue at which a group asks for relief, above 0, at most 1.
    pub(crate) critical_level: f64,
    /// Fatigue below which it no longer does.
    pub(crate) recovery_level: f64,
    /// Fatigue at the start, 0 rested to 1 exhausted; rested when left out.
    pub(crate) start: BTreeMap<String, StartText>,
}

impl Default for FatigueText {
    fn default() -> Self {
        let start = BTreeMap::new();
        let law = LawText::ThreeCompartment;
        Self {
            law,
            parameters: None,
            sex: None,
            curve: None,
            by: None,
            critical_level: 0.6,
            recovery_level: 0.3,
            start,
        }
    }
}

/// Fatigue law.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum LawText {
    /// Three-compartment controller with rest recovery.
    ThreeCompartment,
    /// Integral of time over endurance time.
    Endurance,
}

/// The things that tire.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum TiresText {
    /// Each muscle on its own; the others take over.
    Muscle,
    /// The two muscle groups of each coordinate.
    Joint,
}

/// Published parameters of the three-compartment controller.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ParametersText {
    /// One fit a joint.
    Joint,
    /// One fit a functional muscle group and sex; movements without a group keep the fit of their joint.
    MuscleGroup,
}

/// Sex whose parameters are taken.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FatigueSexText {
    /// Women's.
    Female,
    /// Men's.
    Male,
    /// Both together.
    Any,
}

/// Fatigue of the two groups of a coordinate at the start.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct StartText {
    /// Group that pulls toward larger values.
    pub(crate) positive: f64,
    /// Group that pulls toward smaller values.
    pub(crate) negative: f64,
}
