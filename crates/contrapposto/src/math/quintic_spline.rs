//! Computes the natural quintic spline through points, with its first and second derivative.
//!
//! The spline of degree 5 with four continuous derivatives that passes through all points and has no third and fourth derivative at its
//! ends: OpenSim's GCVSpline of degree 5 without error variance (Woltring 1986; de Boor 1978, "A Practical Guide to Splines", ch. XIII;
//! both recalled). Its third derivative is a sum of the quadratic B-splines `M_i` on the knots `t_i .. t_i+3`, each of
//! integral 1. The third divided difference of any function is `1/6` of the integral of `M_i` times its third derivative, so
//!
//! ```text
//! f''' = sum_j c_j M_j,   sum_j (integral M_i M_j) c_j = 6 [t_i, t_i+1, t_i+2, t_i+3] y
//! ```
//!
//! a positive definite system with five diagonals. First and second derivative at a knot follow from the two neighbouring points and the
//! third derivative between them, so that no error grows along the spline.

use super::function::SplineError;

/// Fewest points of a quintic spline.
pub const LEAST_POINTS: usize = 6;

/// A polynomial of degree 2, lowest power first.
type Quadratic = [f64; 3];

/// The part of all quintic splines through points at the same times.
#[derive(Clone, Debug)]
pub struct QuinticBasis {
    times: Vec<f64>,
    /// By B-spline and interval of it, in the distance from the interval's begin.
    pieces: Vec<[Quadratic; 3]>,
    /// Cholesky factor of the system, by row: the diagonal and the two entries to the left of it.
    factor: Vec<[f64; 3]>,
}

/// A quintic spline.
#[derive(Clone, Debug)]
pub struct QuinticSpline<'a> {
    times: &'a [f64],
    /// By knot: value, first and second derivative.
    knots: Vec<[f64; 3]>,
    /// By interval: third derivative.
    third: Vec<Quadratic>,
}

impl QuinticBasis {
    /// The splines with knots at `times`.
    ///
    /// # Errors
    /// [`SplineError`] for fewer than six times, or times that do not rise.
    pub fn new(times: Vec<f64>) -> Result<Self, SplineError> {
        if times.len() < LEAST_POINTS {
            return Err(SplineError::TooFew { found: times.len(), needed: LEAST_POINTS });
        }
        for pair in times.windows(2) {
            if pair[0] > pair[1] {
                return Err(SplineError::Falls { before: pair[0], after: pair[1] });
            }
            if pair[0] == pair[1] {
                return Err(SplineError::Stays { x: pair[0] });
            }
        }
        let pieces: Vec<[Quadratic; 3]> = times.windows(4).map(b_spline).collect();
        let factor = factor(&gram(&times, &pieces));
        Ok(Self { times, pieces, factor })
    }

    /// The spline through `values`, one a time.
    ///
    /// # Panics
    /// When there are not as many values as times.
    pub fn through(&self, values: &[f64]) -> QuinticSpline<'_> {
        let t = &self.times;
        assert_eq!(values.len(), t.len(), "one value a time");
        let slope = |i: usize| (values[i + 1] - values[i]) / (t[i + 1] - t[i]);
        let second = |i: usize| (slope(i + 1) - slope(i)) / (t[i + 2] - t[i]);
        let mut c: Vec<f64> =
            (0..self.factor.len()).map(|i| 6.0 * (second(i + 1) - second(i)) / (t[i + 3] - t[i])).collect();
        self.solve(&mut c);
        let mut third = vec![[0.0; 3]; t.len() - 1];
        for (i, (c, pieces)) in c.iter().zip(&self.pieces).enumerate() {
            for (own, piece) in third[i..].iter_mut().zip(pieces) {
                own.iter_mut().zip(piece).for_each(|(own, piece)| *own += c * piece);
            }
        }
        let mut knots: Vec<[f64; 3]> = (1..t.len() - 1).map(|i| inner_knot(t, values, &third, i)).collect();
        let first = taylor(&knots[0], &turned(&third[0], t[1] - t[0]), t[0] - t[1]);
        let last = taylor(&knots[knots.len() - 1], &third[third.len() - 1], t[t.len() - 1] - t[t.len() - 2]);
        knots.insert(0, [values[0], first[1], first[2]]);
        knots.push([values[t.len() - 1], last[1], last[2]]);
        QuinticSpline { times: t, knots, third }
    }

    fn solve(&self, c: &mut [f64]) {
        for i in 0..c.len() {
            let [diagonal, near, far] = self.factor[i];
            let known = near * if i > 0 { c[i - 1] } else { 0.0 } + far * if i > 1 { c[i - 2] } else { 0.0 };
            c[i] = (c[i] - known) / diagonal;
        }
        for i in (0..c.len()).rev() {
            let near = self.factor.get(i + 1).map_or(0.0, |row| row[1] * c[i + 1]);
            let far = self.factor.get(i + 2).map_or(0.0, |row| row[2] * c[i + 2]);
            c[i] = (c[i] - near - far) / self.factor[i][0];
        }
    }
}

