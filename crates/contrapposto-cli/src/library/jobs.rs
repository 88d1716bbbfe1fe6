//! Carries out scenarios and motions, and keeps their results: a posture, the postures of least effort, a run over time, an assessment.

mod assess;
mod pose;
mod relax;
mod simulate;
mod source;

pub use assess::{Assessed, MotionSource};
pub use pose::Posed;
pub use relax::Relaxed;
pub use simulate::Simulated;
pub use source::ScenarioSource;
