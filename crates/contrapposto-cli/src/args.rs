//! What can be asked for on the command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum};
use contrapposto_formats::body::BodyRoot;

/// Ready and relaxed human postures: joint torques, fatigue, and where a tired joint finds relief.
#[derive(Debug, Parser)]
#[command(name = "contrapposto", version, about, max_term_width = 100)]
#[command(after_help = "Example:\n  contrapposto demo --out out\n\nStart with `contrapposto demo`; it needs no file.")]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Run a scenario over time: fatigue, relief, a table and charts.
    Simulate(SimulateArgs),
    /// Run a built-in scenario (the paper's Figure 8); needs no file.
    Demo(DemoArgs),
    /// Solve one posture: supports and tasks in order of priority in, posture out.
    Pose(PoseArgs),
    /// Find the different postures of least effort under the tasks, and say what holds each.
    Relax(RelaxArgs),
    /// Carry out two to five scenarios and show their postures side by side: a picture, and what differs.
    Compare(CompareArgs),
    /// Draw Figures 1 and 7-14 of Rodriguez & Boulic 2007.
    Figures(FiguresArgs),
    /// Decide single joints: one JSON problem a line in, one JSON decision a line out.
    Minimize(MinimizeArgs),
    /// Draw the passive torque of a coordinate, with its limits and source.
    Passive(PassiveArgs),
    /// Show a model: segments, masses, joints, coordinates, what was ignored, and where every number comes from.
    Inspect(InspectArgs),
    /// External, passive and active torque of every coordinate, for one posture or a motion.
    Torques(TorquesArgs),
    /// Which muscle group fails first in a recorded motion, when, and what would relieve it.
    Assess(AssessArgs),
    /// Write a model in another format: OpenSim, URDF or MJCF.
    Convert(ConvertArgs),
    /// Print the JSON Schema of the scenario file.
    #[command(after_help = "Example:\n  contrapposto schema > scenario.schema.json")]
    Schema,
}

#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  contrapposto simulate scenarios/figure-07.toml --out out\n\n\
    Writes into DIR: summary.json, report.html, trajectory.csv, torques.sto, fatigue.sto, decisions.csv, time-line.svg/.png, and for \
    one joint torque-balance.svg/.png, for a body on its supports ground_reaction.mot and postures.svg/.png.\n\
    For other programs the body in motion: motion.glb (glTF: Blender, three.js, viewers), motion.bvh (BVH, in cm: animation programs), \
    motion.mot with model.osim (OpenSim).\n\
    Ctrl-C ends a run with what is done, and a snapshot.json from which --resume goes on to the same bytes.")]