impl QuinticSpline<'_> {
    /// Value, first and second derivative at every knot.
    pub fn knots(&self) -> &[[f64; 3]] {
        &self.knots
    }

    /// Value, first and second derivative at a time; beyond the ends the parabola that the spline ends in.
    pub fn at(&self, time: f64) -> [f64; 3] {
        let last = self.times.len() - 1;
        let k = self.times.partition_point(|&knot| knot <= time).saturating_sub(1);
        let third = if time < self.times[0] || k == last { &[0.0; 3] } else { &self.third[k] };
        taylor(&self.knots[k], third, time - self.times[k])
    }
}

/// A quadratic B-spline of integral 1 on four knots, on each of its three intervals.
fn b_spline(t: &[f64]) -> [Quadratic; 3] {
    let h = [t[1] - t[0], t[2] - t[1], t[3] - t[2]];
    let (left, right) = (h[0] + h[1], h[1] + h[2]);
    let scale = 3.0 / (t[3] - t[0]);
    let (a, b) = (h[1] * left, h[1] * right);
    [
        [0.0, 0.0, 1.0 / (h[0] * left)],
        [h[0] * h[1] / a, (h[1] - h[0]) / a + right / b, -1.0 / a - 1.0 / b],
        [h[2] / right, -2.0 / right, 1.0 / (h[2] * right)],
    ]
    .map(|piece| piece.map(|c| scale * c))
}

/// Integrals of products of B-splines, by row: the diagonal and the two entries to the left of it.
fn gram(t: &[f64], pieces: &[[Quadratic; 3]]) -> Vec<[f64; 3]> {
    let integral = |p: &Quadratic, q: &Quadratic, h: f64| {
        let product = [
            p[0] * q[0],
            p[0] * q[1] + p[1] * q[0],
            p[0] * q[2] + p[1] * q[1] + p[2] * q[0],
            p[1] * q[2] + p[2] * q[1],
            p[2] * q[2],
        ];
        product.iter().rev().zip([5.0, 4.0, 3.0, 2.0, 1.0]).fold(0.0, |sum, (c, n)| sum * h + c / n) * h
    };
    let entry = |i: usize, back: usize| -> f64 {
        let Some(other) = i.checked_sub(back) else { return 0.0 };
        // The intervals that both have: those from the begin of the later one on.
        let both = |k: usize| integral(&pieces[i][k], &pieces[other][k + back], t[i + k + 1] - t[i + k]);
        (0..3 - back).map(both).sum()
    };
    (0..pieces.len()).map(|i| [entry(i, 0), entry(i, 1), entry(i, 2)]).collect()
}

/// Cholesky factor of a positive definite matrix with five diagonals, in the same form.
fn factor(matrix: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut rows: Vec<[f64; 3]> = Vec::with_capacity(matrix.len());
    for (i, [diagonal, near, far]) in matrix.iter().enumerate() {
        let far = if i > 1 { far / rows[i - 2][0] } else { 0.0 };
        let near = if i > 0 { (near - far * rows[i - 1][1]) / rows[i - 1][0] } else { 0.0 };
        rows.push([(diagonal - near * near - far * far).sqrt(), near, far]);
    }
    rows
}

/// The third derivative of an interval of length `h`, in the distance from its end, forward.
fn turned(third: &Quadratic, h: f64) -> Quadratic {
    let [a, b, c] = *third;
    [a + h * (b + h * c), b + 2.0 * h * c, c]
}

/// Value and derivatives at a distance `u` from a point where they are known, with the third derivative there.
fn taylor(knot: &[f64; 3], third: &Quadratic, u: f64) -> [f64; 3] {
    let ([y, slope, curvature], [a, b, c]) = (*knot, *third);
    [
        y + u * (slope + u * (0.5 * curvature + u * (a / 6.0 + u * (b / 24.0 + u * c / 60.0)))),
        slope + u * (curvature + u * (0.5 * a + u * (b / 6.0 + u * c / 12.0))),
        curvature + u * (a + u * (0.5 * b + u * c / 3.0)),
    ]
}

