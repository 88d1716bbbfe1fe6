//! Finds a root of a continuous function in an interval at whose ends its sign differs.
//!
//! The paper's `Dichotomy` (Rodriguez & Boulic 2007, Table 1): the bracket is halved until it cannot be halved any more.
//! Newton steps are taken where they stay inside the bracket and shrink fast enough, so the usual cost is a handful of
//! evaluations instead of fifty.

/// Residual below which a Newton iterate that no longer moves is accepted as a root; else the bracket is narrowed to the
/// last bit.
const RESIDUAL: f64 = 1e-9;

/// Evaluations after which only halving is done: it ends for certain, Newton steps usually end long before.
const NEWTON_EVALUATIONS: usize = 60;

/// Root of `f` in `[lo, hi]`, or `None` when both ends have the same sign or one is not finite.
///
/// `f` returns value and slope; the slope may be wrong or NaN, which only costs time. An end where `f` is exactly zero is
/// the root. The answer either has `|f| < 1e-9` and a Newton step below the spacing of `f64`, or is an end of the narrowest
/// bracket that `f64` allows (the end with the smaller `|f|`).
///
/// ```
/// let cube_root = contrapposto::math::dichotomy(|x| (x * x * x - 2.0, 3.0 * x * x), 0.0, 2.0);
/// assert_eq!(cube_root, Some(2f64.cbrt()));
/// assert_eq!(contrapposto::math::dichotomy(|x| (x + 3.0, 1.0), 0.0, 2.0), None);
/// ```
pub fn dichotomy(f: impl Fn(f64) -> (f64, f64), lo: f64, hi: f64) -> Option<f64> {
    let ends = ((lo, f(lo).0), (hi, f(hi).0));
    dichotomy_between(f, ends.0, ends.1, 0.0)
}

/// As [`dichotomy`], where the values at the ends `(x, f(x))` are known already; stops as soon as `|f| <= enough`.
///
/// ```
/// let near = contrapposto::math::dichotomy_between(|x| (x * x - 2.0, 2.0 * x), (0.0, -2.0), (2.0, 2.0), 1e-3);
/// assert!((near.unwrap().powi(2) - 2.0).abs() <= 1e-3);
/// ```
#[inline]
pub fn dichotomy_between(
    f: impl Fn(f64) -> (f64, f64),
    (lo, f_lo): (f64, f64),
    (hi, f_hi): (f64, f64),
    enough: f64,
) -> Option<f64> {
    if !(lo.is_finite() && hi.is_finite()) {
        return None;
    }
    if f_lo == 0.0 {
        return Some(lo);
    }
    if f_hi == 0.0 {
        return Some(hi);
    }
    if (f_lo > 0.0) == (f_hi > 0.0) {
        return None;
    }
    // `below` is the end where f is negative, `above` the one where it is positive.
    let (mut below, mut above) = if f_lo < 0.0 { (lo, hi) } else { (hi, lo) };
    let (mut f_below, mut f_above) = if f_lo < 0.0 { (f_lo, f_hi) } else { (f_hi, f_lo) };
    let mut x = false_position(below, f_below, above, f_above);
    let mut last_step = f64::INFINITY;
    for evaluations in 1.. {
        let (value, slope) = f(x);
        if value.abs() <= enough {
            return Some(x);
        }
        if value < 0.0 {
            (below, f_below) = (x, value);
        } else {
            (above, f_above) = (x, value);
        }
        let newton = x - value / slope;
        let step = (newton - x).abs();
        let inside = newton > below.min(above) && newton < below.max(above);
        if inside && step < 0.5 * last_step && evaluations < NEWTON_EVALUATIONS {
            last_step = step;
            x = newton;
            continue;
        }
        if value.abs() < RESIDUAL && step <= 2.0 * f64::EPSILON * x.abs() {
            return Some(x); // the step is below the spacing of f64: rounding noise points elsewhere
        }
        let middle = f64::midpoint(below, above);
        if middle == below || middle == above {
            break;
        }
        last_step = (above - below).abs();
        x = middle;
    }
    Some(if f_below.abs() < f_above.abs() { below } else { above })
}

/// First guess: where the chord crosses zero, kept away from the ends.
fn false_position(a: f64, f_a: f64, b: f64, f_b: f64) -> f64 {
    let t = (f_a / (f_a - f_b)).clamp(0.01, 0.99);
    (1.0 - t) * a + t * b
}

#[cfg(test)]
mod tests {
    use super::dichotomy;

    #[test]
    fn steep_and_flat_roots_reach_the_last_bit() {
        for (scale, rate) in [(1.0, 1.0), (1e150, 40.0), (1e-12, 0.1), (1.0, 300.0)] {
            let f = |x: f64| {
                let e = libm::exp(-rate * x);
                (scale * (0.3 - e), scale * rate * e)
            };
            let exact = -(libm::log(0.3)) / rate;
            let root = dichotomy(f, 0.0, 100.0).unwrap();
            assert!((root - exact).abs() <= 4.0 * f64::EPSILON * exact, "{scale} {rate}: {root} {exact}");
        }
    }

    #[test]
    fn wrong_slopes_still_end_in_the_narrowest_bracket() {
        for slope in [0.0, -1.0, f64::INFINITY, f64::NAN, 1e-300] {
            let root = dichotomy(|x| (x - 0.1, slope), -1.0, 1.0).unwrap();
            assert!((root - 0.1).abs() <= 2.0 * f64::EPSILON, "{slope}: {root}");
        }
    }

    #[test]
    fn a_jump_is_bracketed() {
        let root = dichotomy(|x| (if x < 0.7 { -1.0 } else { 2.0 }, 0.0), 0.0, 1.0).unwrap();
        assert!((root - 0.7).abs() <= f64::EPSILON);
    }

    #[test]
    fn a_jump_at_zero_in_the_widest_interval_is_bracketed() {
        let root = dichotomy(|x| (if x < 1e-320 { -1.0 } else { 2.0 }, f64::NAN), -f64::MAX, f64::MAX).unwrap();
        assert!((0.0..=1e-320).contains(&root), "{root:e}");
    }
}