pub(crate) struct SimulateArgs {
    /// Scenario file (TOML); `-` reads standard input.
    pub(crate) scenario: PathBuf,
    /// Folder for the results; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Go on from the snapshot that an interrupted run left in DIR.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Also draw, into DIR/figures, the body at the start, at its hardest and at the end, and of the five joints that matter most
    /// their torques over angle and their course, each as SVG and PNG.
    #[arg(long)]
    pub(crate) figures: bool,
    /// Print the summary as JSON instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  contrapposto demo --out out")]
pub(crate) struct DemoArgs {
    /// Folder for the results; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Print the summary as JSON instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  contrapposto pose scenarios/poses/reach-shelf.toml --out out\n\n\
    Writes pose.json, report.html, pose.mot, pose.csv and pose.svg/.png into DIR. A task that yields to those above it is no failure; supports \
    that cannot hold, and steps that run out, are (exit code 1).")]
pub(crate) struct PoseArgs {
    /// Scenario file (TOML) with tasks; `-` reads standard input.
    pub(crate) scenario: PathBuf,
    /// Folder for the results; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Also draw, into DIR/figures, the torques over angle of the five joints that work hardest, each as SVG and PNG.
    #[arg(long)]
    pub(crate) figures: bool,
    /// Print pose.json instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  contrapposto relax scenarios/stand-relaxed.toml --out out\n  \
    contrapposto relax scenarios/stand-relaxed.toml --json\n\n\
    Searches from starts of both strategies: coordinates at their active goals, at their passive goals, and mirror images. Writes \
    relax.json, report.html, postures.mot, relax.csv and postures.svg/.png into DIR. [strategy], [relief], [fatigue] and [run] have no part in \
    it. Exit code 1 when the supports cannot hold the body in any posture that was tried.")]
pub(crate) struct RelaxArgs {
    /// Scenario file (TOML) with supports and tasks; `-` reads standard input.
    pub(crate) scenario: PathBuf,
    /// Folder for the results; made if it is not there. Nothing is written without it.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Also draw, into DIR/figures, the torques over angle of the five joints that work hardest, each as SVG and PNG.
    #[arg(long, requires = "out")]
    pub(crate) figures: bool,
    /// Print relax.json instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Parser)]
#[command(
    after_help = "Example:\n  contrapposto compare scenarios/stand-ready.toml scenarios/stand-relaxed.toml --out out\n\n\
    A scenario with [run] is simulated, and its last posture taken; one without is posed. Writes compare.json and \
    compare.svg/.png into DIR. Bodies may differ: what has the same name is compared."
)]
pub(crate) struct CompareArgs {
    /// Two to five scenario files (TOML); `-` reads standard input.
    #[arg(required = true, num_args = 2..=5, value_name = "SCENARIO")]
    pub(crate) scenarios: Vec<PathBuf>,
    /// Folder for the results; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Print compare.json instead of tables.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Parser)]
#[command(
    after_help = "Examples:\n  contrapposto figures --out out\n  contrapposto figures --only 7,8 --json --out out\n  \
    contrapposto figures --curve measured --out measured"
)]
pub(crate) struct FiguresArgs {
    /// Folder for the pictures; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Only these figures: 1, 7, 8, 9, 10, 11, 12, 13, 14.
    #[arg(long, value_delimiter = ',', value_name = "N,N")]
    pub(crate) only: Vec<u8>,
    /// Elbow curve: mid-range stiffness 0 as the paper assumes, or the measured 0.4 N m/rad.
    #[arg(long, value_enum, default_value_t = ElbowCurve::Neutral)]
    pub(crate) curve: ElbowCurve,
    /// Print cases and goals as JSON instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The named elbow curve of all figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ElbowCurve {
    /// `elbow_neutral`: mid-range stiffness 0.
    Neutral,
    /// `elbow_flexion`: the measured 0.4 N m/rad.
    Measured,
}

#[derive(Debug, Parser)]
#[command(
    after_help = "Example (one line):\n  echo '{\"passive\": {\"lower\": {\"torque_nm\": 12.67, \"rate_per_rad\": 19.92, \
    \"angle_deg\": 0}, \"upper\": {\"torque_nm\": 9.324, \"rate_per_rad\": 3.811, \"angle_deg\": 150}, \
    \"stiffness_nm_per_rad\": 0.4, \"neutral_deg\": 73}, \"range_deg\": [0, 150], \"angle_deg\": 20, \"external_nm\": -2.7, \
    \"external_slope_nm_per_rad\": 0.9, \"strategy\": \"active\", \"minimum_decrease_ratio\": 0.9, \"tolerance_nm\": 0.05}' \
    | contrapposto minimize"
)]
pub(crate) struct MinimizeArgs {
    /// File of JSON lines; standard input when left out or `-`.
    pub(crate) file: Option<PathBuf>,
    /// Follow the printed Tables 1 and 2 to the letter; outcome `none` where they have no answer.
    #[arg(long)]
    pub(crate) literal: bool,
    /// Print JSON lines (the default and only form; accepted so that scripts may say it).
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Parser)]
#[command(
    after_help = "Examples:\n  contrapposto passive elbow_flex_r --out out\n  contrapposto passive hip_flexion --json\n  \
    contrapposto passive --list"
)]
pub(crate) struct PassiveArgs {
    /// A coordinate of the built-in adult (`elbow_flex_r`) or a built-in curve (`elbow_neutral`).
    #[arg(required_unless_present = "list")]
    pub(crate) coordinate: Option<String>,
    /// List the built-in curves by coordinate, with status and source.
    #[arg(long, conflicts_with_all = ["coordinate", "out"])]
    pub(crate) list: bool,
    /// Folder for the picture (default: this folder); with --json nothing is drawn unless it is given.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print the numbers as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// MODEL and what is laid over it.
#[derive(Debug, clap::Args)]
pub(crate) struct ModelArgs {
    /// Model file (.osim, .urdf, MJCF .xml), or the built-in adult: `adult`, `adult:female,1.65m,60kg`.
    pub(crate) model: PathBuf,
    /// Ranges, passive laws, strength and fatigue by coordinate (TOML), laid over the model.
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) overlay: Option<PathBuf>,
    /// How a URDF or MJCF model's root is attached; as the file says when left out.
    #[arg(long, value_enum)]
    pub(crate) root: Option<RootChoice>,
    /// Passive torque and strength that the file does not have: from the built-in library by name, or none.
    #[arg(long, value_enum)]
    pub(crate) passive: Option<PassiveFrom>,
}

