//! Bodies of random worlds: the built-in adult, or the adult in a file, with muscles at elbows and knees or without.

use std::fmt::Write;

use contrapposto::model::{Model, adult};
use contrapposto_formats::tissue::{MuscleUse, Person, ScenarioMuscles, SourcedModel};
use contrapposto_formats::{adult_size, write};
use rand::RngExt;
use rand_pcg::Pcg64Mcg as Random;

use super::world::one_of;

/// A muscle across a joint of one axis: its name, its segments, where it begins in shares of stature, its moment arm (m) and its greatest force (N).
const MUSCLES: [(&str, [&str; 2], f64, f64, f64); 4] = [
    ("vasti", ["femur", "tibia"], -0.08, 0.05, 6000.0),
    ("hamstrings", ["femur", "tibia"], -0.05, -0.05, 4000.0),
    ("biceps", ["humerus", "ulna"], -0.03, 0.04, 2500.0),
    ("triceps", ["humerus", "ulna"], -0.02, -0.03, 2500.0),
];

/// The kind of a world's body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The built-in adult.
    Adult,
    /// The adult in an OpenSim file.
    OpenSim,
    /// The adult in an MJCF file.
    Mjcf,
    /// The adult in an OpenSim file with muscles, which are used so.
    Muscles(MuscleUse),
}

/// Size and kind of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body {
    pub(crate) kind: Kind,
    pub(crate) female: bool,
    /// Stature, m.
    pub(crate) stature: f64,
    /// Mass, kg.
    pub(crate) mass: f64,
}

impl Body {
    pub(crate) fn random(random: &mut Random) -> Self {
        let female = one_of(random, &["male", "female"]) == "female";
        let (stature, mass) = (random.random_range(1.5..1.95), random.random_range(48.0..110.0));
        let kind = match random.random_range(0..20) {
            0..2 => Kind::OpenSim,
            2..4 => Kind::Mjcf,
            4 | 5 => Kind::Muscles(MuscleUse::Strength),
            6 => Kind::Muscles(MuscleUse::Both),
            _ => Kind::Adult,
        };
        Self { kind, female, stature, mass }
    }

    /// Whether the body comes from a file.
    pub(crate) fn is_file(self) -> bool {
        self.kind != Kind::Adult
    }

    /// The lines of `[model]`.
    pub(crate) fn text(self) -> String {
        let sex = if self.female { "female" } else { "male" };
        let size = format!("{{ sex = \"{sex}\", stature_m = {:.3}, mass_kg = {:.1} }}", self.stature, self.mass);
        match self.kind {
            Kind::Adult => format!("adult = {size}\n"),
            Kind::OpenSim => "file = \"world.osim\"\n".to_owned(),
            Kind::Mjcf => format!("file = \"world.xml\"\nperson = {size}\n"),
            Kind::Muscles(uses) => {
                let uses = if uses == MuscleUse::Both { "both" } else { "strength" };
                format!("file = \"world.osim\"\nmuscles = \"{uses}\"\nperson = {size}\n")
            }
        }
    }

    /// The body of the file, written and read again; `None` of the built-in adult.
    pub(crate) fn model(self) -> Option<(Model, Option<ScenarioMuscles>)> {
        if !self.is_file() {
            return None;
        }
        let sex = if self.female { "female" } else { "male" };
        let size = adult_size(&format!("adult:{sex},{:.3}m,{:.1}kg", self.stature, self.mass)).unwrap().unwrap();
        let body = adult(&size).unwrap();
        let (name, text) = match self.kind {
            Kind::Mjcf => ("world.xml", write::mjcf(&body).unwrap().text),
            Kind::Muscles(_) => ("world.osim", with_muscles(&write::osim(&body).unwrap().text, self.stature)),
            _ => ("world.osim", write::osim(&body).unwrap().text),
        };
        let mut opened = SourcedModel::read(name, text.as_bytes(), None, &mut |_| Err("none".to_owned())).unwrap();
        // Without a person the file is the adult that it says it holds.
        let person = if self.kind == Kind::OpenSim {
            Person::default()
        } else {
            Person { sex: Some(size.sex), stature: Some(size.stature), mass: Some(size.mass) }
        };
        let Kind::Muscles(uses) = self.kind else { return Some((opened.fill(&person).unwrap().model, None)) };
        let library = opened.clone().fill(&person).unwrap();
        assert!(opened.use_muscles(uses), "the muscles are read");
        let mut opened = opened.fill(&person).unwrap();
        let (muscles, _) = opened.scenario_muscles(&library).unwrap();
        Some((opened.model, muscles))
    }
}

/// An OpenSim file with muscles on both sides of each elbow and knee.
fn with_muscles(text: &str, stature: f64) -> String {
    let mut muscles = String::new();
    for side in ["r", "l"] {
        for (name, [upper, lower], begin, arm, force) in MUSCLES {
            // From where the muscle begins to the joint.
            let length = stature * (begin + if upper == "femur" { 0.24 } else { 0.16 });
            let fiber = 0.45 * length;
            write!(
                muscles,
                "<Thelen2003Muscle name=\"{name}_{side}\"><GeometryPath><PathPointSet><objects>
                 <PathPoint name=\"p\"><socket_parent_frame>/bodyset/{upper}_{side}</socket_parent_frame>
                 <location>{arm} {} 0</location></PathPoint>
                 <PathPoint name=\"o\"><socket_parent_frame>/bodyset/{lower}_{side}</socket_parent_frame>
                 <location>{arm} 0 0</location></PathPoint></objects></PathPointSet></GeometryPath>
                 <max_isometric_force>{force}</max_isometric_force><optimal_fiber_length>{fiber}</optimal_fiber_length>
                 <tendon_slack_length>{}</tendon_slack_length></Thelen2003Muscle>",
                begin * stature,
                length - fiber
            )
            .unwrap();
        }
    }
    let (before, forces) = text.split_once("<ForceSet>").unwrap();
    let (open, forces) = forces.split_once("<objects>").unwrap();
    format!("{before}<ForceSet>{open}<objects>{muscles}{forces}")
}
