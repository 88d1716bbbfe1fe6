//! Computes smooth curves through corners: quintic Bezier curves end to end, straight beyond both ends.
//!
//! Each section leaves its first and meets its second point with a given slope; its control points lie on these two lines, pairwise at the
//! share `c` of the way to their intersection (Millard, Uchida, Seth & Delp 2013; the shares were learnt from opensim-core,
//! `SegmentedQuinticBezierToolkit`).

use crate::muscle::tolerances::{EQUAL_SLOPES, PARAMETER_STEPS};

/// A point of a curve and its slope there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Knot {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) slope: f64,
}

/// One section: coefficients of x and of y in the parameter from 0 to 1, lowest power first.
#[derive(Clone, Debug, PartialEq)]
struct Section {
    ends: (f64, f64),
    x: [f64; 6],
    y: [f64; 6],
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    sections: Vec<Section>,
    first: Knot,
    last: Knot,
}

impl Curve {
    /// The curve through knots of rising x with corners of a curviness from 0 (sharp) to 1.
    pub(super) fn new(knots: &[Knot], curviness: f64) -> Self {
        let share = 0.1 + 0.8 * curviness;
        let sections = knots.windows(2).map(|pair| Section::new(&pair[0], &pair[1], share)).collect();
        Self { sections, first: knots[0], last: knots[knots.len() - 1] }
    }

    /// Value and slope.
    pub(super) fn at(&self, x: f64) -> (f64, f64) {
        for (outside, end) in [(x <= self.first.x, &self.first), (x >= self.last.x, &self.last)] {
            if outside {
                return (end.y + end.slope * (x - end.x), end.slope);
            }
        }
        let section = self.sections.iter().find(|section| x <= section.ends.1);
        section.map_or((self.last.y, self.last.slope), |section| section.at(x))
    }
}

impl Section {
    fn new(from: &Knot, to: &Knot, share: f64) -> Self {
        let difference = from.slope - to.slope;
        let x = if difference.abs() > EQUAL_SLOPES {
            (to.y - from.y - to.x * to.slope + from.x * from.slope) / difference
        } else {
            f64::midpoint(from.x, to.x)
        };
        let y = (x - to.x) * to.slope + to.y;
        let [near, far] = [from, to].map(|end| (end.x + share * (x - end.x), end.y + share * (y - end.y)));
        Self {
            ends: (from.x, to.x),
            x: powers([from.x, near.0, near.0, far.0, far.0, to.x]),
            y: powers([from.y, near.1, near.1, far.1, far.1, to.y]),
        }
    }

    fn at(&self, x: f64) -> (f64, f64) {
        let u = self.parameter(x);
        let ([y, dy], [_, dx]) = (horner(&self.y, u), horner(&self.x, u));
        (y, dy / dx)
    }

    /// The parameter of an x: Newton's method between bounds.
    fn parameter(&self, x: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        let mut u = (x - self.ends.0) / (self.ends.1 - self.ends.0);
        for _ in 0..PARAMETER_STEPS {
            let [value, slope] = horner(&self.x, u);
            let excess = value - x;
            if excess > 0.0 {
                high = u
            } else {
                low = u
            }
            let newton = u - excess / slope;
            if (newton - u).abs() <= f64::EPSILON * u {
                break;
            }
            u = if newton > low && newton < high { newton } else { f64::midpoint(low, high) };
        }
        u
    }
}

/// Coefficients by power of the quintic Bezier curve with these control points.
fn powers(p: [f64; 6]) -> [f64; 6] {
    let [a, b, c, d, e, f] = p;
    [
        a,
        5.0 * (b - a),
        10.0 * (a - 2.0 * b + c),
        10.0 * (-a + 3.0 * b - 3.0 * c + d),
        5.0 * (a - 4.0 * b + 6.0 * c - 4.0 * d + e),
        -a + 5.0 * b - 10.0 * c + 10.0 * d - 5.0 * e + f,
    ]
}

/// Value and slope of a polynomial.
fn horner(c: &[f64; 6], u: f64) -> [f64; 2] {
    c.iter().rev().fold([0.0; 2], |[value, slope], k| [value * u + k, slope * u + value])
}

#[cfg(test)]
mod tests {
    use super::{Curve, Knot};

    #[test]
    fn a_curve_meets_its_knots_with_their_slopes_and_goes_on_straight() {
        let knots = [(0.5, 0.1, 0.0), (0.8, 0.6, 2.5), (1.1, 1.0, 0.2), (1.6, 0.3, -0.4)].map(|(x, y, slope)| Knot {
            x,
            y,
            slope,
        });
        for curviness in [0.0, 0.6, 1.0] {
            let curve = Curve::new(&knots, curviness);
            for knot in knots {
                let (y, slope) = curve.at(knot.x);
                assert!((y - knot.y).abs() < 1e-12 && (slope - knot.slope).abs() < 1e-9, "{knot:?}: {y}, {slope}");
            }
            assert_eq!(curve.at(0.1), (0.1, 0.0));
            assert!((curve.at(2.6).0 - (0.3 - 0.4)).abs() < 1e-12);
            for k in 1..110 {
                let (x, h) = (0.5 + 0.01 * f64::from(k) + 1e-3, 1e-6);
                let slope = (curve.at(x + h).0 - curve.at(x - h).0) / (2.0 * h);
                let error = (curve.at(x).1 - slope).abs();
                assert!(error < 1e-4 * slope.abs().max(1.0), "at {x}: {} and {slope}", curve.at(x).1);
            }
        }
    }
}
