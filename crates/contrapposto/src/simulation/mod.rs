//! What happens to a posture as muscle groups tire and ask for relief?
//!
//! The loop of Rodriguez & Boulic 2007, section 3: torques, fatigue, hysteresis, minimisation, constraint, motion, record.
//! [`Simulation::step`] is that loop, once; [`run`] repeats it, and a [`Run`] can be left and taken up again. Same scenario, same build: same bits.

mod group;
mod relief_log;
mod run;
mod sample;
mod scenario;
mod state;
mod step;
mod summary;
mod whole;

pub use relief_log::{ReliefLog, ReliefRecord};
pub use run::{Run, Snapshot, run};
pub use sample::{Contact, Relief, Sample, Standing};
pub use scenario::{
    Event, ReliefSettings, RunSettings, Scenario, ScenarioError, StrategySettings, Tables, TaskSettings,
};
pub use step::Simulation;
pub use summary::{CoordinateSummary, Fall, StopReason, Summary};
