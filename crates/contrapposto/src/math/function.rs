//! Functions of one variable that files use to drive joints and couple coordinates: value, first and second derivative.
//!
//! The spline is SIMM's, as OpenSim has it: a cubic with continuous second derivative whose third derivative at either end is
//! that of the cubic through the four outermost points (Forsythe, Malcolm & Moler 1977, chapter 4); beyond its ends it goes
//! on straight. The natural spline, OpenSim's GCVSpline of half order 2 without error variance (Woltring 1986), does not bend at
//! its ends.

/// A function of one variable.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Function {
    /// Always the same.
    Constant(f64),
    /// `slope * x + intercept`.
    Linear {
        /// Slope.
        slope: f64,
        /// Value at 0.
        intercept: f64,
    },
    /// `c[0] + c[1] x + c[2] x^2 + ...`: lowest power first, whatever the file's order is.
    Polynomial(Vec<f64>),
    /// `amplitude * sin(omega * x + phase) + offset`.
    Sine {
        /// Height of the wave.
        amplitude: f64,
        /// Angular frequency, per unit of x.
        omega: f64,
        /// Angle at 0, rad.
        phase: f64,
        /// The constant that is added.
        offset: f64,
    },
    /// SIMM's natural cubic through points, and other piecewise cubics.
    Spline(Spline),
    /// The natural cubic through points, [`Spline::natural`].
    NaturalSpline(Spline),
}

/// Cubic pieces between knots, straight beyond the ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    knots: Vec<f64>,
    /// Per knot the value, slope, half the second and a sixth of the third derivative to its right; of the last knot to
    /// its left.
    pieces: Vec<[f64; 4]>,
}

/// The reason for which points make no spline.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// Too few points.
    #[error("{found} points; at least {needed} are needed")]
    TooFew {
        /// Number of points.
        found: usize,
        /// Least number of points.
        needed: usize,
    },
    /// As many x as y are needed.
    #[error("{x} values of x and {y} of y; as many of one as of the other are needed")]
    Unequal {
        /// Number of x.
        x: usize,
        /// Number of y.
        y: usize,
    },
    /// x must not fall.
    #[error("x falls from {before} to {after}; it must rise from point to point")]
    Falls {
        /// The value before.
        before: f64,
        /// The smaller one after it.
        after: f64,
    },
    /// x must rise.
    #[error("two points are at x = {x}, or nearer than 1e-7; it must rise from point to point")]
    Stays {
        /// The x of the first of the two.
        x: f64,
    },
}

/// OpenSim takes this for the distance of points that are nearer to each other.
const LEAST_DISTANCE: f64 = 1e-7;

impl Function {
    /// Value, first and second derivative.
    #[must_use]
    pub fn value_slope_curvature(&self, x: f64) -> [f64; 3] {
        match self {
            Self::Constant(value) => [*value, 0.0, 0.0],
            Self::Linear { slope, intercept } => [slope * x + intercept, *slope, 0.0],
            Self::Polynomial(coefficients) => {
                coefficients.iter().rev().fold([0.0; 3], |[p, d, c], k| [p * x + k, d * x + p, c * x + 2.0 * d])
            }
            Self::Sine { amplitude, omega, phase, offset } => {
                let (sin, cos) = libm::sincos(omega * x + phase);
                [amplitude * sin + offset, amplitude * omega * cos, -amplitude * omega * omega * sin]
            }
            Self::Spline(spline) | Self::NaturalSpline(spline) => spline.value_slope_curvature(x),
        }
    }

