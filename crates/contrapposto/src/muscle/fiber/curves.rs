//! Defines what a law of fibres and tendon gives: three curves, or the reason why its numbers have no meaning.

/// Force over the greatest isometric force, and its slope, against length over optimal (fibres) or slack length (tendon).
pub(super) trait Curves {
    fn active(&self, length: f64) -> (f64, f64);
    fn passive(&self, length: f64) -> (f64, f64);
    fn tendon(&self, length: f64) -> (f64, f64);
}

/// The reason for which numbers make no muscle.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what} is {value}; accepted: {accepted}")]
pub struct MuscleError {
    /// The number's name.
    pub what: &'static str,
    /// The number.
    pub value: f64,
    /// The values that have a meaning.
    pub accepted: &'static str,
}
