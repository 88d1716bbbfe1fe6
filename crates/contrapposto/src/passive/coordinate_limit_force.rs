//! Computes the torque of OpenSim's `CoordinateLimitForce`.
//!
//! Zero between two limits; beyond them a spring that is switched on over a transition width `w` by the quintic step
//! `S(x) = 10 x^3 - 15 x^4 + 6 x^5` (clipped to 0..1):
//! `tau = -K_u S((q - q_u)/w) (q - q_u)` above, `tau = +K_l S((q_l - q)/w) (q_l - q)` below.
//! Source: opensim-core, `CoordinateLimitForce.cpp`. Damping plays no part in statics.
//!
//! The slope is not monotone in the transition: its size rises to 16/9 K at x = 2/3, then falls to K. A given slope may be
//! met at four angles, and at none in the exactly flat middle.

use super::{Form, PassiveError, PassiveParameter};
use crate::math::dichotomy_between;

/// Two one-sided springs with a smooth start. Positive torque below the lower limit, negative above the upper one.
///
/// OpenSim's files give degrees and N m/deg for rotations:
///
/// ```
/// use contrapposto::passive::{CoordinateLimitForce, PassiveCurve};
/// let knee = CoordinateLimitForce {
///     upper_stiffness: 20f64.to_degrees(), // N m/deg to N m/rad
///     upper_limit: -5f64.to_radians(),
///     lower_stiffness: 10f64.to_degrees(),
///     lower_limit: -120f64.to_radians(),
///     transition: 10f64.to_radians(),
/// };
/// let curve = PassiveCurve::new(knee.form()?, (-133f64.to_radians(), 23f64.to_radians()), None)?;
/// assert!((curve.torque(-133f64.to_radians()) - 130.0).abs() < 1e-9); // 13 deg at 10 N m/deg
/// assert_eq!(curve.torque(-60f64.to_radians()), 0.0);
/// assert_eq!(curve.flattest_zone(), (-120f64.to_radians(), -5f64.to_radians()));
/// # Ok::<(), contrapposto::passive::PassiveError>(())
/// ```
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
        let check = |ok: bool, parameter, value, accepted| {
            if ok { Ok(()) } else { Err(PassiveError::Parameter { parameter, value, accepted }) }
        };
        for (parameter, value) in
            [(PassiveParameter::UpperLimit, self.upper_limit), (PassiveParameter::LowerLimit, self.lower_limit)]
        {
            check(value.is_finite(), parameter, value, "finite")?;
        }
        for (parameter, value) in [
            (PassiveParameter::UpperStiffness, self.upper_stiffness),
            (PassiveParameter::LowerStiffness, self.lower_stiffness),
        ] {
            check(value.is_finite() && value >= 0.0, parameter, value, "finite and not negative")?;
        }
        check(
            self.transition.is_finite() && self.transition > 0.0,
            PassiveParameter::Transition,
            self.transition,
            "positive",
        )?;
        check(
            self.lower_limit <= self.upper_limit,
            PassiveParameter::LowerLimit,
            self.lower_limit,
            "at or below the upper limit",
        )?;
        Ok(Form::CoordinateLimitForce(self))
    }

    pub(super) fn torque_and_slope(&self, q: f64) -> (f64, f64) {
        if q > self.upper_limit {
            let (force, slope) = spring(q - self.upper_limit, self.transition);
            (-self.upper_stiffness * force, -self.upper_stiffness * slope)
        } else if q < self.lower_limit {
            let (force, slope) = spring(self.lower_limit - q, self.transition);
            (self.lower_stiffness * force, -self.lower_stiffness * slope)
        } else {
            (0.0, 0.0)
        }
    }

    pub(super) fn energy(&self, q: f64) -> f64 {
        if q > self.upper_limit {
            self.upper_stiffness * spring_energy(q - self.upper_limit, self.transition)
        } else if q < self.lower_limit {
            self.lower_stiffness * spring_energy(self.lower_limit - q, self.transition)
        } else {
            0.0
        }
    }

    pub(super) fn flattest_zone(&self, from: f64, to: f64) -> (f64, f64) {
        // A side without stiffness belongs to the flat middle.
        let lower = if self.lower_stiffness == 0.0 { from } else { self.lower_limit.max(from) };
        let upper = if self.upper_stiffness == 0.0 { to } else { self.upper_limit.min(to) };
        if lower <= upper {
            return (lower, upper);
        }
        // The range lies on one side: least steep where it comes nearest the limit, or where the spring is straight.
        let above = from > self.upper_limit;
        let (near, far) = if above { (from, to) } else { (to, from) };
        let straight =
            if above { self.upper_limit + self.transition } else { self.lower_limit - self.transition }.clamp(from, to);
        if self.torque_and_slope(near).1 > self.torque_and_slope(straight).1 {
            (near, near)
        } else {
            (straight.min(far), straight.max(far))
        }
    }

    /// Calls `visit` with every angle of about `from..=to` where the slope passes through `slope`.
    pub(super) fn crossings(&self, slope: f64, from: f64, to: f64, mut visit: impl FnMut(f64)) {
        let w = self.transition;
        let reach = ((self.lower_limit - from) / w, (to - self.upper_limit) / w);
        offsets(-slope / self.lower_stiffness, reach.0, |x| visit(self.lower_limit - w * x));
        offsets(-slope / self.upper_stiffness, reach.1, |x| visit(self.upper_limit + w * x));
    }
}

/// Calls `visit` with each distance from the limit, in transition widths and up to about `reach`, where the steepness
/// passes through `level`.
fn offsets(level: f64, reach: f64, mut visit: impl FnMut(f64)) {
    if level == 0.0 {
        return visit(0.0); // the end of the flat middle
    }
    let steepest = steepness(reach.clamp(0.0, STEEPEST)).0;
    if !(level > 0.0 && level <= steepest * (1.0 + 1e-12)) {
        return;
    }
    let miss = |x: f64| {
        let (steep, bend) = steepness(x);
        (steep - level, bend)
    };
    let mut search = |from: f64, to: f64| {
        if let Some(x) = dichotomy_between(miss, (from, miss(from).0), (to, miss(to).0), 1e-15 * level) {
            visit(x);
        }
    };
    // 6 x^3 <= steepness(x) <= 40 x^3 before the peak.
    let foot = libm::cbrt(level / 40.0);
    search(0.99 * foot, (1.9 * foot).min(STEEPEST));
    if reach > STEEPEST && level >= 1.0 {
        search(STEEPEST, 1.0);
    }
}

/// `S(d/w) d` and its derivative, `d >= 0`.
fn spring(d: f64, w: f64) -> (f64, f64) {
    let x = d / w;
    if x >= 1.0 { (d, 1.0) } else { (d * (x * x * x * (10.0 + x * (-15.0 + 6.0 * x))), steepness(x).0) }
}

/// Derivative of `S(x) x` and its own derivative, `0 <= x <= 1`.
fn steepness(x: f64) -> (f64, f64) {
    (x * x * x * (40.0 + x * (-75.0 + 36.0 * x)), x * x * (120.0 + x * (-300.0 + 180.0 * x)))
}

/// Integral of `S(d/w) d` from zero.
fn spring_energy(d: f64, w: f64) -> f64 {
    let x = d / w;
    if x >= 1.0 {
        0.5 * d * d - w * w / 7.0 // the transition holds 5/14 w^2
    } else {
        d * d * (x * x * x * (2.0 + x * (-2.5 + x * (6.0 / 7.0))))
    }
}
