//! What happens to a posture as muscle groups tire and ask for relief?
//!
//! The loop of Rodriguez & Boulic 2007, section 3: torques, fatigue, hysteresis, minimisation, constraint, motion, record.
//! [`Simulation::step`] is that loop, once; [`run`] repeats it. Same scenario, same build: same bits.

mod assess;
mod scenario;
mod step;
mod summary;
mod whole;

pub use assess::{AssessError, AssessSettings, Assessment, GroupAssessment, Instant, Peak, PeakKind, Proposal, assess};
pub use scenario::{
    Event, ReliefSettings, RunSettings, Scenario, ScenarioError, StrategySettings, Tables, TaskSettings,
};
pub use step::{Contact, Relief, Sample, Simulation, Standing};
pub use summary::{CoordinateSummary, StopReason, Summary, run};
