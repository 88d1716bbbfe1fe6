//! Carries out scenarios and keeps their results: a posture, the postures of least effort, a run over time.

mod pose;
mod relax;
mod simulate;
mod source;

pub use pose::Posed;
pub use relax::Relaxed;
pub use simulate::Simulated;
pub use source::ScenarioSource;
