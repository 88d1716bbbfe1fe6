//! Computes closest points of two line segments, and of a line segment and a block.
//!
//! Two line segments `p(s) = p0 + s u`, `q(t) = q0 + t v` with `s, t` in `0..1`: the squared distance is convex, so its least value
//! is at the stationary point `s = (u.v v.w - v.v u.w) / (u.u v.v - (u.v)^2)`, `w = p0 - q0`, or on an edge of the square, where it
//! is the projection of an end on the other line segment (Eberly 2001, "Robust Computation of Distance Between Line Segments";
//! recalled). Parallel line segments have the middle of the part in which they face each other.
//!
//! A line segment and a block: half the squared distance of `p(t)` has the slope `sum_k u_k (p_k - clamp(p_k))`, which does not
//! fall and is linear between the values of `t` at which a coordinate passes a face; so its root is found exactly.

use nalgebra::Vector3;

/// Line segments whose directions differ by less than this, in the sine of the angle, count as parallel.
const PARALLEL_SEGMENTS: f64 = 1e-6;

/// Parameters `s` and `t` of closest points of the line segments between two pairs of ends.
pub fn closest_on_segments(p: [Vector3<f64>; 2], q: [Vector3<f64>; 2]) -> (f64, f64) {
    let (u, v, w) = (p[1] - p[0], q[1] - q[0], p[0] - q[0]);
    let (uu, uv, vv, uw, vw) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let on_p = |t: f64| ratio(t * uv - uw, uu);
    let on_q = |s: f64| ratio(s * uv + vw, vv);
    let determinant = uu * vv - uv * uv;
    if determinant <= PARALLEL_SEGMENTS * PARALLEL_SEGMENTS * uu * vv {
        let s = 0.5 * (on_p(0.0) + on_p(1.0));
        return (s, on_q(s));
    }
    let square = |(s, t): (f64, f64)| (w + s * u - t * v).norm_squared();
    let (s, t) = ((uv * vw - vv * uw) / determinant, (uu * vw - uv * uw) / determinant);
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        return (s, t);
    }
    let edges = [(0.0, on_q(0.0)), (1.0, on_q(1.0)), (on_p(0.0), 0.0), (on_p(1.0), 1.0)];
    edges[1..].iter().fold(edges[0], |best, edge| if square(*edge) < square(best) { *edge } else { best })
}

/// `a / b` within `0..1`; 0 where `b` is 0.
fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { (a / b).clamp(0.0, 1.0) } else { 0.0 }
}

