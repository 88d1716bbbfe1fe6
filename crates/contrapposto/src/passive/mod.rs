//! Computes the torque of ligaments and connective tissue at an angle.
//!
//! One contract for every published form: [`PassiveCurve`] answers torque, slope, energy, the flattest zone and the angles
//! at which the slope has a given value, inside a closed range. One file per form, named after its author. Sign: torque
//! acts in the direction of increasing angle, so a physical curve falls (Rodriguez & Boulic 2007, section 2.2).

use serde::{Deserialize, Serialize};

mod coordinate_limit_force;
mod error;
mod exponentials;
mod law;
mod reshape;
mod riener_edrich1999;
mod scaled;
mod slice;
mod tabulated;

pub use coordinate_limit_force::CoordinateLimitForce;
pub use error::{PassiveError, PassiveParameter};
pub use exponentials::{DoubleExponential, End, Exponentials};
pub use law::{Coupled, PassiveLaw, Term};
pub use reshape::Reshape;
pub use riener_edrich1999::{CoupledTerm, RienerEdrich1999};
pub use slice::Slice;
pub use tabulated::Tabulated;

/// The published form of a curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// Falling exponentials and a linear term: the canonical double exponential, OpenSim's
    /// `ExponentialCoordinateLimitForce`, and Riener & Edrich's laws with the neighbours held.
    Exponentials(Exponentials),
    /// OpenSim's `CoordinateLimitForce`.
    CoordinateLimitForce(CoordinateLimitForce),
    /// Measured points, joined by a monotone cubic.
    Tabulated(Tabulated),
}

/// The angles on both sides of the flattest zone at which the slope has a given value (`theta_smin`, `theta_smax` of the
/// paper). `None`: not inside the closed range.
#[derive(Clone, Copy, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct SlopeAngles {
    /// At or below the flattest zone, rad.
    pub lower: Option<f64>,
    /// At or above the flattest zone, rad.
    pub upper: Option<f64>,
}

/// Passive torque of one coordinate over its closed range.
///
/// ```
/// use contrapposto::passive::{DoubleExponential, End, PassiveCurve};
/// let elbow = DoubleExponential {
///     lower: End { torque: 12.67, rate: 19.92, angle: 0.0 },
///     upper: End { torque: 9.324, rate: 3.811, angle: 150f64.to_radians() },
///     stiffness: 0.4,
///     neutral: 73f64.to_radians(),
/// };
/// let curve = PassiveCurve::new(elbow.form()?, (0.0, 150f64.to_radians()), None)?;
/// assert!((curve.torque(0.0) - 13.18).abs() < 0.01);
/// let steep = curve.slope_angles(-2.0);
/// assert!(steep.lower < Some(curve.flattest_angle()) && steep.upper > Some(curve.flattest_angle()));
/// # Ok::<(), contrapposto::passive::PassiveError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PassiveCurve {
    form: Form,
    range: (f64, f64),
    reshape: Option<Reshape>,
    // Computed once from the above.
    zones: Vec<Zone>,
    limit_torques: (f64, f64),
    flattest: (f64, f64),
    flattest_slope: f64,
}

/// A part of the range without kink: the whole of it, or what reshaping makes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Zone {
    from: f64,
    to: f64,
    /// Slope that reshaping adds, N m/rad.
    added_slope: f64,
    /// The form's slope at both ends, without what is added.
    form_slopes: (f64, f64),
    /// Angles between which the form is least steep in the zone, rad.
    flattest: (f64, f64),
}

/// Greatest size of torque, slope and energy that is accepted: far beyond any body, and no sum of them overflows.
const GREATEST: f64 = 1e150;

/// Greatest size of a limit of the range, rad.
const GREATEST_ANGLE: f64 = 1e6;

