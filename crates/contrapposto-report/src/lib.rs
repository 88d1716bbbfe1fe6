//! Writes a result as a page that opens in any browser: plain numbers in, one `report.html` out, with the body in three dimensions,
//! over time or in a few postures, charts of every joint, and decisions in plain words. The page needs no network, and its content
//! security policy allows none. Parts of the page about which nothing is known are hidden.
//!
//! Inside, a file uses only those above it in this list: `column` (numbers over time, short), `cycles` (mean and spread over cycles), `skin` (its mesh), `muscles` (lines of muscles), `data` (the input of the page's script), `page` (the file), `document` (a page of words, pictures and tables alone). The page's own scripts and style stand in `page/`, plotly.js in `vendor/`.
//!
//! Every function takes any input without panicking: numbers that are not finite count as 0, lists that are too short as if
//! their last number went on. The same input gives the same bytes. Texts may come from strangers: they reach the page as text.

mod column;
mod cycles;
mod data;
mod document;
mod muscles;
mod page;
mod skin;

pub use cycles::{Band, CycleCurves, Cycles};
pub use document::{Document, Picture, write_document};
pub use muscles::{Carrier, PressedJoint};
pub use page::{write, write_with};

/// Everything a page shows. Ground axes: x forward, y up, z to the right; m, s, N, N m, degrees.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Title of the job.
    pub title: String,
    /// Name of the body.
    pub body: String,
    /// The finding in one plain sentence.
    pub headline: String,
    /// The findings behind it.
    pub facts: Vec<Fact>,
    /// Changes and what each of them gives, in its first column the change; may be empty. It has no heading.
    pub changes: Table,
    /// The reasons, a sentence each.
    pub reasons: Vec<String>,
    /// The most important numbers.
    pub figures: Vec<Figure>,
    /// Motors move the body, not muscles.
    pub motors: bool,
    /// Meaning of the frames.
    pub moments: Moments,
    /// Number of the frame to show first.
    pub open: usize,
    /// Segments of the body.
    pub segments: Vec<Segment>,
    /// The skin that is shown in place of the segments; they remain as a choice.
    pub skin: Option<Skin>,
    /// Coordinates of the body that carry a torque.
    pub joints: Vec<Joint>,
    /// Index in `joints` of the joint to show first.
    pub main: usize,
    /// Mean and spread of the joints over the cycles of a motion; `None` of a motion without cycles.
    pub cycles: Option<Cycles>,
    /// Fatigue at which relief begins and ends, 0..=1; `None` without relief.
    pub levels: Option<[f64; 2]>,
    /// Supports of the body; empty if the root is fixed.
    pub supports: Vec<Support>,
    /// Height of the ground, m; with `None` no ground is drawn.
    pub ground: Option<f64>,
    /// Other surfaces that carry the body: a seat, a table, a wall.
    pub surfaces: Vec<Surface>,
    /// Things around the body and in its hands.
    pub things: Vec<Thing>,
    /// Loads on the body besides its weight.
    pub loads: Vec<Push>,
    /// Muscles of the body whose activations are known.
    pub muscles: Option<Muscles>,
    /// Targets of tasks.
    pub targets: Vec<Target>,
    /// The greatest forces at a point in every direction.
    pub solid: Option<ForceSolid>,
    /// Centre of mass in every frame; may be empty.
    pub center_of_mass: Vec<[f64; 3]>,
    /// Texts about single frames.
    pub list: List,
    /// A table about all frames; may be empty.
    pub table: Table,
}

/// Meaning of the frames of a report.
#[derive(Clone, Debug)]
pub enum Moments {
    /// Times of a motion, s, rising; the page has a slider and a button to play.
    Times(Vec<f64>),
    /// Postures to choose between, each with its name.
    Postures(Vec<String>),
}

impl Default for Moments {
    fn default() -> Self {
        Self::Times(vec![])
    }
}

impl Moments {
    /// Number of frames.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Times(times) => times.len(),
            Self::Postures(names) => names.len(),
        }
    }
}

/// A finding with its name.
#[derive(Clone, Debug, Default)]
pub struct Fact {
    /// Name of the finding.
    pub name: String,
    /// The finding, a sentence without a full stop.
    pub text: String,
}

/// An important number.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// Name of the number.
    pub label: String,
    /// The number with its unit.
    pub value: String,
    /// A value to compare with; may be empty.
    pub note: String,
}

/// A ball, in the frame of its segment: centre and radius, m.
pub type Ball = [f64; 4];

