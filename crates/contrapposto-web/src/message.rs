//! Defines the requests of a page and the answers to them.

use std::collections::BTreeMap;

use contrapposto_formats::VerdictText;
use serde::{Deserialize, Serialize};
use toml::Table;

/// One request. Lengths in m, masses in kg, ground axes: x forward, y up, z to the right.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Request {
    /// Opens a scenario, with the texts of the files that it names by their names.
    Open {
        scenario: String,
        #[serde(default)]
        files: BTreeMap<String, String>,
    },
    /// Opens a model file, on a scenario of its own.
    OpenModel { name: String, text: String },
    /// Gives the built-in adult another size; posture and held points begin anew.
    Adult { sex: String, stature: f64, mass: f64 },
    /// Gives the built-in adult the stature and the mass that so many percent of people of that sex do not exceed, each alone.
    Percentile { sex: String, percentile: f64 },
    /// Takes hold of a point of a segment, in the segment's frame. A foot that carries weight is put elsewhere on its floor.
    Grab { segment: String, point: [f64; 3] },
    /// One step of the point that was grabbed toward a place in ground.
    Drag { target: [f64; 3] },
    /// Lets go of it; `hold`: the point stays where it is.
    Release { hold: bool },
    /// Frees a point that is held.
    Free { segment: String },
    /// One step toward the posture of least effort.
    Settle {},
    /// Hangs a weight on a segment in place of the one that hangs there; 0 takes it off.
    Load { segment: String, mass: f64 },
    /// Pushes on a point of a segment, in the segment's frame, with a force in ground, N, in place of the force that pushes on that segment;
    /// no force takes it off.
    Push { segment: String, point: [f64; 3], force: [f64; 3] },
    /// Puts a thing there, by a table of the scenario file: its word (`box`, `seat`, ...) and its keys. But for a bag and a tool that is only
    /// carried, posture and held points begin anew.
    Put { word: String, keys: Table },
    /// Takes the thing of a table away; `number` counts the tables of this word from 0.
    TakeAway { word: String, number: usize },
    /// Strategy, `active` or `passive`, of a region (`spine`, `neck`, `arms`, `legs`), or of the whole body.
    Strategy {
        kind: String,
        #[serde(default)]
        region: Option<String>,
    },
    /// Lets time run for so many samples; the first call begins a run.
    Play { samples: u32 },
    /// Ends the run; `take`: the body stays in the posture, and its muscles as tired, as it has come to.
    Stop { take: bool },
    /// The torques of a coordinate over its range.
    Balance { coordinate: String },
    /// The different ways to rest: the search of `contrapposto relax`, from the posture that is shown.
    Relax {},
    /// Goes to a posture, by the values of all coordinates.
    Go { q: Vec<f64> },
    /// Shows a posture, held still on the supports of the job, without going there; an empty one shows that of the job again.
    At { q: Vec<f64> },
    /// The postures of a recorded motion, an OpenSim table, as those of this body.
    Motion { name: String, text: String },
    /// Exchanges left and right: posture, held points, weights, fatigue, strategies.
    Mirror {},
    /// The run at a moment that has passed, s: of the samples that are kept, the last one until then.
    Look { time: f64 },
    /// The skin of the body, from the file that the session was given.
    Skin {},
    /// The posture that is shown, or the run so far, as glTF; with the skin, unless `wooden`.
    Gltf {
        wooden: bool,
        #[serde(default)]
        course: Option<Course>,
    },
    /// The same as BVH.
    Bvh {
        #[serde(default)]
        course: Option<Course>,
    },
    /// The posture that is shown, or the run so far, as `report.html`.
    Report {},
    /// The scenario as a file.
    Export {},
    /// All of the present document as a text, for `restore` in another session.
    State {},
    /// Takes over the document of another session; a change that can be undone.
    Restore { state: String },
    /// Takes the last change back.
    Undo {},
    /// Makes it again.
    Redo {},
    /// Back to the scenario as it was opened.
    Reset {},
}

/// Postures over time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Course {
    /// s.
    pub(crate) times: Vec<f64>,
    /// Values of all coordinates at each.
    pub(crate) postures: Vec<Vec<f64>>,
}