/// How a root is attached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RootChoice {
    /// Fixed to ground.
    Fixed,
    /// Free: columns root_tx .. root_qz, forces root_fx .. root_mz.
    Free,
}

impl RootChoice {
    pub(crate) fn body(self) -> BodyRoot {
        match self {
            Self::Fixed => BodyRoot::Fixed,
            Self::Free => BodyRoot::Free,
        }
    }
}

/// Where passive torque comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PassiveFrom {
    /// What the file (and overlay) do not have is taken from the built-in data, by standard names.
    Library,
    /// Only what the file (and overlay) have.
    File,
}

#[derive(Debug, Parser)]
#[command(
    after_help = "Examples:\n  contrapposto inspect subject.osim\n  contrapposto inspect adult:female,1.65m,60kg --json"
)]
pub(crate) struct InspectArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Print everything as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  contrapposto torques adult default --load \"hand_r 3kg\"\n  \
    contrapposto torques subject.osim gait.mot --grf forces.mot --out torques.csv\n  \
    contrapposto torques robot.urdf pose.csv --root free --gradient --json\n\n\
    Torques act in the direction of their coordinate; external + passive + active = 0.")]
pub(crate) struct TorquesArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Postures: .mot, .sto or .csv, one row a frame; or `default`.
    pub(crate) postures: PathBuf,
    #[command(flatten)]
    pub(crate) under: LoadArgs,
    /// Also d external_i / d q_j.
    #[arg(long)]
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
    contrapposto assess adult standing.csv --support calcn_l,calcn_r --load \"hand_r 3kg\"\n\n\
    Each posture counts as held at rest, and loads change in a straight line from one to the next. Writes assess.json, \
    report.html, torques.sto and fatigue.sto into DIR.")]
pub(crate) struct AssessArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Recorded motion: .mot, .sto or .csv, one row a frame, with times.
    pub(crate) motion: PathBuf,
    #[command(flatten)]
    pub(crate) under: LoadArgs,
    /// Segments that carry the body in every frame; their forces are found, at least effort of the muscles.
    #[arg(long, value_delimiter = ',', value_name = "SEG,SEG", conflicts_with = "grf")]
    pub(crate) support: Vec<String>,
    /// Where a supporting segment touches, corners in its frame (m): "calcn_r 0.1,-0.02,0.04 0.1,-0.02,-0.04 -0.04,-0.02,0".
    #[arg(long, value_name = "PATCH", requires = "support")]
    pub(crate) patch: Vec<String>,
    /// Folder for the results; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Also draw, into DIR/figures, the body at the start, at its hardest and at the end, and of the five joints that fail first
    /// their torques over angle and their course, each as SVG and PNG.
    #[arg(long, requires = "out")]
    pub(crate) figures: bool,
    /// Print assess.json instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What pulls and pushes on a body in given postures, and how those are read.
#[derive(Debug, clap::Args)]
pub(crate) struct LoadArgs {
    /// A held weight, at the segment's centre of mass unless told: "hand_r 3kg", "hand_r 3kg at 0,-0.08,0".
    #[arg(long, value_name = "LOAD")]
    pub(crate) load: Vec<String>,
    /// A force (N) at a point of a segment (m): "hand_r 0,-20,0 at 0,-0.08,0 world" (or segment: its axes).
    #[arg(long, value_name = "FORCE")]
    pub(crate) force: Vec<String>,
    /// Ground reaction forces as OpenSim writes them (ground_force_vx .. ground_torque_z), interpolated in time.
    #[arg(long, value_name = "FILE.mot")]
    pub(crate) grf: Option<PathBuf>,
    /// Segments that the ground reactions act on, in the order of the file's columns; guessed by name when left out.
    #[arg(long, value_delimiter = ',', value_name = "SEG,SEG", requires = "grf")]
    pub(crate) grf_on: Vec<String>,
    /// Angles of the postures are degrees, whatever the file says.
    #[arg(long, conflicts_with = "radians")]
    pub(crate) degrees: bool,
    /// Angles of the postures are radians, whatever the file says.
    #[arg(long)]
    pub(crate) radians: bool,
}

#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  contrapposto convert subject.osim subject.urdf\n\n\
    The format is that of OUT's ending: .osim, .urdf, or .xml (MJCF). What the format cannot say is told.")]
pub(crate) struct ConvertArgs {
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// File to write: .osim, .urdf, or .xml for MJCF.
    pub(crate) out: PathBuf,
}
