//! The name of a muscle group in JSON files and terminal tables.

use contrapposto::model::{Model, Side, plain_group_name};
use contrapposto_formats::tissue::FatigueParametersText;
use serde::Serialize;

/// A muscle group: its movement, its coordinate, and the sign of its torque.
#[derive(Serialize)]
pub(crate) struct GroupName {
    pub(crate) group: String,
    pub(crate) coordinate: String,
    /// `positive` or `negative`: the sign of its torque.
    side: &'static str,
    /// The parameters of its fatigue law.
    #[serde(skip_serializing_if = "Option::is_none")]
    fatigue: Option<FatigueParametersText>,
}

impl GroupName {
    pub(crate) fn new(model: &Model, coordinate: usize, side: Side) -> Self {
        let coordinate = &model.coordinates()[coordinate];
        let group = coordinate.groups.as_ref().map(|groups| &groups[side.index()]);
        Self {
            group: group.map(|group| group.name.clone()).unwrap_or_default(),
            coordinate: coordinate.name.clone(),
            side: side.word(),
            fatigue: group.map(FatigueParametersText::new),
        }
    }
}

impl std::fmt::Display for GroupName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({})", plain_group_name(&self.group, &self.coordinate), self.coordinate)
    }
}
