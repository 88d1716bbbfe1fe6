//! Defines the passive torque of muscles about one coordinate near a posture.
//!
//! Muscles cross several joints, so that their torque `tau_i(q)` is a function of all of them, costly to compute. Near the posture `q0`
//!
//! ```text
//! tau_i(q) = table(q_i) + s_i + sum_j k_j w tanh((q_j - q0_j) / w)          j over all coordinates, i included
//! ```
//!
//! with a falling table of the torque over the range of `q_i`, the others held. `s_i` and `k_j` make torque and whole gradient exact in `q0`;
//! the hyperbolic tangent ends what a derivative of one posture says about others: beyond about `w` the table alone counts.

use std::sync::Arc;

use super::{Form, PassiveCurve, PassiveError, Tabulated};

/// `w`: angle over which the derivatives of a posture are followed, rad (m for slides). Assumed: half the turn after which published curves
/// of a joint with its neighbours held look different (Riener & Edrich 1999).
const FOLLOWED: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Distance of rows that count as one, rad.
const ONE_ROW: f64 = 1e-4;

/// Passive torque of muscles about one coordinate near a posture.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    table: Arc<PassiveCurve>,
    shift: f64,
    /// Coordinates with their angles in the posture, rad, and the slopes that are not the table's, N m/rad.
    slopes: Vec<(usize, f64, f64)>,
}

impl Slice {
    /// A falling table of coordinate `own`, brought to `torque` (N m) and its derivatives (N m/rad) by coordinates at the angles (rad) of
    /// a posture: (coordinate, angle, derivative), `own` among them.
    ///
    /// # Panics
    /// Unless `own` is among the derivatives.
    pub fn new(table: Arc<PassiveCurve>, own: usize, torque: f64, derivatives: &[(usize, f64, f64)]) -> Self {
        let angle = derivatives.iter().find(|(by, ..)| *by == own).map(|(_, angle, _)| *angle);
        let angle = angle.unwrap_or_else(|| panic!("no derivative by coordinate {own} itself"));
        let (of_table, slope_of_table) = along(&table, angle);
        let rest =
            |&(by, at, slope): &(usize, f64, f64)| (by, at, if by == own { slope - slope_of_table } else { slope });
        Self { shift: torque - of_table, slopes: derivatives.iter().map(rest).collect(), table }
    }

    /// The same table with its neighbour `coordinate` held at an angle, rad.
    pub(crate) fn hold(&mut self, coordinate: usize, angle: f64) {
        let held = self.slopes.iter().filter(|(by, ..)| *by == coordinate);
        self.shift += held.map(|slope| followed(slope, angle).0).sum::<f64>();
        self.slopes.retain(|(by, ..)| *by != coordinate);
    }

    /// Torque (N m) in a posture (values of all coordinates, rad), and through `visit` its derivatives by coordinates, N m/rad.
    pub(super) fn torque_and_slopes(&self, own: usize, posture: &[f64], mut visit: impl FnMut(usize, f64)) -> f64 {
        let (mut torque, slope) = along(&self.table, posture[own]);
        visit(own, slope);
        torque += self.shift;
        for of in &self.slopes {
            let (more, slope) = followed(of, posture[of.0]);
            torque += more;
            visit(of.0, slope);
        }
        torque
    }

    /// Derivative by the own coordinate at an angle, N m/rad.
    pub(super) fn own_slope(&self, own: usize, angle: f64) -> f64 {
        let at = self.slopes.iter().filter(|(by, ..)| *by == own);
        along(&self.table, angle).1 + at.map(|slope| followed(slope, angle).1).sum::<f64>()
    }

    /// The falling curve over `range` (rad) with the neighbours held as in `posture`.
    pub(super) fn curve(&self, own: usize, posture: &[f64], range: (f64, f64)) -> Result<PassiveCurve, PassiveError> {
        let neighbours = self.slopes.iter().filter(|(by, ..)| *by != own);
        let shift = self.shift + neighbours.map(|slope| followed(slope, posture[slope.0]).0).sum::<f64>();
        let (low, high) = self.table.range();
        let mut angles = vec![range.0];
        if let Form::Tabulated(table) = self.table.form() {
            let starts = table.pieces().iter().map(|piece| piece.start);
            angles.extend(starts.chain([low, high]).filter(|angle| range.0 < *angle && *angle < range.1));
        }
        angles.push(range.1);
        // A row at the present angle, so that the curve passes through the torque there.
        let here = posture[own];
        if range.0 < here && here < range.1 {
            angles.retain(|angle| *angle == range.0 || *angle == range.1 || (angle - here).abs() > ONE_ROW);
            angles.push(here);
        }
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        let mut rows: Vec<(f64, f64)> = vec![];
        for angle in angles {
            let torque = along(&self.table, angle).0 + shift;
            // The last bit of a sum may rise.
            rows.push((angle, rows.last().map_or(torque, |(_, before)| torque.min(*before))));
        }
        PassiveCurve::new(Tabulated::new(&rows)?.form(), range, None)
    }

