//! Computes the curves of OpenSim's `Schutte1993Muscle_Deprecated` (Schutte, Rodgers, Zajac & Glaser 1993; recalled) at zero velocity:
//! splines of the file, or the default ones of opensim-core, and an exponential passive force where the file gives no curve.

use super::curves::Curves;
use crate::math::{Function, Spline};

/// Exponent of the passive force without a curve.
const NO_CURVE_EXPONENT: f64 = 8.0;
/// Fibre length over optimal length at which that force is the greatest isometric force.
const NO_CURVE_ONE: f64 = 1.5;

/// OpenSim's default tendon: strain and force.
const TENDON: [(f64, f64); 17] = [
    (-10.0, 0.0),
    (-0.002, 0.0),
    (-0.001, 0.0),
    (0.0, 0.0),
    (0.00131, 0.0108),
    (0.00281, 0.0257),
    (0.00431, 0.0435),
    (0.00581, 0.0652),
    (0.00731, 0.0915),
    (0.00881, 0.123),
    (0.0103, 0.161),
    (0.0118, 0.208),
    (0.0123, 0.227),
    (9.2, 345.0),
    (9.201, 345.0),
    (9.202, 345.0),
    (20.0, 345.0),
];

/// OpenSim's default active curve: fibre length over optimal length and force.
const ACTIVE: [(f64, f64); 21] = [
    (-5.307_692, 0.012_188),
    (-4.307_692, 0.021_899),
    (-1.923_077, 0.036_466),
    (-0.884_615, 0.052_493),
    (-0.269_231, 0.075_312),
    (0.230_769, 0.114_158),
    (0.461_538, 0.157_859),
    (0.527_25, 0.226_667),
    (0.628_75, 0.636_667),
    (0.718_75, 0.856_667),
    (0.861_25, 0.95),
    (1.045, 0.993_333),
    (1.2175, 0.77),
    (1.438_75, 0.246_667),
    (1.5, 0.193_821),
    (1.615_385, 0.133_252),
    (2.0, 0.072_683),
    (2.961_538, 0.044_417),
    (3.692_308, 0.036_341),
    (5.461_538, 0.021_899),
    (9.901_902, 0.007_332),
];

/// The curves of one muscle.
#[derive(Clone, Debug, PartialEq)]
pub struct Schutte1993 {
    /// Active force against fibre length over optimal length.
    pub active: Function,
    /// Passive force against the same; the exponential for `None`.
    pub passive: Option<Function>,
    /// Force of the tendon against its strain.
    pub tendon: Function,
}

impl Default for Schutte1993 {
    fn default() -> Self {
        Self { active: spline(&ACTIVE), passive: None, tendon: spline(&TENDON) }
    }
}

fn spline(points: &[(f64, f64)]) -> Function {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    Spline::simm(&x, &y).map_or(Function::Constant(0.0), Function::Spline)
}

impl Curves for Schutte1993 {
    fn active(&self, length: f64) -> (f64, f64) {
        let [force, slope, _] = self.active.value_slope_curvature(length);
        if force > 0.0 { (force, slope) } else { (0.0, 0.0) }
    }

    fn passive(&self, length: f64) -> (f64, f64) {
        let Some(curve) = &self.passive else {
            let force = libm::exp(NO_CURVE_EXPONENT * (length - NO_CURVE_ONE));
            return (force, NO_CURVE_EXPONENT * force);
        };
        let [force, slope, _] = curve.value_slope_curvature(length);
        (force, slope)
    }

    fn tendon(&self, length: f64) -> (f64, f64) {
        if length < 1.0 {
            return (0.0, 0.0);
        }
        let [force, slope, _] = self.tendon.value_slope_curvature(length - 1.0);
        (force, slope)
    }
}