/// The answer to a request.
#[derive(Debug, Serialize)]
#[serde(tag = "is", rename_all = "snake_case")]
pub(crate) enum Answer {
    /// Another body or another job.
    Scene(Box<Scene>),
    /// Another posture.
    Shown(Box<Shown>),
    /// A run went on.
    Played(Box<Played>),
    /// Torques of a coordinate.
    Balance(Balance),
    /// Postures of least effort, the least first.
    Ways { ways: Vec<Way> },
    /// The skin of the body; `None` of a body without one.
    Skin { skin: Option<SkinScene> },
    /// A file.
    Bytes { bytes: Vec<u8> },
    /// A recorded motion, and sentences about faults of its file.
    Motion { course: Course, notes: Vec<String> },
    /// A text.
    Text { text: String },
    /// The module with all readers and writers answers this request: one that opens something in place of this session, another one in a
    /// session with this document, for this course, or after a run of so many samples.
    Elsewhere { state: String, course: Option<Course>, samples: u64 },
    /// The request was refused; nothing has changed.
    Refused { sentence: String },
}

/// A body and its job.
#[derive(Debug, Serialize)]
pub(crate) struct Scene {
    pub(crate) title: String,
    pub(crate) person: Option<Person>,
    pub(crate) coordinates: Vec<CoordinateScene>,
    pub(crate) segments: Vec<SegmentScene>,
    pub(crate) handles: Vec<Handle>,
    pub(crate) held: Vec<Handle>,
    pub(crate) supports: Vec<String>,
    pub(crate) things: Vec<ThingScene>,
    pub(crate) loads: Vec<Hung>,
    /// Tables of the scenario file that put things there.
    pub(crate) tables: Vec<ThingTable>,
    /// Forces that push on segments.
    pub(crate) forces: Vec<Pushed>,
    pub(crate) strategy: String,
    /// Strategies of the regions of the body.
    pub(crate) regions: Vec<RegionScene>,
    pub(crate) notes: Vec<String>,
    pub(crate) can_undo: bool,
    pub(crate) can_redo: bool,
    pub(crate) shown: Shown,
}

/// Size of the built-in adult.
#[derive(Debug, Serialize)]
pub(crate) struct Person {
    pub(crate) sex: String,
    pub(crate) stature: f64,
    pub(crate) mass: f64,
    /// Percent of people of that sex who do not exceed the stature, and the mass.
    pub(crate) percentiles: [f64; 2],
}

/// A region of the body with its strategy: `active`, `passive`, or `mixed`.
#[derive(Debug, Serialize)]
pub(crate) struct RegionScene {
    pub(crate) name: &'static str,
    pub(crate) strategy: &'static str,
}

/// A coordinate with its two muscle groups.
#[derive(Debug, Serialize)]
pub(crate) struct CoordinateScene {
    pub(crate) name: String,
    pub(crate) label: String,
    pub(crate) positive: String,
    /// An angle, not a distance or a part of a quaternion.
    pub(crate) turns: bool,
    pub(crate) range: [f64; 2],
    pub(crate) groups: Option<[String; 2]>,
}

/// A segment: hulls of balls in its frame, and the coordinates of the joint that moves it.
#[derive(Debug, Serialize)]
pub(crate) struct SegmentScene {
    pub(crate) name: String,
    pub(crate) label: String,
    pub(crate) hulls: Vec<Vec<[f64; 4]>>,
    pub(crate) coordinates: [usize; 2],
}

/// A way to rest.
#[derive(Debug, Serialize)]
pub(crate) struct Way {
    /// Sum of (active torque / strength)^2.
    pub(crate) effort: f64,
    /// Joints whose ligaments carry at least half of the torque, the one with the greatest first.
    pub(crate) on_ligaments: Vec<String>,
    pub(crate) shown: Shown,
}

/// A mesh that bones move, in the T-pose.
#[derive(Debug, Serialize)]
pub(crate) struct SkinScene {
    /// Vertices, m.
    pub(crate) vertices: Vec<[f64; 3]>,
    /// Corners of triangles, anticlockwise seen from outside.
    pub(crate) triangles: Vec<[u16; 3]>,
    /// Bones that move a vertex, as indices in [`Self::heads`] and [`Shown::bones`].
    pub(crate) bones: Vec<[u8; 4]>,
    /// Weights of these bones, which sum to 255.
    pub(crate) weights: Vec<[u8; 4]>,
    /// Brightness of every vertex, as a share of 255.
    pub(crate) light: Vec<u8>,
    /// Place of every bone, m.
    pub(crate) heads: Vec<[f64; 3]>,
    /// The segment that every bone follows.
    pub(crate) segments: Vec<usize>,
}

