//! Arguments of the command about plans of many runs.

use std::num::NonZero;
use std::path::PathBuf;

use clap::Parser;

#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  contrapposto sweep scenarios/sweeps/elbow.toml --out out\n\n\
    Writes part-NNNNN-KEY.parquet, some rows each, and at the end sweep.json with the names of all parts and the meaning of the columns. \
    A part appears whole. Ctrl-C, or a kill at any time, loses at most the parts under way; the same command with --resume computes \
    what is missing. The bytes do not depend on threads, kills or resumption.")]
pub(crate) struct SweepArgs {
    /// Plan (TOML): base scenario, parameters, design, rows.
    pub(crate) plan: PathBuf,
    /// Folder for the parts; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Keep the parts of the same plan, scenario and version that DIR has, and compute the others.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Number of threads; all cores when left out.
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZero<usize>>,
}
