//! Computes the passive torque of tissues that stiffen exponentially toward both ends of a range.
//!
//! `tau(q) = sum_i a_i exp(r_i (q - q_i)) - k (q - q_mid) + c`, every exponential term falling (`a_i r_i <= 0`). With one term
//! a side it is the canonical double exponential (Anderson & Pandy 1999; OpenSim's `ExponentialCoordinateLimitForce`);
//! Riener & Edrich's laws take this form when the neighbouring joints are held.
//!
//! Its slope is concave, so a given slope is met at most twice, once on each side of one flattest angle: the case split
//! of the paper's Table 1.

use super::{Form, PassiveError, PassiveParameter, Zone};
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
}

/// One end of the double exponential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Size of the torque at `angle`, N m, not negative.
    pub torque: f64,
    /// Rate of growth toward the end, 1/rad, positive.
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
    /// Mid-range stiffness, N m/rad; may be negative where the exponentials outweigh it over the whole range.
    pub stiffness: f64,
    /// Angle where the linear term is zero, rad.
    pub neutral: f64,
}

impl DoubleExponential {
    /// The evaluable form.
    ///
    /// # Errors
    /// [`PassiveError::Parameter`] for a number that is not finite or a rate that is not positive. Where a negative
    /// torque or stiffness makes the curve rise is found by [`super::PassiveCurve::new`], which knows the range and names the angle where the curve rises.
    pub fn form(self) -> Result<Form, PassiveError> {
        let terms = [
            (self.lower.torque, -self.lower.rate, self.lower.angle),
            (-self.upper.torque, self.upper.rate, self.upper.angle),
        ];
        for rate in [self.lower.rate, self.upper.rate] {
            if rate.is_nan() || rate <= 0.0 {
                return Err(PassiveError::Parameter {
                    parameter: PassiveParameter::Rate,
                    value: rate,
                    accepted: "positive",
                });
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
        let finite = |parameter, value: f64| {
            if value.is_finite() {
                Ok(())
            } else {
                Err(PassiveError::Parameter { parameter, value, accepted: "finite" })
            }
        };
        finite(PassiveParameter::Stiffness, stiffness)?;
        finite(PassiveParameter::NeutralAngle, neutral)?;
        finite(PassiveParameter::Constant, constant)?;
        let mut sum = Self {
            terms: [Term { torque: 0.0, rate: 0.0, angle: 0.0 }; TERMS],
            count: 0,
            stiffness,
            neutral,
            constant,
        };
        for &(torque, rate, angle) in terms {
            finite(PassiveParameter::Torque, torque)?;
            finite(PassiveParameter::Rate, rate)?;
            finite(PassiveParameter::Angle, angle)?;
            if torque == 0.0 || rate == 0.0 {
                sum.constant += torque;
                continue;
            }
            if sum.count == TERMS {
                let value = terms.len() as f64;
                return Err(PassiveError::Parameter {
                    parameter: PassiveParameter::Terms,
                    value,
                    accepted: "three at most",
                });
            }
            sum.terms[sum.count] = Term { torque, rate, angle };
            sum.count += 1;
        }
        Ok(sum)
    }

    /// The same sum with `times` the torque at every angle.
    pub(super) fn scaled(&self, times: f64) -> Self {
        let term = |term: Term| Term { torque: times * term.torque, ..term };
        Self {
            terms: self.terms.map(term),
            stiffness: times * self.stiffness,
            constant: times * self.constant,
            ..self.clone()
        }
    }

    /// The exponential terms as (torque N m, rate 1/rad, angle rad).
    pub fn exponential_terms(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        self.terms().iter().map(|term| (term.torque, term.rate, term.angle))
    }

    /// The linear term: stiffness (N m/rad), and the angle where it is zero (rad).
    pub fn linear_term(&self) -> (f64, f64) {
        (self.stiffness, self.neutral)
    }

    /// The constant torque, N m.
    pub fn constant(&self) -> f64 {
        self.constant
    }

    fn terms(&self) -> &[Term] {
        &self.terms[..self.count]
    }

    #[inline]
    pub(super) fn torque_and_slope(&self, q: f64) -> (f64, f64) {
        let mut torque = self.constant - self.stiffness * (q - self.neutral);
        let mut slope = -self.stiffness;
        for term in self.terms() {
            let value = term.torque * libm::exp(term.rate * (q - term.angle));
            torque += value;
            slope += term.rate * value;
        }
        (torque, slope)
    }

    pub(super) fn energy(&self, q: f64) -> f64 {
        let x = q - self.neutral;
        let mut energy = 0.5 * self.stiffness * x * x - self.constant * q;
        for term in self.terms() {
            energy -= term.torque / term.rate * libm::exp(term.rate * (q - term.angle));
        }
        energy
    }

    /// Second derivative of the torque and its own derivative. The second derivative falls, so it has one zero at most.
    fn curvature(&self, q: f64) -> (f64, f64) {
        let (mut curvature, mut change) = (0.0, 0.0);
        for term in self.terms() {
            let value = term.torque * term.rate * term.rate * libm::exp(term.rate * (q - term.angle));
            curvature += value;
            change += term.rate * value;
        }
        (curvature, change)
    }

    pub(super) fn flattest_zone(&self, from: f64, to: f64) -> (f64, f64) {
        if self.count == 0 {
            return (from, to);
        }
        let angle = if self.curvature(from).0 <= 0.0 {
            from
        } else if self.curvature(to).0 >= 0.0 {
            to
        } else {
            dichotomy(|q| self.curvature(q), from, to).unwrap_or(from)
        };
        (angle, angle)
    }

    /// The angles of the zone where the slope passes through `slope`: at most one on each side of the flattest angle.
    pub(super) fn crossings(&self, slope: f64, zone: &Zone, mut visit: impl FnMut(f64)) {
        // steepness(q) = sum |a r| exp(r (q - q_i)) must reach `level`; it is convex.
        let level = -(slope + self.stiffness);
        if level <= 0.0 {
            return;
        }
        let steep = (zone.form_slopes.0 < slope, zone.form_slopes.1 < slope);
        let flattest_inside = zone.from < zone.flattest.0 && zone.flattest.1 < zone.to;
        if !flattest_inside && steep.0 == steep.1 {
            return;
        }
        for (side, present) in [(-1.0, steep.0), (1.0, steep.1)] {
            if let Some(angle) = present.then(|| self.newton(level, side)).flatten() {
                visit(angle.clamp(zone.from, zone.to));
            }
        }
    }

    /// The angle on one side of the flattest one where the steepness is `level`; `None` where it is nowhere so flat.
    fn newton(&self, level: f64, side: f64) -> Option<f64> {
        // Where the strongest single term of this side reaches the level, the sum lies above it: start there, outside the
        // wanted angle, and Newton's method on a convex function runs inward without overshooting.
        let mut q = f64::NAN;
        for term in self.terms().iter().filter(|t| t.rate * side > 0.0) {
            let angle = term.angle + libm::log(level / (term.torque * term.rate).abs()) / term.rate;
            q = if side < 0.0 { q.max(angle) } else { q.min(angle) };
        }
        if q.is_nan() {
            return None; // no term on this side
        }
        for _ in 0..200 {
            let (mut excess, mut rise, mut bend) = (-level, 0.0, 0.0);
            for term in self.terms() {
                let steep = -term.torque * term.rate * libm::exp(term.rate * (q - term.angle));
                excess += steep;
                rise += term.rate * steep;
                bend += term.rate * term.rate * steep;
            }
            if rise * side <= 0.0 {
                return None; // past the flattest angle: the level is never met
            }
            let step = excess / rise;
            // Inward is toward -side; no step, or one outward, is rounding: converged.
            if step * side <= 0.0 {
                return Some(q);
            }
            q -= step;
            if bend * step * step < f64::EPSILON * level {
                return Some(q); // what is left is less than rounding
            }
        }
        q.is_finite().then_some(q)
    }

    /// Refuses a curve that rises, naming the angle of the range where it does so most.
    pub(super) fn check_falls(&self, (min, max): (f64, f64)) -> Result<(), PassiveError> {
        let rising_term = self.terms().iter().find(|t| t.torque * t.rate > 0.0);
        let angle = match rising_term {
            None => self.flattest_zone(min, max).0, // every term falls: the slope is concave
            Some(_) => (0..=1000u32)
                .map(|i| min + (max - min) * f64::from(i) / 1000.0)
                .max_by(|a, b| self.torque_and_slope(*a).1.total_cmp(&self.torque_and_slope(*b).1))
                .unwrap_or(min),
        };
        let slope = self.torque_and_slope(angle).1;
        if slope > 0.0 {
            return Err(PassiveError::Rises { angle, slope });
        }
        // A curve that falls although one of its terms rises: its slope is not concave.
        rising_term.map_or(Ok(()), |term| {
            let accepted = "such that every exponential term falls with the angle";
            Err(PassiveError::Parameter { parameter: PassiveParameter::Torque, value: term.torque, accepted })
        })
    }
}
