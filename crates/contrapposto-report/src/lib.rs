//! How does a result become a page that opens anywhere? Plain numbers in, one `report.html` out: the body in three dimensions,
//! over time or in a few postures, charts of every joint, decisions in plain words. It needs no network, and its content security
//! policy allows none. What is not known stands nowhere on the page.
//!
//! Inside, every file stands on those above it in this list: `solid` (thickness of segments), `column` (numbers over time,
//! short), `data` (what the page's script reads), `page` (the file itself). The page's own script and style stand in `page/`.
//!
//! Every function takes any input without panicking: numbers that are not finite count as 0, lists that are too short as if
//! their last number went on. The same input gives the same bytes. Texts may come from strangers: they reach the page as text.

mod column;
mod data;
mod page;
mod solid;

pub use page::write;
pub use solid::balls_of;

/// Everything a page shows. Ground axes: x forward, y up, z to the right; m, s, N, N m, degrees.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Title of the job.
    pub title: String,
    /// Name of the body.
    pub body: String,
    /// What was found, in one plain sentence.
    pub headline: String,
    /// Why, in a few more.
    pub reasons: Vec<String>,
    /// The few numbers that say most.
    pub figures: Vec<Figure>,
    /// What its frames are.
    pub moments: Moments,
    /// What the body is made of.
    pub segments: Vec<Segment>,
    /// Its coordinates, those that hold a torque.
    pub joints: Vec<Joint>,
    /// Place in `joints` of the one to show first.
    pub main: usize,
    /// Fatigue at which relief begins and ends, 0..=1; none where nobody is relieved.
    pub levels: Option<[f64; 2]>,
    /// What carries the body; without, it is held by its root.
    pub supports: Vec<Support>,
    /// Height of the ground, m; without, none is drawn.
    pub ground: Option<f64>,
    /// Other things that the body rests on, a seat, a table, a wall: corners of flat pieces, around, m.
    pub surfaces: Vec<[[f64; 3]; 4]>,
    /// Places that tasks ask for, m.
    pub targets: Vec<[f64; 3]>,
    /// Centre of mass in every frame; may be empty.
    pub center_of_mass: Vec<[f64; 3]>,
    /// What there is to read of single frames.
    pub list: List,
    /// What there is to read of all of them; may be empty.
    pub table: Table,
}

/// What the frames of a report are.
#[derive(Clone, Debug)]
pub enum Moments {
    /// Moments of a motion, s, rising: a slider and a button to play go through them.
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

/// A number worth a large print.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// What it is.
    pub label: String,
    /// The number with its unit.
    pub value: String,
    /// What it was, or is to be compared with; may be empty.
    pub note: String,
}

/// A ball, in the frame of its segment: centre and radius, m.
pub type Ball = [f64; 4];

/// A solid part of the body: the hull of a few balls.
#[derive(Clone, Debug, Default)]
pub struct Segment {
    /// Its name.
    pub name: String,
    /// At least one.
    pub balls: Vec<Ball>,
    /// Places in [`Report::joints`] of the coordinates that join it to what carries it; none for a root.
    pub joints: Vec<usize>,
    /// Where it is in every frame: origin, m, and unit quaternion `w x y z`.
    pub places: Vec<[f64; 7]>,
    /// Where it was before anything happened: a ghost shows it.
    pub start: [f64; 7],
}

/// One coordinate over time.
#[derive(Clone, Debug, Default)]
pub struct Joint {
    /// Its name in the model.
    pub name: String,
    /// The same in words.
    pub label: String,
    /// Which way is positive; may be empty.
    pub positive: String,
    /// It slides: its values are m and N, not degrees and N m.
    pub slides: bool,
    /// Its two muscle groups, positive torque first.
    pub groups: Option<[Group; 2]>,
    /// Value in every frame, degrees (m for slides).
    pub angle: Vec<f64>,
    /// External torque in every frame.
    pub external: Vec<f64>,
    /// Passive torque in every frame. The active one is minus the sum of both.
    pub passive: Vec<f64>,
    /// |Active torque| over strength in every frame.
    pub load: Vec<f64>,
    /// Its torques over its range: one for all frames, one for each, or none.
    pub balance: Vec<Balance>,
}

/// Torques over the range of a joint.
#[derive(Clone, Debug, Default)]
pub struct Balance {
    /// Angles, degrees.
    pub angle: Vec<f64>,
    /// Minus the passive torque at each.
    pub minus_passive: Vec<f64>,
    /// External torque at each, everything else held; empty where that makes no sense, as for a leg that stands.
    pub external: Vec<f64>,
}

/// One muscle group over time.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// In words.
    pub label: String,
    /// Fatigue in every frame, 0..=1; empty where it is not known.
    pub fatigue: Vec<f64>,
    /// How long the present load can still be held, s, in every frame; infinite for ever.
    pub left: Vec<f64>,
}

/// What carries the body, over time.
#[derive(Clone, Debug, Default)]
pub struct Support {
    /// Its name.
    pub label: String,
    /// Force on the body in every frame, N.
    pub force: Vec<[f64; 3]>,
    /// Where it acts in every frame, m.
    pub at: Vec<[f64; 3]>,
    /// Share of the body's weight in every frame.
    pub share: Vec<f64>,
}

/// What there is to read of single frames; empty with nothing in it.
#[derive(Clone, Debug, Default)]
pub struct List {
    /// What the list is.
    pub heading: String,
    /// In the order of frames.
    pub entries: Vec<Entry>,
    /// What to say where there are none.
    pub none: String,
}

/// Something that a frame and a joint show: a click goes there.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    /// Number of the frame.
    pub frame: usize,
    /// Place in [`Report::joints`].
    pub joint: usize,
    /// In plain words.
    pub text: String,
}

/// A table of texts.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// What it shows.
    pub heading: String,
    /// Names of its columns.
    pub columns: Vec<String>,
    /// Its rows.
    pub rows: Vec<Vec<String>>,
}
