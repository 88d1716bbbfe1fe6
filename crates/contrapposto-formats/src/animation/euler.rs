//! Computes three angles of a rotation that continue the angles before without jumps.

use std::f64::consts::{PI, TAU};

use nalgebra::Matrix3;

/// Nearer than this to its pole (cosine of the middle angle) the first angle is kept as it was.
const POLE: f64 = 1e-9;

/// Angles `[a, b, c]`, rad, with `rotation = Rz(a) Ry(b) Rx(c)`: of all such angles those nearest to `before`.
pub(crate) fn zyx(rotation: &Matrix3<f64>, before: [f64; 3]) -> [f64; 3] {
    let r = rotation;
    let level = libm::hypot(r[(0, 0)], r[(1, 0)]);
    let a = if level < POLE { before[0] } else { libm::atan2(r[(1, 0)], r[(0, 0)]) };
    let b = libm::atan2(-r[(2, 0)], level);
    // Well conditioned for whatever first angle was taken.
    let (sin, cos) = libm::sincos(a);
    let c = libm::atan2(sin * r[(0, 2)] - cos * r[(1, 2)], cos * r[(1, 1)] - sin * r[(0, 1)]);
    let near = |angles: [f64; 3]| [0, 1, 2].map(|i| angles[i] - TAU * ((angles[i] - before[i]) / TAU).round());
    let way = |angles: &[f64; 3]| angles.iter().zip(before).map(|(a, b)| (a - b).abs()).sum::<f64>();
    let (one, other) = (near([a, b, c]), near([a + PI, PI - b, c + PI]));
    if level >= POLE && way(&other) < way(&one) { other } else { one }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Vector3};

    use super::*;

    fn rotation([a, b, c]: [f64; 3]) -> Matrix3<f64> {
        let turn = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
        (turn(Vector3::z_axis(), a) * turn(Vector3::y_axis(), b) * turn(Vector3::x_axis(), c)).into_inner()
    }

    /// Through poles and many turns: the same rotation to rounding, and the very angles where they run smoothly.
    #[test]
    fn angles_give_the_rotation_and_run_on() {
        let (mut worst, mut before) = (0.0_f64, [0.0; 3]);
        for i in 0..4000 {
            let t = f64::from(i) * 0.005;
            let wanted = [1.3 * t, 0.4 * libm::sin(0.7 * t), -0.9 * t];
            let found = zyx(&rotation(wanted), before);
            worst = worst.max([0, 1, 2].map(|k| (found[k] - wanted[k]).abs()).into_iter().fold(0.0, f64::max));
            before = found;
        }
        assert!(worst < 1e-12, "{worst:e}");
        for b in [PI / 2.0, -PI / 2.0, PI / 2.0 - 1e-10, PI / 2.0 + 1e-8] {
            for a in [0.0, 1.0, -3.0] {
                for c in [0.0, -2.0, 3.0] {
                    let wanted = rotation([a, b, c]);
                    let off = (rotation(zyx(&wanted, [0.3, 0.1, -0.2])) - wanted).norm();
                    assert!(off < 1e-8, "{a} {b} {c}: {off:e}");
                }
            }
        }
    }
}
