//! Holds a place where a run may put a hand, as a scenario file writes it.

use contrapposto::model::LARGEST;
use schemars::JsonSchema;
use serde::Deserialize;

use super::task_text::{HeelText, OnText, PlaceText, PlaneText, SupportText};
use crate::input_error::InputError;
use crate::toml_file::{Located, rows, shown};

/// A place where `simulate` may put a part of the body when a muscle group is tired; nothing lies there at the start.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RestText {
    /// The segment that may rest there.
    pub(crate) segment: String,
    /// The plane: normal, and a point of it.
    pub(crate) on: PlaneText,
    /// Corners of the region in which the middle of the patch is put, ground, m, three or more; seen along the normal of the plane.
    #[serde(deserialize_with = "corners")]
    pub(crate) region_m: Vec<[f64; 3]>,
    /// Coefficient of friction, 0 to 10; 0.6 when left out.
    pub(crate) friction: Option<f64>,
    /// Greatest share of body weight that it should carry, 0 to 1.
    pub(crate) share_max: Option<f64>,
    /// Corners of the patch that touches, in the segment's frame, m; that of the model when left out.
    #[serde(default, deserialize_with = "rows")]
    pub(crate) corners_m: Option<Vec<[f64; 3]>>,
}

fn corners<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec<[f64; 3]>, D::Error> {
    Ok(rows(deserializer)?.unwrap_or_default())
}

impl RestText {
    /// The same as a support, but for its region.
    pub(super) fn as_support(&self) -> SupportText {
        SupportText {
            segment: self.segment.clone(),
            on: Some(OnText::Plane(self.on)),
            step_m: None,
            friction: self.friction,
            share_max: self.share_max,
            corners_m: self.corners_m.clone(),
            place: PlaceText::default(),
            heel: HeelText::default(),
        }
    }

    /// Refuses a region without the numbers that it needs; `path` is the table of the file.
    pub(super) fn check(&self, at: &Located, path: &[&str]) -> Result<(), InputError> {
        let error = |key: &str, message: String| {
            let path: Vec<&str> = path.iter().copied().chain([key]).collect();
            Err(at.error(&path, message, None))
        };
        if self.region_m.len() < 3 {
            let message = format!("region_m has {} corners; a region has three or more", self.region_m.len());
            return error("region_m", message);
        }
        match self.region_m.iter().flatten().find(|value| value.is_nan() || value.abs() > LARGEST) {
            Some(value) => error("region_m", format!("a corner of the region is at {} m; 1e9 at most", shown(*value))),
            None => Ok(()),
        }
    }
}
