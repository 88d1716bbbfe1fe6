//! Computes the outline of a solid part on the sheet.
//!
//! The orthographic image of the hull of balls is the hull of circles: arcs joined by straight lines. The arcs are exact: the circle
//! that reaches farthest in a direction `u` changes only where two circles reach equally far, `(a - b).u = rb - ra`.

use std::f64::consts::TAU;

use crate::geometry::Point;
use crate::path::{Path, Step};

/// Greatest number of circles of one outline.
pub(crate) const MOST_CIRCLES: usize = 32;
/// Arcs are drawn as cubic curves of at most this angle, rad: they stay within a millionth of the radius.
const LONGEST_CURVE: f64 = std::f64::consts::FRAC_PI_6;
/// Directions nearer to each other than this, rad, count as one.
const ANGLE_TOLERANCE: f64 = 1e-12;

/// A circle on the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Circle {
    pub(crate) center: Point,
    pub(crate) radius: f64,
}

/// A piece of an outline: the circle's points in directions `from` to `to`, rad.
#[derive(Clone, Copy, Debug)]
struct Arc {
    circle: Circle,
    from: f64,
    to: f64,
}

impl Arc {
    /// Cubic curves from the arc's first point to its last; of a circle without radius none.
    fn curves(&self) -> impl Iterator<Item = Step> {
        let pieces = if self.circle.radius > 0.0 { ((self.to - self.from) / LONGEST_CURVE).ceil() } else { 0.0 };
        let step = (self.to - self.from) / pieces;
        // A cubic curve whose handles are so long touches the arc at both ends and in the middle.
        let handle = 4.0 / 3.0 * libm::tan(step / 4.0) * self.circle.radius;
        (0..pieces as u32).map(move |piece| {
            let ends = [f64::from(piece), f64::from(piece + 1)].map(|k| self.from + k * step);
            let [(x0, y0), (x, y)] = ends.map(|angle| self.circle.point(angle));
            let [(s0, c0), (s, c)] = ends.map(libm::sincos);
            Step::Curve((x0 - handle * s0, y0 + handle * c0), (x + handle * s, y - handle * c), (x, y))
        })
    }
}

impl Circle {
    /// Largest component of the circle's points in a direction (its support function).
    fn support(&self, (x, y): Point) -> f64 {
        self.center.0 * x + self.center.1 * y + self.radius
    }

    fn point(&self, angle: f64) -> Point {
        let (sin, cos) = libm::sincos(angle);
        (self.center.0 + self.radius * cos, self.center.1 + self.radius * sin)
    }
}

/// The hull of circles.
pub(crate) struct Outline {
    arcs: Vec<Arc>,
    /// Ends of the arcs.
    corners: Vec<Point>,
}

impl Outline {
    /// The hull of the first [`MOST_CIRCLES`] circles; empty if there is none.
    pub(crate) fn of(circles: &[Circle]) -> Self {
        let arcs = arcs(circles);
        let corners = arcs.iter().flat_map(|arc| [arc.circle.point(arc.from), arc.circle.point(arc.to)]).collect();
        Self { arcs, corners }
    }

    /// Corners of the hull of circles without radius, one after the other.
    pub(crate) fn corners(&self) -> &[Point] {
        &self.corners
    }

    /// Whether the hull contains the point.
    pub(crate) fn contains(&self, (x, y): Point) -> bool {
        let left_of = |(a, b): (&Point, &Point)| (b.0 - a.0) * (y - a.1) - (b.1 - a.1) * (x - a.0) >= 0.0;
        let within = |arc: &Arc| libm::hypot(x - arc.circle.center.0, y - arc.circle.center.1) <= arc.circle.radius;
        let corners = &self.corners;
        let polygon = corners.len() > 2 && corners.iter().zip(corners.iter().cycle().skip(1)).all(left_of);
        polygon || self.arcs.iter().any(within)
    }

    /// The closed path of the outline, px.
    pub(crate) fn path(&self) -> Path {
        let mut steps = vec![];
        for arc in &self.arcs {
            let start = arc.circle.point(arc.from);
            steps.push(if steps.is_empty() { Step::Move(start) } else { Step::Line(start) });
            steps.extend(arc.curves());
        }
        if !steps.is_empty() {
            steps.push(Step::Close);
        }
        Path(steps)
    }
}

