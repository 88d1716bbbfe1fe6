//! The program `contrapposto` as a library: its commands as they are typed, and their results as values for other programs.
//!
//! Results go to standard output, progress and complaints to standard error. Exit codes: 0 done, 1 the job failed, 2 bad
//! input. A closed pipe is no failure.

/// The text of a scenario of the repository, by its name; `build.rs` says where it is.
macro_rules! scenario {
    ($name:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), env!("CONTRAPPOSTO_SCENARIOS"), $name, ".toml"))
    };
}

mod args;
mod commands;
mod fail;
mod input;
mod interruption;
pub mod library;
mod model_file;
mod motion_file;
mod moving;
mod output;
mod progress;
mod scenario_file;
mod view;

use std::ffi::OsString;

use clap::Parser;

use args::{Args, Verb};
use commands::{
    animation, assess, capacity, compare, convert, figures, inspect, minimize, muscles, new, passive, population, pose,
    relax, scale, simulate, studio, sweep, torques, track,
};
use input::is_animation;
use output::Notes;

/// Carries out a command line, whose first word is the program's name; gives the exit code.
pub fn run(words: impl IntoIterator<Item = OsString>) -> u8 {
    interruption::tell_file_size_limit();
    let args = match Args::try_parse_from(words) {
        Ok(args) => args,
        Err(error) => {
            // Nothing is left to try when the terminal is closed. Help and version are errors to the parser, with code 0.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
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
        Verb::Capacity(args) => capacity::capacity(&args),
        Verb::Sweep(args) => sweep::sweep(&args),
        Verb::Population(args) => population::population(&args),
        Verb::Figures(args) => figures::figures(&args),
        Verb::Minimize(args) => minimize::minimize(&args),
        Verb::Passive(args) => passive::passive(&args),
        Verb::Inspect(args) => inspect::inspect(&args),
        Verb::Torques(args) => torques::torques(&args),
        Verb::Muscles(args) => muscles::muscles(&args),
        Verb::Muscle(args) => muscles::one::muscle(&args),
        Verb::Scale(args) => scale::scale(&args),
        Verb::Track(args) if is_animation(&args.markers) => animation::animation(&args),
        Verb::Track(args) => track::track(&args),
        Verb::Assess(args) => assess::assess(&args),
        Verb::Convert(args) => convert::convert(&args),
        Verb::Studio(args) => studio::studio(&args),
        Verb::Schema => output::print(&format!("{:#}\n", contrapposto_formats::scenario_schema())),
    };
    output::print_waiting_notes();
    match result {
        Ok(()) => 0,
        Err(fail) => fail.report(),
    }
}
