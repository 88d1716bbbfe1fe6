//! Interpolates falling data by a smooth curve that never overshoots.
//!
//! Piecewise cubic Hermite interpolation with the tangents of Fritsch & Carlson 1980 (SIAM J. Numer. Anal. 17:238-246):
//! on every piece the curve lies between its two data points, so a falling table gives a falling curve.

/// One cubic piece `value(t) = c0 + c1 t + c2 t^2 + c3 t^3`, `t = x - start`.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Abscissa of the left data point.
    pub start: f64,
    /// Abscissa of the right data point.
    pub end: f64,
    /// Coefficients from constant to cubic.
    pub coefficients: [f64; 4],
    /// Slope at the right data point.
    pub end_slope: f64,
}

impl Piece {
    /// Value and slope at `x`.
    pub fn value_and_slope(&self, x: f64) -> (f64, f64) {
        let [c0, c1, c2, c3] = self.coefficients;
        let t = x - self.start;
        (c0 + t * (c1 + t * (c2 + t * c3)), c1 + t * (2.0 * c2 + t * 3.0 * c3))
    }

    /// Second derivative at `x`.
    pub(crate) fn curvature(&self, x: f64) -> f64 {
        let [_, _, c2, c3] = self.coefficients;
        2.0 * c2 + 6.0 * c3 * (x - self.start)
    }

    /// The piece of the curve that runs the other way, `x -> -x`.
    fn mirrored(&self) -> Self {
        let ((value, slope), curvature) = (self.value_and_slope(self.end), self.curvature(self.end));
        let coefficients = [value, -slope, curvature / 2.0, -self.coefficients[3]];
        Self { start: -self.end, end: -self.start, coefficients, end_slope: -self.coefficients[1] }
    }

    /// Integral of the value from the piece's start to `x`.
    pub(crate) fn integral(&self, x: f64) -> f64 {
        let [c0, c1, c2, c3] = self.coefficients;
        let t = x - self.start;
        t * (c0 + t * (c1 / 2.0 + t * (c2 / 3.0 + t * c3 / 4.0)))
    }

    /// Angle inside the piece where the slope is extreme (the vertex of the slope parabola), if there is one.
    pub(crate) fn slope_vertex(&self) -> Option<f64> {
        let [_, _, c2, c3] = self.coefficients;
        let x = self.start - c2 / (3.0 * c3);
        (c3 != 0.0 && x > self.start && x < self.end).then_some(x)
    }

    /// Calls `visit` with each abscissa of the piece where the slope passes through `slope`, in rising order.
    ///
    /// Judged by the signs of `slope(x) - slope` at both ends and at the vertex, with the tangent that a piece shares with
    /// its neighbour, so no passage falls between two pieces by rounding.
    pub(crate) fn crossings(&self, slope: f64, mut visit: impl FnMut(f64)) {
        let [_, c1, c2, c3] = self.coefficients;
        let (start, end) = ((self.start, c1 - slope), (self.end, self.end_slope - slope));
        let mut between = |a: (f64, f64), b: (f64, f64)| {
            if (a.1 < 0.0) != (b.1 < 0.0) {
                // The root of c1 - slope + 2 c2 t + 3 c3 t^2 on the falling or the rising branch of the parabola.
                let root = (c2 * c2 - 3.0 * c3 * (c1 - slope)).max(0.0).sqrt();
                let root = if b.1 > a.1 { root } else { -root };
                // Without cancellation, whichever signs meet.
                let t = if c2 * root > 0.0 { (slope - c1) / (c2 + root) } else { (root - c2) / (3.0 * c3) };
                visit(if t.is_finite() { (self.start + t).clamp(a.0, b.0) } else { b.0 });
            }
        };
        match self.slope_vertex() {
            Some(x) => {
                let vertex = (x, self.value_and_slope(x).1 - slope);
                between(start, vertex);
                between(vertex, end);
            }
            None => between(start, end),
        }
    }
}

/// A monotone piecewise cubic through given points.
#[derive(Clone, Debug, PartialEq)]
pub struct MonotoneCubic {
    pieces: Vec<Piece>,
}

