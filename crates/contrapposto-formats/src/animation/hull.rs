//! Computes the surface of a solid: the convex hull of balls as a closed mesh with normals.

/// A ball: position in the segment's frame and radius, m.
pub(super) type Ball = [f64; 4];

/// The convex hull of balls.
pub type Solid = Vec<[f64; 4]>;

/// Rings from pole to pole, and points on each.
pub(super) const RINGS: usize = 12;
pub(super) const SLICES: usize = 16;

/// Directions in which a hull is measured: the poles first and last.
fn directions() -> impl Iterator<Item = [f64; 3]> {
    let point = |ring: usize, slice: usize| {
        let (across, up) = libm::sincos(std::f64::consts::PI * ring as f64 / RINGS as f64);
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * slice as f64 / SLICES as f64);
        [across * cos, up, across * sin]
    };
    let rings = (1..RINGS).flat_map(move |ring| (0..SLICES).map(move |slice| point(ring, slice)));
    std::iter::once([0.0, 1.0, 0.0]).chain(rings).chain([[0.0, -1.0, 0.0]])
}

/// Position (less `origin`) and normal of every corner: the farthest point of the hull in each direction.
pub(super) fn corners(balls: &[[f64; 4]], origin: [f64; 3]) -> Vec<[[f32; 3]; 2]> {
    let corner = |d: [f64; 3]| {
        let reach = |b: &&[f64; 4]| b[0] * d[0] + b[1] * d[1] + b[2] * d[2] + b[3];
        let ball = balls.iter().max_by(|a, b| reach(a).total_cmp(&reach(b))).copied().unwrap_or_default();
        [[0, 1, 2].map(|k| (ball[k] + ball[3] * d[k] - origin[k]) as f32), d.map(|v| v as f32)]
    };
    directions().map(corner).collect()
}

/// Corners of the triangles, anticlockwise seen from outside; the same for every hull.
pub(super) fn triangles() -> Vec<u16> {
    let at = |ring: usize, slice: usize| (1 + (ring - 1) * SLICES + slice % SLICES) as u16;
    let (top, bottom) = (0, (1 + (RINGS - 1) * SLICES) as u16);
    let mut list = vec![];
    for slice in 0..SLICES {
        list.extend([top, at(1, slice + 1), at(1, slice)]);
        for ring in 1..RINGS - 1 {
            let (a, b, c, d) = (at(ring, slice), at(ring, slice + 1), at(ring + 1, slice), at(ring + 1, slice + 1));
            list.extend([a, b, c, b, d, c]);
        }
        list.extend([at(RINGS - 1, slice), at(RINGS - 1, slice + 1), bottom]);
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed: every edge is walked once each way. Outward: the volume is positive, and that of a ball.
    #[test]
    fn a_hull_is_closed_and_looks_outward() {
        let triangles = triangles();
        let mut edges: Vec<[u16; 2]> =
            triangles.chunks_exact(3).flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]).collect();
        edges.sort_unstable();
        assert!(edges.windows(2).all(|pair| pair[0] != pair[1]));
        assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()));
        let corners = corners(&[[1.0, 2.0, 3.0, 0.5]], [1.0, 2.0, 2.0]);
        assert!(triangles.iter().all(|&i| usize::from(i) < corners.len()));
        let p = |i: u16| nalgebra::Vector3::from(corners[usize::from(i)][0].map(f64::from));
        let volume: f64 = triangles.chunks_exact(3).map(|t| p(t[0]).dot(&p(t[1]).cross(&p(t[2]))) / 6.0).sum();
        let ball = 4.0 / 3.0 * std::f64::consts::PI * 0.125;
        assert!((0.93 * ball..ball).contains(&volume), "{volume} {ball}");
    }
}
