//! Arguments of `contrapposto population`.

use std::num::NonZero;
use std::path::PathBuf;

use clap::Parser;
use contrapposto_sweep::MOST_BODIES;

/// Greatest seed: each sex has a seed of its own, twice this one and one more.
const MOST_SEED: i64 = 0x7fff_ffff;

#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  contrapposto population scenarios/hold-tool.toml --out out\n  \
    contrapposto population scenarios/overhead.toml --rows 60 --json\n\n\
    Runs the scenario for half women and half men whose stature, mass, strength and passive torque differ as those of people do, and says \
    which percent of each can hold the job for the time of its [run], with 95 % intervals, who fails first, and the parameters on \
    which the answer depends most. Writes population.json, population.csv (a row a body) and population.html into DIR; DIR/rows has the \
    parts of the sweep. After Ctrl-C or a kill the same command with --resume continues. The bytes do not depend on the number of threads. \
    Exit code 0 whatever the percent is.")]
pub(crate) struct PopulationArgs {
    /// Scenario file (TOML) of `simulate`, of the built-in adult; `-` reads standard input.
    pub(crate) scenario: PathBuf,
    /// Number of bodies, half of them women.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = rows)]
    pub(crate) rows: usize,
    /// Another seed gives other people.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=MOST_SEED))]
    pub(crate) seed: u32,
    /// Folder for the results; made if it is not there. Nothing is written without it.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Keep the bodies of the same scenario, seed and version that DIR has, and compute the others.
    #[arg(long, requires = "out")]
    pub(crate) resume: bool,
    /// Number of threads; all cores when left out.
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZero<usize>>,
    /// Print population.json instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// An even number of bodies.
fn rows(text: &str) -> Result<usize, String> {
    let rows = text.parse::<usize>().ok().filter(|rows| rows % 2 == 0 && (2..=MOST_BODIES).contains(rows));
    rows.ok_or_else(|| format!("an even number from 2 to {MOST_BODIES} is accepted: half are women, half are men"))
}