    /// Value.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        self.value_slope_curvature(x)[0]
    }

    /// First derivative.
    #[must_use]
    pub fn slope(&self, x: f64) -> f64 {
        self.value_slope_curvature(x)[1]
    }

    /// The function times a number.
    #[must_use]
    pub fn scaled(self, by: f64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(value * by),
            Self::Linear { slope, intercept } => Self::Linear { slope: slope * by, intercept: intercept * by },
            Self::Polynomial(mut coefficients) => {
                coefficients.iter_mut().for_each(|c| *c *= by);
                Self::Polynomial(coefficients)
            }
            Self::Sine { amplitude, omega, phase, offset } => {
                Self::Sine { amplitude: amplitude * by, omega, phase, offset: offset * by }
            }
            Self::Spline(spline) => Self::Spline(spline.scaled(by)),
            Self::NaturalSpline(spline) => Self::NaturalSpline(spline.scaled(by)),
        }
    }

    /// The numbers that it was made of.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        match self {
            Self::Constant(value) => vec![*value],
            Self::Linear { slope, intercept } => vec![*slope, *intercept],
            Self::Polynomial(coefficients) => coefficients.clone(),
            Self::Sine { amplitude, omega, phase, offset } => vec![*amplitude, *omega, *phase, *offset],
            Self::Spline(spline) | Self::NaturalSpline(spline) => spline.points().flat_map(|(x, y)| [x, y]).collect(),
        }
    }

    /// Whether it gives back what it is given.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        *self == Self::Linear { slope: 1.0, intercept: 0.0 }
    }
}

impl Spline {
    /// OpenSim's `SimmSpline` (`natCubicSpline`, `NaturalCubicSpline` in older files) through the points.
    ///
    /// # Errors
    /// [`SplineError`] for fewer than two points, lists of different length, or falling x.
    pub fn simm(x: &[f64], y: &[f64]) -> Result<Self, SplineError> {
        let (h, slopes) = Self::steps(x, y, 2)?;
        let n = x.len();
        // Ends: the sixth of the third derivative there, (s[1] - s[0]) / h[0], is the third divided difference.
        let span = |from: usize, to: usize| (x[to] - x[from]).max(LEAST_DISTANCE);
        let second = |i: usize| (slopes[i + 1] - slopes[i]) / span(i, i + 2);
        let third = |i: usize| (second(i + 1) - second(i)) / span(i, i + 3);
        let (first, last) = if n > 3 { (third(0), third(n - 4)) } else { (0.0, 0.0) };
        let (before, behind) = (h[0], h[n - 2]);
        let ends = [(-before, before * before * first), (-behind, -behind * behind * last)];
        Ok(Self::cubic(x, y, &h, &slopes, ends))
    }

    /// OpenSim's `GCVSpline` with half order 2 and no error variance: no second derivative at either end.
    ///
    /// # Errors
    /// [`SplineError`] for fewer than four points (OpenSim's own limit), lists of different length, or x that does not rise.
    pub fn natural(x: &[f64], y: &[f64]) -> Result<Self, SplineError> {
        let (h, slopes) = Self::steps(x, y, 4)?;
        if let Some(pair) = x.windows(2).find(|pair| pair[1] - pair[0] < LEAST_DISTANCE) {
            return Err(SplineError::Stays { x: pair[0] });
        }
        // An infinite diagonal holds its unknown at zero.
        Ok(Self::cubic(x, y, &h, &slopes, [(f64::INFINITY, 0.0); 2]))
    }

