//! Writes a model as an OpenSim, URDF or MJCF file.
//!
//! Each writer gives the text and, in plain sentences, what the format cannot hold. Numbers stand in the shortest form that
//! reads back as the same bits; orientations are chosen so that our readers find the same quaternion where there is one such
//! choice (`exact.rs`). The list of lost parts stands at the head of the file, too. The same model always gives the same text.
//!
//! Coordinates keep their names and values everywhere, except balls in `.osim` files, which become three angles. External
//! torque is what the programs call generalised gravity, with the other sign.

mod exact;
mod law;
mod mjcf;
mod mjcf_body;
mod names;
mod osim;
mod osim_again;
mod osim_functions;
mod osim_joint;
mod osim_motion;
mod osim_muscles;
mod steps;
mod urdf;
mod xml;

pub use mjcf::mjcf;
pub(crate) use names::Names;
pub use osim::osim;
pub use osim_again::osim_again;
pub use osim_motion::osim_motion;
pub use urdf::urdf;

use contrapposto::fatigue::FatigueLaw;
use contrapposto::model::{Coordinate, Model};

/// A file, and the properties of the model that it lacks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The whole file; comments at its head tell what is lost.
    pub text: String,
    /// Properties that the format cannot hold: one plain sentence each, in the order of the model.
    pub lost: Vec<String>,
}

/// The reason for which a model cannot be written in a format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// A character that XML cannot hold.
    #[error("the name {name:?} has a character that no XML file can hold")]
    Name {
        /// The name.
        name: String,
    },
    /// A joint that the format has no words for.
    #[error("joint `{joint}`: {problem}")]
    Joint {
        /// Name of the joint.
        joint: String,
        /// The missing ability of the format.
        problem: &'static str,
    },
    /// A segment that the format's program would refuse.
    #[error("segment `{segment}`: {problem}")]
    Segment {
        /// Name of the segment.
        segment: String,
        /// The part that the format refuses.
        problem: &'static str,
    },
}

/// Written as a joint's greatest speed (rad/s or m/s): URDF asks for one, and models of posture know none.
const PLACEHOLDER_VELOCITY: f64 = 10.0;
/// Written as a joint's greatest effort where the strength of its muscle groups is not known: URDF asks for one, and this reader takes
/// 0 for none.
const PLACEHOLDER_EFFORT: f64 = 0.0;
/// Written as a limit where there is none but the format asks for one, rad or m.
const PLACEHOLDER_LIMIT: f64 = 1e9;

/// Mass that a massless end of a chain gets in MuJoCo, kg: a torque of 1e-11 N m a metre.
const FEATHER_MASS: f64 = 1e-12;
/// Inertia of such a segment, kg m^2, which plays no part at rest.
const FEATHER_INERTIA: f64 = 1e-9;

/// Greatest torque in the positive and negative sense of a coordinate that a motor drives, N m.
fn motor(coordinate: &Coordinate) -> Option<[f64; 2]> {
    let groups = coordinate.groups.as_ref()?;
    let motors = groups.iter().all(|group| group.fatigue == FatigueLaw::Tireless);
    motors.then(|| [0, 1].map(|side| groups[side].strength.peak))
}

/// Properties that the format does not hold, after a check of all names. `holds`: the format holds the strength of such a motor.
fn common(model: &Model, holds: fn([f64; 2]) -> bool) -> Result<Vec<String>, WriteError> {
    let segments = model.segments().iter().flat_map(|s| [&s.name, &s.joint]);
    let all = segments.chain(model.coordinates().iter().map(|c| &c.name));
    for name in all.map(String::as_str).chain([model.name()]) {
        if !name.chars().all(xml::holds) {
            return Err(WriteError::Name { name: name.to_owned() });
        }
    }
    let mut lost = vec![];
    let count = |wanted: &dyn Fn(&Coordinate) -> bool| model.coordinates().iter().filter(|c| wanted(c)).count();
    let groups = count(&|c| c.groups.is_some() && !motor(c).is_some_and(holds));
    if groups > 0 {
        lost.push(format!("Strength and fatigue of the muscle groups of {groups} coordinates are not written."));
    }
    let patches = model.segments().iter().filter(|segment| !segment.patch.is_empty()).count();
    if patches > 0 {
        lost.push(format!("The patches of {patches} segments, which can rest on something, are not written."));
    }
    let words = count(&|c| !c.positive.is_empty());
    if words > 0 {
        lost.push(format!("The clinical words for the positive direction of {words} coordinates are not written."));
    }
    Ok(lost)
}

/// `a`, `b` and `c`.
fn listed(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}
