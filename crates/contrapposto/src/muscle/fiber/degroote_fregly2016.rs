//! Computes the curves of De Groote, Kinney, Rao & Fregly 2016 ("Evaluation of direct collocation optimal control problem formulations for
//! solving the muscle redundancy problem"), OpenSim's `DeGrooteFregly2016Muscle`, at zero velocity, with the numbers of opensim-core: three
//! bells, an exponential that is zero at a fibre length of 0.2, and an exponential tendon that is zero at its slack length.

use super::curves::{Curves, MuscleError};

/// Height, place, width and its growth of the three bells of the active curve.
const BELLS: [[f64; 4]; 3] = [
    [0.815_067_113_424_354_2, 1.055_033_428_970_575, 0.162_384_573_599_574, 0.063_303_448_465_465],
    [0.433_004_984_392_647, 0.716_775_413_397_76, -0.029_947_116_970_696, 0.200_356_847_296_188],
    [0.1, 1.0, 0.353_553_390_593_274, 0.0],
];
/// Exponent of the passive curve.
const PASSIVE_EXPONENT: f64 = 4.0;
/// Fibre length over optimal length at which the passive force is zero.
const PASSIVE_ZERO: f64 = 0.2;
/// Force of the tendon at its slack length before the same is subtracted, over the greatest isometric force.
const TENDON_FORCE: f64 = 0.2;

/// The parameters of one muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeGrooteFregly2016 {
    /// Factor of the width of the active curve.
    pub active_width: f64,
    /// Passive strain of the fibres at the greatest isometric force.
    pub fiber_strain: f64,
    /// Strain of the tendon at the greatest isometric force.
    pub tendon_strain: f64,
    /// The fibres have no passive force.
    pub without_passive: bool,
}

impl Default for DeGrooteFregly2016 {
    fn default() -> Self {
        Self { active_width: 1.0, fiber_strain: 0.6, tendon_strain: 0.049, without_passive: false }
    }
}

impl DeGrooteFregly2016 {
    /// Itself, if its numbers have a meaning.
    pub(super) fn checked(&self) -> Result<Self, MuscleError> {
        for (what, value, least) in [
            ("active_force_width_scale", self.active_width, 1.0),
            ("passive_fiber_strain_at_one_norm_force", self.fiber_strain, f64::MIN_POSITIVE),
            ("tendon_strain_at_one_norm_force", self.tendon_strain, f64::MIN_POSITIVE),
        ] {
            if !(value >= least && value.is_finite()) {
                return Err(MuscleError { what, value, accepted: "above 0; active_force_width_scale at least 1" });
            }
        }
        Ok(*self)
    }
}

impl Curves for DeGrooteFregly2016 {
    fn active(&self, length: f64) -> (f64, f64) {
        let x = (length - 1.0) / self.active_width + 1.0;
        let bell = |[height, place, width, growth]: [f64; 4]| {
            let (away, wide) = (x - place, width + growth * x);
            let force = height * libm::exp(-0.5 * (away / wide).powi(2));
            (force, -force * away / wide * (wide - away * growth) / (wide * wide))
        };
        let sum = BELLS.map(bell).into_iter().fold((0.0, 0.0), |(f, s), (force, slope)| (f + force, s + slope));
        (sum.0, sum.1 / self.active_width)
    }

    fn passive(&self, length: f64) -> (f64, f64) {
        if self.without_passive {
            return (0.0, 0.0);
        }
        let rate = PASSIVE_EXPONENT / self.fiber_strain;
        let zero = libm::exp(rate * (PASSIVE_ZERO - 1.0));
        let (force, all) = (libm::exp(rate * (length - 1.0)), libm::exp(PASSIVE_EXPONENT) - zero);
        ((force - zero) / all, rate * force / all)
    }

    fn tendon(&self, length: f64) -> (f64, f64) {
        let rate = libm::log((1.0 + TENDON_FORCE) / TENDON_FORCE) / self.tendon_strain;
        let force = TENDON_FORCE * libm::exp(rate * (length - 1.0));
        (force - TENDON_FORCE, rate * force)
    }
}

#[cfg(test)]
mod tests {
    use super::{Curves, DeGrooteFregly2016};

    /// Places that the publication and opensim-core name: no force at slack lengths, the greatest isometric force at the strains given.
    #[test]
    fn curves_pass_through_the_places_that_define_them() {
        for law in [
            DeGrooteFregly2016::default(),
            DeGrooteFregly2016 { fiber_strain: 0.4, tendon_strain: 0.1, ..Default::default() },
        ] {
            for (found, expected) in [
                (law.tendon(1.0).0, 0.0),
                (law.tendon(1.0 + law.tendon_strain).0, 1.0),
                (law.passive(0.2).0, 0.0),
                (law.passive(1.0 + law.fiber_strain).0, 1.0),
            ] {
                assert!((found - expected).abs() < 1e-12, "{found} instead of {expected}");
            }
            assert!((law.active(1.0).0 - 1.0).abs() < 0.01, "{}", law.active(1.0).0);
        }
    }

    #[test]
    fn slopes_are_central_differences() {
        let law = DeGrooteFregly2016 { active_width: 1.2, ..Default::default() };
        let at = |x: f64| [law.active(x), law.passive(x), law.tendon(x)];
        for k in 0..=20 {
            let (x, h) = (0.4 + 0.06 * f64::from(k), 1e-5);
            let (before, here, after) = (at(x - h), at(x), at(x + h));
            for curve in 0..3 {
                let slope = (after[curve].0 - before[curve].0) / (2.0 * h);
                let error = (here[curve].1 - slope).abs();
                assert!(error < 1e-7 * slope.abs().max(1.0), "curve {curve} at {x}: {} and {slope}", here[curve].1);
            }
        }
    }
}