/// A point of a segment that can be dragged or is held.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Handle {
    pub(crate) label: String,
    pub(crate) segment: String,
    pub(crate) point: [f64; 3],
}

/// A box around the body or in its hands.
#[derive(Debug, Serialize)]
pub(crate) struct ThingScene {
    pub(crate) name: String,
    pub(crate) size: [f64; 3],
    /// Position and quaternion x, y, z, w, in ground or in the frame of the segment.
    pub(crate) place: [f64; 7],
    pub(crate) segment: Option<usize>,
}

/// A table of the scenario file that puts a thing there.
#[derive(Debug, Serialize)]
pub(crate) struct ThingTable {
    pub(crate) word: String,
    /// Counts the tables of this word from 0.
    pub(crate) number: usize,
    pub(crate) keys: Table,
}

/// A weight that hangs on a segment.
#[derive(Debug, Serialize)]
pub(crate) struct Hung {
    pub(crate) segment: String,
    pub(crate) mass: f64,
}

/// A force that pushes on a point of a segment: in the segment's frame, m, and in ground, N.
#[derive(Debug, Serialize)]
pub(crate) struct Pushed {
    pub(crate) segment: String,
    pub(crate) label: String,
    pub(crate) point: [f64; 3],
    pub(crate) force: [f64; 3],
}

/// One posture and its torques, by coordinate; of three-axis joints about the axes that stand for their coordinates.
#[derive(Debug, Serialize)]
pub(crate) struct Shown {
    pub(crate) q: Vec<f64>,
    /// Angles, of three-axis joints about their axes.
    pub(crate) angles: Vec<f64>,
    pub(crate) external: Vec<f64>,
    pub(crate) passive: Vec<f64>,
    pub(crate) active: Vec<f64>,
    pub(crate) load: Vec<f64>,
    /// Position and quaternion x, y, z, w of every segment, in ground.
    pub(crate) places: Vec<[f64; 7]>,
    /// The same of every bone of the skin, which no bone turns in the T-pose; empty of a body without one.
    pub(crate) bones: Vec<[f64; 7]>,
    pub(crate) center: [f64; 3],
    pub(crate) contacts: Vec<ContactShown>,
    /// Corners of the patches on supports, in ground.
    pub(crate) patches: Vec<[f64; 3]>,
    pub(crate) pushes: Vec<Push>,
    pub(crate) verdict: VerdictText,
    /// Distance of the dragged point from its target, m.
    pub(crate) miss: Option<f64>,
    /// The last step moved next to nothing.
    pub(crate) settled: bool,
}

/// The force of a support on the body.
#[derive(Debug, Serialize)]
pub(crate) struct ContactShown {
    pub(crate) force: [f64; 3],
    pub(crate) share: f64,
    pub(crate) at: Option<[f64; 3]>,
}

/// A load on the body.
#[derive(Debug, Serialize)]
pub(crate) struct Push {
    pub(crate) at: [f64; 3],
    pub(crate) force: [f64; 3],
}

/// A run so far.
#[derive(Debug, Serialize)]
pub(crate) struct Played {
    /// s.
    pub(crate) time: f64,
    pub(crate) samples: u64,
    /// By coordinate: of the positive and of the negative group, 0 to 1.
    pub(crate) fatigue: Vec<[f64; 2]>,
    /// Muscle groups that ask for relief.
    pub(crate) asking: Vec<String>,
    /// Decisions with their reasons: the sentences of `decisions.csv`, the latest last.
    pub(crate) log: Vec<LogLine>,
    /// Number of all decisions.
    pub(crate) decisions: u64,
    /// Indices of the things that have been put down.
    pub(crate) put_down: Vec<usize>,
    /// The reason for which the run ended; `None` while it goes on.
    pub(crate) ended: Option<&'static str>,
    pub(crate) shown: Shown,
}

/// A line of the log of a run.
#[derive(Debug, Serialize)]
pub(crate) struct LogLine {
    /// s.
    pub(crate) time: f64,
    pub(crate) sentence: String,
}

/// Torques of one coordinate over its range, N m, about its axis, in the posture shown, that joint alone moving.
#[derive(Debug, Serialize)]
pub(crate) struct Balance {
    pub(crate) coordinate: String,
    pub(crate) angle: Vec<f64>,
    pub(crate) external: Vec<f64>,
    pub(crate) minus_passive: Vec<f64>,
}
