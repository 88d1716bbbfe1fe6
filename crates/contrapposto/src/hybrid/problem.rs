//! Defines the input of one decision.

use super::Strategy;
use crate::passive::PassiveCurve;

/// One joint coordinate that asks for relief. Input of [`super::minimise`].
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    /// Passive torque over the whole range.
    pub curve: &'a PassiveCurve,
    /// Present angle `theta_c`, rad, inside the curve's range.
    pub angle: f64,
    /// Present external torque `tau_e`, N m.
    pub external_torque: f64,
    /// Present slope `d tau_e` of the external torque, N m/rad (Eq. 7, the entry of the coordinate itself).
    pub external_slope: f64,
    /// The kind of solution that is sought.
    pub strategy: Strategy,
    /// `R_min`, 0..=1: least share of the torque that the active solution of case 3.1 must remove.
    pub minimum_decrease_ratio: f64,
    /// `eps`, N m, not negative: active torque within it counts as none.
    pub torque_tolerance: f64,
    /// The strategy that an earlier decision of the same recovery ended in, if any. It is kept: once case 3.1 was accepted
    /// `R_min` is not asked again, once a passive goal was taken the passive strategy stays (docs/deviations.md, D4).
    pub accepted: Option<Strategy>,
}

/// The reason for which a problem was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// A number is NaN or infinite.
    #[error("{name} is {value}; it must be finite")]
    NotFinite {
        /// Name with unit.
        name: &'static str,
        /// The value given.
        value: f64,
    },
    /// The present angle lies outside the range of motion.
    #[error("angle is {:.6} deg, outside the range {:.6}..{:.6} deg", angle.to_degrees(), range.0.to_degrees(), range.1.to_degrees())]
    AngleOutsideRange {
        /// The angle, rad.
        angle: f64,
        /// The closed range, rad.
        range: (f64, f64),
    },
    /// `R_min` is not a share.
    #[error("minimum decrease ratio is {value}; it must lie in 0..1")]
    Ratio {
        /// The value given.
        value: f64,
    },
    /// `eps` is negative.
    #[error("torque tolerance is {value} N m; it must not be negative")]
    Tolerance {
        /// The value given, N m.
        value: f64,
    },
}

impl Problem<'_> {
    pub(super) fn check(&self) -> Result<(), ProblemError> {
        for (name, value) in [
            ("angle (rad)", self.angle),
            ("external torque (N m)", self.external_torque),
            ("external slope (N m/rad)", self.external_slope),
            ("minimum decrease ratio", self.minimum_decrease_ratio),
            ("torque tolerance (N m)", self.torque_tolerance),
        ] {
            if !value.is_finite() {
                return Err(ProblemError::NotFinite { name, value });
            }
        }
        let range = self.curve.range();
        if self.angle < range.0 || self.angle > range.1 {
            return Err(ProblemError::AngleOutsideRange { angle: self.angle, range });
        }
        if !(0.0..=1.0).contains(&self.minimum_decrease_ratio) {
            return Err(ProblemError::Ratio { value: self.minimum_decrease_ratio });
        }
        if self.torque_tolerance < 0.0 {
            return Err(ProblemError::Tolerance { value: self.torque_tolerance });
        }
        Ok(())
    }
}
