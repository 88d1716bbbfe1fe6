//! Gives the results of the commands as values, for programs that have no command line.

mod controller;
mod examples;
mod failure;
mod frames;
mod jobs;
mod model;
mod motion;
mod muscles;
mod population;
mod sweep;
mod torques;

pub use controller::Controller;
pub use examples::EXAMPLES;
pub use failure::{Failure, Note, Place};
pub use frames::Frames;
pub use jobs::{Assessed, MotionSource, Posed, Relaxed, ScenarioSource, Simulated};
pub use model::{ModelOptions, ModelSource, OpenedModel};
pub use motion::{MotionRows, read_motion, write_motion};
pub use muscles::muscle_lines;
pub use population::Populated;
pub use sweep::{Sweep, SweepFolder};
pub use torques::{RestTorques, TorqueRow};