/// A solid part of the body: the hull of a few balls.
#[derive(Clone, Debug, Default)]
pub struct Segment {
    /// Name of the segment.
    pub name: String,
    /// At least one.
    pub balls: Vec<Ball>,
    /// Indices in [`Report::joints`] of the coordinates that join the segment to its parent; empty for a root.
    pub joints: Vec<usize>,
    /// Placement in every frame: origin, m, and unit quaternion `w x y z`.
    pub places: Vec<[f64; 7]>,
    /// Placement at the start, drawn as a ghost.
    pub start: [f64; 7],
}

/// A mesh that follows segments.
#[derive(Clone, Debug, Default)]
pub struct Skin {
    /// Vertices in the rest posture, m.
    pub vertices: Vec<[f64; 3]>,
    /// Corners of triangles, counterclockwise seen from outside; those with an index out of range are left out.
    pub triangles: Vec<[u16; 3]>,
    /// Brightness of each vertex, as a share of 255; of vertices without one 255. The page shows by it that cloth is no skin.
    pub light: Vec<u8>,
    /// Bones that move each vertex, as indices in `nodes`; those out of range count as the first one.
    pub bones: Vec<[u8; 4]>,
    /// Weights of these bones, as shares of 255.
    pub weights: Vec<[u8; 4]>,
    /// Bones.
    pub nodes: Vec<Bone>,
    /// Segments that bones follow, with or without a solid of their own.
    pub segments: Vec<Followed>,
}

/// A bone of a skin. Its head is the joint of a segment, and it turns by a part of what that segment turns from another one.
#[derive(Clone, Debug, Default)]
pub struct Bone {
    /// Index in [`Skin::segments`] of the segment from which the turn counts.
    pub from: usize,
    /// Index of the segment; the same for a bone that turns as its segment does.
    pub to: usize,
    /// Axis of twist in the rest posture, a unit vector; zero where only the whole turn counts.
    pub axis: [f64; 3],
    /// Shares of swing and twist.
    pub shares: [f64; 2],
}

/// A segment that bones follow.
#[derive(Clone, Debug, Default)]
pub struct Followed {
    /// Indices in [`Report::joints`] of the coordinates that join the segment to its parent.
    pub joints: Vec<usize>,
    /// Placement in the rest posture: origin, m, and unit quaternion `w x y z`.
    pub rest: [f64; 7],
    /// Placement in every frame.
    pub places: Vec<[f64; 7]>,
    /// Placement at the start.
    pub start: [f64; 7],
}

/// One coordinate over time.
#[derive(Clone, Debug, Default)]
pub struct Joint {
    /// Name of the joint in the model.
    pub name: String,
    /// Name of the joint in words.
    pub label: String,
    /// The positive direction in words; may be empty.
    pub positive: String,
    /// Whether the coordinate is a length: values in m and N, not degrees and N m.
    pub slides: bool,
    /// Whether angle and torques are those about an axis of a joint with three, not those of the coordinate.
    pub about_axis: bool,
    /// The two muscle groups of the joint, positive torque first.
    pub groups: Option<[Group; 2]>,
    /// Value in every frame, degrees (m for slides).
    pub angle: Vec<f64>,
    /// Value of the coordinate itself in every frame, degrees, where `angle` is about an axis; else empty.
    pub coordinate: Vec<f64>,
    /// External torque in every frame.
    pub external: Vec<f64>,
    /// Passive torque in every frame. The active one is minus the sum of both.
    pub passive: Vec<f64>,
    /// |Active torque| over strength in every frame.
    pub load: Vec<f64>,
    /// Whether ligaments carry it in every frame where that is a hazard; empty for never.
    pub hazard: Vec<bool>,
    /// Torques of the joint over its range: one for all frames, one for each, or none.
    pub balance: Vec<Balance>,
}

/// Torques over the range of a joint.
#[derive(Clone, Debug, Default)]
pub struct Balance {
    /// Angles, degrees.
    pub angle: Vec<f64>,
    /// Minus the passive torque at each.
    pub minus_passive: Vec<f64>,
    /// External torque at each angle, all other coordinates unchanged; empty where that has no meaning, as for a standing leg.
    pub external: Vec<f64>,
}

/// One muscle group over time.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// Name in words.
    pub label: String,
    /// Fatigue in every frame, 0..=1; empty if not known.
    pub fatigue: Vec<f64>,
    /// Time for which the present load can still be held, s, in every frame; may be infinite.
    pub left: Vec<f64>,
    /// Time at which the fatigue of the group first reaches 1, s, which may be between two frames.
    pub fails: Option<f64>,
}

/// One support of the body over time.
#[derive(Clone, Debug, Default)]
pub struct Support {
    /// Name of the support.
    pub label: String,
    /// Force on the body in every frame, N.
    pub force: Vec<[f64; 3]>,
    /// Point where the force acts in every frame, m.
    pub at: Vec<[f64; 3]>,
    /// Share of the body's weight in every frame.
    pub share: Vec<f64>,
}

