//! Computes the curves of Millard, Uchida, Seth & Delp 2013 ("Flexing computational muscle"), OpenSim's `Millard2012EquilibriumMuscle`,
//! at zero velocity. The knots were learnt from opensim-core, `SmoothSegmentedFunctionFactory`.

use super::curve::{Curve, Knot};
use super::curves::{Curves, MuscleError};

/// Parameters of the active curve against fibre length over optimal length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveCurve {
    /// Length at which force begins.
    pub least: f64,
    /// Length at which the steep part goes over into the shallow one.
    pub transition: f64,
    /// Length at which force ends.
    pub greatest: f64,
    /// Slope of the shallow part.
    pub shallow_slope: f64,
    /// Least value.
    pub floor: f64,
}

impl Default for ActiveCurve {
    fn default() -> Self {
        Self { least: 0.4441, transition: 0.73, greatest: 1.8123, shallow_slope: 0.8616, floor: 0.1 }
    }
}

/// Shape of the passive curve, which has a default by its strains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassiveShape {
    /// Slope at low force.
    pub low_slope: f64,
    /// Slope at the greatest isometric force.
    pub slope: f64,
    /// From 0, sharp corners, to 1.
    pub curviness: f64,
}

/// Parameters of the passive curve against fibre strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassiveFiberCurve {
    /// Strain at which force begins.
    pub zero_strain: f64,
    /// Strain at the greatest isometric force.
    pub strain: f64,
    /// Shape of the curve, where that is not the default.
    pub shape: Option<PassiveShape>,
}

impl Default for PassiveFiberCurve {
    fn default() -> Self {
        Self { zero_strain: 0.0, strain: 0.7, shape: None }
    }
}

/// Shape of the tendon's curve, which has a default by its strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonShape {
    /// Slope at the greatest isometric force.
    pub slope: f64,
    /// Force at which it becomes straight, over the greatest isometric force.
    pub toe_force: f64,
    /// From 0, sharp corners, to 1.
    pub curviness: f64,
}

/// Parameters of the tendon's curve against strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonCurve {
    /// Strain at the greatest isometric force.
    pub strain: f64,
    /// Shape of the curve, where that is not the default.
    pub shape: Option<TendonShape>,
}

impl Default for TendonCurve {
    fn default() -> Self {
        Self { strain: 0.049, shape: None }
    }
}

/// The parameters of one muscle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Millard2012 {
    /// Active force of the fibres.
    pub active: ActiveCurve,
    /// Passive force of the fibres.
    pub passive: PassiveFiberCurve,
    /// Force of the tendon.
    pub tendon: TendonCurve,
}

/// The curves, ready to be evaluated.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Millard {
    active: Curve,
    passive: Curve,
    tendon: Curve,
    pub(super) least_length: f64,
}

impl Millard2012 {
    /// The curves. A rigid tendon and a damped fibre have no least active force.
    pub(super) fn curves(&self) -> Result<Millard, MuscleError> {
        Ok(Millard {
            active: self.active.curve()?,
            passive: self.passive.curve()?,
            tendon: self.tendon.curve()?,
            least_length: self.active.least,
        })
    }
}

impl Curves for Millard {
    fn active(&self, length: f64) -> (f64, f64) {
        self.active.at(length)
    }

    fn passive(&self, length: f64) -> (f64, f64) {
        self.passive.at(length)
    }

    fn tendon(&self, length: f64) -> (f64, f64) {
        self.tendon.at(length)
    }
}

fn refused(what: &'static str, value: f64, accepted: &'static str) -> MuscleError {
    MuscleError { what, value, accepted }
}

impl ActiveCurve {
    fn curve(&self) -> Result<Curve, MuscleError> {
        let Self { least: x0, transition: x1, greatest: x3, shallow_slope, floor } = *self;
        // Fibres pull most at their optimal length.
        let x2 = 1.0;
        // Half the width of the summit, in optimal lengths.
        let half = 0.05 * x2;
        if !(x0 >= 0.0 && x1 > x0 && x1 < x2 - half && x3 > x2 + half) {
            return Err(refused(
                "transition length of the active curve",
                x1,
                "0 <= least < transition < 0.95, greatest > 1.05",
            ));
        }
        if !((0.0..0.5).contains(&floor) && (0.0..(1.0 - floor) / (x2 - x1)).contains(&shallow_slope)) {
            return Err(refused(
                "shallow slope of the active curve",
                shallow_slope,
                "0 to (1 - floor) / (1 - transition)",
            ));
        }
        let end = x2 - half;
        let y1 = 1.0 - shallow_slope * (end - x1);
        let knots = [
            Knot { x: x0, y: floor, slope: 0.0 },
            Knot { x: f64::midpoint(x0, x1), y: 0.5 * y1, slope: 1.25 * y1 / (x1 - x0) },
            Knot { x: f64::midpoint(x1, end), y: f64::midpoint(y1, 1.0), slope: shallow_slope },
            Knot { x: x2, y: 1.0, slope: 0.0 },
            Knot { x: f64::midpoint(x2 + half, x3), y: 0.5, slope: -1.0 / (x3 - x2 - 2.0 * half) },
            Knot { x: x3, y: floor, slope: 0.0 },
        ];
        Ok(Curve::new(&knots, 1.0))
    }
}

