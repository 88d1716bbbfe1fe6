//! Computes how neighbouring shortest lines spread along one on a surface.
//!
//! The distance `y` of a neighbouring geodesic changes as `y'' = -K y` with Gauss's curvature `K` (Jacobi's equation): in closed form on
//! cylinders and spheres, else integrated along the geodesic `x'' = -k n` with normal curvature `k` by Runge and Kutta's method
//! of fourth order.

use nalgebra::Vector3;

use super::WrapShape;
use crate::muscle::tolerances::SPREAD_STEPS;

type V = Vector3<f64>;

/// Distance of two neighbouring shortest lines on a surface and the angle between them, m and rad: what they are at the end of a
/// part of length `s` is this matrix times what they are at its beginning. Its determinant is 1.
pub(crate) type Spread = [[f64; 2]; 2];

/// Place, direction, and the two solutions of Jacobi's equation with their slopes.
type Along = (V, V, [f64; 4]);

impl WrapShape {
    /// Outward unit normal at a place on the surface.
    pub(in crate::muscle) fn normal(&self, place: &V) -> V {
        match self {
            Self::Cylinder { .. } => V::new(place.x, place.y, 0.0).normalize(),
            Self::Sphere { .. } => place.normalize(),
            Self::Ellipsoid { half_axes } => place.component_div(half_axes).component_div(half_axes).normalize(),
            Self::Torus { circle, .. } => {
                let out = V::new(place.x, place.y, 0.0).normalize();
                (place - out * *circle).normalize()
            }
        }
    }

    /// Spread of shortest lines beside the one that starts at a place in a direction, over a length, m.
    pub(super) fn spread(&self, place: &V, direction: &V, length: f64) -> Spread {
        match self {
            Self::Cylinder { .. } => [[1.0, length], [0.0, 1.0]],
            Self::Sphere { radius } => {
                let (sin, cos) = libm::sincos(length / radius);
                [[cos, radius * sin], [-sin / radius, cos]]
            }
            Self::Ellipsoid { .. } | Self::Torus { .. } => self.integrated(place, direction, length),
        }
    }

    /// Normal curvature at a place of the surface in a unit direction, 1/m.
    pub(in crate::muscle) fn normal_curvature(&self, place: &V, direction: &V) -> f64 {
        match self {
            Self::Cylinder { radius, .. } => direction.xy().norm_squared() / radius,
            Self::Sphere { radius } => 1.0 / radius,
            Self::Ellipsoid { .. } | Self::Torus { .. } => self.curvatures(place, direction).0,
        }
    }

    /// Normal curvature in a unit direction, and Gauss's curvature, at a place.
    fn curvatures(&self, place: &V, direction: &V) -> (f64, f64) {
        match self {
            Self::Ellipsoid { half_axes } => {
                let gradient = place.component_div(half_axes).component_div(half_axes);
                let bent = direction.component_div(half_axes).norm_squared();
                let product = half_axes.iter().product::<f64>();
                (bent / gradient.norm(), 1.0 / (product * gradient.norm_squared()).powi(2))
            }
            Self::Torus { tube, .. } => {
                let out = V::new(place.x, place.y, 0.0);
                let round = self.normal(place).dot(&out) / out.norm_squared();
                let along = V::z().cross(&out).normalize().dot(direction).powi(2);
                ((1.0 - along) / tube + along * round, round / tube)
            }
            Self::Cylinder { .. } | Self::Sphere { .. } => (0.0, 0.0),
        }
    }

    fn integrated(&self, place: &V, direction: &V, length: f64) -> Spread {
        let rates = |(place, direction, y): &Along| {
            let (normal, gauss) = self.curvatures(place, direction);
            (*direction, -normal * self.normal(place), [y[1], -gauss * y[0], y[3], -gauss * y[2]])
        };
        let moved = |(place, direction, y): &Along, by: &Along, step: f64| {
            let y = std::array::from_fn(|i| y[i] + step * by.2[i]);
            (place + step * by.0, direction + step * by.1, y)
        };
        let step = length / SPREAD_STEPS as f64;
        let start: Along = (*place, *direction, [1.0, 0.0, 0.0, 1.0]);
        let end = (0..SPREAD_STEPS).fold(start, |at, _| {
            let a = rates(&at);
            let b = rates(&moved(&at, &a, step / 2.0));
            let c = rates(&moved(&at, &b, step / 2.0));
            let d = rates(&moved(&at, &c, step));
            [(a, 1.0), (b, 2.0), (c, 2.0), (d, 1.0)]
                .iter()
                .fold(at, |at, (by, share)| moved(&at, by, share * step / 6.0))
        });
        let [a, slope_of_a, b, slope_of_b] = end.2;
        [[a, b], [slope_of_a, slope_of_b]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_an_ellipsoid_of_equal_axes_lines_spread_as_on_a_sphere() {
        let (radius, place, direction) = (0.03, V::new(0.0, 0.03, 0.0), V::new(0.6, 0.0, 0.8));
        let [sphere, ellipsoid] = [WrapShape::Sphere { radius }, WrapShape::Ellipsoid { half_axes: V::repeat(radius) }]
            .map(|shape| shape.spread(&place, &direction, 0.05));
        for (ours, theirs) in ellipsoid.iter().flatten().zip(sphere.iter().flatten()) {
            assert!((ours - theirs).abs() < 1e-8 * theirs.abs().max(1.0), "{ellipsoid:?} {sphere:?}");
        }
    }

    #[test]
    fn along_the_outer_circle_of_a_torus_lines_spread_as_on_a_surface_of_constant_curvature() {
        let (tube, circle) = (0.01, 0.03);
        let shape = WrapShape::Torus { tube, circle };
        let found = shape.spread(&V::new(tube + circle, 0.0, 0.0), &V::y(), 0.02);
        let rate = (1.0 / (tube * (tube + circle))).sqrt();
        let (sin, cos) = libm::sincos(rate * 0.02);
        let expected = [[cos, sin / rate], [-rate * sin, cos]];
        for (ours, theirs) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((ours - theirs).abs() < 1e-8 * theirs.abs().max(1.0), "{found:?} {expected:?}");
        }
    }
}