/// Value and derivatives at a knot inside: those with which the spline meets the points before and after it.
fn inner_knot(t: &[f64], values: &[f64], third: &[Quadratic], i: usize) -> [f64; 3] {
    let (back, on) = (t[i - 1] - t[i], t[i + 1] - t[i]);
    let rest = |u: f64, third: &Quadratic| taylor(&[0.0; 3], third, u)[0];
    // Slopes to both points, less what the third derivative adds: slope + u curvature / 2.
    let before = (values[i - 1] - values[i] - rest(back, &turned(&third[i - 1], -back))) / back;
    let after = (values[i + 1] - values[i] - rest(on, &third[i])) / on;
    let curvature = 2.0 * (after - before) / (on - back);
    [values[i], after - 0.5 * on * curvature, curvature]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uneven(n: usize) -> Vec<f64> {
        (0..n).map(|i| 0.3 + 0.01 * i as f64 + 0.003 * libm::sin(1.7 * i as f64)).collect()
    }

    #[test]
    fn a_parabola_is_its_own_spline_beyond_its_ends_too() {
        let times = uneven(9);
        let f = |x: f64| [2.0 - 3.0 * x + 5.0 * x * x, -3.0 + 10.0 * x, 10.0];
        let values: Vec<f64> = times.iter().map(|&x| f(x)[0]).collect();
        let basis = QuinticBasis::new(times).unwrap();
        let spline = basis.through(&values);
        for x in [0.0, 0.3, 0.333, 0.36, 0.4, 1.0] {
            for (found, expected) in spline.at(x).into_iter().zip(f(x)) {
                assert!((found - expected).abs() < 1e-7, "{x}: {found} and {expected}");
            }
        }
    }

    #[test]
    fn the_spline_meets_its_points_is_smooth_to_the_fourth_derivative_and_natural() {
        let times = uneven(40);
        let values: Vec<f64> = times.iter().map(|x| libm::sin(9.0 * x) + libm::cos(31.0 * x)).collect();
        let basis = QuinticBasis::new(times.clone()).unwrap();
        let spline = basis.through(&values);
        for i in 1..times.len() - 1 {
            let h = times[i] - times[i - 1];
            let from_left = taylor(&spline.knots[i - 1], &spline.third[i - 1], h);
            for (k, scale) in [1e-12, 1e-9, 1e-6].into_iter().enumerate() {
                assert!((from_left[k] - spline.knots[i][k]).abs() < scale, "derivative {k} at knot {i}");
            }
            let [third, fourth, _] = turned(&spline.third[i - 1], h);
            assert!((third - spline.third[i][0]).abs() < 1e-6 * (1.0 + third.abs()), "third derivative at knot {i}");
            assert!((fourth - spline.third[i][1]).abs() < 1e-6 * (1.0 + fourth.abs()), "fourth derivative at knot {i}");
        }
        assert!(spline.third[0][0].abs() < 1e-6 && spline.third[0][1].abs() < 1e-3);
        let end = turned(&spline.third[38], times[39] - times[38]);
        assert!(end[0].abs() < 1e-6 && end[1].abs() < 1e-3);
    }

    #[test]
    fn derivatives_are_central_differences() {
        let times = uneven(20);
        let values: Vec<f64> = times.iter().map(|x| libm::sin(20.0 * x)).collect();
        let basis = QuinticBasis::new(times).unwrap();
        let spline = basis.through(&values);
        let h = 1e-5;
        for x in [0.31, 0.35, 0.41, 0.47] {
            let ([a, da, _], [_, slope, curvature], [b, db, _]) = (spline.at(x - h), spline.at(x), spline.at(x + h));
            assert!(((b - a) / (2.0 * h) - slope).abs() < 1e-6 * (1.0 + slope.abs()));
            assert!(((db - da) / (2.0 * h) - curvature).abs() < 1e-5 * (1.0 + curvature.abs()));
        }
    }

    #[test]
    fn too_few_points_and_times_that_do_not_rise_are_refused() {
        assert_eq!(QuinticBasis::new(vec![0.0; 5]).unwrap_err(), SplineError::TooFew { found: 5, needed: 6 });
        let stays = QuinticBasis::new(vec![0.0, 1.0, 2.0, 2.0, 3.0, 4.0]).unwrap_err();
        assert_eq!(stays, SplineError::Stays { x: 2.0 });
        let falls = QuinticBasis::new(vec![0.0, 1.0, 2.0, 1.5, 3.0, 4.0]).unwrap_err();
        assert_eq!(falls, SplineError::Falls { before: 2.0, after: 1.5 });
    }
}
