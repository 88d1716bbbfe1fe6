//! Computes sine and cosine by additions, multiplications and operations on bits alone, so that eight angles are computed at a time.
//!
//! The angle is reduced to `|r| <= pi/4` by subtracting `k pi/2` in three parts, of which the first two have 33 bits, so that their
//! products with `k` are exact (Cody & Waite 1980, chapter 8); the polynomials are the minimax ones of Sun's fdlibm (`k_sin.c` and
//! `k_cos.c`, 1993; recalled). The results differ from those of the standard library by at most two units in the last place.

use super::lanes::{LANES, Lanes};

/// Largest angle, rad, up to which `k` has at most 20 bits.
pub(super) const LARGEST_ANGLE: f64 = 1e6;

/// Adding it rounds to a whole number, which the lowest bits then hold.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// `pi/2` in three parts.
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Coefficients of `z, z^2, ...` of `sin(r)/r - 1`, `z = r^2`.
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// Coefficients of `z^2, z^3, ...` of `cos(r) - 1 + z/2`.
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sine and cosine of every lane, whose angles are at most [`LARGEST_ANGLE`] in size.
#[inline(always)]
pub(super) fn sin_cos(angles: Lanes) -> (Lanes, Lanes) {
    let (mut sines, mut cosines) = ([0.0; LANES], [0.0; LANES]);
    for i in 0..LANES {
        (sines[i], cosines[i]) = of_angle(angles.0[i]);
    }
    (Lanes(sines), Lanes(cosines))
}

/// As [`sin_cos`], with the standard library's results for larger angles.
pub(super) fn sin_cos_of_any(angles: Lanes) -> (Lanes, Lanes) {
    let (mut sines, mut cosines) = sin_cos(angles);
    for (i, angle) in angles.0.into_iter().enumerate().filter(|(_, angle)| angle.abs() > LARGEST_ANGLE) {
        (sines.0[i], cosines.0[i]) = libm::sincos(angle);
    }
    (sines, cosines)
}

#[inline(always)]
fn of_angle(angle: f64) -> (f64, f64) {
    let shifted = angle * std::f64::consts::FRAC_2_PI + ROUNDING;
    let (k, quadrant) = (shifted - ROUNDING, shifted.to_bits());
    let r = ((angle - k * HALF_PI[0]) - k * HALF_PI[1]) - k * HALF_PI[2];
    let z = r * r;
    let [a, b, c, d, e, f] = SINE;
    let sine = r + (r * z) * (a + z * (b + z * (c + z * (d + z * (e + z * f)))));
    let [a, b, c, d, e, f] = COSINE;
    let half = 0.5 * z;
    let near = 1.0 - half;
    let rest = (z * z) * (a + z * (b + z * (c + z * (d + z * (e + z * f)))));
    let cosine = near + (((1.0 - near) - half) + rest);
    // Odd quadrants exchange both; the sign of the sine changes in quadrants 2 and 3, that of the cosine in 1 and 2.
    let (sine, cosine) = (sine.to_bits(), cosine.to_bits());
    let exchanged = (sine ^ cosine) & 0u64.wrapping_sub(quadrant & 1);
    let sine = sine ^ exchanged ^ ((quadrant & 2) << 62);
    let cosine = cosine ^ exchanged ^ ((quadrant.wrapping_add(1) & 2) << 62);
    (f64::from_bits(sine), f64::from_bits(cosine))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance of `a` from `b` in units in the last place of `b`.
    fn units(a: f64, b: f64) -> f64 {
        (a - b).abs() / (f64::from_bits(b.abs().to_bits() + 1) - b.abs())
    }

    fn assert_near(angle: f64) {
        let (sine, cosine) = of_angle(angle);
        let (s, c) = libm::sincos(angle);
        assert!(units(sine, s) <= 2.0, "sin {angle:e} is {sine:e}, by the standard library {s:e}");
        assert!(units(cosine, c) <= 2.0, "cos {angle:e} is {cosine:e}, by the standard library {c:e}");
    }

    #[test]
    fn angles_all_over_the_range_agree_with_the_standard_library_to_two_units_in_the_last_place() {
        for i in -400_000..=400_000 {
            let share = f64::from(i) / 400_000.0;
            assert_near(share * 4.0);
            assert_near(share * LARGEST_ANGLE);
            assert_near(share * share * share * 1e-3);
        }
        assert_near(LARGEST_ANGLE);
        assert_near(-LARGEST_ANGLE);
    }

    #[test]
    fn angles_next_to_multiples_of_a_quarter_turn_agree_with_the_standard_library_to_two_units_in_the_last_place() {
        for k in -600_000..=600_000 {
            let at = f64::from(k) * std::f64::consts::FRAC_PI_2;
            let next = f64::from_bits(at.to_bits() + 1);
            [at, next].into_iter().for_each(assert_near);
        }
    }

    #[test]
    fn zero_has_the_sine_zero_and_the_cosine_one() {
        assert_eq!(of_angle(0.0), (0.0, 1.0));
        assert_eq!(of_angle(-0.0), (0.0, 1.0));
    }

    #[test]
    fn an_angle_beyond_the_range_has_the_standard_librarys_sine_and_leaves_other_lanes_alone() {
        let mut angles = Lanes::all(0.3);
        let alone = sin_cos(angles);
        angles.0[5] = 7e8;
        let (sines, cosines) = sin_cos_of_any(angles);
        assert_eq!((sines.0[5], cosines.0[5]), libm::sincos(7e8f64));
        assert_eq!((sines.0[4], cosines.0[4]), (alone.0.0[4], alone.1.0[4]));
    }
}
