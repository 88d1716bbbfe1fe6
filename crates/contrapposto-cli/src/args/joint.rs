//! Arguments of the commands about single joints and published figures.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};

#[derive(Debug, Parser)]
#[command(
    after_help = "Examples:\n  contrapposto figures --out out\n  contrapposto figures --only 7,8 --json --out out\n  \
    contrapposto figures --curve measured --out measured\n\n\
    Each run of a figure starts with tired elbow muscles and ends where it settles. `cases`: of Table 1, in order, with their \
    number of steps. `kink`: the angle between start and end where reshaping makes the passive slope jump. `as printed`: \
    the cases are those of the paper, and a kink occurs exactly where the paper's text names one (Figures 7 and 9)."
)]
pub(crate) struct FiguresArgs {
    /// Folder for the pictures; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Only these figures: 1, 7, 8, 9, 10, 11, 12, 13, 14.
    #[arg(long, value_delimiter = ',', value_name = "N,N")]
    pub(crate) only: Vec<u8>,
    /// Elbow curve, reshaped near both limits: mid-range stiffness 0 as the paper assumes, or the measured 0.4 N m/rad.
    #[arg(long, value_enum, default_value_t = ElbowCurve::Neutral)]
    pub(crate) curve: ElbowCurve,
    /// Print cases, final angles and the comparison with the paper as JSON instead of a table.
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
    | contrapposto minimize\n\n\
    Each answer: `case` of Table 1; `outcome`; `goal_deg`; `active_nm` now and `active_at_goal_nm` at the goal, with the \
    external torque continued as a straight line; `decrease_ratio` R (Eq. 3) in cases 3.1 and 3.2; `interval_deg` that was \
    searched; `stable`, null where the goal is no balance; `why`, one sentence. A line that cannot be read gets `error` and \
    `line`, and the exit code is 2.\n\n\
    Outcomes:\n  \
    stay          the present angle is the goal\n  \
    active        an unstable balance, where muscles work well\n  \
    passive       a stable balance: passive tissue, or the load itself, restores it\n  \
    least_torque  no balance: the goal of case 3.1, or the least active torque in the range\n  \
    at_limit      no balance: the least active torque in the range is at this limit\n  \
    none          only with --literal: the printed tables give no goal"
)]
pub(crate) struct MinimizeArgs {
    /// File of JSON lines, one problem a line; standard input when left out or `-`.
    pub(crate) file: Option<PathBuf>,
    /// Follow the printed Tables 1 and 2 to the letter; outcome `none` where they have no answer.
    #[arg(long)]
    pub(crate) literal: bool,
    /// Print JSON lines: the default, and the only form.
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
    /// Folder for the picture (default: this folder); with --json a picture is drawn only if it is given.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print the numbers as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
