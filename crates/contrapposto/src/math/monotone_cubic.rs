//! Which smooth curve passes through falling data without ever overshooting?
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
}

impl Piece {
    /// Value and slope at `x`.
    pub fn value_and_slope(&self, x: f64) -> (f64, f64) {
        let [c0, c1, c2, c3] = self.coefficients;
        let t = x - self.start;
        (c0 + t * (c1 + t * (c2 + t * c3)), c1 + t * (2.0 * c2 + t * 3.0 * c3))
    }

    /// Integral of the value from the piece's start to `x`.
    pub fn integral(&self, x: f64) -> f64 {
        let [c0, c1, c2, c3] = self.coefficients;
        let t = x - self.start;
        t * (c0 + t * (c1 / 2.0 + t * (c2 / 3.0 + t * c3 / 4.0)))
    }

    /// Angle inside the piece where the slope is extreme (the vertex of the slope parabola), if there is one.
    pub fn slope_vertex(&self) -> Option<f64> {
        let [_, _, c2, c3] = self.coefficients;
        let x = self.start - c2 / (3.0 * c3);
        (c3 != 0.0 && x > self.start && x < self.end).then_some(x)
    }

    /// Calls `visit` with each angle of the piece where the slope passes through `slope`, in rising order.
    pub fn crossings(&self, slope: f64, mut visit: impl FnMut(f64)) {
        let [_, c1, c2, c3] = self.coefficients;
        let (a, b, c) = (3.0 * c3, 2.0 * c2, c1 - slope);
        let width = self.end - self.start;
        let mut roots = [f64::NAN; 2];
        if a == 0.0 {
            roots[0] = -c / b;
        } else {
            let discriminant = b * b - 4.0 * a * c;
            if discriminant > 0.0 {
                let q = -0.5 * (b + b.signum() * discriminant.sqrt());
                roots = [q / a, c / q];
                if roots[0] > roots[1] {
                    roots.swap(0, 1);
                }
            }
        }
        for t in roots {
            if t >= 0.0 && t <= width {
                visit((self.start + t).min(self.end));
            }
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
    /// Returns `None` if they are not, or if a number is not finite.
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
            if secants[i - 1] * secants[i] > 0.0 {
                tangents[i] = 0.5 * (secants[i - 1] + secants[i]);
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
            let radius = alpha.hypot(beta);
            if radius > 3.0 {
                tangents[i] = 3.0 / radius * alpha * secants[i];
                tangents[i + 1] = 3.0 / radius * beta * secants[i];
            }
        }
        let pieces = (0..n - 1)
            .map(|i| {
                let h = points[i + 1].0 - points[i].0;
                let (d, m0, m1) = (secants[i], tangents[i], tangents[i + 1]);
                let coefficients = [points[i].1, m0, (3.0 * d - 2.0 * m0 - m1) / h, (m0 + m1 - 2.0 * d) / (h * h)];
                Piece { start: points[i].0, end: points[i + 1].0, coefficients }
            })
            .collect();
        Some(Self { pieces })
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
