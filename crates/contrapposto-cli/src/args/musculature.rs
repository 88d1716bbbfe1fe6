//! Arguments of the commands about the muscles of a model.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};

use super::model::{FatigueArgs, FrameArgs, LoadArgs, ModelArgs};
use super::muscles::{SharingArgs, SharingChoice};
use super::support::SupportArgs;
use super::time::time;
use crate::fail::Fail;

#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  contrapposto muscles gait2392.osim\n  \
    contrapposto muscles subject.osim gait.mot --json > muscles.jsonl\n  \
    contrapposto muscles myo_sim/leg/myolegs.xml --json\n  \
    contrapposto muscles subject.osim crouch.csv --support calcn_l,calcn_r --hold 10min\n\n\
    Fibres and tendons are in equilibrium at rest. A moment arm is the torque about a coordinate for each newton of tension; those of \
    coordinates that follow others are part of theirs. Muscles of an MJCF file have MuJoCo's curves and a rigid tendon. Strength \
    is a plain sum, muscles that pull one way at full activation and all others at --activation; and a coupled one, the greatest torque while the muscles give no torque about any other joint.")]
pub(crate) struct MusclesArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Postures: .mot, .sto or .csv, one row a frame; or `default`.
    #[arg(default_value = "default")]
    pub(crate) postures: PathBuf,
    #[command(flatten)]
    pub(crate) hold: HoldArgs,
    /// The rule by which paths lie on the surfaces that they wrap over; tendons of MJCF files have MuJoCo's always.
    #[arg(long, value_enum, default_value = "geodesic", conflicts_with = "hold")]
    pub(crate) rule: RuleChoice,
    /// Activation of all muscles, 0 to 1; a muscle with a least activation of its own has at least that.
    #[arg(long, value_name = "A", default_value_t = 0.01, value_parser = activation, conflicts_with = "hold")]
    pub(crate) activation: f64,
    /// Print one line of JSON a posture, in rad, m, N, N m, instead of tables.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  contrapposto muscle gait2392.osim soleus_r\n  \
    contrapposto muscle gait2392.osim rect_fem_r crouch.csv --out out\n\n\
    --out draws the forces of the fibres against their length, with the present state at --activation and at full activation.")]
pub(crate) struct OneMuscleArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Name of the muscle in the file.
    pub(crate) name: String,
    /// Posture: .mot, .sto or .csv of one row, or one that --from and --to select; or `default`.
    #[arg(default_value = "default")]
    pub(crate) posture: PathBuf,
    #[command(flatten)]
    pub(crate) frames: FrameArgs,
    /// The rule by which its path lies on the surfaces that it wraps over; a tendon of an MJCF file has MuJoCo's always.
    #[arg(long, value_enum, default_value = "geodesic")]
    pub(crate) rule: RuleChoice,
    /// Activation, 0 to 1; a muscle with a least activation of its own has at least that.
    #[arg(long, value_name = "A", default_value_t = 0.01, value_parser = activation)]
    pub(crate) activation: f64,
    /// Draw the force-length curves into DIR: muscle-NAME.svg and .png.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print JSON, in m, N and rad, instead of tables.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The rule by which a path lies on its surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RuleChoice {
    /// Shortest lines: moment arms are minus the derivatives of the length.
    Geodesic,
    /// OpenSim's lines and moment arms, for comparisons with it.
    Opensim,
}

fn activation(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|a| (0.0..=1.0).contains(a))
        .ok_or_else(|| "an activation is a number from 0 to 1".to_owned())
}

/// A posture that muscles hold: the time, the loads and the supports.
#[derive(Debug, clap::Args)]
pub(crate) struct HoldArgs {
    /// Hold one posture for TIME, or until the muscles fail, each with its own fatigue: "30s", "10min", "1.5h". The answer says how long, which
    /// muscle is exhausted first, and which others take over. Loads, supports and fatigue below count with it only.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) hold: Option<f64>,
    #[command(flatten)]
    pub(crate) under: LoadArgs,
    #[command(flatten)]
    pub(crate) carried: SupportArgs,
    #[command(flatten)]
    pub(crate) fatigue: FatigueArgs,
    #[command(flatten)]
    pub(crate) sharing: SharingArgs,
}

impl HoldArgs {
    /// Refuses arguments that count with --hold only.
    pub(crate) fn refuse_without_hold(&self) -> Result<(), Fail> {
        let Self { under, carried, fatigue, sharing, .. } = self;
        let given = [
            ("--load", !under.load.is_empty()),
            ("--force", !under.force.is_empty()),
            ("--grf", under.grf.is_some()),
            ("--support", !carried.support.is_empty()),
            ("--fixed-root", carried.fixed_root),
            ("--fatigue", !fatigue.is_default()),
            ("--sharing", sharing.sharing != SharingChoice::Squares),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((name, _)) => Err(Fail::Refused(format!(
                "{name}: counts for a posture that is held; add --hold TIME, or leave it out: lengths and forces of muscles at rest do not \
                 depend on it"
            ))),
            None => Ok(()),
        }
    }
}
