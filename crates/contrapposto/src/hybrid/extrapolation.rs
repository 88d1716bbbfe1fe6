//! What would the active torque be at another angle, judged from here?
//!
//! `tau_a(theta) = -(tau_p(theta) + tau_e + d tau_e (theta - theta_c))` (Rodriguez & Boulic 2007, section 2.2).

use super::Problem;
use crate::math::dichotomy;
use crate::passive::PassiveCurve;

/// Torques beyond this size (N m) or slopes (N m/rad) are cut to it, so that no sum overflows. No body comes near it.
const GREATEST: f64 = 1e150;

/// Active torque over the range, with the external torque continued as a straight line.
#[derive(Clone, Copy, Debug)]
pub struct Extrapolation<'a> {
    curve: &'a PassiveCurve,
    angle: f64,
    external_torque: f64,
    external_slope: f64,
}

impl<'a> Extrapolation<'a> {
    /// The straight line through the present external torque.
    pub fn new(problem: &Problem<'a>) -> Self {
        Self {
            curve: problem.curve,
            angle: problem.angle,
            external_torque: problem.external_torque.clamp(-GREATEST, GREATEST),
            external_slope: problem.external_slope.clamp(-GREATEST, GREATEST),
        }
    }

    /// Slope of the external line, N m/rad.
    pub fn external_slope(&self) -> f64 {
        self.external_slope
    }

    /// Active torque at `angle` (rad), N m.
    #[inline]
    pub fn active(&self, angle: f64) -> f64 {
        self.active_and_slope(angle).0
    }

    /// Active torque (N m) and its slope (N m/rad) at `angle` (rad).
    #[inline]
    pub fn active_and_slope(&self, angle: f64) -> (f64, f64) {
        let (passive, passive_slope) = self.curve.torque_and_slope(angle);
        let external = self.external_torque + self.external_slope * (angle - self.angle);
        (-(passive + external), -(passive_slope + self.external_slope))
    }

    /// The paper's `Dichotomy`: the root of the active torque in `interval`, `None` when its ends have the same sign.
    pub fn root(&self, interval: (f64, f64)) -> Option<f64> {
        dichotomy(|angle| self.active_and_slope(angle), interval.0, interval.1)
    }
}
