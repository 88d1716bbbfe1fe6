//! Computes the angles of swing and twist of an orientation, and their derivatives.
//!
//! An orientation `R` is a turn `twist` about the long axis `e_t` of the distal segment, followed by a swing about an axis
//! square to it (Grassia 1998, J. Graphics Tools 3:29-48; Baerlocher & Boulic 2001, "Parametrization and range of motion of the
//! ball-and-socket joint"):
//!
//! ```text
//! Q0^-1 Q = (w, v), unit quaternions of the orientation from the reference Q0
//! twist   = 2 atan2(v_t, w)
//! c       = sqrt(w^2 + v_t^2) = cos(swing / 2)
//! swing_a = (w v_a - h v_t v_b) swing / (c sin(swing / 2)),  swing_b = (w v_b + h v_t v_a) swing / (c sin(swing / 2))
//! ```
//!
//! with `h = e_t . (e_a x e_b)`, 1 or -1. The reference is a swing itself, whose components are added: turns about one axis only
//! have the angle of that axis as long as the reference has none about the other one. The angles are functions of `R` alone,
//! smooth up to half a turn of swing from the reference and up to half a turn of twist.
//!
//! Derivatives are by rotations of the distal segment about its own axes: `E_k f(R) = d/ds f(R exp(s e_k))` at `s = 0`. Second
//! ones do not commute: `E_m E_l - E_l E_m` is the derivative about `e_m x e_l`.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::jet::Jet;

/// Cosine of half the swing from which on the quotient of swing and its half sine is a series.
const SERIES_COSINE: f64 = 0.999;

/// The axes that swing and twist are counted about, and the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct SwingTwist {
    /// Orthonormal axes in the distal frame.
    axes: [Vector3<f64>; 3],
    /// Index of the long axis.
    twist: usize,
    /// Inverse of the reference orientation.
    back: UnitQuaternion<f64>,
    /// Swing of the reference about each axis, rad.
    reference: [f64; 3],
}

/// Angles about three axes, and their derivatives by rotations about these axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    /// By axis, rad.
    pub values: [f64; 3],
    /// `E_k x_j` in row `j` and column `k`.
    pub first: Matrix3<f64>,
    /// `E_m E_l x_j` in row `m` and column `l` of entry `j`; not symmetric.
    pub second: [Matrix3<f64>; 3],
}

impl Default for Angles {
    fn default() -> Self {
        Self { values: [0.0; 3], first: Matrix3::identity(), second: [Matrix3::zeros(); 3] }
    }
}

impl SwingTwist {
    /// About orthonormal `axes`, of which `twist` is the long one, from a reference that swings by so many rad about the others.
    pub fn new(axes: [Vector3<f64>; 3], twist: usize, mut reference: [f64; 3]) -> Self {
        reference[twist] = 0.0;
        let turn: Vector3<f64> = axes.iter().zip(reference).map(|(axis, angle)| angle * axis).sum();
        Self { axes, twist, back: UnitQuaternion::from_scaled_axis(turn).inverse(), reference }
    }

    /// Index of the long axis.
    pub fn twist(&self) -> usize {
        self.twist
    }

    /// Swing of the reference about each axis, rad.
    pub fn reference(&self) -> [f64; 3] {
        self.reference
    }

    /// The angles of an orientation.
    pub fn angles(&self, orientation: &UnitQuaternion<f64>) -> Angles {
        let q = self.back * orientation;
        let (w, v) = (q.w, q.imag());
        // Q exp(d) = Q (1 - |d|^2/8, d/2) to second order.
        let jet = |value: f64, by: [f64; 3]| Jet {
            value,
            gradient: Vector3::from(by),
            hessian: Matrix3::from_diagonal_element(-0.25 * value),
        };
        let scalar = jet(w, self.axes.map(|axis| -0.5 * v.dot(&axis)));
        let part = |j: usize| {
            let axis = &self.axes[j];
            jet(v.dot(axis), self.axes.map(|by| 0.5 * (w * axis.dot(&by) + axis.dot(&v.cross(&by)))))
        };
        let (t, a, b) = (self.twist, (self.twist + 1) % 3, (self.twist + 2) % 3);
        let hand = self.axes[t].dot(&self.axes[a].cross(&self.axes[b])).signum();
        let (along, first, second) = (part(t), part(a), part(b));
        let twist = 2.0 * along.atan2(scalar);
        let cosine = (scalar * scalar + along * along).sqrt();
        let factor = cosine.compose(swing_over_sine(cosine.value)) * cosine.recip();
        let mut jets = [twist; 3];
        jets[a] = (scalar * first + (-hand) * (along * second)) * factor;
        jets[b] = (scalar * second + hand * (along * first)) * factor;
        let mut angles = Angles::default();
        for (j, jet) in jets.iter().enumerate() {
            angles.values[j] = jet.value + self.reference[j];
            angles.first.set_row(j, &jet.gradient.transpose());
            angles.second[j] = jet.hessian + 0.5 * self.turned(&jet.gradient);
        }
        angles.values[t] = wrapped(angles.values[t]);
        angles
    }

