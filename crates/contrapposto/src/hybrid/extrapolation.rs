//! Extrapolates the active torque from the present angle to another one.
//!
//! `tau_a(theta) = -(tau_p(theta) + tau_e + d tau_e (theta - theta_c))` (Rodriguez & Boulic 2007, section 2.2).

use super::Problem;
use crate::joint_torques::active_torque;
use crate::math::dichotomy_between;
use crate::passive::PassiveCurve;

/// External torques beyond this size (N m) are cut to it, so that no sum overflows. No body comes near it.
const GREATEST_TORQUE: f64 = 1e308;

/// External slopes beyond this size (N m/rad) likewise; a curve's range ends at 1e6 rad.
const GREATEST_SLOPE: f64 = 1e300;

/// Active torque (N m) at which a root search may stop.
const NO_TORQUE: f64 = 1e-12;

/// An angle (rad) and the extrapolated active torque there (N m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) angle: f64,
    pub(super) torque: f64,
}

/// Active torque over the range, with the external torque continued as a straight line. [`super::minimise`] works on it;
/// charts draw it.
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
            external_torque: problem.external_torque.clamp(-GREATEST_TORQUE, GREATEST_TORQUE),
            external_slope: problem.external_slope.clamp(-GREATEST_SLOPE, GREATEST_SLOPE),
        }
    }

    /// Slope of the external line, N m/rad.
    pub(crate) fn external_slope(&self) -> f64 {
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
        (active_torque(self.external(angle), passive), -(passive_slope + self.external_slope))
    }

    /// The straight line.
    #[inline]
    fn external(&self, angle: f64) -> f64 {
        self.external_torque + self.external_slope * (angle - self.angle)
    }

    #[inline]
    pub(super) fn at(&self, angle: f64) -> Point {
        Point { angle, torque: self.active(angle) }
    }

    /// Both limits of the range; costs nothing, because the curve remembers its torque there.
    pub(super) fn limits(&self) -> (Point, Point) {
        let (min, max) = self.curve.range();
        let (at_min, at_max) = self.curve.limit_torques();
        let point = |angle, passive: f64| Point { angle, torque: active_torque(self.external(angle), passive) };
        (point(min, at_min), point(max, at_max))
    }

    /// The paper's `Dichotomy`: the root of the active torque in the interval, `None` when its ends have the same sign.
    pub(super) fn root(&self, (from, to): (Point, Point)) -> Option<f64> {
        let ends = ((from.angle, from.torque), (to.angle, to.torque));
        dichotomy_between(|angle| self.active_and_slope(angle), ends.0, ends.1, NO_TORQUE)
    }
}
