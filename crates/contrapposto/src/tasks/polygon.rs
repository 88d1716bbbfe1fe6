//! Computes the support polygon of points on the ground.
//!
//! The convex hull of the points seen along gravity, as half-planes `normal . x <= offset` in ground coordinates with
//! unit normals square to gravity. Monotone chain (Andrew 1979, "Another efficient algorithm for convex hulls in two
//! dimensions").

use nalgebra::{Vector2, Vector3};

/// `normal . x <= offset`, in ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane {
    /// Outward normal, of unit length.
    pub normal: Vector3<f64>,
    /// Coordinate of the edge along the normal, m.
    pub offset: f64,
}

impl HalfPlane {
    /// Distance by which `point` (m) lies outside, m; not positive inside.
    pub fn excess(&self, point: &Vector3<f64>) -> f64 {
        self.normal.dot(point) - self.offset
    }
}

/// A hull thinner than this, m, counts as a line segment, and a shorter line segment as a point: the half-planes at so sharp corners would be inaccurate.
const THIN_HULL: f64 = 1e-6;

/// Corners nearer to each other than this, m, are one.
const SAME_CORNER: f64 = 1e-9;

/// The half-planes whose intersection is the convex hull of `points` (ground, m) seen along `gravity`. Points on one
/// line, or all in one place (to a micrometre), give the half-planes around that line segment or point. Empty without
/// points or without gravity.
pub fn half_planes(points: &[Vector3<f64>], gravity: Vector3<f64>) -> Vec<HalfPlane> {
    let Some(down) = gravity.try_normalize(0.0) else { return vec![] };
    let right = down.cross(&Vector3::ith(down.iamin(), 1.0)).normalize();
    let ahead = down.cross(&right);
    // Minus zero becomes zero, which sorting tells apart.
    let seen: Vec<Vector2<f64>> =
        points.iter().map(|p| Vector2::new(p.dot(&right) + 0.0, p.dot(&ahead) + 0.0)).collect();
    let corners = corners(seen);
    // The half-plane to the left of `along`.
    let left_of = |at: &Vector2<f64>, along: Vector2<f64>| {
        let outward = Vector2::new(along.y, -along.x).normalize();
        HalfPlane { normal: outward.x * right + outward.y * ahead, offset: outward.dot(at) }
    };
    let four = |a: &Vector2<f64>, b: &Vector2<f64>, along: Vector2<f64>| {
        let across = Vector2::new(along.y, -along.x);
        vec![left_of(a, along), left_of(b, -across), left_of(b, -along), left_of(a, across)]
    };
    let far = |from: Vector2<f64>| {
        corners.iter().copied().max_by(|p, q| (p - from).norm_squared().total_cmp(&(q - from).norm_squared()))
    };
    let Some((a, b)) = corners.first().and_then(|first| far(*first)).and_then(|a| Some((a, far(a)?))) else {
        return vec![];
    };
    let along = b - a;
    if along.norm() < THIN_HULL {
        return four(&a, &a, Vector2::x());
    }
    if corners.iter().all(|p| along.perp(&(p - a)).abs() < THIN_HULL * along.norm()) {
        return four(&a, &b, along);
    }
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(p, q)| left_of(p, q - p)).collect()
}

/// Corners of the convex hull, anticlockwise.
fn corners(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let chain = |points: &mut dyn Iterator<Item = &Vector2<f64>>| {
        let mut hull: Vec<Vector2<f64>> = vec![];
        for point in points {
            while let [.., o, p] = hull[..] {
                if (p - o).perp(&(point - o)) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(*point);
        }
        hull.pop();
        hull
    };
    let mut hull = chain(&mut points.iter());
    hull.extend(chain(&mut points.iter().rev()));
    // Edges this short have the direction of their rounding errors.
    hull.dedup_by(|q, p| (*q - *p).norm() < SAME_CORNER);
    if hull.len() > 1 && (hull[hull.len() - 1] - hull[0]).norm() < SAME_CORNER {
        hull.pop();
    }
    hull
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::half_planes;

    /// A square metre, each corner of which is given twice, at most half a nanometre apart, in every direction.
    #[test]
    fn a_corner_that_is_given_twice_within_rounding_has_no_edge_of_its_own() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, z]| Vector3::new(x, 0.0, z));
        for corner in corners {
            for step in 0..16 {
                let (sin, cos) = libm::sincos(0.1 + 0.393 * f64::from(step));
                for apart in [1e-12, 5e-10] {
                    let mut points = corners.to_vec();
                    points.push(corner + apart * Vector3::new(cos, 0.0, sin));
                    let planes = half_planes(&points, Vector3::new(0.0, -9.81, 0.0));
                    assert_eq!(planes.len(), 4, "{corner} {step} {apart}");
                    let middle = Vector3::new(0.5, 0.0, 0.5);
                    assert!(planes.iter().all(|plane| (plane.excess(&middle) + 0.5).abs() < 1e-9));
                }
            }
        }
    }
}
