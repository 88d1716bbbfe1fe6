//! Arguments of marker tracking.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};
use contrapposto_formats::markers::MarkerUnit;

use super::model::ModelArgs;

#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  contrapposto track subject.osim walk.trc --out out\n  \
    contrapposto track subject.osim walk.trc --tasks Setup_IK.xml --out out\n  \
    contrapposto assess subject.osim out/motion.mot --grf walk_grf.xml --out report\n  \
    contrapposto track adult walk.bvh --out out\n\n\
    The weighted squared distances of the markers, and the weighted squared errors of coordinates with a task, are least at every instant, as in \
    OpenSim's inverse kinematics. Locked coordinates keep their default, and ranges of clamped ones are hard limits. Writes motion.mot \
    and marker-errors.sto into DIR.\n\n\
    An animation (.bvh, .glb, .gltf; names of Mixamo, CMU and others, or --rig) moves the adult: `adult` gets the bones of the rig, `adult:female,1.65m,60kg` stays as \
    it is. adult.toml, written beside motion.mot, is that adult, as MODEL of `assess` and others.")]
pub(crate) struct TrackArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Measured markers (.trc, .c3d); or an animation (.bvh, .glb, .gltf), which moves the built-in adult.
    pub(crate) markers: PathBuf,
    /// OpenSim's IKTaskSet, or the setup file (.xml) that holds one: weights of markers, and coordinates with wanted values. Without it
    /// every marker that file and model have counts the same.
    #[arg(long, value_name = "SET.xml")]
    pub(crate) tasks: Option<PathBuf>,
    /// Joints of an animation by the adult's segments (TOML: hand_r = "RightHand"), where their names are not known.
    #[arg(long, value_name = "NAMES.toml", conflicts_with = "tasks")]
    pub(crate) rig: Option<PathBuf>,
    /// Unit of the markers, whatever the file says; of an animation, whatever its legs say.
    #[arg(long, value_enum)]
    pub(crate) units: Option<UnitChoice>,
    /// The axis of the laboratory that points up: places of markers are turned so that it points against the gravity of the model. Without it that of
    /// a C3D file with force plates or a screen axis; other files are taken as they are.
    #[arg(long, value_enum, conflicts_with = "rig")]
    pub(crate) up: Option<UpChoice>,
    /// Leave out the instants before this time, s; as the setup file says when left out.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) from: Option<f64>,
    /// Leave out the instants after this time, s; as the setup file says when left out.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) to: Option<f64>,
    /// Folder for the results; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// Unit of markers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum UnitChoice {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
}

/// The upward axis of a laboratory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum UpChoice {
    /// x
    X,
    /// y, as in OpenSim.
    Y,
    /// z
    Z,
}

impl UpChoice {
    pub(crate) fn axis(self) -> nalgebra::Vector3<f64> {
        match self {
            Self::X => nalgebra::Vector3::x(),
            Self::Y => nalgebra::Vector3::y(),
            Self::Z => nalgebra::Vector3::z(),
        }
    }
}

impl UnitChoice {
    pub(crate) fn unit(self) -> MarkerUnit {
        match self {
            Self::Mm => MarkerUnit::Millimetre,
            Self::Cm => MarkerUnit::Centimetre,
            Self::M => MarkerUnit::Metre,
        }
    }
}
