//! The command line: one command, its arguments.

mod capacity;
mod dynamics;
mod joint;
mod model;
mod muscles;
mod musculature;
mod population;
mod repeat;
mod scale;
mod scenario;
mod studio;
mod support;
mod sweep;
mod time;
mod track;

use std::path::PathBuf;

use clap::{Parser, Subcommand};

pub(crate) use capacity::CapacityArgs;
pub(crate) use dynamics::{CutOff, DynamicsArgs};
pub(crate) use joint::{ElbowCurve, FiguresArgs, MinimizeArgs, PassiveArgs};
pub(crate) use model::{
    AssessArgs, ConvertArgs, FrameArgs, InspectArgs, LoadArgs, ModelArgs, PassiveFrom, RootChoice, TorquesArgs,
};
pub(crate) use muscles::use_muscles;
pub(crate) use musculature::{MusclesArgs, OneMuscleArgs, RuleChoice};
pub(crate) use population::PopulationArgs;
pub(crate) use repeat::{CyclesChoice, RepeatArgs};
pub(crate) use scale::ScaleArgs;
pub(crate) use scenario::{CompareArgs, DemoArgs, JobChoice, NewArgs, PoseArgs, RelaxArgs, SimulateArgs, SuggestArgs};
pub(crate) use studio::StudioArgs;
pub(crate) use sweep::SweepArgs;
pub(crate) use track::{TrackArgs, UnitChoice, UpChoice};

/// Ready and relaxed human postures: joint torques, fatigue, and where a tired joint finds relief.
#[derive(Debug, Parser)]
#[command(name = "contrapposto", version, about, max_term_width = 100)]
#[command(after_help = "Example:\n  contrapposto demo --out out\n\nStart with `contrapposto demo`; it needs no file.")]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) verb: Verb,
    /// Show all notes; without it the most important ones and the number of the others. Warnings are always shown.
    #[arg(long, global = true)]
    pub(crate) verbose: bool,
    /// Show no notes. Warnings are always shown.
    #[arg(long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// A folder whose files a scenario may name, too; without it those in the scenario's own folder and below. May be repeated.
    #[arg(long, global = true, value_name = "DIR")]
    pub(crate) allow_path: Vec<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Write a commented scenario to begin with: lift, overhead, sit, push, stand or carry.
    New(NewArgs),
    /// Run a scenario over time: fatigue, relief, a table and charts.
    Simulate(SimulateArgs),
    /// Show a person who waits, tires and rests a leg; needs no file.
    Demo(DemoArgs),
    /// Solve one posture: supports and tasks in order of priority in, posture out.
    Pose(PoseArgs),
    /// Find the different postures of least effort under the tasks, and their stability.
    Relax(RelaxArgs),
    /// Carry out two to five scenarios and show their postures side by side: a picture, and the differences.
    Compare(CompareArgs),
    /// Run a scenario for many bodies, loads or other values, as a plan says, on all cores; the answers as a table.
    Sweep(SweepArgs),
    /// The percent of women and of men who can hold a job for the asked time, who fails first, and the parameters that count most.
    Population(PopulationArgs),
    /// The greatest force at a hand in every direction: by joint strength, balance, friction and, held for a time, fatigue.
    Capacity(CapacityArgs),
    /// Draw Figures 1 and 7-14 of Rodriguez & Boulic 2007.
    Figures(FiguresArgs),
    /// Decide single joints: one JSON problem a line in, one JSON decision a line out.
    Minimize(MinimizeArgs),
    /// Draw the passive torque of a coordinate, with its limits and source.
    Passive(PassiveArgs),
    /// Show a model: segments, masses, joints, coordinates, notes about ignored parts, and the source of every number. Or a scenario:
    /// its supports, loads, tasks and obstacles.
    Inspect(InspectArgs),
    /// External, passive and active torque of every coordinate, for one posture or a motion.
    Torques(TorquesArgs),
    /// Path, forces and moment arms of every muscle of an OpenSim or MJCF model, and the strength of its joints, for one posture or a motion.
    Muscles(MusclesArgs),
    /// Path, moment arms, fibres and forces of one muscle in a posture, and its force-length curves with the present state.
    Muscle(OneMuscleArgs),
    /// Scale an OpenSim model to a person by the markers of a static trial (.trc, .c3d) and the setup file of OpenSim's ScaleTool.
    Scale(ScaleArgs),
    /// Find the motion of an OpenSim model whose markers lie nearest to measured ones (.trc, .c3d): inverse kinematics. Or that of the built-in
    /// adult which moves as an animation (.bvh, .glb).
    Track(TrackArgs),
    /// Find the muscle group that fails first in a recorded motion, when, and which change of posture would relieve it.
    Assess(AssessArgs),
    /// Write a model in another format: OpenSim, URDF or MJCF.
    Convert(ConvertArgs),
    /// Open the studio, a page in which a body is taken by the hand, tires and rests.
    Studio(StudioArgs),
    /// Print the JSON Schema of the scenario file.
    #[command(after_help = "Example:\n  contrapposto schema > scenario.schema.json")]
    Schema,
}
