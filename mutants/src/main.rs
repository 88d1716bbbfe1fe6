//! Mutation tests (DeMillo, Lipton & Sayward 1978, "Hints on test data selection"; the changes are those of cargo-mutants).
//!
//! A mutant is one small change of a source: another operator, an operand without its sign, or a function that returns a constant. All
//! mutants drawn are written into one copy of the workspace, each behind a number that the environment names (Untch, Offutt & Harrold
//! 1993, "Mutation analysis using mutant schemata"), so that the copy is compiled once. A run without a mutant notes which tests reach
//! which mutants; then each mutant is tried with the tests that reach it, the fastest first, until one fails.
//!
//! `mutants SEED COUNT FOLDER [NUMBERS...]`: the copy is made in FOLDER, the report printed; with numbers of an earlier report, of these mutants
//! only. Tests that need more than a clone, and tests that take longer than [`judge::LONGEST`] alone, have no part.

mod draw;
mod judge;
mod rewrite;

use std::path::Path;
use std::process::{Command, ExitCode};

/// Folders whose functions are changed: the solver, the science crate and the readers.
const SOURCES: [&str; 3] =
    ["crates/hierarchical-least-squares/src", "crates/contrapposto/src", "crates/contrapposto-formats/src"];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [seed, count, folder, only @ ..] = &arguments[..] else {
        return failed("usage: mutants SEED COUNT FOLDER [NUMBERS...]");
    };
    let only: Result<Vec<usize>, _> = only.iter().map(|number| number.parse()).collect();
    let (Ok(seed), Ok(count), Ok(only)) = (seed.parse(), count.parse(), only) else {
        return failed("SEED, COUNT and NUMBERS are whole numbers");
    };
    if let Some(number) = only.iter().find(|number| **number >= count) {
        return failed(&format!("mutant {number} is not one of {count}; the first is 0"));
    }
    match run((seed, count), Path::new(folder), only) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failed(&error),
    }
}

fn failed(message: &str) -> ExitCode {
    eprintln!("mutants: {message}");
    ExitCode::FAILURE
}

fn run((seed, count): (u64, usize), folder: &Path, only: Vec<usize>) -> Result<(), String> {
    let root = output(Command::new("git").args(["rev-parse", "--show-toplevel"]))?;
    let root = Path::new(root.trim());
    copy(root, folder)?;
    let candidates = draw::candidates(root, &SOURCES)?;
    println!("{} possible changes; {count} of them by seed {seed}", candidates.len());
    let mutants = rewrite::compiled(root, folder, draw::shuffled(candidates, seed), count)?;
    let only = if only.is_empty() { (0..mutants.len()).collect() } else { only };
    judge::judge(folder, &mutants, &only)
}

/// Copies the files that git knows.
fn copy(root: &Path, folder: &Path) -> Result<(), String> {
    let files = output(Command::new("git").arg("-C").arg(root).args(["ls-files", "-z"]))?;
    for file in files.split('\0').filter(|file| !file.is_empty()) {
        let (from, to) = (root.join(file), folder.join(file));
        let complaint = |error: std::io::Error| format!("{file}: {error}");
        std::fs::create_dir_all(to.parent().unwrap_or(folder)).map_err(complaint)?;
        if from.is_symlink() {
            let _ = std::fs::remove_file(&to);
            std::os::unix::fs::symlink(std::fs::read_link(&from).map_err(complaint)?, &to).map_err(complaint)?;
        } else {
            std::fs::copy(&from, &to).map_err(complaint)?;
        }
    }
    Ok(())
}

/// The text that a command prints; its errors where it fails.
fn output(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    if !output.status.success() {
        return Err(format!("{command:?}: {}", String::from_utf8_lossy(&output.stderr)));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
