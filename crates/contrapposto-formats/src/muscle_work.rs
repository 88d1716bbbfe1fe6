//! Writes how hard single muscles worked, for `assess.json` and `summary.json`.

use std::collections::BTreeMap;

use contrapposto::model::{Model, Side};
use serde::Serialize;

/// The muscles of a job; entries of the file that holds them.
#[derive(Clone, Debug, Serialize)]
pub struct MuscleWorkText {
    /// By name.
    pub muscles: BTreeMap<String, WorkedMuscleText>,
    /// The greatest torque that the muscles could not give; `null`: they gave all.
    pub muscles_lack: Option<LackText>,
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

impl WorksForText {
    /// The group of one side of a coordinate.
    pub fn new(model: &Model, coordinate: usize, side: Side) -> Self {
        let coordinate = &model.coordinates()[coordinate];
        let group = coordinate.groups.as_ref().map(|groups| groups[side.index()].name.clone());
        Self { group: group.unwrap_or_default(), coordinate: coordinate.name.clone(), side: side.word() }
    }
}
