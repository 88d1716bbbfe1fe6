//! What happens to a posture as muscle groups tire and ask for relief?
//!
//! The loop of Rodriguez & Boulic 2007, section 3: torques, fatigue, hysteresis, minimisation, constraint, motion, record.
//! [`Simulation::step`] is that loop, once; [`run`] repeats it. Same scenario, same build: same bits.

mod scenario;
mod step;
mod summary;

pub use scenario::{ReliefSettings, RunSettings, Scenario, ScenarioError, StrategySettings, Tables};
pub use step::{Sample, Simulation};
pub use summary::{CoordinateSummary, StopReason, Summary, run};
