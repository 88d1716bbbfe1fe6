//! Adds linear terms to a curve near both limits, so that it outweighs the external torque there.
//!
//! Rodriguez & Boulic 2007, section 4.1, add two linear terms close to both extremes, so that passive torque there always
//! outweighs the external one; the paper gives no coefficients. Here: inside a zone of stated width at each limit a linear
//! term is added that starts at zero (hence the kink of Figures 7 and 9). It may be applied to every curve.

use super::{PassiveError, PassiveParameter};

/// Linear terms near both limits.
///
/// ```
/// use contrapposto::passive::{DoubleExponential, End, PassiveCurve, Reshape};
/// let range = (0.0, 2.0);
/// let end = |angle| End { torque: 3.0, rate: 8.0, angle };
/// let form = DoubleExponential { lower: end(0.0), upper: end(2.0), stiffness: 0.0, neutral: 0.0 }.form()?;
/// let plain = PassiveCurve::new(form.clone(), range, None)?;
/// let strong = Reshape::reaching(12.0, 0.25, (plain.torque(0.0), plain.torque(2.0)));
/// let curve = PassiveCurve::new(form, range, Some(strong))?;
/// assert!((curve.torque(0.0) - 12.0).abs() < 1e-12 && (curve.torque(2.0) + 12.0).abs() < 1e-12);
/// assert_eq!(curve.torque(1.0), plain.torque(1.0));
/// # Ok::<(), contrapposto::passive::PassiveError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reshape {
    /// Width of each zone, rad, positive, less than half the range.
    pub zone: f64,
    /// Stiffness added inside the lower zone, N m/rad, not negative.
    pub lower_stiffness: f64,
    /// Stiffness added inside the upper zone, N m/rad, not negative.
    pub upper_stiffness: f64,
}

impl Reshape {
    /// Linear terms over `zone` (rad) that bring `torque` (the unreshaped torque at the lower and upper limit, N m) to at
    /// least `end_torque` (N m) in size. Numbers without meaning are refused by [`super::PassiveCurve::new`].
    pub fn reaching(end_torque: f64, zone: f64, torque: (f64, f64)) -> Self {
        Self {
            zone,
            lower_stiffness: (end_torque - torque.0).max(0.0) / zone,
            upper_stiffness: (end_torque + torque.1).max(0.0) / zone,
        }
    }

    pub(super) fn check(&self, (min, max): (f64, f64)) -> Result<(), PassiveError> {
        let check = |ok: bool, parameter, value, accepted| {
            if ok { Ok(()) } else { Err(PassiveError::Parameter { parameter, value, accepted }) }
        };
        let fits = self.zone > 0.0 && min + self.zone < max - self.zone;
        check(fits, PassiveParameter::ReshapeZone, self.zone, "positive and less than half the range")?;
        for stiffness in [self.lower_stiffness, self.upper_stiffness] {
            let ok = stiffness.is_finite() && stiffness >= 0.0;
            check(ok, PassiveParameter::ReshapeStiffness, stiffness, "finite and not negative")?;
        }
        Ok(())
    }

    pub(super) fn torque_and_slope(&self, (min, max): (f64, f64), q: f64) -> (f64, f64) {
        let below = min + self.zone - q;
        let above = q - (max - self.zone);
        if below > 0.0 {
            (self.lower_stiffness * below, -self.lower_stiffness)
        } else if above > 0.0 {
            (-self.upper_stiffness * above, -self.upper_stiffness)
        } else {
            (0.0, 0.0)
        }
    }

    pub(super) fn energy(&self, (min, max): (f64, f64), q: f64) -> f64 {
        let below = (min + self.zone - q).max(0.0);
        let above = (q - (max - self.zone)).max(0.0);
        0.5 * (self.lower_stiffness * below * below + self.upper_stiffness * above * above)
    }

    /// The three zones as (from, to, added slope); a zone to which nothing is added belongs to the middle one.
    pub(super) fn zones(&self, (min, max): (f64, f64)) -> [(f64, f64, f64); 3] {
        let a = if self.lower_stiffness > 0.0 { min + self.zone } else { min };
        let b = if self.upper_stiffness > 0.0 { max - self.zone } else { max };
        [(min, a, -self.lower_stiffness), (a, b, 0.0), (b, max, -self.upper_stiffness)]
    }
}
