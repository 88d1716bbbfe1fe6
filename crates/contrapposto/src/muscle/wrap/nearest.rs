//! Computes the point of an ellipsoid that is nearest to a place, as OpenSim does: to a limited accuracy, and apart in planes of symmetry.
//!
//! Newton's method for the factor t of the normal, x = a^2 u / (t + a^2) (Hart in Graphics Gems IV, by OpenSim's own account).

use nalgebra::Vector3;

use crate::muscle::tolerances::{ELLIPSOID_PLANE, NEAREST_RESIDUAL, NEAREST_STEPS};

type V = Vector3<f64>;

/// The point nearest to a place. `axis`: in the plane of symmetry across that axis, in which the place lies. `None` where the search does
/// not end.
pub(super) fn nearest(axes: &V, place: &V, axis: Option<usize>) -> Option<V> {
    // Of several planes that of the smallest section.
    let near = (0..3).filter(|&i| place[i].abs() <= ELLIPSOID_PLANE);
    if let Some(axis) = axis.or_else(|| near.max_by(|&i, &j| axes[i].total_cmp(&axes[j]).then(j.cmp(&i)))) {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let (x, y) = on_ellipse([axes[i], axes[j]], [place[i], place[j]]);
        let mut point = *place;
        (point[i], point[j]) = (x, y);
        return Some(point);
    }
    let squares = axes.component_mul(axes);
    let products = squares.component_mul(&place.component_mul(place));
    let inside = place.component_div(axes).norm_squared() < 1.0;
    let mut t = if inside { 0.0 } else { axes.max() * place.norm() };
    for _ in 0..NEAREST_STEPS {
        let [p, q, r] = [squares.x + t, squares.y + t, squares.z + t];
        let [pp, qq, rr] = [p * p, q * q, r * r];
        let residual = pp * qq * rr - products.x * qq * rr - products.y * pp * rr - products.z * pp * qq;
        if residual.abs() < NEAREST_RESIDUAL {
            return Some(squares.component_mul(place).component_div(&V::new(p, q, r)));
        }
        let slope = p * q * r * (q * r + p * r + p * q)
            - products.x * q * r * (q + r)
            - products.y * p * r * (p + r)
            - products.z * p * q * (p + q);
        t -= residual / (2.0 * slope);
    }
    None
}

/// The point of an ellipse nearest to a place of its plane.
fn on_ellipse([a, b]: [f64; 2], [u, v]: [f64; 2]) -> (f64, f64) {
    let sign = |number: f64| if number < 0.0 { -1.0 } else { 1.0 };
    let (on_v, on_u) = (u.abs() <= ELLIPSOID_PLANE, v.abs() <= ELLIPSOID_PLANE);
    let across = |along: f64, half: f64, other: f64| other * (1.0 - (along / half).powi(2)).abs().sqrt();
    let (aa, bb) = (a * a, b * b);
    match (on_v, on_u) {
        (true, true) if a < b => (sign(u) * a, v),
        (true, true) => (u, sign(v) * b),
        (true, false) if a >= b || v.abs() >= b - aa / b => (u, sign(v) * b),
        (true, false) => {
            let y = bb * v / (bb - aa);
            (across(y, b, a), y)
        }
        (false, true) if b >= a || u.abs() >= a - bb / a => (sign(u) * a, v),
        (false, true) => {
            let x = aa * u / (aa - bb);
            (x, across(x, a, b))
        }
        (false, false) => {
            let inside = (u / a).powi(2) + (v / b).powi(2) < 1.0;
            let mut t = if inside { 0.0 } else { a.max(b) * libm::hypot(u, v) };
            let (mut p, mut q) = (aa + t, bb + t);
            for _ in 0..NEAREST_STEPS {
                (p, q) = (aa + t, bb + t);
                let residual = p * p * q * q - aa * u * u * q * q - bb * v * v * p * p;
                if residual.abs() < NEAREST_RESIDUAL {
                    break;
                }
                t -= residual / (2.0 * (p * q * (p + q) - aa * u * u * q - bb * v * v * p));
            }
            (aa * u / p, bb * v / q)
        }
    }
}
