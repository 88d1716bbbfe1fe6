//! Runs the program `contrapposto` inside Python, and gives the scenarios that it carries.

use std::ffi::OsString;

use pyo3::prelude::*;

use crate::unlocked::in_background;

/// Carries out a command line, whose first word is the program's name; gives the exit code.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, words: Vec<OsString>) -> PyResult<u8> {
    in_background(py, move |_| contrapposto_cli::run(words))
}

/// Name and text of each scenario of the repository that needs no other file.
#[pyfunction]
pub(crate) fn examples() -> Vec<(&'static str, &'static str)> {
    contrapposto_cli::library::EXAMPLES.to_vec()
}
