//! Reads animations of jointed rigs ([`read_bvh`], [`read_gltf`]) and carries them over to the built-in adult ([`Fitted`]).
//!
//! A rig's joints are found by the names of known programs ([`Assignment::find`]), or by a file of names ([`read_rig_names`]). Its rest pose tells which
//! way is up and ahead, and how each bone lies to the adult's segment; its legs tell the unit.

mod axes;
mod branches;
mod bvh;
mod fit;
mod gltf;
mod gltf_data;
mod json;
mod names;
mod names_file;
mod size;
mod targets;

pub use axes::RigAxes;
pub use branches::settle_branches;
pub use bvh::read_bvh;
pub use fit::{Fitted, RigError};
pub use gltf::read_gltf;
pub use gltf_data::GltfError;
pub use names::{Assignment, MissingJoints, names_template};
pub use names_file::read_rig_names;
pub use size::{RigUnit, Sizing};
pub use targets::Targets;

use contrapposto::model::Placement;
use nalgebra::{Translation3, UnitQuaternion, Vector3};

/// One number of a joint in each frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Place along an axis (0 to 2), in the place of the offset.
    Place(usize),
    /// Turn about an axis (0 to 2).
    Turn(usize),
}

/// A joint of a rig.
#[derive(Clone, Debug, PartialEq)]
pub struct RigJoint {
    /// Name, as the file has it.
    pub name: String,
    /// Index of the joint that carries it, always a smaller one.
    pub parent: Option<usize>,
    /// Place in the parent's axes at rest, units of the file.
    pub offset: Vector3<f64>,
    /// Turn against the parent's axes at rest, and of a joint without channels that turn it.
    pub rest: UnitQuaternion<f64>,
    /// Channels, in the order in which the file has them.
    pub channels: Vec<Channel>,
    /// Number of the first of them in a frame.
    pub first: usize,
}

/// A rig and its motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Joints, parents before children.
    pub joints: Vec<RigJoint>,
    /// Ends of last joints: index of the joint, place in its axes.
    pub ends: Vec<(usize, Vector3<f64>)>,
    /// Time between frames, s.
    pub frame_time: f64,
    /// Channels of each frame: units of the file, rad.
    pub frames: Vec<Vec<f64>>,
    /// Faults of a file that can be read nevertheless, a sentence each.
    pub warnings: Vec<String>,
}

impl Rig {
    /// The joint of that name.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// Whether `above` is `joint` or carries it.
    pub fn carries(&self, above: usize, joint: usize) -> bool {
        self.chain(joint).any(|j| j == above)
    }

    /// A joint, the one that carries it, and so on.
    pub fn chain(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(joint), |&j| self.joints[j].parent)
    }

    /// Places all joints in the axes of the file: in a frame, or at rest (in a .bvh file: all angles 0) without one.
    pub fn place(&self, frame: Option<usize>, placed: &mut Vec<Placement>) {
        placed.clear();
        let values = frame.and_then(|frame| self.frames.get(frame));
        for joint in &self.joints {
            let turns = values.is_some() && joint.channels.iter().any(|channel| matches!(channel, Channel::Turn(_)));
            let (mut at, mut turn) = (joint.offset, if turns { UnitQuaternion::identity() } else { joint.rest });
            for (channel, value) in joint.channels.iter().zip(values.into_iter().flat_map(|v| &v[joint.first..])) {
                match *channel {
                    Channel::Place(axis) => at[axis] = *value,
                    Channel::Turn(axis) => turn *= UnitQuaternion::from_axis_angle(&FILE_AXES[axis], *value),
                }
            }
            let own = Placement::from_parts(Translation3::from(at), turn);
            placed.push(joint.parent.map_or(own, |parent| placed[parent] * own));
        }
    }
}

/// The axes of a file by number.
const FILE_AXES: [nalgebra::UnitVector3<f64>; 3] = [
    nalgebra::UnitVector3::new_unchecked(Vector3::new(1.0, 0.0, 0.0)),
    nalgebra::UnitVector3::new_unchecked(Vector3::new(0.0, 1.0, 0.0)),
    nalgebra::UnitVector3::new_unchecked(Vector3::new(0.0, 0.0, 1.0)),
];
