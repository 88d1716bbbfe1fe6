//! The name of a muscle group in JSON files and terminal tables.

use contrapposto::model::{Model, Side};
use serde::Serialize;

/// A muscle group: its movement, its coordinate, and the sign of its torque.
#[derive(Serialize)]
pub(crate) struct GroupName {
    pub(crate) group: String,
    pub(crate) coordinate: String,
    /// `positive` or `negative`: the sign of its torque.
    side: &'static str,
}

impl GroupName {
    pub(crate) fn new(model: &Model, coordinate: usize, side: Side) -> Self {
        let coordinate = &model.coordinates()[coordinate];
        let group = coordinate.groups.as_ref().map(|groups| groups[side.index()].name.clone());
        Self { group: group.unwrap_or_default(), coordinate: coordinate.name.clone(), side: side.word() }
    }
}

impl std::fmt::Display for GroupName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({})", self.group, self.coordinate)
    }
}
