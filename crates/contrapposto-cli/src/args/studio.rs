//! Arguments of `studio`.

use std::path::PathBuf;

use clap::Args;

/// Opens the studio in the browser: a page on this machine, which sends nothing anywhere.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  contrapposto studio scenarios/stand-relaxed.toml")]
pub(crate) struct StudioArgs {
    /// Scenario (.toml) to begin with; without it a standing adult.
    pub(crate) scenario: Option<PathBuf>,
    /// Folder of the built page; without it `web/dist` beside the program or in the present folder.
    #[arg(long, value_name = "DIR")]
    pub(crate) page: Option<PathBuf>,
    /// Port on this machine; 0 for one that is free.
    #[arg(long, value_name = "NUMBER", default_value_t = 0)]
    pub(crate) port: u16,
    /// Only print the address.
    #[arg(long)]
    pub(crate) no_browser: bool,
}
