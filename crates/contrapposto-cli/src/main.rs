//! `contrapposto`: ready and relaxed human postures from the command line.
//!
//! Results go to standard output, progress and complaints to standard error. Exit codes: 0 done, 1 the job failed, 2 bad
//! input. A closed pipe is no failure.

mod args;
mod commands;
mod fail;
mod input;
mod interruption;
mod model_file;
mod motion_file;
mod output;
mod progress;
mod scenario_file;
mod view;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Verb};
use commands::{
    assess, compare, convert, figures, inspect, minimize, muscles, new, passive, pose, relax, simulate, torques,
};
use output::Notes;

fn main() -> ExitCode {
    interruption::tell_file_size_limit();
    let args = Args::parse();
    output::show_notes(match (args.verbose, args.quiet) {
        (true, _) => Notes::All,
        (_, true) => Notes::Quiet,
        _ => Notes::Folded,
    });
    input::allow(args.allow_path);
    let result = match args.verb {
        Verb::New(args) => new::new(&args),
        Verb::Simulate(args) => simulate::simulate(&args),
        Verb::Demo(args) => simulate::demo(&args),
        Verb::Pose(args) => pose::pose(&args),
        Verb::Relax(args) => relax::relax(&args),
        Verb::Compare(args) => compare::compare(&args),
        Verb::Figures(args) => figures::figures(&args),
        Verb::Minimize(args) => minimize::minimize(&args),
        Verb::Passive(args) => passive::passive(&args),
        Verb::Inspect(args) => inspect::inspect(&args),
        Verb::Torques(args) => torques::torques(&args),
        Verb::Muscles(args) => muscles::muscles(&args),
        Verb::Assess(args) => assess::assess(&args),
        Verb::Convert(args) => convert::convert(&args),
        Verb::Schema => output::print(&format!("{:#}\n", contrapposto_formats::scenario_schema())),
    };
    output::print_waiting_notes();
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(fail) => fail.report(),
    }
}