    /// The angles of an orientation without derivatives, rad: to the bit the values of [`SwingTwist::angles`].
    pub fn values(&self, orientation: &UnitQuaternion<f64>) -> [f64; 3] {
        let q = self.back * orientation;
        let (w, v) = (q.w, q.imag());
        let (t, a, b) = (self.twist, (self.twist + 1) % 3, (self.twist + 2) % 3);
        let hand = self.axes[t].dot(&self.axes[a].cross(&self.axes[b])).signum();
        let [along, first, second] = [t, a, b].map(|j| v.dot(&self.axes[j]));
        let cosine = (w * w + along * along).sqrt();
        let factor = swing_over_sine(cosine)[0] * cosine.recip();
        let mut values = [0.0; 3];
        values[t] = wrapped(2.0 * libm::atan2(along, w) + self.reference[t]);
        values[a] = (w * first + (-hand) * (along * second)) * factor + self.reference[a];
        values[b] = (w * second + hand * (along * first)) * factor + self.reference[b];
        values
    }

    /// The orientation that has the angles `values`, rad.
    pub fn orientation(&self, values: [f64; 3]) -> UnitQuaternion<f64> {
        let turn = |of: &dyn Fn(usize) -> f64| -> Vector3<f64> { (0..3).map(|j| of(j) * self.axes[j]).sum() };
        let swing = turn(&|j| if j == self.twist { 0.0 } else { values[j] - self.reference[j] });
        let twist = turn(&|j| if j == self.twist { values[j] } else { 0.0 });
        self.back.inverse() * UnitQuaternion::from_scaled_axis(swing) * UnitQuaternion::from_scaled_axis(twist)
    }

    /// `E_m E_l - E_l E_m` of a function with the derivatives `gradient` about the axes: row `m`, column `l`.
    pub fn turned(&self, gradient: &Vector3<f64>) -> Matrix3<f64> {
        Matrix3::from_fn(|m, l| {
            let about = self.axes[m].cross(&self.axes[l]);
            (0..3).map(|n| about.dot(&self.axes[n]) * gradient[n]).sum()
        })
    }
}

/// `swing / sin(swing / 2)` by `c = cos(swing / 2)`, `f(c) = 2 acos(c) / sqrt(1 - c^2)`, with its first two derivatives.
fn swing_over_sine(c: f64) -> [f64; 3] {
    let d = 1.0 - c;
    if c > SERIES_COSINE {
        // f = 2 (1 + d/3 + 2 d^2/15 + 2 d^3/35 + 8 d^4/315 + ...), d = 1 - c.
        let f = 2.0 * (1.0 + d * (1.0 / 3.0 + d * (2.0 / 15.0 + d * (2.0 / 35.0 + d * 8.0 / 315.0))));
        let first = -2.0 * (1.0 / 3.0 + d * (4.0 / 15.0 + d * (6.0 / 35.0 + d * 32.0 / 315.0)));
        let second = 2.0 * (4.0 / 15.0 + d * (12.0 / 35.0 + d * 96.0 / 315.0));
        return [f, first, second];
    }
    let sine = d * (1.0 + c);
    let f = 2.0 * libm::acos(c) / sine.sqrt();
    let first = (c * f - 2.0) / sine;
    [f, first, (f + 3.0 * c * first) / sine]
}

/// The same angle within half a turn.
fn wrapped(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    if angle > std::f64::consts::PI {
        angle - turn
    } else if angle < -std::f64::consts::PI {
        angle + turn
    } else {
        angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::next_number;

    /// The series and the formula agree at the angle where one takes over, but for what the series leaves out.
    #[test]
    fn the_series_of_a_small_swing_goes_on_from_its_formula() {
        let series = swing_over_sine(SERIES_COSINE + 1e-15);
        let formula = swing_over_sine(SERIES_COSINE);
        for (k, tolerance) in [1e-13, 1e-11, 2e-9].into_iter().enumerate() {
            let error = (series[k] - formula[k]).abs();
            assert!(error < tolerance, "derivative {k}: {} and {}", series[k], formula[k]);
        }
    }

    #[test]
    fn values_are_those_of_the_angles_with_derivatives_to_the_bit() {
        let mut state = 1;
        for twist in 0..3 {
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            let joint = SwingTwist::new(axes, twist, [0.3, -0.2, 0.4]);
            for _ in 0..3_000 {
                let turn = Vector3::from_fn(|_, _| std::f64::consts::PI * next_number(&mut state));
                let orientation = UnitQuaternion::from_scaled_axis(turn);
                assert_eq!(joint.values(&orientation), joint.angles(&orientation).values, "{turn}");
            }
        }
    }
}