impl PassiveCurve {
    /// A curve over `range` (rad, lower limit first, at most 1e6 in size), reshaped near both limits if asked for.
    ///
    /// # Errors
    /// [`PassiveError::Rises`] with the angle if the torque rises anywhere in the range, and the other variants for
    /// parameters without meaning.
    pub fn new(form: Form, range: (f64, f64), reshape: Option<Reshape>) -> Result<Self, PassiveError> {
        let (min, max) = range;
        for value in [min, max] {
            if value.is_nan() || value.abs() > GREATEST_ANGLE {
                let accepted = "a number between -1e6 and 1e6";
                return Err(PassiveError::Parameter { parameter: PassiveParameter::RangeLimit, value, accepted });
            }
        }
        if min >= max {
            let accepted = "above the lower limit";
            return Err(PassiveError::Parameter { parameter: PassiveParameter::UpperRangeLimit, value: max, accepted });
        }
        if let Form::Tabulated(table) = &form {
            table.check_covers(range)?;
        }
        if let Some(reshape) = &reshape {
            reshape.check(range)?;
        }
        let unknown = (0.0, 0.0);
        let mut curve = Self {
            form,
            range,
            reshape,
            zones: Vec::new(),
            limit_torques: unknown,
            flattest: unknown,
            flattest_slope: 0.0,
        };
        for angle in [min, max] {
            let (torque, slope) = curve.torque_and_slope(angle);
            if [torque, slope, curve.energy(angle)].iter().any(|x| x.is_nan() || x.abs() > GREATEST) {
                return Err(PassiveError::NotFinite { angle, torque });
            }
        }
        if let Form::Exponentials(exponentials) = &curve.form {
            exponentials.check_falls(range)?;
        }
        curve.limit_torques = (curve.torque(min), curve.torque(max));
        let zones = reshape.map_or_else(|| vec![(min, max, 0.0)], |reshape| reshape.zones(range).to_vec());
        for (from, to, added_slope) in zones {
            let form_slopes = (curve.form.torque_and_slope(from).1, curve.form.torque_and_slope(to).1);
            let flattest = curve.form.flattest_zone(from, to);
            curve.zones.push(Zone { from, to, added_slope, form_slopes, flattest });
        }
        (curve.flattest, curve.flattest_slope) = curve.find_flattest();
        Ok(curve)
    }

    /// The closed range (lower, upper), rad.
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// Torque at the lower and the upper limit, N m.
    pub fn limit_torques(&self) -> (f64, f64) {
        self.limit_torques
    }

    /// The form without reshaping.
    pub fn form(&self) -> &Form {
        &self.form
    }

    /// The reshaping near both limits, if any.
    pub fn reshape(&self) -> Option<&Reshape> {
        self.reshape.as_ref()
    }

    /// Passive torque at `angle`, N m.
    pub fn torque(&self, angle: f64) -> f64 {
        self.torque_and_slope(angle).0
    }

    /// Slope of the passive torque at `angle`, N m/rad; never positive. Stiffness is minus this.
    pub fn slope(&self, angle: f64) -> f64 {
        self.torque_and_slope(angle).1
    }

    /// Torque (N m) and slope (N m/rad) at `angle`.
    #[inline]
    pub fn torque_and_slope(&self, angle: f64) -> (f64, f64) {
        let (torque, slope) = self.form.torque_and_slope(angle);
        match &self.reshape {
            None => (torque, slope),
            Some(reshape) => {
                let (added_torque, added_slope) = reshape.torque_and_slope(self.range, angle);
                (torque + added_torque, slope + added_slope)
            }
        }
    }

    /// Elastic energy `U` with `torque = -dU/d angle`, J, up to a constant.
    pub fn energy(&self, angle: f64) -> f64 {
        self.form.energy(angle) + self.reshape.as_ref().map_or(0.0, |reshape| reshape.energy(self.range, angle))
    }

    /// The angle of least stiffness inside the range (`theta_d tau_p min` of the paper), rad: the middle of the flattest zone.
    pub fn flattest_angle(&self) -> f64 {
        0.5 * (self.flattest.0 + self.flattest.1)
    }

    /// The flattest zone (rad): both ends are the same angle unless the curve is straight there.
    pub fn flattest_zone(&self) -> (f64, f64) {
        self.flattest
    }