    /// The same with `times` the torque.
    pub(super) fn scaled(&self, times: f64) -> Result<Self, PassiveError> {
        let slopes = self.slopes.iter().map(|(by, angle, slope)| (*by, *angle, times * slope)).collect();
        Ok(Self { table: Arc::new(self.table.scaled(times)?), shift: times * self.shift, slopes })
    }
}

/// Torque and slope of a table; beyond its range along its tangent there.
fn along(table: &PassiveCurve, angle: f64) -> (f64, f64) {
    let (low, high) = table.range();
    let inside = angle.clamp(low, high);
    let (torque, slope) = table.torque_and_slope(inside);
    (torque + slope * (angle - inside), slope)
}

/// Torque and slope that a derivative of the posture gives at an angle.
fn followed(&(_, at, slope): &(usize, f64, f64), angle: f64) -> (f64, f64) {
    let tanh = libm::tanh((angle - at) / FOLLOWED);
    (slope * FOLLOWED * tanh, slope * (1.0 - tanh * tanh))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slice() -> Slice {
        let rows = [(-0.5, 4.0), (0.0, 1.0), (0.5, 0.5), (1.0, -3.0)];
        let table = PassiveCurve::new(Tabulated::new(&rows).unwrap().form(), (-0.5, 1.0), None).unwrap();
        Slice::new(Arc::new(table), 1, 2.5, &[(0, 0.3, -4.0), (1, 0.2, -1.5), (2, -0.1, 3.0)])
    }

    #[test]
    fn torque_and_gradient_in_the_posture_are_those_given() {
        let (slice, posture) = (slice(), [0.3, 0.2, -0.1]);
        let mut gradient = [0.0; 3];
        let torque = slice.torque_and_slopes(1, &posture, |by, slope| gradient[by] += slope);
        assert!((torque - 2.5).abs() < 1e-12, "{torque}");
        for (found, given) in gradient.into_iter().zip([-4.0, -1.5, 3.0]) {
            assert!((found - given).abs() < 1e-12, "{gradient:?}");
        }
    }

    #[test]
    fn gradient_agrees_with_central_differences_also_beyond_the_table() {
        let slice = slice();
        for own in [-0.8, -0.1, 0.2, 0.7, 1.3] {
            let posture = [0.4, own, -0.3];
            let mut gradient = [0.0; 3];
            slice.torque_and_slopes(1, &posture, |by, slope| gradient[by] += slope);
            assert!((slice.own_slope(1, own) - gradient[1]).abs() < 1e-12);
            for by in 0..3 {
                let at = |h: f64| {
                    let mut moved = posture;
                    moved[by] += h;
                    slice.torque_and_slopes(1, &moved, |_, _| {})
                };
                let difference = (at(1e-6) - at(-1e-6)) / 2e-6;
                assert!((difference - gradient[by]).abs() < 1e-6, "{own} {by}: {difference} {gradient:?}");
            }
        }
    }

    #[test]
    fn curve_falls_over_the_range_and_passes_through_the_torque_of_the_posture() {
        let posture = [0.3, 0.2, -0.1];
        for range in [(-1.0, 1.5), (0.1, 0.4), (0.5, 1.2)] {
            let curve = slice().curve(1, &posture, range).unwrap();
            assert_eq!(curve.range(), range);
            if range.0 < 0.2 && range.1 > 0.2 {
                assert!((curve.torque(0.2) - 2.5).abs() < 1e-12, "{range:?}: {}", curve.torque(0.2));
            }
        }
    }

    #[test]
    fn a_neighbour_that_is_held_adds_its_torque_and_no_slope() {
        let (whole, posture) = (slice(), [0.7, 0.4, 0.5]);
        let mut held = whole.clone();
        held.hold(0, 0.7);
        let gradient = |slice: &Slice| {
            let mut gradient = [0.0; 3];
            (slice.torque_and_slopes(1, &posture, |by, slope| gradient[by] += slope), gradient)
        };
        let ((a, by), (b, without)) = (gradient(&whole), gradient(&held));
        assert!((a - b).abs() < 1e-12 && by[0] < -0.01);
        assert_eq!(without, [0.0, by[1], by[2]]);
        assert_eq!(held.scaled(2.0).unwrap().torque_and_slopes(1, &posture, |_, _| {}), 2.0 * b);
    }
}