    /// The cubic with continuous second derivative. `ends`: diagonal and right side of the first and the last equation.
    fn cubic(x: &[f64], y: &[f64], h: &[f64], slopes: &[f64], ends: [(f64, f64); 2]) -> Self {
        let n = x.len();
        // A sixth of the second derivative at each point, from the tridiagonal system of continuous slopes:
        //   h[i-1] s[i-1] + 2 (h[i-1] + h[i]) s[i] + h[i] s[i+1] = slopes[i] - slopes[i-1].
        let (mut diagonal, mut s) = (vec![0.0; n], vec![0.0; n]);
        if n > 2 {
            for i in 1..n - 1 {
                diagonal[i] = 2.0 * (h[i - 1] + h[i]);
                s[i] = slopes[i] - slopes[i - 1];
            }
            [(diagonal[0], s[0]), (diagonal[n - 1], s[n - 1])] = ends;
            for i in 1..n {
                let factor = h[i - 1] / diagonal[i - 1];
                diagonal[i] -= factor * h[i - 1];
                s[i] -= factor * s[i - 1];
            }
            s[n - 1] /= diagonal[n - 1];
            for i in (0..n - 1).rev() {
                s[i] = (s[i] - h[i] * s[i + 1]) / diagonal[i];
            }
        }
        let mut pieces: Vec<[f64; 4]> = (0..n - 1)
            .map(|i| [y[i], slopes[i] - h[i] * (s[i + 1] + 2.0 * s[i]), 3.0 * s[i], (s[i + 1] - s[i]) / h[i]])
            .collect();
        let end_slope = slopes[n - 2] + h[n - 2] * (s[n - 2] + 2.0 * s[n - 1]);
        pieces.push([y[n - 1], end_slope, 3.0 * s[n - 1], pieces[n - 2][3]]);
        Self { knots: x.to_vec(), pieces }
    }

    fn scaled(mut self, by: f64) -> Self {
        self.pieces.iter_mut().flatten().for_each(|c| *c *= by);
        self
    }

    /// Straight lines between the points.
    ///
    /// # Errors
    /// [`SplineError`] for fewer than two points, lists of different length, or falling x.
    pub fn piecewise_linear(x: &[f64], y: &[f64]) -> Result<Self, SplineError> {
        let (_, slopes) = Self::steps(x, y, 2)?;
        let last = slopes[slopes.len() - 1];
        let pieces =
            y.iter().zip(slopes.iter().copied().chain([last])).map(|(&y, slope)| [y, slope, 0.0, 0.0]).collect();
        Ok(Self { knots: x.to_vec(), pieces })
    }

    /// Distances of neighbours and slopes between them.
    fn steps(x: &[f64], y: &[f64], needed: usize) -> Result<(Vec<f64>, Vec<f64>), SplineError> {
        if x.len() != y.len() {
            return Err(SplineError::Unequal { x: x.len(), y: y.len() });
        }
        if x.len() < needed {
            return Err(SplineError::TooFew { found: x.len(), needed });
        }
        if let Some(pair) = x.windows(2).find(|pair| pair[0] > pair[1]) {
            return Err(SplineError::Falls { before: pair[0], after: pair[1] });
        }
        let h: Vec<f64> = x.windows(2).map(|pair| (pair[1] - pair[0]).max(LEAST_DISTANCE)).collect();
        let slopes = y.windows(2).zip(&h).map(|(pair, h)| (pair[1] - pair[0]) / h).collect();
        Ok((h, slopes))
    }

    /// The points that the spline goes through, x and y.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        self.knots.iter().zip(&self.pieces).map(|(&x, piece)| (x, piece[0]))
    }

    /// Value.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        self.value_slope_curvature(x)[0]
    }

    /// Whether straight lines join its points.
    #[must_use]
    pub fn is_straight(&self) -> bool {
        self.pieces.iter().all(|piece| piece[2] == 0.0 && piece[3] == 0.0)
    }

    /// First and last x of the points.
    #[must_use]
    pub(crate) fn range(&self) -> (f64, f64) {
        (self.knots[0], self.knots[self.knots.len() - 1])
    }

    fn value_slope_curvature(&self, x: f64) -> [f64; 3] {
        let last = self.knots.len() - 1;
        let (first_x, last_x) = self.range();
        if x < first_x || x > last_x {
            let end = if x < first_x { 0 } else { last };
            let [y, slope, ..] = self.pieces[end];
            return [y + (x - self.knots[end]) * slope, slope, 0.0];
        }
        let k = self.knots.partition_point(|&knot| knot <= x).saturating_sub(1);
        let [a, b, c, d] = self.pieces[k];
        let dx = x - self.knots[k];
        [a + dx * (b + dx * (c + dx * d)), b + dx * (2.0 * c + 3.0 * dx * d), 2.0 * c + 6.0 * dx * d]
    }
}
