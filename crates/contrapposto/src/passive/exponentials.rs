//! Which torque do tissues give that stiffen exponentially toward both ends of a range?
//!
//! `tau(q) = sum_i a_i exp(r_i (q - q_i)) - k (q - q_mid) + c`, every term falling (`a_i r_i <= 0`, `k >= 0`). With one term
//! a side it is the canonical double exponential (Anderson & Pandy 1999; OpenSim's `ExponentialCoordinateLimitForce`);
//! Riener & Edrich's laws take this form when the neighbouring joints are held.
//!
//! Its slope is concave, so a given slope is met at most twice, once on each side of one flattest angle: the case split
//! of the paper's Table 1.

use super::{Form, PassiveError};
use crate::math::dichotomy;

/// One exponential term `torque * exp(rate * (q - angle))`; torque and rate have opposite signs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Term {
    torque: f64,
    rate: f64,
    angle: f64,
}

/// Greatest number of exponential terms (Riener & Edrich's knee has three).
const TERMS: usize = 3;

/// A sum of falling exponentials, a linear term and a constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Exponentials {
    terms: [Term; TERMS],
    count: usize,
    stiffness: f64,
    neutral: f64,
    constant: f64,
    /// Flattest angle of the unrestricted curve; `None` when no term, or only terms of one side, exist.
    flattest: Option<f64>,
}

/// One end of the double exponential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Size of the torque at `angle`, N m, not negative.
    pub torque: f64,
    /// How fast it grows toward the end, 1/rad, positive.
    pub rate: f64,
    /// Angle at which the torque has this size, rad.
    pub angle: f64,
}

/// `tau = lower.torque exp(-lower.rate (q - lower.angle)) - upper.torque exp(upper.rate (q - upper.angle)) - stiffness (q - neutral)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleExponential {
    /// Resists at the lower end of the range (positive torque).
    pub lower: End,
    /// Resists at the upper end of the range (negative torque).
    pub upper: End,
    /// Mid-range stiffness, N m/rad, not negative.
    pub stiffness: f64,
    /// Angle where the linear term is zero, rad.
    pub neutral: f64,
}

impl DoubleExponential {
    /// The evaluable form.
    ///
    /// # Errors
    /// [`PassiveError::Parameter`] for a number that is not finite or a rate that is not positive. A negative torque or
    /// stiffness is left to [`super::PassiveCurve::new`], which knows the range and names the angle where the curve rises.
    pub fn form(self) -> Result<Form, PassiveError> {
        let terms = [
            (self.lower.torque, -self.lower.rate, self.lower.angle),
            (-self.upper.torque, self.upper.rate, self.upper.angle),
        ];
        for rate in [self.lower.rate, self.upper.rate] {
            if rate.is_nan() || rate <= 0.0 {
                return Err(PassiveError::Parameter { name: "rate (1/rad)", value: rate, accepted: "positive" });
            }
        }
        Ok(Form::Exponentials(Exponentials::new(&terms, self.stiffness, self.neutral, 0.0)?))
    }
}

impl Exponentials {
    /// Terms as (torque, rate, angle): at most three; a term of zero torque or rate falls away into the constant.
    ///
    /// # Errors
    /// [`PassiveError::Parameter`] for a number that is not finite, or more than three terms.
    pub fn new(terms: &[(f64, f64, f64)], stiffness: f64, neutral: f64, constant: f64) -> Result<Self, PassiveError> {
        let finite = |name, value: f64| {
            if value.is_finite() { Ok(()) } else { Err(PassiveError::Parameter { name, value, accepted: "finite" }) }
        };
        finite("stiffness (N m/rad)", stiffness)?;
        finite("neutral angle (rad)", neutral)?;
        finite("constant (N m)", constant)?;
        let mut sum = Self {
            terms: [Term { torque: 0.0, rate: 0.0, angle: 0.0 }; TERMS],
            count: 0,
            stiffness,
            neutral,
            constant,
            flattest: None,
        };
        for &(torque, rate, angle) in terms {
            finite("torque (N m)", torque)?;
            finite("rate (1/rad)", rate)?;
            finite("angle (rad)", angle)?;
            if torque == 0.0 || rate == 0.0 {
                sum.constant += torque;
                continue;
            }
            if sum.count == TERMS {
                let value = terms.len() as f64;
                return Err(PassiveError::Parameter {
                    name: "number of exponential terms",
                    value,
                    accepted: "three at most",
                });
            }
            sum.terms[sum.count] = Term { torque, rate, angle };
            sum.count += 1;
        }
        sum.flattest = sum.find_flattest();
        Ok(sum)
    }

    fn terms(&self) -> &[Term] {
        &self.terms[..self.count]
    }

    #[inline]
    pub(super) fn torque_and_slope(&self, q: f64) -> (f64, f64) {
        let mut torque = self.constant - self.stiffness * (q - self.neutral);
        let mut slope = -self.stiffness;
        for term in self.terms() {
            let value = term.torque * (term.rate * (q - term.angle)).exp();
            torque += value;
            slope += term.rate * value;
        }
        (torque, slope)
    }

