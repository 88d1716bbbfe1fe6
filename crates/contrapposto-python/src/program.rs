//! Runs the program `contrapposto` inside Python.

use std::ffi::OsString;

use pyo3::prelude::*;

use crate::unlocked::in_background;

/// Carries out a command line, whose first word is the program's name; gives the exit code.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, words: Vec<OsString>) -> PyResult<u8> {
    in_background(py, move |_| contrapposto_cli::run(words))
}