/// Arcs of the hull, one after the other; straight lines join them.
fn arcs(circles: &[Circle]) -> Vec<Arc> {
    let circles = &circles[..circles.len().min(MOST_CIRCLES)];
    // Directions in which two circles reach equally far: (a - b).u = rb - ra.
    let mut turns = vec![0.0];
    for (i, a) in circles.iter().enumerate() {
        for b in &circles[..i] {
            let (dx, dy) = (a.center.0 - b.center.0, a.center.1 - b.center.1);
            let share = (b.radius - a.radius) / libm::hypot(dx, dy);
            if share.abs() < 1.0 {
                let (middle, half) = (libm::atan2(dy, dx), libm::acos(share));
                turns.extend([middle - half, middle + half].map(|turn| turn.rem_euclid(TAU)));
            }
        }
    }
    turns.sort_by(f64::total_cmp);
    turns.push(TAU);
    let mut arcs: Vec<Arc> = vec![];
    for pair in turns.windows(2).filter(|pair| pair[1] - pair[0] > ANGLE_TOLERANCE) {
        let (sin, cos) = libm::sincos(0.5 * (pair[0] + pair[1]));
        // The first of equals.
        let farthest = circles.iter().rev().max_by(|a, b| a.support((cos, sin)).total_cmp(&b.support((cos, sin))));
        let Some(&circle) = farthest else { return vec![] };
        match arcs.last_mut() {
            Some(arc) if arc.circle == circle => arc.to = pair[1],
            _ => arcs.push(Arc { circle, from: pair[0], to: pair[1] }),
        }
    }
    if let [first, .., last] = arcs.as_mut_slice()
        && first.circle == last.circle
    {
        last.to = TAU + first.to;
        arcs.remove(0);
    }
    arcs
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: u32 = 720;

    fn circles(list: &[(f64, f64, f64)]) -> Vec<Circle> {
        list.iter().map(|&(x, y, radius)| Circle { center: (x, y), radius }).collect()
    }

    /// Pseudo-random numbers, the same in every run.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// Points of a path: ends of lines and 16 points of every cubic curve.
    fn points(path: &Path) -> Vec<Point> {
        let mut found: Vec<Point> = vec![];
        for step in &path.0 {
            match (found.last().copied(), *step) {
                (_, Step::Move(point) | Step::Line(point)) => found.push(point),
                (Some(a), Step::Curve(b, c, d)) => found.extend((1..=16).map(|k| {
                    let t = f64::from(k) / 16.0;
                    let s = 1.0 - t;
                    let mix = |f: fn(Point) -> f64| {
                        s * s * s * f(a) + 3.0 * s * s * t * f(b) + 3.0 * s * t * t * f(c) + t * t * t * f(d)
                    };
                    (mix(|p| p.0), mix(|p| p.1))
                })),
                _ => {}
            }
        }
        found
    }

    #[test]
    fn the_path_has_the_support_function_of_its_circles() {
        let mut next = numbers(7);
        let mut cases = vec![
            circles(&[(5.0, 5.0, 2.0)]),
            circles(&[(0.0, 0.0, 5.0), (1.0, 0.0, 1.0)]),
            circles(&[(0.0, 0.0, 3.0), (10.0, 0.0, 3.0), (0.0, 0.0, 3.0)]),
            circles(&[(0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (0.0, 10.0, 0.0)]),
        ];
        for count in 2..14 {
            cases.push(
                (0..count)
                    .map(|_| Circle { center: (200.0 * next(), 200.0 * next()), radius: 60.0 * next() })
                    .collect(),
            );
        }
        for case in cases {
            let outline = Outline::of(&case);
            let drawn = points(&outline.path());
            for k in 0..STEPS {
                let (sin, cos) = libm::sincos(TAU * f64::from(k) / f64::from(STEPS));
                let wanted = case.iter().map(|c| c.support((cos, sin))).fold(f64::NEG_INFINITY, f64::max);
                let found = drawn.iter().map(|p| p.0 * cos + p.1 * sin).fold(f64::NEG_INFINITY, f64::max);
                // The sag between the 16 points of a curve.
                assert!((wanted - found).abs() < 0.03, "{case:?}: {wanted} {found}");
            }
            let turned: f64 = outline.arcs.iter().map(|arc| arc.to - arc.from).sum();
            assert!((turned - TAU).abs() < 1e-9, "{turned}");
        }
    }

    #[test]
    fn a_point_is_contained_if_no_direction_separates_it() {
        let mut next = numbers(11);
        for _ in 0..40 {
            let case: Vec<Circle> =
                (0..5).map(|_| Circle { center: (10.0 * next(), 10.0 * next()), radius: 3.0 * next() }).collect();
            let outline = Outline::of(&case);
            for _ in 0..200 {
                let p = (20.0 * next() - 5.0, 20.0 * next() - 5.0);
                let room = (0..STEPS).map(|k| {
                    let (sin, cos) = libm::sincos(TAU * f64::from(k) / f64::from(STEPS));
                    case.iter().map(|c| c.support((cos, sin))).fold(f64::NEG_INFINITY, f64::max) - p.0 * cos - p.1 * sin
                });
                let room = room.fold(f64::INFINITY, f64::min);
                if room.abs() > 1e-3 {
                    assert_eq!(outline.contains(p), room > 0.0, "{p:?} {room}");
                }
            }
        }
    }

    #[test]
    fn the_outline_of_no_circles_is_empty() {
        let nothing = Outline::of(&[]);
        assert_eq!(nothing.path(), Path::default());
        assert!(!nothing.contains((0.0, 0.0)));
    }
}