/// A flat piece that carries the body.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Name of the surface.
    pub label: String,
    /// The four corners of the surface in order, m.
    pub corners: [[f64; 3]; 4],
}

/// A place that a point of the body is to reach, or that it looks at.
#[derive(Clone, Debug, Default)]
pub struct Target {
    /// Name of the part of the body.
    pub label: String,
    /// The place in every frame, m.
    pub at: Vec<[f64; 3]>,
    /// The point of the body in every frame, m; empty where it need not come to the place.
    pub from: Vec<[f64; 3]>,
}

/// A thing, drawn as a box.
#[derive(Clone, Debug, Default)]
pub struct Thing {
    /// Name of the thing.
    pub label: String,
    /// Full lengths along its own axes x, y and z, m.
    pub size: [f64; 3],
    /// Placement of its middle in every frame: origin, m, and unit quaternion `w x y z`; one entry for a thing that stays.
    pub places: Vec<[f64; 7]>,
    /// The frame from which on it is not there; `None` for a thing that is not put down.
    pub put_down: Option<usize>,
}

/// A load over time: a held weight, a tool, a push at a handle.
#[derive(Clone, Debug, Default)]
pub struct Push {
    /// Name of the force.
    pub label: String,
    /// Point where it acts in every frame, m.
    pub at: Vec<[f64; 3]>,
    /// Force on the body in every frame, N; zero where the load is not in force.
    pub force: Vec<[f64; 3]>,
}

/// Muscles over time.
#[derive(Clone, Debug, Default)]
pub struct Muscles {
    /// Frames that carry points of muscles.
    pub carriers: Vec<Carrier>,
    /// The muscles.
    pub lines: Vec<Muscle>,
    /// Of every frame the greatest torque that the muscles cannot give, N m, with its index in [`Report::joints`].
    pub lacks: Vec<Option<(Option<usize>, f64)>>,
    /// Joints that bones press together.
    pub pressed: Vec<PressedJoint>,
}

/// One muscle over time.
#[derive(Clone, Debug, Default)]
pub struct Muscle {
    /// Name of the muscle.
    pub name: String,
    /// The muscle group that it works for, in words; may be empty.
    pub works_for: String,
    /// Index in [`Report::joints`] of the joint of that group.
    pub joint: Option<usize>,
    /// Radius of its picture, m.
    pub radius: f64,
    /// Activation in every frame, 0..=1.
    pub activation: Vec<f64>,
    /// Tension in every frame, N.
    pub tension: Vec<f64>,
    /// All points that its line has in some frame; those on an unknown carrier are left out.
    pub points: Vec<PathPoint>,
    /// Lines: indices in `points` from one end to the other; `None` for a gap.
    pub orders: Vec<Vec<Option<usize>>>,
    /// Index in `orders` of the line of every frame.
    pub order: Vec<usize>,
}

/// A point of a muscle.
#[derive(Clone, Debug, Default)]
pub struct PathPoint {
    /// Index in [`Muscles::carriers`].
    pub carrier: usize,
    /// The place in that frame, m, in every frame of the report.
    pub at: Vec<[f64; 3]>,
}

/// The solid of all forces that the body can exert at a point, drawn from the point at so many metres a newton.
#[derive(Clone, Debug, Default)]
pub struct ForceSolid {
    /// The point, m.
    pub at: [f64; 3],
    /// Corners of the solid, m.
    pub corners: Vec<[f64; 3]>,
    /// Triangles between corners, by index, seen counterclockwise from outside; those with an index out of range are left out.
    pub faces: Vec<[usize; 3]>,
    /// Index of the limit of every corner in `names`.
    pub limits: Vec<usize>,
    /// Names of the limits, each a colour of its own; those from the eighth on share the last one.
    pub names: Vec<String>,
    /// The scale in words.
    pub scale: String,
}

/// Texts about single frames; the default is empty.
#[derive(Clone, Debug, Default)]
pub struct List {
    /// Heading of the list.
    pub heading: String,
    /// In the order of frames.
    pub entries: Vec<Entry>,
    /// The text of an empty list.
    pub none: String,
}

/// A text about a frame and perhaps a joint; a click shows both.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    /// Number of the frame.
    pub frame: usize,
    /// The time that it names, s; `None` for that of the frame.
    pub time: Option<f64>,
    /// Index in [`Report::joints`]; `None` for a text about no joint.
    pub joint: Option<usize>,
    /// In plain words.
    pub text: String,
}

/// A table of texts.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Heading of the table.
    pub heading: String,
    /// Names of its columns.
    pub columns: Vec<String>,
    /// Rows of the table.
    pub rows: Vec<Vec<String>>,
}
