//! Holds tasks, supports and the solver's options as a scenario file writes them: flat tables, so that every error has its place.

use std::collections::BTreeMap;

use contrapposto::posture_solver::Options;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::toml_file::{numbers, rows};

/// A segment that carries weight: it stays where it is at the start, above all tasks.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SupportText {
    /// The segment that carries weight.
    pub(crate) segment: String,
    /// The surface that it stands on. When left out: the floor for feet of the built-in adult and with `step_m`, else `ground`.
    pub(crate) on: Option<OnText>,
    /// Height above the floor of a step under it, m, 0 to 2; 0 when left out.
    pub(crate) step_m: Option<f64>,
    /// Coefficient of friction, 0 to 10; 0.6 when left out. Has no part in a pose.
    pub(crate) friction: Option<f64>,
    /// Greatest share of body weight that it should carry, 0 to 1: "rest this leg". Has no part in a pose.
    pub(crate) share_max: Option<f64>,
    /// Corners of the patch that touches, in the segment's frame, m; that of the model when left out (sole, palm, seat of the
    /// built-in adult). Has no part in a pose.
    #[serde(default, deserialize_with = "rows")]
    pub(crate) corners_m: Option<Vec<[f64; 3]>>,
    /// Whether the patch may be put elsewhere on its plane: `"start"` (the default): it stays where it is at the start; `"free"`: the
    /// program chooses place and turn, a foot beside the other one without crossing it; or a region.
    #[serde(default)]
    pub(crate) place: PlaceText,
    /// Of a foot of the built-in adult: `"down"` (the default): the whole sole lies on the surface; `"free"`: the toes and the ball of
    /// the foot lie on it and carry the weight, and the heel rises as the posture asks.
    #[serde(default)]
    pub(crate) heel: HeelText,
}

/// The heel of a foot that carries weight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum HeelText {
    /// On the surface.
    #[default]
    Down,
    /// On the surface or above it; the ball of the foot carries the weight.
    Free,
}

/// Place of a support, or a region for it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "place is \"start\", \"free\", or { corners_m = [[x, y, z], ...], turn_deg = [-10, 40] }"
)]
pub(crate) enum PlaceText {
    /// In a word.
    Named(NamedPlaceText),
    /// Within limits of the file.
    Region(RegionText),
}

impl Default for PlaceText {
    fn default() -> Self {
        Self::Named(NamedPlaceText::Start)
    }
}

/// A place in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum NamedPlaceText {
    /// The place at the start.
    Start,
    /// On its plane, where least effort puts it.
    Free,
}

/// The region of a free support.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct RegionText {
    /// Corners of the region of the patch's middle, ground, m, three or more; seen along the normal of the plane.
    #[serde(deserialize_with = "rows")]
    pub(crate) corners_m: Option<Vec<[f64; 3]>>,
    /// Least and greatest turn about the normal from the start, deg, -90 to 0 and 0 to 90.
    #[serde(deserialize_with = "numbers")]
    pub(crate) turn_deg: Option<[f64; 2]>,
}

/// The surface under a support: `"floor"`, `"ground"`, or a plane.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum OnText {
    /// By name.
    Named(GroundText),
    /// A plane.
    Plane(PlaneText),
}

/// A plane with a name.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum GroundText {
    /// Horizontal, at y = 0, or at the height of a step on it.
    Floor,
    /// Horizontal, where the middle of the patch is at the start.
    Ground,
}

/// Seat, table, wall.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlaneText {
    /// The direction in which it pushes, ground axes; its length does not matter.
    pub(crate) normal: [f64; 3],
    /// A point of it, ground, m; the middle of the patch at the start when left out.
    pub(crate) point_m: Option<[f64; 3]>,
}