    /// The angles where the slope is `slope` (N m/rad), one at most on each side of the flattest zone; where a curve has
    /// more (CoordinateLimitForce, tables), the pair nearest that zone. At a kink the angle where the slope jumps past
    /// `slope` counts.
    pub fn slope_angles(&self, slope: f64) -> SlopeAngles {
        let (lower_end, upper_end) = self.flattest;
        let mut found = SlopeAngles::default();
        if slope == self.flattest_slope && lower_end < upper_end {
            found = SlopeAngles { lower: Some(lower_end), upper: Some(upper_end) };
        } else if slope < self.flattest_slope {
            self.crossings(slope, |angle| {
                // At a kink that is itself the flattest angle, the steeper neighbour decides the side.
                let kink = lower_end == upper_end && angle == upper_end && self.steeper_beyond(angle, slope);
                if angle <= lower_end && !kink {
                    found.lower = Some(found.lower.map_or(angle, |best| best.max(angle)));
                } else if angle >= upper_end {
                    found.upper = Some(found.upper.map_or(angle, |best| best.min(angle)));
                }
            });
        }
        found
    }

    /// Whether a zone that begins at `angle` is steeper there than `slope`.
    fn steeper_beyond(&self, angle: f64, slope: f64) -> bool {
        self.zones.iter().any(|zone| zone.from == angle && zone.form_slopes.0 + zone.added_slope < slope)
    }

    /// Calls `visit` with every angle of the closed range where the slope passes through `slope` (N m/rad), in no fixed
    /// order and some perhaps twice; a limit of the range counts where the slope there is `slope`.
    ///
    /// Between two neighbouring ones the torque minus `slope * angle` is monotone, which is what makes root searches
    /// complete.
    pub fn crossings(&self, slope: f64, mut visit: impl FnMut(f64)) {
        let mut before: Option<&Zone> = None;
        for zone in &self.zones {
            let steeper = |form_slope: f64, zone: &Zone| form_slope + zone.added_slope < slope;
            if before.is_some_and(|b| steeper(b.form_slopes.1, b) != steeper(zone.form_slopes.0, zone)) {
                visit(zone.from);
            }
            self.form.crossings(slope - zone.added_slope, zone, &mut visit);
            for (angle, form_slope) in [(zone.from, zone.form_slopes.0), (zone.to, zone.form_slopes.1)] {
                let at_limit = angle == self.range.0 || angle == self.range.1;
                if at_limit && form_slope + zone.added_slope == slope {
                    visit(angle);
                }
            }
            before = Some(zone);
        }
    }

    /// The zone of the greatest (least steep) slope and that slope.
    fn find_flattest(&self) -> ((f64, f64), f64) {
        let mut best = (self.range, f64::NEG_INFINITY);
        for zone in &self.zones {
            let angle = f64::midpoint(zone.flattest.0, zone.flattest.1);
            let slope = self.form.torque_and_slope(angle).1 + zone.added_slope;
            if slope > best.1 {
                best = (zone.flattest, slope);
            }
        }
        best
    }
}

impl Form {
    #[inline]
    fn torque_and_slope(&self, angle: f64) -> (f64, f64) {
        match self {
            Self::Exponentials(form) => form.torque_and_slope(angle),
            Self::CoordinateLimitForce(form) => form.torque_and_slope(angle),
            Self::Tabulated(form) => form.torque_and_slope(angle),
        }
    }

    fn energy(&self, angle: f64) -> f64 {
        match self {
            Self::Exponentials(form) => form.energy(angle),
            Self::CoordinateLimitForce(form) => form.energy(angle),
            Self::Tabulated(form) => form.energy(angle),
        }
    }

    fn flattest_zone(&self, from: f64, to: f64) -> (f64, f64) {
        match self {
            Self::Exponentials(form) => form.flattest_zone(from, to),
            Self::CoordinateLimitForce(form) => form.flattest_zone(from, to),
            Self::Tabulated(form) => form.flattest_zone(from, to),
        }
    }

    /// The crossings inside the closed zone. One that rounding puts just outside is moved to its end.
    fn crossings(&self, slope: f64, zone: &Zone, visit: &mut impl FnMut(f64)) {
        let margin = 1e-12 * (zone.to - zone.from);
        let inside = |angle: f64| {
            if angle >= zone.from - margin && angle <= zone.to + margin {
                visit(angle.clamp(zone.from, zone.to));
            }
        };
        match self {
            Self::Exponentials(form) => form.crossings(slope, zone, visit),
            Self::CoordinateLimitForce(form) => form.crossings(slope, zone.from, zone.to, inside),
            Self::Tabulated(form) => form.crossings(slope, inside),
        }
    }
}
