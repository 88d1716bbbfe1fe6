//! The whole-job problem of the peers (`50_posture_pinocchio.py` of their bench): the 48-joint human with 2 kg in the right hand,
//! which is to be on a target, with the least sum of squared active torques; double exponentials of 10 N m and 8 per radian as
//! passive torque of every joint, unit strengths. Either the upper body on a fixed pelvis, or standing on both feet without a
//! limit of friction.

use std::path::Path;

use contrapposto::contact::{Balance, Support};
use contrapposto::model::{Adult, Model, MuscleGroup, adult};
use contrapposto::passive::{DoubleExponential, End, PassiveCurve};
use contrapposto::posture::Posture;
use contrapposto::posture_solver::{Engine, Options, SolvedPosture};
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto::strength::Strength;
use contrapposto::tasks::PriorityLevel;
use contrapposto::tasks::{Effort, Point, Task};
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::urdf;
use nalgebra::Vector3;
use serde_json::Value;

use super::shared::shared;

/// Sole of a foot in the frame of the peer's foot: centre and half length, half width, height, m.
const SOLE: [f64; 4] = [0.054652, 0.0899, 0.0374, 0.0785085];

/// The problem without a target.
pub(crate) struct Problem {
    pub(crate) model: Model,
    pub(crate) rest: Posture,
    supports: Vec<Support>,
    load: Load,
    /// Rates that do not move.
    locked: Vec<usize>,
}

/// One target, and what the peer came to from rest.
pub(crate) struct Target {
    pub(crate) target: Vector3<f64>,
    pub(crate) effort: f64,
    /// Processor time in the peer's run, ms.
    pub(crate) ms: f64,
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

impl Problem {
    /// Reads the peer's files in `../shared`.
    pub(crate) fn read(standing: bool) -> Self {
        let bytes = std::fs::read(shared("models/human-gazebo/humanSubject01_48dof.urdf")).unwrap();
        let text = std::fs::read(shared("vectors/ik_targets_human48.json")).unwrap();
        let root = if standing { RootAttachment::Free } else { RootAttachment::Fixed };
        let options = urdf::Options { root, ..urdf::Options::default() };
        // The peer minimises the torques of the coordinates, and knows nothing of the file's effort limits.
        let read = urdf::read(&bytes, "human48", &options).unwrap().model().unwrap().model;
        let mut model = read.without_groups().by_coordinates();
        let file: Value = serde_json::from_slice(&text).unwrap();
        let rest = rest(&model, &file);
        let mut locked = vec![];
        let fatigue = adult(&Adult::default()).unwrap();
        let fatigue = fatigue.coordinates().iter().find_map(|c| c.groups.clone()).unwrap()[0].fatigue.clone();
        for i in 0..model.coordinates().len() {
            let name = model.coordinates()[i].name.clone();
            let leg = ["Hip", "Knee", "Ankle", "Ball"].iter().any(|part| name.contains(part));
            if name.starts_with("root_") {
                continue;
            }
            if leg && !standing {
                locked.extend(model.coordinates()[i].rate);
                continue;
            }
            let range = model.coordinates()[i].range;
            let end = |angle| End { torque: 10.0, rate: 8.0, angle };
            let law = DoubleExponential { lower: end(range.0), upper: end(range.1), stiffness: 0.0, neutral: 0.0 };
            model = model.with_passive(i, PassiveCurve::new(law.form().unwrap(), range, None).unwrap());
            let group =
                MuscleGroup { name: "unit".into(), strength: Strength::constant(1.0), fatigue: fatigue.clone() };
            model = model.with_groups(i, [group.clone(), group]);
        }
        let support = |foot: &str| {
            let [centre, length, width, height] = SOLE;
            let corner = |(x, y): (f64, f64)| Vector3::new(centre + length * x, width * y, -height);
            Support {
                segment: model.segment(foot).unwrap(),
                corners: [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner).to_vec(),
                normal: Vector3::z(),
                friction: f64::INFINITY,
                share_max: 1.0,
                place: contrapposto::contact::Place::Fixed,
            }
        };
        let supports = if standing { ["LeftFoot", "RightFoot"].map(support).to_vec() } else { vec![] };
        let weight = LoadKind::Force(Vector3::new(0.0, 0.0, -2.0 * 9.81), FixedIn::World);
        let load = Load { segment: model.segment("RightHandCOM").unwrap(), point: Vector3::zeros(), kind: weight };
        Self { rest, supports, load, locked, model }
    }

    /// The engine for a target.
    pub(crate) fn engine(&self, target: Vector3<f64>, options: Options) -> Engine<'_> {
        let hand = Point { segment: self.load.segment, point: Vector3::zeros(), target, axes: [true; 3] };
        let goals: Vec<PriorityLevel> = vec![Task::Point(hand).into(), Task::Effort(Effort::whole(&self.model)).into()];
        let supports = self.supports.clone();
        let mut engine =
            Engine::with_supports(&self.model, &self.rest, supports, goals, &[self.load], options).unwrap();
        self.locked.iter().for_each(|rate| engine.lock(*rate));
        engine
    }
}

/// The peer's rest posture: x y z, quaternion x y z w, then the joints by name.
fn rest(model: &Model, file: &Value) -> Posture {
    let names: Vec<&str> = file["joint_names"].as_array().unwrap()[2..].iter().map(|n| n.as_str().unwrap()).collect();
    let q = numbers(&file["rest_q"]);
    let root = ["root_tx", "root_ty", "root_tz", "root_qx", "root_qy", "root_qz", "root_qw"];
    let place = |name: &str| {
        let joint = || 7 + names.iter().position(|n| *n == name).unwrap();
        root.iter().position(|n| *n == name).unwrap_or_else(joint)
    };
    Posture::new(model.coordinates().iter().map(|c| q[place(&c.name)]).collect())
}

/// The targets of one problem in a file of the peer's answers.
pub(crate) fn targets(file: &Path, problem: &str) -> Vec<Target> {
    let file: Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    let row = |row: &Value| Target {
        target: Vector3::from_vec(numbers(&row["target"])),
        effort: row["sum_sq_active"].as_f64().unwrap(),
        ms: 1e3 * row["cpu_s"].as_f64().unwrap_or(f64::NAN),
    };
    file[problem]["rows"].as_array().unwrap().iter().map(row).collect()
}

/// Whether hand, feet and root are at their places.
pub(crate) fn holds(pose: &SolvedPosture) -> bool {
    pose.levels[0].length < 1e-6 && pose.slip.length() < 1e-6 && pose.balance == Balance::Held
}
