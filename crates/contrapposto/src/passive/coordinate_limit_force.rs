//! Which torque does OpenSim's `CoordinateLimitForce` give?
//!
//! Zero between two limits; beyond them a spring that is switched on over a transition width `w` by the quintic step
//! `S(x) = 10 x^3 - 15 x^4 + 6 x^5` (clipped to 0..1):
//! `tau = -K_u S((q - q_u)/w) (q - q_u)` above, `tau = +K_l S((q_l - q)/w) (q_l - q)` below.
//! Source: opensim-core, `CoordinateLimitForce.cpp`. Damping plays no part in statics.
//!
//! The slope is not monotone in the transition: its size rises to 16/9 K at x = 2/3, then falls to K. A given slope may be
//! met at four angles, and at none in the exactly flat middle.

use super::{Form, PassiveError};
use crate::math::dichotomy;

/// Two one-sided springs with a smooth start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateLimitForce {
    /// Stiffness above `upper_limit`, N m/rad, not negative.
    pub upper_stiffness: f64,
    /// Angle where the upper spring begins, rad.
    pub upper_limit: f64,
    /// Stiffness below `lower_limit`, N m/rad, not negative.
    pub lower_stiffness: f64,
    /// Angle where the lower spring begins, rad.
    pub lower_limit: f64,
    /// Transition width, rad, positive.
    pub transition: f64,
}

/// Share of the transition at which the spring is steepest.
const STEEPEST: f64 = 2.0 / 3.0;

impl CoordinateLimitForce {
    /// The evaluable form.
    ///
    /// # Errors
    /// [`PassiveError::Parameter`] for a number that is not finite, a negative stiffness, a transition that is not
    /// positive, or limits in the wrong order.
    pub fn form(self) -> Result<Form, PassiveError> {
        let check = |ok: bool, name, value, accepted| {
            if ok { Ok(()) } else { Err(PassiveError::Parameter { name, value, accepted }) }
        };
        for (name, value) in [("upper limit (rad)", self.upper_limit), ("lower limit (rad)", self.lower_limit)] {
            check(value.is_finite(), name, value, "finite")?;
        }
        for (name, value) in
            [("upper stiffness (N m/rad)", self.upper_stiffness), ("lower stiffness (N m/rad)", self.lower_stiffness)]
        {
            check(value.is_finite() && value >= 0.0, name, value, "finite and not negative")?;
        }
        check(self.transition.is_finite() && self.transition > 0.0, "transition (rad)", self.transition, "positive")?;
        check(
            self.lower_limit <= self.upper_limit,
            "lower limit (rad)",
            self.lower_limit,
            "at or below the upper limit",
        )?;
        Ok(Form::CoordinateLimitForce(self))
    }

    pub(super) fn torque_and_slope(&self, q: f64) -> (f64, f64) {
        let w = self.transition;
        if q > self.upper_limit {
            let (force, slope) = spring((q - self.upper_limit) / w);
            (-self.upper_stiffness * w * force, -self.upper_stiffness * slope)
        } else if q < self.lower_limit {
            let (force, slope) = spring((self.lower_limit - q) / w);
            (self.lower_stiffness * w * force, -self.lower_stiffness * slope)
        } else {
            (0.0, 0.0)
        }
    }

    pub(super) fn energy(&self, q: f64) -> f64 {
        let w2 = self.transition * self.transition;
        if q > self.upper_limit {
            self.upper_stiffness * w2 * spring_energy((q - self.upper_limit) / self.transition)
        } else if q < self.lower_limit {
            self.lower_stiffness * w2 * spring_energy((self.lower_limit - q) / self.transition)
        } else {
            0.0
        }
    }

    pub(super) fn flattest_zone(&self, from: f64, to: f64) -> (f64, f64) {
        let zone = (self.lower_limit.max(from), self.upper_limit.min(to));
        if zone.0 <= zone.1 {
            return zone;
        }
        // The range lies on one side. The slope is least steep at one of its ends, or all along where it is straight.
        let (a, b) = (self.torque_and_slope(from).1, self.torque_and_slope(to).1);
        if a == b && (from >= self.upper_limit + self.transition || to <= self.lower_limit - self.transition) {
            (from, to)
        } else if a > b {
            (from, from)
        } else {
            (to, to)
        }
    }

    pub(super) fn crossings(&self, slope: f64, mut visit: impl FnMut(f64)) {
        let w = self.transition;
        let mut offsets = |stiffness: f64, visit: &mut dyn FnMut(f64)| {
            let level = -slope / stiffness;
            let miss = |x: f64| {
                let (s, ds) = steepness(x);
                (s - level, ds)
            };
            if level > 0.0 {
                for (from, to) in [(0.0, STEEPEST), (STEEPEST, 1.0)] {
                    if let Some(x) = dichotomy(miss, from, to) {
                        visit(x);
                    }
                }
            }
        };
        offsets(self.lower_stiffness, &mut |x| visit(self.lower_limit - w * x));
        offsets(self.upper_stiffness, &mut |x| visit(self.upper_limit + w * x));
    }
}

/// `S(x) x` and its derivative, `x >= 0` in transition widths.
fn spring(x: f64) -> (f64, f64) {
    if x >= 1.0 { (x, 1.0) } else { (x * x * x * x * (10.0 + x * (-15.0 + 6.0 * x)), steepness(x).0) }
}

/// Derivative of `S(x) x` and its own derivative, `0 <= x <= 1`.
fn steepness(x: f64) -> (f64, f64) {
    (x * x * x * (40.0 + x * (-75.0 + 36.0 * x)), x * x * (120.0 + x * (-300.0 + 180.0 * x)))
}

/// Integral of `S(x) x` from zero.
fn spring_energy(x: f64) -> f64 {
    let inside = |x: f64| x.powi(5) * (2.0 + x * (-2.5 + x * 6.0 / 7.0));
    if x >= 1.0 { inside(1.0) + 0.5 * (x * x - 1.0) } else { inside(x) }
}
