//! Writes how hard single muscles worked, for `assess.json` and `summary.json`.

use std::collections::BTreeMap;

use contrapposto::model::{Model, Side};
use serde::Serialize;

use crate::ReactionText;

/// Activations below this are said as none.
pub const LEAST_ACTIVATION_SAID: f64 = 0.005;

/// The muscles of a job; entries of the file that holds them.
#[derive(Clone, Debug, Serialize)]
pub struct MuscleWorkText {
    /// By name.
    pub muscles: BTreeMap<String, WorkedMuscleText>,
    /// The greatest torque that the muscles could not give; `null`: they gave all.
    pub muscles_lack: Option<LackText>,
    /// By joint that muscles cross; left out where the loads are not known.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub reactions: BTreeMap<String, PeakReactionText>,
    /// Of muscles that tire one by one: when they can no longer give all torques.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub muscles_fail: Option<MusclesFailText>,
}

/// Force and moment of a joint at the time of its greatest compression.
#[derive(Clone, Debug, Serialize)]
pub struct PeakReactionText {
    /// The time, s.
    pub at_s: f64,
    /// Force and moment.
    #[serde(flatten)]
    pub reaction: ReactionText,
}

/// Times at which muscles can no longer give all torques, s; `null`: not within a day with the last posture held on.
#[derive(Clone, Debug, Serialize)]
pub struct MusclesFailText {
    /// Of a person whose strength is a standard deviation below the mean.
    pub weaker_s: Option<f64>,
    /// Of one of mean strength.
    pub mean_s: Option<f64>,
    /// Of one whose strength is a standard deviation above the mean.
    pub stronger_s: Option<f64>,
    /// The group with the largest share in the limit of the mean person.
    pub who: Option<WorksForText>,
}

/// Fatigue of a muscle that tires by itself.
#[derive(Clone, Debug, Serialize)]
pub struct TiredMuscleText {
    /// Share that is fatigued at the end, 0 to 1.
    pub fatigued_end: f64,
    /// First time at which the muscle gave all that fatigue had left it, s; `null`: never.
    pub exhausted_s: Option<f64>,
}

/// A muscle at its greatest activation.
#[derive(Clone, Debug, Serialize)]
pub struct WorkedMuscleText {
    /// Greatest activation, 0 to 1.
    pub peak_activation: f64,
    /// Time of it, s.
    pub at_s: f64,
    /// Tension there, that of passive fibres included, N.
    pub force_n: f64,
    /// The group that the muscle works for; `null` of one that turns no joint.
    pub works_for: Option<WorksForText>,
    /// Fatigue of a muscle that tires by itself.
    #[serde(flatten)]
    pub tired: Option<TiredMuscleText>,
}

/// A muscle group.
#[derive(Clone, Debug, Serialize)]
pub struct WorksForText {
    /// Movement of the group.
    pub group: String,
    /// Coordinate of the group.
    pub coordinate: String,
    /// `positive` or `negative`: the sign of its torque.
    pub side: &'static str,
}

/// A torque that muscles lack.
#[derive(Clone, Debug, Serialize)]
pub struct LackText {
    /// Coordinate of the torque.
    pub coordinate: String,
    /// Size of it, N m.
    pub torque_nm: f64,
    /// Time of it, s.
    pub at_s: f64,
}

impl MuscleWorkText {
    /// The muscles with the greatest activations, at most `most` of them, without those at rest.
    pub fn hardest(&self, most: usize) -> Vec<(&str, &WorkedMuscleText)> {
        let working = self.muscles.iter().filter(|(_, muscle)| muscle.peak_activation >= LEAST_ACTIVATION_SAID);
        let mut all: Vec<_> = working.map(|(name, muscle)| (name.as_str(), muscle)).collect();
        all.sort_by(|a, b| b.1.peak_activation.total_cmp(&a.1.peak_activation));
        all.truncate(most);
        all
    }
}

impl WorksForText {
    /// The group of one side of a coordinate.
    pub fn new(model: &Model, coordinate: usize, side: Side) -> Self {
        let coordinate = &model.coordinates()[coordinate];
        let group = coordinate.groups.as_ref().map(|groups| groups[side.index()].name.clone());
        Self { group: group.unwrap_or_default(), coordinate: coordinate.name.clone(), side: side.word() }
    }
}
