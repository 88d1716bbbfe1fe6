//! Arguments of the commands about a model file and motions of it.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};
use contrapposto::model::data::FatigueSet;
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::person;
use contrapposto_formats::tissue::{FatigueChoice, FatigueSex, Person};

use super::dynamics::DynamicsArgs;
use super::muscles::MuscleArgs;
use super::support::SupportArgs;
use crate::fail::Fail;

/// MODEL, and the options that complete it.
#[derive(Debug, clap::Args)]
pub(crate) struct ModelArgs {
    /// Model file (.osim, .urdf, MJCF .xml), or the built-in adult: `adult`, `adult:female,1.65m,60kg`, a scenario (.toml) that describes it.
    pub(crate) model: PathBuf,
    /// Ranges, passive laws, strength and fatigue by coordinate (TOML), laid over the model.
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) overlay: Option<PathBuf>,
    /// Attachment of a URDF or MJCF model's root; as the file says when left out.
    #[arg(long, value_enum)]
    pub(crate) root: Option<RootChoice>,
    /// Passive torque and strength that the file does not have: from the built-in library by name, or none.
    #[arg(long, value_enum)]
    pub(crate) passive: Option<PassiveFrom>,
    /// Leave out the strength that a URDF or MJCF file gives to the motors of its joints.
    #[arg(long)]
    pub(crate) no_strength: bool,
    /// The person whom a model file stands for, as the built-in strength and passive torque need: `female,1.65m,60kg`, or some
    /// of them. Without it: a man of the model's mass, and of a stature in proportion to it.
    #[arg(long, value_name = "SEX,STATURE,MASS", value_parser = person)]
    pub(crate) person: Option<Person>,
}

/// Attachment of a root.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RootChoice {
    /// Fixed to ground.
    Fixed,
    /// Free: columns root_tx .. root_qz, forces root_fx .. root_mz.
    Free,
}

impl RootChoice {
    pub(crate) fn body(self) -> RootAttachment {
        match self {
            Self::Fixed => RootAttachment::Fixed,
            Self::Free => RootAttachment::Free,
        }
    }
}

/// Source of passive torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PassiveFrom {
    /// From the built-in data, by standard names, where the file (and overlay) have none.
    Library,
    /// Only what the file (and overlay) have.
    File,
}

/// The fatigue law of the muscle groups.
#[derive(Debug, clap::Args)]
pub(crate) struct FatigueArgs {
    /// Parameters of the three-compartment fatigue law, where an overlay names none.
    #[arg(long, value_enum, value_name = "SET", default_value = "joint")]
    pub(crate) fatigue: ParametersChoice,
    /// Sex whose parameters `muscle_group` takes; that of the body when left out.
    #[arg(long, value_enum, value_name = "SEX")]
    pub(crate) fatigue_sex: Option<FatigueSexChoice>,
}

/// Published parameters of the three-compartment law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum ParametersChoice {
    /// One fit a joint (Frey-Law et al. 2012).
    Joint,
    /// One fit a functional muscle group and sex (Rakshit et al. 2021); movements without a group keep the fit of their joint.
    MuscleGroup,
}

/// Sex whose parameters are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FatigueSexChoice {
    /// Women's.
    Female,
    /// Men's.
    Male,
    /// Both together.
    Any,
}

impl FatigueArgs {
    /// Whether no other parameters are asked for.
    pub(super) fn is_default(&self) -> bool {
        self.fatigue == ParametersChoice::Joint && self.fatigue_sex.is_none()
    }

    pub(crate) fn choice(&self) -> Result<FatigueChoice, Fail> {
        let set = match self.fatigue {
            ParametersChoice::Joint => FatigueSet::Joint,
            ParametersChoice::MuscleGroup => FatigueSet::MuscleGroup,
        };
        if self.fatigue_sex.is_some() && set == FatigueSet::Joint {
            let why = "--fatigue-sex: the parameters of joints are the same for both sexes; add --fatigue muscle_group";
            return Err(Fail::Refused(why.to_owned()));
        }
        let sex = match self.fatigue_sex {
            None => FatigueSex::OfBody,
            Some(FatigueSexChoice::Female) => FatigueSex::Female,
            Some(FatigueSexChoice::Male) => FatigueSex::Male,
            Some(FatigueSexChoice::Any) => FatigueSex::Any,
        };
        Ok(FatigueChoice::ThreeCompartment(set, sex))
    }
}

