//! Arguments of the commands about scenario files.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};

#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  contrapposto simulate scenarios/figure-07.toml --out out\n\n\
    Writes into DIR: summary.json, report.html, trajectory.csv, torques.sto, fatigue.sto, decisions.csv, time-line.svg/.png, and for \
    one joint torque-balance.svg/.png, for a body on its supports ground_reaction.mot and postures.svg/.png.\n\
    For other programs the body in motion: motion.glb (glTF: Blender, three.js, viewers; the built-in adult has a skin), motion.bvh (BVH, in cm: animation programs), \
    motion.mot with model.osim (OpenSim).\n\
    Ctrl-C ends a run, writes the results so far, and a snapshot.json from which --resume continues to the same bytes.")]
pub(crate) struct SimulateArgs {
    /// Scenario file (TOML); `-` reads standard input.
    pub(crate) scenario: PathBuf,
    /// Start in the posture of a result: the coordinates of a pose.json, or of the first posture of a relax.json.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) start_from: Option<PathBuf>,
    /// Folder for the results; made if it is not there. Nothing is written without it: the answer goes to standard output only.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Draw and write nothing, as without --out.
    #[arg(long, conflicts_with_all = ["out", "resume", "figures"])]
    pub(crate) no_report: bool,
    /// Continue from the snapshot that an interrupted run left in DIR.
    #[arg(long, requires = "out")]
    pub(crate) resume: bool,
    /// Also draw, into DIR/figures, the body at the start, at its hardest and at the end, and of the five joints that matter most
    /// their torques over angle and their course, each as SVG and PNG.
    #[arg(long, requires = "out")]
    pub(crate) figures: bool,
    /// Also search for the largest load, by runs of the job with other loads: the one that a person of mean strength holds for the time
    /// asked, and the one of weaker people. No further run begins after as many solver steps as for changes (`--suggest-steps`), counted anew.
    #[arg(long)]
    pub(crate) largest_load: bool,
    /// Print the summary as JSON instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the built-in adult as a wooden figure into .glb, without a skin; other bodies have none.
    #[arg(long)]
    pub(crate) wooden: bool,
    #[command(flatten)]
    pub(crate) suggest: SuggestArgs,
}

/// Changes of the job that are tried.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub(crate) struct SuggestArgs {
    /// Do not try changes of a job that does not hold with reserve. Each is a job of its own.
    #[arg(long)]
    pub(crate) no_suggest: bool,
    /// Begin no further trial of a change after so many solver steps; without it twice those of the job itself, 150,000 at least.
    #[arg(long, value_name = "N", conflicts_with = "no_suggest")]
    pub(crate) suggest_steps: Option<usize>,
}

#[derive(Debug, Parser)]
#[command(
    after_help = "Examples:\n  contrapposto new lift --out job.toml\n  contrapposto simulate job.toml --out out\n\n\
    The file is a commented scenario that runs as it is. An existing file is not overwritten."
)]
pub(crate) struct NewArgs {
    /// The job.
    #[arg(value_enum)]
    pub(crate) job: JobChoice,
    /// File to write.
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) out: PathBuf,
}

/// A job that a new scenario begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum JobChoice {
    /// A box held in two hands.
    Lift,
    /// A tool overhead.
    Overhead,
    /// Sitting at a desk.
    Sit,
    /// Pushing at a handle.
    Push,
    /// Standing at a counter.
    Stand,
    /// Carrying a bag.
    Carry,
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
    /// The elbow of the paper's Figure 8 instead of a whole person.
    #[arg(long = "figure-8")]
    pub(crate) figure_8: bool,
}

#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  contrapposto pose scenarios/poses/reach-shelf.toml --out out\n\n\
    Writes pose.json, report.html, pose.mot, pose.csv, pose.svg/.png and pose.glb/.bvh into DIR. A task that yields to tasks of higher priority is no failure; \
    supports that cannot hold, and the step limit, are (exit code 1).")]
pub(crate) struct PoseArgs {
    /// Scenario file (TOML) with tasks; `-` reads standard input.
    pub(crate) scenario: PathBuf,
    /// Start in the posture of a result: the coordinates of a pose.json, or of the first posture of a relax.json.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) start_from: Option<PathBuf>,
    /// Folder for the results; made if it is not there. Nothing is written without it: the answer goes to standard output only.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Draw and write nothing, as without --out.
    #[arg(long, conflicts_with_all = ["out", "figures"])]
    pub(crate) no_report: bool,
    /// Also draw, into DIR/figures, the torques over angle of the five joints that work hardest, each as SVG and PNG.
    #[arg(long, requires = "out")]
    pub(crate) figures: bool,
    /// Print pose.json instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the built-in adult as a wooden figure into .glb, without a skin; other bodies have none.
    #[arg(long)]
    pub(crate) wooden: bool,
    #[command(flatten)]
    pub(crate) suggest: SuggestArgs,
}

#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  contrapposto relax scenarios/stand-relaxed.toml --out out\n  \
    contrapposto relax scenarios/stand-relaxed.toml --json\n\n\
    Searches from starts of both strategies: coordinates at their active goals, at their passive goals, and mirror images. Writes \
    relax.json, report.html, postures.mot, relax.csv, postures.svg/.png and postures.glb/.bvh into DIR. [strategy], [relief], [fatigue] and [run] are \
    ignored. Exit code 1 when the supports cannot hold the body in any posture that was tried.")]
pub(crate) struct RelaxArgs {
    /// Scenario file (TOML) with supports and tasks; `-` reads standard input.
    pub(crate) scenario: PathBuf,
    /// Start in the posture of a result: the coordinates of a pose.json, or of the first posture of a relax.json.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) start_from: Option<PathBuf>,
    /// Folder for the results; made if it is not there. Nothing is written without it.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Draw and write nothing, as without --out.
    #[arg(long, conflicts_with_all = ["out", "figures"])]
    pub(crate) no_report: bool,
    /// Also draw, into DIR/figures, the torques over angle of the five joints that work hardest, each as SVG and PNG.
    #[arg(long, requires = "out")]
    pub(crate) figures: bool,
    /// Print relax.json instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the built-in adult as a wooden figure into .glb, without a skin; other bodies have none.
    #[arg(long)]
    pub(crate) wooden: bool,
    #[command(flatten)]
    pub(crate) suggest: SuggestArgs,
}

#[derive(Debug, Parser)]
#[command(
    after_help = "Example:\n  contrapposto compare scenarios/stand-ready.toml scenarios/stand-relaxed.toml --out out\n\n\
    A scenario with [run] is simulated, and its last posture taken; one without is posed. Writes compare.json and \
    compare.svg/.png into DIR. Bodies may differ: coordinates and muscle groups of the same name are compared."
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