impl PassiveFiberCurve {
    fn curve(&self) -> Result<Curve, MuscleError> {
        let span = self.strain - self.zero_strain;
        if span.is_nan() || span <= 0.0 {
            return Err(refused("strain of the passive curve", self.strain, "above its strain at zero force"));
        }
        let default = PassiveShape { low_slope: 0.2, slope: 2.0 / span, curviness: 0.75 };
        let PassiveShape { low_slope, slope, curviness } = self.shape.unwrap_or(default);
        if !(slope > 1.0 / span && low_slope > 0.0 && low_slope < 1.0 / span && (0.0..=1.0).contains(&curviness)) {
            return Err(refused(
                "slope of the passive curve",
                slope,
                "above 1 / strain, with a lower one at low force",
            ));
        }
        let zero = 1.0 + self.zero_strain;
        let low = zero + (0.1 / slope).min(0.1 * span);
        let foot = f64::midpoint(zero, low);
        let knots = [
            Knot { x: zero, y: 0.0, slope: 0.0 },
            Knot { x: low, y: low_slope * (low - foot), slope: low_slope },
            Knot { x: 1.0 + self.strain, y: 1.0, slope },
        ];
        Ok(Curve::new(&knots, curviness))
    }
}

impl TendonCurve {
    fn curve(&self) -> Result<Curve, MuscleError> {
        if self.strain.is_nan() || self.strain <= 0.0 {
            return Err(refused("strain of the tendon", self.strain, "above 0"));
        }
        let default = TendonShape { slope: 1.375 / self.strain, toe_force: 2.0 / 3.0, curviness: 0.5 };
        let TendonShape { slope, toe_force, curviness } = self.shape.unwrap_or(default);
        let fits = slope > 1.0 / self.strain && toe_force > 0.0 && toe_force < 1.0 && (0.0..=1.0).contains(&curviness);
        if !fits {
            return Err(refused("slope of the tendon", slope, "above 1 / strain, with a toe's force between 0 and 1"));
        }
        let straight = |force: f64| 1.0 + self.strain + (force - 1.0) / slope;
        let toe = straight(toe_force);
        let foot = 1.0 + (toe - 1.0) / 10.0;
        let middle = straight(toe_force / 2.0);
        let rise = toe_force / 2.0 / (middle - foot);
        let control = f64::midpoint(foot, middle);
        let knots = [
            Knot { x: 1.0, y: 0.0, slope: 0.0 },
            Knot { x: control, y: rise * (control - foot), slope: rise },
            Knot { x: toe, y: toe_force, slope },
        ];
        Ok(Curve::new(&knots, curviness))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::ActiveCurve;

    /// Beyond the summit, which ends 0.05 above the optimal length.
    #[test]
    fn the_active_curve_falls_to_half_with_the_slope_of_a_line_from_summit_to_end_and_on_to_its_floor() {
        for greatest in [1.3, 1.8123, 2.4] {
            let curve = ActiveCurve { greatest, ..ActiveCurve::default() }.curve().unwrap();
            let (value, slope) = curve.at(0.5 * (1.05 + greatest));
            assert!((value - 0.5).abs() < 1e-12, "{value}");
            assert!((slope + 1.0 / (greatest - 1.1)).abs() < 1e-9, "{slope}");
            let values: Vec<f64> =
                (0..=200).map(|k| curve.at(1.0 + (greatest - 1.0) * f64::from(k) / 200.0).0).collect();
            assert!(values.windows(2).all(|pair| pair[1] <= pair[0] + 1e-12), "{values:?}");
            assert!((values[0] - 1.0).abs() < 1e-12 && (values[200] - 0.1).abs() < 1e-12);
        }
    }
}
