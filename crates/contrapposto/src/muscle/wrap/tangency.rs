//! Searches the point where a line from a place touches the section of an ellipsoid with a plane, as OpenSim does.
//!
//! Unknowns are the point r and d; residuals: r lies in the plane, r lies on the ellipsoid, and the tangent plane at r (of offset d) contains
//! r and the place. A damped least-squares step is cut to a sixteenth and repeated as long as it helps. The search ends at a residual
//! of 1e-4, so that its course determines the point.

use nalgebra::{Matrix4, Vector3, Vector4};

use crate::muscle::tolerances::{TANGENCY_REPEATS, TANGENCY_RESIDUAL, TANGENCY_STEPS};

type V = Vector3<f64>;

/// The search from one place.
pub(super) struct Tangency<'a> {
    /// Inverse squares of the half axes.
    inverse: V,
    place: &'a V,
    /// Normal and offset of the plane.
    plane: (V, f64),
}

impl<'a> Tangency<'a> {
    pub(super) fn new(axes: &V, place: &'a V, plane: (V, f64)) -> Self {
        Self { inverse: axes.map(|a| 1.0 / (a * a)), place, plane }
    }

    /// The residuals of a point and an offset.
    fn residual(&self, at: &Vector4<f64>) -> Vector4<f64> {
        let point = at.xyz();
        let gradient = 2.0 * point.component_mul(&self.inverse);
        Vector4::new(
            self.plane.0.dot(&point) + self.plane.1,
            0.5 * gradient.dot(&point) - 1.0,
            gradient.dot(&point) + at.w,
            gradient.dot(self.place) + at.w,
        )
    }

    /// Derivatives of the residuals by row of unknowns. Those of the third are as in OpenSim.
    fn slopes(&self, point: &V) -> Matrix4<f64> {
        let gradient = 2.0 * point.component_mul(&self.inverse);
        let by_place = 2.0 * self.place.component_mul(&self.inverse);
        let row = |i: usize| [self.plane.0[i], gradient[i], 2.0 * gradient[i], by_place[i]];
        let rows = [row(0), row(1), row(2), [0.0, 0.0, 1.0, 1.0]];
        Matrix4::from_fn(|i, j| rows[i][j])
    }

    /// The point, from a first one.
    pub(super) fn search(&self, start: V) -> V {
        let offset = -2.0 * start.component_mul(&self.inverse).dot(&start);
        let mut at = Vector4::new(start.x, start.y, start.z, offset);
        let mut square = self.residual(&at).norm_squared();
        let mut damping = 0.01;
        let out = self.place.normalize();
        for _ in 0..TANGENCY_STEPS {
            if square.is_nan() || square <= TANGENCY_RESIDUAL {
                break;
            }
            let slopes = self.slopes(&at.xyz());
            let cosine = (self.place - at.xyz()).try_normalize(f64::EPSILON).unwrap_or_default().dot(&out);
            let share = if cosine > 0.1 { 1.0 - cosine.powi(100) } else { 1.0 } / 16.0;
            let force = -slopes * self.residual(&at);
            let matrix = slopes * slopes.transpose();
            let (mut step, mut before) = (Vector4::zeros(), square);
            for _ in 0..TANGENCY_REPEATS {
                if square < before {
                    break;
                }
                let mut damped = matrix;
                (0..4).for_each(|i| damped[(i, i)] *= 1.0 + damping);
                let Some(inverse) = damped.try_inverse() else { return at.xyz() };
                step = share * (inverse * force);
                at += step;
                (before, square) = (square, self.residual(&at).norm_squared());
                damping *= 4.0;
            }
            damping /= 8.0;
            let mut repeat = 0.5;
            for _ in 0..TANGENCY_REPEATS {
                if square.is_nan() || square > before {
                    break;
                }
                repeat *= 2.0;
                at += repeat * step;
                (before, square) = (square, self.residual(&at).norm_squared());
            }
            at -= repeat * step;
            square = self.residual(&at).norm_squared();
        }
        at.xyz()
    }
}