/// Something the body should do; the first task is the most important.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TaskText {
    /// Decides which of the other keys the task takes.
    pub(crate) kind: TaskKindText,
    /// As important as the task before; else the task yields to all before it.
    #[serde(default)]
    pub(crate) same_priority: bool,
    /// Ranks above the relief of tired muscles (`simulate`). Has no part in a pose.
    #[serde(default)]
    pub(crate) above_relief: bool,
    /// point, orientation, placement, look_at (`head` when left out): which segment.
    pub(crate) segment: Option<String>,
    /// point, placement: which point, in the segment's frame, m; its origin when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) at_m: Option<[f64; 3]>,
    /// point, placement, look_at, center_of_mass: where, in ground, m.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) target_m: Option<[f64; 3]>,
    /// orientation, placement: the rotation from the segment's frame to ground, quaternion w, x, y, z.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) target_quaternion: Option<[f64; 4]>,
    /// orientation, placement: the same as turns about the ground axes x, then y, then z, deg.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) target_deg: Option<[f64; 3]>,
    /// point, orientation, placement, center_of_mass: `start` keeps what is not said otherwise as it is at the start.
    pub(crate) target: Option<TargetText>,
    /// point, center_of_mass at a place: which ground axes are asked for, such as `xy`; `xyz` when left out.
    pub(crate) axes: Option<String>,
    /// look_at: a direction in ground along which the segment's direction should point, instead of a place; its length does not matter.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) target_direction: Option<[f64; 3]>,
    /// look_at: where the gaze begins, in the segment's frame, m; its centre of mass when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) eye_m: Option<[f64; 3]>,
    /// look_at: the gaze in the segment's frame; its x axis when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) direction: Option<[f64; 3]>,
    /// distance: one point.
    pub(crate) a: Option<PointText>,
    /// distance: the other point.
    pub(crate) b: Option<PointText>,
    /// distance: least and greatest, m.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) range_m: Option<[f64; 2]>,
    /// distance: exactly this, m.
    pub(crate) distance_m: Option<f64>,
    /// center_of_mass over a polygon: corners in the horizontal plane, m, such as `[[x, z], ...]` where y is up; the patches of
    /// the supports when left out.
    #[serde(default, deserialize_with = "rows")]
    pub(crate) polygon_m: Option<Vec<[f64; 2]>>,
    /// center_of_mass over a polygon: how far inside of its edges, m; 0 when left out.
    pub(crate) margin_m: Option<f64>,
    /// posture, effort: only these; all (effort: all with known strength) when left out.
    pub(crate) coordinates: Option<Vec<String>>,
    /// posture: weights by coordinate; 1 when left out.
    pub(crate) weights: Option<BTreeMap<String, f64>>,
    /// posture: wanted values, keys as in `[posture]`; as at the start when left out.
    pub(crate) values: Option<BTreeMap<String, f64>>,
}

/// Kind of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum TaskKindText {
    /// A point of a segment at a place.
    Point,
    /// A segment turned as wanted.
    Orientation,
    /// Both.
    Placement,
    /// A segment looks at a place.
    LookAt,
    /// Two points as far apart as wanted.
    Distance,
    /// The centre of mass at a place, or over the support polygon.
    CenterOfMass,
    /// Coordinates at wanted values.
    Posture,
    /// Little active torque for the strength there is.
    Effort,
}

impl TaskKindText {
    /// The kind as the file writes it, and the keys it takes besides [`COMMON_KEYS`].
    pub(super) fn word_and_keys(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Self::Point => ("point", &["segment", "at_m", "target_m", "target", "axes"]),
            Self::Orientation => ("orientation", &["segment", "target_quaternion", "target_deg", "target"]),
            Self::Placement => {
                ("placement", &["segment", "at_m", "target_m", "target_quaternion", "target_deg", "target"])
            }
            Self::LookAt => ("look_at", &["segment", "target_m", "target_direction", "eye_m", "direction"]),
            Self::Distance => ("distance", &["a", "b", "range_m", "distance_m"]),
            Self::CenterOfMass => ("center_of_mass", &["target_m", "target", "axes", "polygon_m", "margin_m"]),
            Self::Posture => ("posture", &["coordinates", "weights", "values"]),
            Self::Effort => ("effort", &["coordinates"]),
        }
    }
}

/// Keys that tasks of all kinds take.
pub(super) const COMMON_KEYS: [&str; 3] = ["kind", "same_priority", "above_relief"];

/// A target in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum TargetText {
    /// As it is at the start.
    Start,
}

/// A point of a segment.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PointText {
    /// The segment of the point.
    pub(crate) segment: String,
    /// The point in the segment's frame, m; the frame's origin when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) at_m: Option<[f64; 3]>,
}

/// Settings of the solver of a pose.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SolverText {
    /// Largest change of an angle in one step, deg, 180 at most; a slide moves as many metres as this is radians.
    pub(crate) max_step_deg: f64,
    /// Largest number of steps, 100000 at most.
    pub(crate) max_steps: u32,
    /// Steps end when no coordinate would change by more, rad or m.
    pub(crate) still: f64,
    /// A task counts as reached when what is left of it is at most this, in its unit (m, rad, share of strength).
    pub(crate) reached: f64,
}

impl Default for SolverText {
    fn default() -> Self {
        let options = Options::inverse_kinematics();
        Self {
            max_step_deg: options.max_step.to_degrees(),
            max_steps: options.max_steps.try_into().unwrap_or(u32::MAX),
            still: options.step_tolerance,
            reached: options.level_tolerance,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn every_key_of_a_task_belongs_to_a_kind_and_every_kind_is_read_by_its_word() {
        let schema = schemars::schema_for!(TaskText).to_value();
        let mut known: Vec<&str> = schema["properties"].as_object().unwrap().keys().map(String::as_str).collect();
        known.sort_unstable();
        let mut taken = COMMON_KEYS.to_vec();
        for kind in schema["$defs"]["TaskKindText"]["oneOf"].as_array().unwrap() {
            let word = kind["const"].as_str().unwrap();
            let kind: TaskKindText = toml::Value::String(word.to_owned()).try_into().unwrap();
            assert_eq!(kind.word_and_keys().0, word);
            taken.extend(kind.word_and_keys().1);
        }
        taken.sort_unstable();
        taken.dedup();
        assert_eq!(taken, known);
    }
}
