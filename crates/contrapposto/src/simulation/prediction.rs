//! Predicts what a decision does to the active torque of its joint, by the extrapolation that the decision is made of.

use crate::constraint::relief_step;
use crate::hybrid::{Decision, Extrapolation, Problem};

use super::ReliefSettings;

/// Angles between a joint and its goal at which the active torque is predicted.
const PATH_SAMPLES: u32 = 16;
/// The step of relief is halved once for each rejection, and at most so many times.
const MOST_HALVINGS: u32 = 30;

/// The predicted effect of a decision on its joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Prediction {
    /// The next step toward the goal (Eq. 9), rad.
    pub(super) step: f64,
    /// Change of active torque by that step, N m.
    pub(super) change: f64,
    /// Greatest size of active torque between here and the goal, N m.
    pub(super) peak: f64,
}

impl Prediction {
    /// For a joint whose active torque is `active`, N m.
    pub(super) fn new(
        problem: &Problem<'_>,
        decision: &Decision,
        active: f64,
        settings: &ReliefSettings,
        rejections: u32,
    ) -> Self {
        let Some(goal) = decision.goal else { return Self { peak: active.abs(), ..Self::default() } };
        let extrapolation = Extrapolation::new(problem);
        let angles = (1..=PATH_SAMPLES)
            .map(|sample| problem.angle + (goal - problem.angle) * f64::from(sample) / f64::from(PATH_SAMPLES));
        let peak = angles.fold(active.abs(), |peak, angle| peak.max(extrapolation.active(angle).abs()));
        let gain = settings.step_gain * 0.5f64.powi(rejections.min(MOST_HALVINGS) as i32);
        let step = relief_step(goal, problem.angle, gain, settings.max_step);
        Self { step, change: extrapolation.active_and_slope(problem.angle).1 * step, peak }
    }
}
