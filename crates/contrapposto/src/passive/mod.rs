//! How much torque do ligaments and connective tissue give at an angle?
//!
//! One contract for every published form: [`PassiveCurve`] answers torque, slope, energy, the flattest zone and the angles
//! at which the slope has a given value, inside a closed range. One file per form, named after its author. Sign: torque
//! acts in the direction of increasing angle, so a physical curve falls (Rodriguez & Boulic 2007, section 2.2).

mod coordinate_limit_force;
mod exponentials;
mod reshape;
mod riener_edrich1999;
mod tabulated;

pub use coordinate_limit_force::CoordinateLimitForce;
pub use exponentials::{DoubleExponential, End, Exponentials};
pub use reshape::Reshape;
pub use riener_edrich1999::{CoupledTerm, RienerEdrich1999};
pub use tabulated::Tabulated;

/// What a curve is made of.
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

/// Why a curve was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PassiveError {
    /// A parameter has no meaning.
    #[error("{name} is {value}; it must be {accepted}")]
    Parameter {
        /// Name of the parameter with its unit.
        name: &'static str,
        /// The value given.
        value: f64,
        /// What would be accepted.
        accepted: &'static str,
    },
    /// The torque rises with the angle somewhere in the range.
    #[error("passive torque rises at {:.4} deg (slope {slope:+.4} N m/rad); it must fall or stay level over the whole range", angle.to_degrees())]
    Rises {
        /// Angle where it does, rad.
        angle: f64,
        /// Slope there, N m/rad.
        slope: f64,
    },
    /// The torque is not a finite number at a limit of the range.
    #[error("passive torque is {torque} N m at {:.4} deg; it must be finite over the whole range", angle.to_degrees())]
    NotFinite {
        /// Angle, rad.
        angle: f64,
        /// Torque there.
        torque: f64,
    },
    /// The table's angles are not in order, or too few.
    #[error("row {row} of the table: {problem}")]
    Table {
        /// Row, counted from 1.
        row: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
}

/// The angles on both sides of the flattest zone at which the slope has a given value (`theta_smin`, `theta_smax` of the
/// paper). `None`: not inside the closed range.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
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
    flattest: (f64, f64),
    flattest_slope: f64,
}

impl PassiveCurve {
    /// A curve over `range` (rad, lower limit first), reshaped near both limits if asked for.
    ///
    /// # Errors
    /// [`PassiveError::Rises`] with the angle if the torque rises anywhere in the range, and the other variants for
    /// parameters without meaning.
    pub fn new(form: Form, range: (f64, f64), reshape: Option<Reshape>) -> Result<Self, PassiveError> {
        let (min, max) = range;
        if !(min.is_finite() && max.is_finite() && min < max) {
            let value = if min.is_finite() { max } else { min };
            return Err(PassiveError::Parameter { name: "range", value, accepted: "finite, lower limit below upper" });
        }
        if let Form::Tabulated(table) = &form {
            table.check_covers(range)?;
        }
        let mut curve = Self { form, range, reshape, flattest: range, flattest_slope: 0.0 };
        if let Some(reshape) = &curve.reshape {
            reshape.check(range)?;
        }
        for angle in [min, max] {
            let torque = curve.torque(angle);
            if !torque.is_finite() || !curve.slope(angle).is_finite() {
                return Err(PassiveError::NotFinite { angle, torque });
            }
        }
        if let Form::Exponentials(exponentials) = &curve.form {
            exponentials.check_falls(range)?;
        }
        (curve.flattest, curve.flattest_slope) = curve.find_flattest();
        Ok(curve)
    }

    /// The closed range (lower, upper), rad.
    pub fn range(&self) -> (f64, f64) {
        self.range
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
        let (torque, slope) = match &self.form {
            Form::Exponentials(form) => form.torque_and_slope(angle),
            Form::CoordinateLimitForce(form) => form.torque_and_slope(angle),
            Form::Tabulated(form) => form.torque_and_slope(angle),
        };
        match &self.reshape {
            None => (torque, slope),
            Some(reshape) => {
                let (extra, extra_slope) = reshape.torque_and_slope(self.range, angle);
                (torque + extra, slope + extra_slope)
            }
        }
    }

    /// Elastic energy `U` with `torque = -dU/d angle`, J, up to a constant.
    pub fn energy(&self, angle: f64) -> f64 {
        let energy = match &self.form {
            Form::Exponentials(form) => form.energy(angle),
            Form::CoordinateLimitForce(form) => form.energy(angle),
            Form::Tabulated(form) => form.energy(angle),
        };
        energy + self.reshape.as_ref().map_or(0.0, |reshape| reshape.energy(self.range, angle))
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
        if slope == self.flattest_slope && lower_end < upper_end {
            return SlopeAngles { lower: Some(lower_end), upper: Some(upper_end) };
        }
        let mut found = SlopeAngles::default();
        if slope < self.flattest_slope {
            self.crossings(slope, |angle| {
                if angle <= lower_end {
                    found.lower = Some(found.lower.map_or(angle, |best| best.max(angle)));
                } else if angle >= upper_end {
                    found.upper = Some(found.upper.map_or(angle, |best| best.min(angle)));
                }
            });
        }
        found
    }

    /// Calls `visit` with every angle of the closed range where the slope passes through `slope` (N m/rad).
    ///
    /// Between two neighbouring ones the torque minus `slope * angle` is monotone, which is what makes root searches
    /// complete.
    pub fn crossings(&self, slope: f64, mut visit: impl FnMut(f64)) {
        let (min, max) = self.range;
        match &self.reshape {
            None => self.form_crossings(slope, min, max, &mut visit),
            Some(reshape) => {
                for (from, to, extra_slope) in reshape.zones(self.range) {
                    self.form_crossings(slope - extra_slope, from, to, &mut visit);
                }
                for (kink, left, right) in reshape.kinks(self.range) {
                    let base = self.slope(kink) - reshape.torque_and_slope(self.range, kink).1;
                    if (base + left < slope) != (base + right < slope) {
                        visit(kink);
                    }
                }
            }
        }
    }

    fn form_crossings(&self, slope: f64, from: f64, to: f64, visit: &mut impl FnMut(f64)) {
        let inside = |angle: f64| {
            if angle >= from && angle <= to {
                visit(angle);
            }
        };
        match &self.form {
            Form::Exponentials(form) => form.crossings(slope, inside),
            Form::CoordinateLimitForce(form) => form.crossings(slope, inside),
            Form::Tabulated(form) => form.crossings(slope, inside),
        }
    }

    /// The zone of the greatest (least steep) slope and that slope.
    fn find_flattest(&self) -> ((f64, f64), f64) {
        let (min, max) = self.range;
        let whole = [(min, max, 0.0)];
        let zones = self.reshape.as_ref().map(|reshape| reshape.zones(self.range));
        let mut best = ((min, min), f64::NEG_INFINITY);
        for &(from, to, extra) in zones.as_ref().map_or(&whole[..], |zones| &zones[..]) {
            let zone = match &self.form {
                Form::Exponentials(form) => form.flattest_zone(from, to),
                Form::CoordinateLimitForce(form) => form.flattest_zone(from, to),
                Form::Tabulated(form) => form.flattest_zone(from, to),
            };
            let middle = 0.5 * (zone.0 + zone.1);
            let slope = match &self.form {
                Form::Exponentials(form) => form.torque_and_slope(middle).1,
                Form::CoordinateLimitForce(form) => form.torque_and_slope(middle).1,
                Form::Tabulated(form) => form.torque_and_slope(middle).1,
            } + extra;
            if slope > best.1 {
                best = (zone, slope);
            }
        }
        best
    }
}