#[derive(Debug, Parser)]
#[command(
    after_help = "Examples:\n  contrapposto inspect subject.osim\n  contrapposto inspect adult:female,1.65m,60kg --json\n  \
    contrapposto inspect scenarios/lift-box.toml\n\n\
    Of a scenario (.toml): supports, loads, tasks, obstacles and start that it and its things became."
)]
pub(crate) struct InspectArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) fatigue: FatigueArgs,
    /// Draw the body with the names of joints, coordinates and segments into DIR: body.svg and body.png.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print everything as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  contrapposto torques adult default --load \"hand_r 3kg\"\n  \
    contrapposto torques subject.osim gait.mot --grf loads.xml --dynamics --out torques.csv\n  \
    contrapposto torques robot.urdf pose.csv --root free --gradient --json\n\n\
    Inertia counts with --dynamics and, where the motion is fast, without it; a note says so. External torque has it as a part, which \
    inertia_nm shows alone. Otherwise each posture is held at rest.\n\n\
    Torques act in the direction of their coordinate, as OpenSim's generalised forces; external + passive + active = 0. Loads and \
    effort of three-axis joints are those of their moment: --json gives it about their axes.")]
pub(crate) struct TorquesArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Postures: .mot, .sto or .csv, one row a frame; or `default`.
    pub(crate) postures: PathBuf,
    #[command(flatten)]
    pub(crate) muscles: MuscleArgs,
    #[command(flatten)]
    pub(crate) under: LoadArgs,
    #[command(flatten)]
    pub(crate) dynamics: DynamicsArgs,
    /// Also d external_i / d q_j, of postures at rest.
    #[arg(long, conflicts_with = "dynamics")]
    pub(crate) gradient: bool,
    /// Write the table to a file: .csv, .sto or .mot, or .json.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Print JSON, in rad, m, N m, instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  contrapposto assess subject.osim lifting.mot --grf forces.mot --out out\n  \
    contrapposto assess adult standing.csv --support calcn_l,calcn_r --load \"hand_r 3kg\"\n  \
    contrapposto assess adult lift.csv --support calcn_l,calcn_r --repeat 8h --every 20s --work 50min --break 10min\n\n\
    Inertia counts where the motion is fast, or with --dynamics; otherwise each posture is held at rest. Loads are interpolated linearly \
    between postures. Writes assess.json, \
    report.html, torques.sto, fatigue.sto and motion.glb into DIR.")]
pub(crate) struct AssessArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) fatigue: FatigueArgs,
    /// Recorded motion: .mot, .sto or .csv, one row a frame, with times.
    pub(crate) motion: PathBuf,
    #[command(flatten)]
    pub(crate) muscles: MuscleArgs,
    #[command(flatten)]
    pub(crate) under: LoadArgs,
    #[command(flatten)]
    pub(crate) dynamics: DynamicsArgs,
    #[command(flatten)]
    pub(crate) repeat: super::RepeatArgs,
    /// Cycles of the motion: the length of each from the start on, s (1.12); or the starts of all and the end of the last one (0.62,1.74,2.85);
    /// or `find` (none found is an error); or `none`. Report and JSON have the mean and the standard deviation of angles, torques and loads over
    /// them. Without it a cycle goes from a landing of a foot to its next one, or else from where the angles come back to where they do again.
    #[arg(long, value_name = "S", value_parser = super::repeat::cycles, allow_hyphen_values = true)]
    pub(crate) cycles: Option<super::CyclesChoice>,
    #[command(flatten)]
    pub(crate) carried: SupportArgs,
    /// Error of the given angles: muscles that work against the ligaments of their own joint are judged at the angle within it where they work
    /// least. 5 for measured angles; 0 for a file of this program that holds the built-in adult, whose motions are exact.
    #[arg(long, value_name = "DEG", value_parser = angle_error, allow_hyphen_values = true)]
    pub(crate) angle_error: Option<f64>,
    /// Folder for the results; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Draw and write nothing, as without --out.
    #[arg(long, conflicts_with_all = ["out", "figures"])]
    pub(crate) no_report: bool,
    /// Also draw, into DIR/figures, the body at the start, at its hardest and at the end, and of the five joints that fail first
    /// their torques over angle and their course, each as SVG and PNG.
    #[arg(long, requires = "out")]
    pub(crate) figures: bool,
    /// Print assess.json instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the built-in adult as a wooden figure into .glb, without a skin; other bodies have none.
    #[arg(long)]
    pub(crate) wooden: bool,
    #[command(flatten)]
    pub(crate) suggest: super::SuggestArgs,
}