    pub(super) fn energy(&self, q: f64) -> f64 {
        let x = q - self.neutral;
        let mut energy = 0.5 * self.stiffness * x * x - self.constant * q;
        for term in self.terms() {
            energy -= term.torque / term.rate * (term.rate * (q - term.angle)).exp();
        }
        energy
    }

    /// Second derivative of the torque; falls with the angle, so its only zero is the flattest angle.
    fn curvature(&self, q: f64) -> f64 {
        self.terms().iter().map(|t| t.torque * t.rate * t.rate * (t.rate * (q - t.angle)).exp()).sum()
    }

    fn find_flattest(&self) -> Option<f64> {
        let lower = self.terms().iter().filter(|t| t.rate < 0.0);
        let upper = self.terms().iter().filter(|t| t.rate > 0.0);
        // Where one lower and one upper term bend equally, in closed form; of three terms the extremes bracket the answer.
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for l in lower {
            for u in upper.clone() {
                let ratio = (l.torque * l.rate * l.rate / (-u.torque * u.rate * u.rate)).ln();
                let angle = (ratio - l.rate * l.angle + u.rate * u.angle) / (u.rate - l.rate);
                from = from.min(angle);
                to = to.max(angle);
            }
        }
        if from == to {
            return Some(from);
        }
        if from < to {
            // Two terms on one side bend more than each alone: widen the bracket by their factor of at most two.
            let margin =
                2.0 * std::f64::consts::LN_2 / self.terms().iter().map(|t| t.rate.abs()).fold(f64::INFINITY, f64::min);
            return dichotomy(|q| (self.curvature(q), f64::NAN), from - margin, to + margin);
        }
        None
    }

    pub(super) fn flattest_zone(&self, from: f64, to: f64) -> (f64, f64) {
        if self.count == 0 {
            return (from, to);
        }
        let angle = match self.flattest {
            Some(angle) => angle.clamp(from, to),
            None if self.terms[0].rate < 0.0 => to,
            None => from,
        };
        (angle, angle)
    }

    /// Both angles where the slope is `slope`, lower one first, wherever they are.
    pub(super) fn crossings(&self, slope: f64, mut visit: impl FnMut(f64)) {
        // steepness(q) = sum |a r| exp(r (q - q_i)) must reach `level`; it is convex.
        let level = -(slope + self.stiffness);
        if level <= 0.0 {
            return;
        }
        for side in [-1.0, 1.0] {
            // Where the strongest single term of this side reaches the level, the sum lies above it: start there,
            // outside the wanted angle, and Newton's method on a convex function runs inward without overshooting.
            let mut start = f64::NAN;
            for term in self.terms().iter().filter(|t| t.rate * side > 0.0) {
                let angle = term.angle + (level / (term.torque * term.rate).abs()).ln() / term.rate;
                start = if side < 0.0 { start.max(angle) } else { start.min(angle) };
            }
            if start.is_nan() {
                continue; // no term on this side
            }
            if let Some(angle) = self.newton(level, start, side) {
                visit(angle);
            }
        }
    }

    /// Runs inward from `start` (steepness above `level`) to where the steepness is `level`.
    fn newton(&self, level: f64, start: f64, side: f64) -> Option<f64> {
        let mut q = start;
        for _ in 0..200 {
            let (mut excess, mut rise) = (-level, 0.0);
            for term in self.terms() {
                let steep = -term.torque * term.rate * (term.rate * (q - term.angle)).exp();
                excess += steep;
                rise += term.rate * steep;
            }
            if rise * side <= 0.0 {
                return None; // past the flattest angle: the level is never met
            }
            let next = q - excess / rise;
            // Inward is toward -side; no step, or one outward, is rounding: converged.
            if (next - q) * side >= 0.0 {
                return Some(q);
            }
            q = next;
        }
        Some(q)
    }

    /// Refuses a term that rises, naming the angle of the range where the curve is least steep or rises.
    pub(super) fn check_falls(&self, (min, max): (f64, f64)) -> Result<(), PassiveError> {
        if self.stiffness >= 0.0 && self.terms().iter().all(|t| t.torque * t.rate < 0.0) {
            return Ok(());
        }
        let (mut angle, mut slope) = (min, f64::NEG_INFINITY);
        for i in 0..=1000 {
            let q = min + (max - min) * f64::from(i) / 1000.0;
            let s = self.torque_and_slope(q).1;
            if s > slope {
                (angle, slope) = (q, s);
            }
        }
        if slope > 0.0 {
            return Err(PassiveError::Rises { angle, slope });
        }
        let rising = self.terms().iter().find(|t| t.torque * t.rate > 0.0);
        let (name, value) = rising.map_or(("stiffness (N m/rad)", self.stiffness), |t| ("torque (N m)", t.torque));
        Err(PassiveError::Parameter { name, value, accepted: "such that every term falls with the angle" })
    }
}
