//! The program `contrapposto`: ready and relaxed human postures from the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(contrapposto_cli::run(std::env::args_os()))
}