/// Greatest error of angles that is accepted, deg: no method of measurement is worse.
const MOST_ANGLE_ERROR: f64 = 20.0;

/// The error of angles, deg.
fn angle_error(text: &str) -> Result<f64, String> {
    let error = text.parse().ok().filter(|error| (0.0..=MOST_ANGLE_ERROR).contains(error));
    error.ok_or_else(|| format!("an error of angles lies between 0 and {MOST_ANGLE_ERROR} deg"))
}

/// Loads on a body in given postures, and the unit of the postures.
#[derive(Debug, clap::Args)]
pub(crate) struct LoadArgs {
    /// A held weight, at the segment's centre of mass unless a point is given: "hand_r 3kg", "hand_r 3kg at 0,-0.08,0".
    #[arg(long, value_name = "LOAD")]
    pub(crate) load: Vec<String>,
    /// A force (N) at a point of a segment (m): "hand_r 0,-20,0 at 0,-0.08,0 world" (or segment: its axes).
    #[arg(long, value_name = "FORCE")]
    pub(crate) force: Vec<String>,
    /// Ground reaction forces as OpenSim writes them (ground_force_vx .. ground_torque_z), interpolated in time; or OpenSim's ExternalLoads
    /// file (.xml), which names them and their segments; or a C3D file with force plates of types 1 to 4, each stance on the foot that is nearest
    /// to it.
    #[arg(long, value_name = "FILE")]
    pub(crate) grf: Option<PathBuf>,
    /// Segments that the ground reactions act on, in the order of the file's columns; guessed by name when left out.
    #[arg(long, value_delimiter = ',', value_name = "SEG,SEG", requires = "grf")]
    pub(crate) grf_on: Vec<String>,
    /// Natural cubic splines between the times of --grf, as OpenSim has them, in place of straight lines. They ring where a foot lands.
    #[arg(long, requires = "grf")]
    pub(crate) grf_splines: bool,
    /// The segment that a force plate of the C3D file of --grf acts on: 1=calcn_r, or 2=none for a plate that does not act on the body.
    #[arg(long, value_name = "NUMBER=SEG", requires = "grf")]
    pub(crate) plate: Vec<String>,
    #[command(flatten)]
    pub(crate) frames: FrameArgs,
}

/// The frames of a motion, and the unit of its angles.
#[derive(Debug, clap::Args)]
pub(crate) struct FrameArgs {
    /// Leave out the instants before this time, s.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) from: Option<f64>,
    /// Leave out the instants after this time, s.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) to: Option<f64>,
    /// Angles of the postures are degrees, whatever the file says.
    #[arg(long, conflicts_with = "radians")]
    pub(crate) degrees: bool,
    /// Angles of the postures are radians, whatever the file says.
    #[arg(long)]
    pub(crate) radians: bool,
}

#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  contrapposto convert subject.osim subject.urdf\n\n\
    The format is that of OUT's ending: .osim, .urdf, or .xml (MJCF). Parts that the format cannot express are listed.")]
pub(crate) struct ConvertArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// File to write: .osim, .urdf, or .xml for MJCF.
    pub(crate) out: PathBuf,
}