/// Parameter of the point of a line segment that is closest to the block `|x_k| <= half_k`; inside, the middle of the part in it.
pub fn closest_to_block(p: [Vector3<f64>; 2], half: &Vector3<f64>) -> f64 {
    let u = p[1] - p[0];
    let slope = |t: f64| -> f64 {
        (0..3)
            .map(|k| {
                let x = p[0][k] + t * u[k];
                u[k] * (x - x.clamp(-half[k], half[k]))
            })
            .sum()
    };
    let mut passes = [0.0; 8];
    passes[7] = 1.0;
    for k in 0..3 {
        for (i, face) in [-half[k], half[k]].into_iter().enumerate() {
            let t = (face - p[0][k]) / u[k];
            passes[1 + 2 * k + i] = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 };
        }
    }
    passes.sort_unstable_by(f64::total_cmp);
    // The slope is 0 between the last pass below the root and the first one above it, if there is such a part.
    let below = passes.iter().rev().find(|t| slope(**t) < 0.0).copied();
    let above = passes.iter().find(|t| slope(**t) > 0.0).copied();
    let root = |a: f64, b: f64, upper: bool| {
        let flat = passes.iter().filter(|t| (a..=b).contains(*t) && slope(**t) == 0.0);
        let mut flat = flat.copied();
        let found = if upper { flat.next_back() } else { flat.next() };
        found.unwrap_or_else(|| a + (b - a) * slope(a) / (slope(a) - slope(b)))
    };
    match (below, above) {
        (Some(a), Some(b)) => 0.5 * (root(a, b, false) + root(a, b, true)),
        (Some(a), None) => {
            if slope(1.0) < 0.0 {
                1.0
            } else {
                0.5 * (root(a, 1.0, false) + 1.0)
            }
        }
        (None, Some(b)) => {
            if slope(0.0) > 0.0 {
                0.0
            } else {
                0.5 * root(0.0, b, true)
            }
        }
        (None, None) => 0.5,
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    const SEED: u64 = 41;

    fn vector(random: &mut Pcg64Mcg) -> Vector3<f64> {
        Vector3::from_fn(|_, _| random.random_range(-1.0..1.0))
    }

    /// Least distance over a grid of both parameters, and how much finer points could be nearer.
    fn sampled(p: [Vector3<f64>; 2], q: [Vector3<f64>; 2], n: usize) -> (f64, f64) {
        let at = |ends: &[Vector3<f64>; 2], i: usize| ends[0] + (i as f64 / n as f64) * (ends[1] - ends[0]);
        let mut least = f64::INFINITY;
        for i in 0..=n {
            for j in 0..=n {
                least = least.min((at(&p, i) - at(&q, j)).norm());
            }
        }
        (least, ((p[1] - p[0]).norm() + (q[1] - q[0]).norm()) / n as f64)
    }

    /// Random, parallel, crossing and degenerate line segments.
    #[test]
    fn closest_points_of_line_segments_are_those_of_dense_sampling() {
        let mut random = Pcg64Mcg::new(SEED.into());
        println!("seed {SEED}");
        for case in 0..500 {
            let mut p = [vector(&mut random), vector(&mut random)];
            let mut q = [vector(&mut random), vector(&mut random)];
            match case % 5 {
                1 => q[1] = q[0] + random.random_range(-2.0..2.0) * (p[1] - p[0]),
                2 => q = [p[0] + (q[0] - q[1]), p[0] - (q[0] - q[1])],
                3 => q[1] = q[0],
                4 => (p[1], q[1]) = (p[0], if case % 2 == 0 { q[0] } else { q[1] }),
                _ => {}
            }
            let (s, t) = closest_on_segments(p, q);
            assert!((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t), "{s} {t}");
            let found = (p[0] + s * (p[1] - p[0]) - q[0] - t * (q[1] - q[0])).norm();
            let (least, finer) = sampled(p, q, 200);
            assert!(found <= least + 1e-9 && found >= least - finer, "case {case}: {found} {least}");
        }
    }

    /// Legs side by side: the middle of the common part, whichever way the ends are listed.
    #[test]
    fn parallel_line_segments_have_the_middle_of_their_common_part() {
        let line = |x: f64, from: f64, to: f64| [Vector3::new(x, from, 0.0), Vector3::new(x, to, 0.0)];
        assert_eq!(closest_on_segments(line(0.0, 0.0, 1.0), line(1.0, 0.5, 1.5)), (0.75, 0.25));
        assert_eq!(closest_on_segments(line(0.0, 0.0, 1.0), line(1.0, 1.5, 0.5)), (0.75, 0.75));
        assert_eq!(closest_on_segments(line(0.0, 0.0, 1.0), line(1.0, 2.0, 3.0)), (1.0, 0.0));
        assert_eq!(closest_on_segments(line(0.0, 0.0, 0.0), line(1.0, -1.0, 3.0)), (0.0, 0.25));
    }

    #[test]
    fn closest_point_to_a_block_is_that_of_dense_sampling() {
        let mut random = Pcg64Mcg::new(SEED.into());
        println!("seed {SEED}");
        let mut inside = 0;
        for case in 0..2000 {
            let half = vector(&mut random).map(|x| 0.5 * x.abs() + 0.01);
            let mut p = [vector(&mut random), vector(&mut random)];
            match case % 4 {
                1 => p[1] = p[0],
                2 => p[1].x = p[0].x,
                3 => p = [Vector3::new(-1.0, 0.2, half.z), Vector3::new(1.0, 0.2, half.z)],
                _ => {}
            }
            let distance = |t: f64| {
                let x = p[0] + t * (p[1] - p[0]);
                (x - x.zip_map(&half, |x, h| x.clamp(-h, h))).norm()
            };
            let t = closest_to_block(p, &half);
            assert!((0.0..=1.0).contains(&t), "{t}");
            let least = (0..=2000).map(|i| distance(f64::from(i) / 2000.0)).fold(f64::INFINITY, f64::min);
            let finer = (p[1] - p[0]).norm() / 2000.0;
            assert!(
                distance(t) <= least + 1e-9 && distance(t) >= least - finer,
                "case {case}: {} {least}",
                distance(t)
            );
            inside += usize::from(least == 0.0);
        }
        assert!((100..1900).contains(&inside), "{inside}");
    }
}
