//! Computes the curves of Thelen 2003 ("Adjustment of muscle mechanics model parameters to simulate dynamic contractions in older adults"),
//! OpenSim's `Thelen2003Muscle`, at zero velocity: a Gaussian, an exponential, and a tendon with an exponential toe. The unrounded
//! numbers of the toe are those of opensim-core.

use super::curves::{Curves, MuscleError};

/// Force at the end of the toe, over the greatest isometric force.
const TOE_FORCE: f64 = 0.33;
/// Exponent of the toe.
const TOE_EXPONENT: f64 = 3.0;

/// The parameters of one muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thelen2003 {
    /// Strain of the tendon at the greatest isometric force.
    pub tendon_strain: f64,
    /// Passive strain of the fibres at the greatest isometric force.
    pub fiber_strain: f64,
    /// Width of the active curve.
    pub active_shape: f64,
    /// Exponent of the passive curve.
    pub passive_shape: f64,
}

impl Default for Thelen2003 {
    fn default() -> Self {
        Self { tendon_strain: 0.04, fiber_strain: 0.6, active_shape: 0.45, passive_shape: 5.0 }
    }
}

impl Curves for Thelen2003 {
    fn active(&self, length: f64) -> (f64, f64) {
        let x = length - 1.0;
        let force = libm::exp(-x * x / self.active_shape);
        (force, -2.0 * x / self.active_shape * force)
    }

    fn passive(&self, length: f64) -> (f64, f64) {
        let x = length - 1.0;
        if x <= 0.0 {
            return (0.0, 0.0);
        }
        let rate = self.passive_shape / self.fiber_strain;
        let all = libm::expm1(self.passive_shape);
        (libm::expm1(rate * x) / all, rate * libm::exp(rate * x) / all)
    }

    fn tendon(&self, length: f64) -> (f64, f64) {
        let x = length - 1.0;
        if x <= 0.0 {
            return (0.0, 0.0);
        }
        let e = libm::exp(TOE_EXPONENT);
        let toe = self.tendon_strain * 0.99 * e / (1.66 * e - 0.67);
        if x > toe {
            let slope = (1.0 - TOE_FORCE) / (self.tendon_strain - toe);
            return (TOE_FORCE + slope * (x - toe), slope);
        }
        let (rate, all) = (TOE_EXPONENT / toe, libm::expm1(TOE_EXPONENT));
        (TOE_FORCE / all * libm::expm1(rate * x), TOE_FORCE / all * rate * libm::exp(rate * x))
    }
}

impl Thelen2003 {
    /// Itself, if its numbers have a meaning.
    pub(super) fn checked(&self) -> Result<Self, MuscleError> {
        for (what, value) in [
            ("FmaxTendonStrain", self.tendon_strain),
            ("FmaxMuscleStrain", self.fiber_strain),
            ("KshapeActive", self.active_shape),
            ("KshapePassive", self.passive_shape),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(MuscleError { what, value, accepted: "above 0" });
            }
        }
        Ok(*self)
    }
}
