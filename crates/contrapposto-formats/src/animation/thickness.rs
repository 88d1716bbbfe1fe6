//! Computes the thickness of a segment from its volume: the convex hull of balls about its points has that volume.

use super::hull::{Ball, RINGS, SLICES};

/// Thinnest and thickest ball, m.
const THINNEST: f64 = 0.012;
const THICKEST: f64 = 0.5;

/// Balls about `points` (position and relative thickness) whose hull has `volume`, m3, as near as radii from 12 mm to 0.5 m allow.
pub(super) fn balls_of(points: &[Ball], volume: f64) -> Vec<Ball> {
    let balls = |size: f64| -> Vec<Ball> {
        let thick = |p: &Ball| [p[0], p[1], p[2], (size * p[3]).clamp(THINNEST, THICKEST)];
        points.iter().map(thick).collect()
    };
    let (mut low, mut high) = (0.0, 2.0 * THICKEST);
    for _ in 0..30 {
        let size = 0.5 * (low + high);
        if hull_volume(&balls(size)) < volume { low = size } else { high = size }
    }
    balls(0.5 * (low + high))
}

/// Volume of the convex hull of balls, m3: the farthest point in each direction, joined to a mesh.
fn hull_volume(balls: &[Ball]) -> f64 {
    let point = |ring: usize, slice: usize| -> [f64; 3] {
        let (down, across) = libm::sincos(std::f64::consts::PI * ring as f64 / RINGS as f64);
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * (slice % SLICES) as f64 / SLICES as f64);
        let d = [down * cos, across, down * sin];
        let support = |b: &&Ball| b[0] * d[0] + b[1] * d[1] + b[2] * d[2] + b[3];
        let Some(b) = balls.iter().max_by(|a, b| support(a).total_cmp(&support(b))) else { return [0.0; 3] };
        [b[0] + b[3] * d[0], b[1] + b[3] * d[1], b[2] + b[3] * d[2]]
    };
    let mut six = 0.0;
    for ring in 0..RINGS {
        for slice in 0..SLICES {
            let (a, b) = (point(ring, slice), point(ring, slice + 1));
            let (c, d) = (point(ring + 1, slice), point(ring + 1, slice + 1));
            six += determinant(a, b, d) + determinant(a, d, c);
        }
    }
    (six / 6.0).abs()
}

fn determinant(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_of_the_volume_of_a_ball_and_of_a_bar_have_their_radius() {
        let radius: f64 = 0.1;
        let ball = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        let found = balls_of(&[[0.3, 0.2, 0.1, 1.0]], ball)[0][3];
        assert!((found - radius).abs() < 0.005, "{found}");
        let bar = ball + 0.4 * std::f64::consts::PI * radius.powi(2);
        let found = balls_of(&[[0.0, 0.0, 0.0, 1.0], [0.0, -0.4, 0.0, 1.0]], bar)[0][3];
        assert!((found - radius).abs() < 0.005, "{found}");
    }

    #[test]
    fn volumes_of_zero_and_of_a_billion_give_the_thinnest_and_thickest_ball() {
        assert_eq!(balls_of(&[[0.0, 0.0, 0.0, 1.0]], 0.0)[0][3], THINNEST);
        assert_eq!(balls_of(&[[0.0, 0.0, 0.0, 1.0]], 1e9)[0][3], THICKEST);
        assert!(balls_of(&[], 1.0).is_empty());
        assert!(balls_of(&[[f64::NAN; 4]], f64::NAN).len() == 1);
    }
}
