//! Gives the results of the commands as values, for programs that have no command line.

mod failure;
mod model;
mod torques;

pub use failure::{Failure, Note, Place};
pub use model::{ModelOptions, ModelSource};
pub use torques::{RestTorques, TorqueRow};
