//! Simulates how a posture changes as muscle groups tire and request relief.
//!
//! The loop of Rodriguez & Boulic 2007, section 3: motion, torques, fatigue, hysteresis, minimisation, constraint, record. The motion
//! of a step is the one that the constraints of the step before request. [`Simulation::step`] is that loop, once; [`run`] repeats it,
//! and a [`Run`] can be interrupted and resumed. The same scenario and the same build give the same bits.

mod approach;
mod body_motion;
mod body_ways;
mod decide;
mod easiest;
mod foot_step;
mod goal;
mod group_state;
mod joint_motion;
mod motion;
mod muscle_course;
mod muscle_outcome;
mod muscles_under_way;
mod offer;
mod path;
mod prediction;
mod recovery;
mod relief_log;
mod rest;
mod run;
mod sample;
mod scenario;
mod setting;
mod state;
mod step;
mod step_length;
mod strength;
mod summary;
mod swing;
mod under_way;

pub use muscle_outcome::{MuscleFailure, MuscleOutcome, MuscleSummary};
pub use relief_log::{ReliefLog, ReliefRecord};
pub use rest::Rest;
pub use run::{Run, Snapshot, run};
pub use sample::{Attempt, Contact, FootStep, Relief, Sample, Standing, StepKind};
pub use scenario::{
    Event, ReliefSettings, RunSettings, Scenario, ScenarioError, StrategySettings, Tables, TaskSettings,
};
pub use setting::Setting;
pub use step::Simulation;
pub use summary::{CoordinateSummary, Fall, Hazardous, StopReason, Summary};
