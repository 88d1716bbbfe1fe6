//! Defines the module `contrapposto._native`: the model and the jobs of `contrapposto` for Python, on arrays and texts.
//!
//! The package `python/contrapposto` is the public interface; it checks types and names results. Inputs are copied before the
//! interpreter's lock is released, because another thread may write to them then; outputs are handed over without a copy.

use pyo3::prelude::*;

mod arrays;
mod engine;
mod errors;
mod groups;
mod job;
mod loads;
mod model;
mod program;
mod sweep;
mod torques;
mod unlocked;

/// The compiled half of the package `contrapposto`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::engine::Engine;
    #[pymodule_export]
    use super::errors::panic_for_tests;
    #[pymodule_export]
    use super::groups::{endurance_time, fatigue, group_names, minimize, strength};
    #[pymodule_export]
    use super::job::Job;
    #[pymodule_export]
    use super::model::Model;
    #[pymodule_export]
    use super::program::{examples, run_program};
    #[pymodule_export]
    use super::sweep::{Sweep, SweepFolder, population};

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