impl MonotoneCubic {
    /// Interpolates `points` (abscissa, ordinate), abscissas strictly rising, at least two of them.
    ///
    /// Returns `None` if they are not, if a number is not finite, or if they lie so far apart that a coefficient would not be.
    ///
    /// ```
    /// use contrapposto::math::MonotoneCubic;
    /// let curve = MonotoneCubic::new(&[(0.0, 5.0), (1.0, 1.0), (2.0, 0.0)]).unwrap();
    /// let (value, slope) = curve.piece_at(1.0).value_and_slope(1.0);
    /// assert_eq!((value, slope), (1.0, -2.5));
    /// assert!(MonotoneCubic::new(&[(1.0, 5.0), (0.0, 1.0)]).is_none());
    /// ```
    pub fn new(points: &[(f64, f64)]) -> Option<Self> {
        let usable = points.len() >= 2
            && points.iter().all(|(x, y)| x.is_finite() && y.is_finite())
            && points.windows(2).all(|w| w[0].0 < w[1].0);
        if !usable {
            return None;
        }
        let secants: Vec<f64> = points.windows(2).map(|w| (w[1].1 - w[0].1) / (w[1].0 - w[0].0)).collect();
        let n = points.len();
        let mut tangents = vec![0.0; n];
        tangents[0] = secants[0];
        tangents[n - 1] = secants[n - 2];
        for i in 1..n - 1 {
            if (secants[i - 1] > 0.0) == (secants[i] > 0.0) {
                tangents[i] = f64::midpoint(secants[i - 1], secants[i]);
            }
        }
        // Fritsch & Carlson: pull the tangent pair of each piece into the circle of radius 3.
        for i in 0..n - 1 {
            if secants[i] == 0.0 {
                tangents[i] = 0.0;
                tangents[i + 1] = 0.0;
                continue;
            }
            let (alpha, beta) = (tangents[i] / secants[i], tangents[i + 1] / secants[i]);
            let radius = libm::hypot(alpha, beta);
            if radius > 3.0 {
                tangents[i] *= 3.0 / radius;
                tangents[i + 1] *= 3.0 / radius;
            }
        }
        let pieces: Vec<Piece> = (0..n - 1)
            .map(|i| {
                let h = points[i + 1].0 - points[i].0;
                let (d, m0, m1) = (secants[i], tangents[i], tangents[i + 1]);
                // Written in differences, so that a straight piece has no trace of curvature.
                let (bend0, bend1) = (d - m0, d - m1);
                let coefficients = [points[i].1, m0, (2.0 * bend0 + bend1) / h, -(bend0 + bend1) / h / h];
                Piece { start: points[i].0, end: points[i + 1].0, coefficients, end_slope: m1 }
            })
            .collect();
        let finite = pieces.iter().all(|p| p.end_slope.is_finite() && p.coefficients.iter().all(|c| c.is_finite()));
        finite.then_some(Self { pieces })
    }

    /// The same curve with `times` the ordinate everywhere.
    pub(crate) fn scaled(&self, times: f64) -> Self {
        let scaled = |piece: &Piece| Piece {
            coefficients: piece.coefficients.map(|coefficient| times * coefficient),
            end_slope: times * piece.end_slope,
            ..piece.clone()
        };
        Self { pieces: self.pieces.iter().map(scaled).collect() }
    }

    /// The curve that runs the other way, `x -> -x`.
    pub(crate) fn mirrored(&self) -> Self {
        Self { pieces: self.pieces.iter().rev().map(Piece::mirrored).collect() }
    }

    /// The cubic pieces from left to right.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The piece that holds `x` (the first or last one when `x` lies outside).
    pub fn piece_at(&self, x: f64) -> &Piece {
        let i = self.pieces.partition_point(|p| p.end < x).min(self.pieces.len() - 1);
        &self.pieces[i]
    }
}

#[cfg(test)]
mod tests {
    use super::MonotoneCubic;

    /// Inside the curve, at its ends, and beyond them.
    #[test]
    fn a_scaled_and_a_mirrored_curve_have_their_values_and_slopes_everywhere() {
        let points = [(-1.0, 4.0), (0.0, 2.5), (0.5, 1.0), (2.0, -3.0)];
        let curve = MonotoneCubic::new(&points).unwrap();
        let (scaled, mirrored) = (curve.scaled(2.5), curve.mirrored());
        for piece in scaled.pieces().iter().chain(mirrored.pieces()) {
            let slope = piece.value_and_slope(piece.end).1;
            assert!((piece.end_slope - slope).abs() < 1e-12, "{} instead of {slope}", piece.end_slope);
        }
        for k in 0..=60 {
            let x = -3.0 + 0.1 * f64::from(k);
            let (value, slope) = curve.piece_at(x).value_and_slope(x);
            let of_scaled = scaled.piece_at(x).value_and_slope(x);
            let of_mirrored = mirrored.piece_at(-x).value_and_slope(-x);
            for (found, expected) in [
                (of_scaled.0, 2.5 * value),
                (of_scaled.1, 2.5 * slope),
                (of_mirrored.0, value),
                (of_mirrored.1, -slope),
            ] {
                assert!((found - expected).abs() < 1e-12, "{found} instead of {expected} at {x}");
            }
        }
    }

    /// Values and slopes of these points are numbers, the curvature between them is not.
    #[test]
    fn points_so_near_that_a_coefficient_is_no_number_have_no_curve() {
        let at = |h: f64| MonotoneCubic::new(&[(0.0, 0.0), (h, h), (2.0 * h, 3.0 * h)]);
        assert!(at(1e-100).is_some() && at(1e-200).is_none());
    }
}
