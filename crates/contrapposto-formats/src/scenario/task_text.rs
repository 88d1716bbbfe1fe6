//! Tasks, supports and the solver's options as a scenario file writes them: flat tables, so that every complaint has its place.

use std::collections::BTreeMap;

use contrapposto::posture_solver::Options;
use schemars::JsonSchema;
use serde::Deserialize;

use super::text::{numbers, rows};

/// A segment that carries weight: it stays where it is at the start, above all tasks.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportText {
    /// Which segment.
    pub segment: String,
    /// What it stands on.
    #[serde(default)]
    pub on: OnText,
    /// Coefficient of friction, 0 to 10; 0.6 when left out. Has no part in a pose.
    pub friction: Option<f64>,
    /// Greatest share of body weight that it should carry, 0 to 1: "rest this leg". Has no part in a pose.
    pub share_max: Option<f64>,
    /// Corners of the patch that touches, in the segment's frame, m; that of the model when left out (sole, palm, seat of the
    /// built-in adult). Has no part in a pose.
    #[serde(default, deserialize_with = "rows")]
    pub corners_m: Option<Vec<[f64; 3]>>,
}

/// What a support stands on: `"ground"`, or a plane.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum OnText {
    /// By name.
    Named(GroundText),
    /// A plane.
    Plane(PlaneText),
}

impl Default for OnText {
    fn default() -> Self {
        Self::Named(GroundText::Ground)
    }
}

/// A plane with a name.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GroundText {
    /// Horizontal, where the support is at the start.
    Ground,
}

/// Seat, table, wall.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneText {
    /// The direction in which it pushes, ground axes; its length does not matter.
    pub normal: [f64; 3],
    /// A point of it, ground, m: checked against where the support is at the start.
    pub point_m: Option<[f64; 3]>,
}

/// Something the body should do; the first task is the most important.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TaskText {
    /// Decides which of the other keys the task takes.
    pub kind: TaskKindText,
    /// As important as the task before; else the task yields to all before it.
    #[serde(default)]
    pub same_priority: bool,
    /// Ranks above the relief of tired muscles (`simulate`). Has no part in a pose.
    #[serde(default)]
    pub above_relief: bool,
    /// point, orientation, placement, look_at (`head` when left out): which segment.
    pub segment: Option<String>,
    /// point, placement: which point, in the segment's frame, m; its origin when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub at_m: Option<[f64; 3]>,
    /// point, placement, look_at, center_of_mass: where, in ground, m.
    #[serde(default, deserialize_with = "numbers")]
    pub target_m: Option<[f64; 3]>,
    /// orientation, placement: the rotation from the segment's frame to ground, quaternion w, x, y, z.
    #[serde(default, deserialize_with = "numbers")]
    pub target_quaternion: Option<[f64; 4]>,
    /// orientation, placement: the same as turns about the ground axes x, then y, then z, deg.
    #[serde(default, deserialize_with = "numbers")]
    pub target_deg: Option<[f64; 3]>,
    /// point, orientation, placement, center_of_mass: `start` keeps what is not said otherwise as it is at the start.
    pub target: Option<TargetText>,
    /// point, center_of_mass at a place: which ground axes are asked for, such as `xy`; `xyz` when left out.
    pub axes: Option<String>,
    /// look_at: where the gaze begins, in the segment's frame, m; its centre of mass when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub eye_m: Option<[f64; 3]>,
    /// look_at: the gaze in the segment's frame; its x axis when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub direction: Option<[f64; 3]>,
    /// distance: one point.
    pub a: Option<PointText>,
    /// distance: the other point.
    pub b: Option<PointText>,
    /// distance: least and greatest, m.
    #[serde(default, deserialize_with = "numbers")]
    pub range_m: Option<[f64; 2]>,
    /// distance: exactly this, m.
    pub distance_m: Option<f64>,
    /// center_of_mass over a polygon: corners in the horizontal plane, m, such as `[[x, z], ...]` where y is up; the joints of
    /// the supports when left out.
    #[serde(default, deserialize_with = "rows")]
    pub polygon_m: Option<Vec<[f64; 2]>>,
    /// center_of_mass over a polygon: how far inside of its edges, m; 0 when left out.
    pub margin_m: Option<f64>,
    /// posture, effort: only these; all (effort: all with known strength) when left out.
    pub coordinates: Option<Vec<String>>,
    /// posture: weights by coordinate; 1 when left out.
    pub weights: Option<BTreeMap<String, f64>>,
    /// posture: wanted values, keys as in `[posture]`; as at the start when left out.
    pub values: Option<BTreeMap<String, f64>>,
}

/// Kind of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TaskKindText {
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
    /// As in the file.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Orientation => "orientation",
            Self::Placement => "placement",
            Self::LookAt => "look_at",
            Self::Distance => "distance",
            Self::CenterOfMass => "center_of_mass",
            Self::Posture => "posture",
            Self::Effort => "effort",
        }
    }

    /// The keys it takes besides those that all take.
    pub(super) fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Point => &["segment", "at_m", "target_m", "target", "axes"],
            Self::Orientation => &["segment", "target_quaternion", "target_deg", "target"],
            Self::Placement => &["segment", "at_m", "target_m", "target_quaternion", "target_deg", "target"],
            Self::LookAt => &["segment", "target_m", "eye_m", "direction"],
            Self::Distance => &["a", "b", "range_m", "distance_m"],
            Self::CenterOfMass => &["target_m", "target", "axes", "polygon_m", "margin_m"],
            Self::Posture => &["coordinates", "weights", "values"],
            Self::Effort => &["coordinates"],
        }
    }
}

impl TaskText {
    /// Keys that are given, those aside that all kinds take.
    pub(super) fn given(&self) -> impl Iterator<Item = &'static str> {
        [
            ("segment", self.segment.is_some()),
            ("at_m", self.at_m.is_some()),
            ("target_m", self.target_m.is_some()),
            ("target_quaternion", self.target_quaternion.is_some()),
            ("target_deg", self.target_deg.is_some()),
            ("target", self.target.is_some()),
            ("axes", self.axes.is_some()),
            ("eye_m", self.eye_m.is_some()),
            ("direction", self.direction.is_some()),
            ("a", self.a.is_some()),
            ("b", self.b.is_some()),
            ("range_m", self.range_m.is_some()),
            ("distance_m", self.distance_m.is_some()),
            ("polygon_m", self.polygon_m.is_some()),
            ("margin_m", self.margin_m.is_some()),
            ("coordinates", self.coordinates.is_some()),
            ("weights", self.weights.is_some()),
            ("values", self.values.is_some()),
        ]
        .into_iter()
        .filter_map(|(key, given)| given.then_some(key))
    }
}

/// A target in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TargetText {
    /// As it is at the start.
    Start,
}

/// A point of a segment.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointText {
    /// Which segment.
    pub segment: String,
    /// Which point, in the segment's frame, m; its origin when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub at_m: Option<[f64; 3]>,
}

/// How a pose is solved.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SolverText {
    /// Largest change of an angle in one step, deg, 180 at most; a slide moves as many metres as this is radians.
    pub max_step_deg: f64,
    /// Largest number of steps, 100000 at most.
    pub max_steps: u32,
    /// Steps end when no coordinate would change by more, rad or m.
    pub still: f64,
    /// A task counts as reached when what is left of it is at most this, in its unit (m, rad, share of strength).
    pub reached: f64,
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
