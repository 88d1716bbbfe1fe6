//! Orders solid parts for drawing, so that nearer parts hide farther ones.
//!
//! Where two parts overlap on the sheet, the part whose front is nearer there comes later; of two parts that penetrate each other, as
//! at a joint, the second of the list comes later. Parts are hulls of balls in the axes of a view: x right, y up, z towards the viewer.

use std::f64::consts::TAU;

use crate::geometry::Point;
use crate::outline::{Circle, Outline};

/// A ball: centre and radius.
pub(crate) type Ball = [f64; 4];

/// Directions towards the viewer in which a front is measured: rings about the axis of view, and directions of a ring.
const RINGS: u32 = 6;
const SLICES: u32 = 16;
/// Two parts are compared at this number of points squared where their boxes overlap.
const SAMPLES_PER_SIDE: u32 = 6;

/// Two fronts nearer to each other than this share of the thinner part's thickness count as equally near.
const TIE_SHARE: f64 = 0.7;

/// A part in the axes of a view.
pub(crate) struct Solid {
    pub(crate) outline: Outline,
    /// Planes that touch the part from the viewer's side: z at the origin of the sheet, and its decrease with x and with y.
    planes: Vec<[f64; 3]>,
    low: Point,
    high: Point,
    /// Mean z of the balls.
    depth: f64,
    /// Radius of the largest ball.
    thick: f64,
}

impl Solid {
    pub(crate) fn new(balls: &[Ball]) -> Self {
        let circles: Vec<Circle> = balls.iter().map(|b| Circle { center: (b[0], b[1]), radius: b[3] }).collect();
        let least = |f: &dyn Fn(&Ball) -> f64| balls.iter().map(f).fold(f64::INFINITY, f64::min);
        let plane = |[x, y, z]: [f64; 3]| {
            let support = -least(&|b| -(b[0] * x + b[1] * y + b[2] * z + b[3]));
            [support / z, x / z, y / z]
        };
        Self {
            outline: Outline::of(&circles),
            planes: directions().map(plane).collect(),
            low: (least(&|b| b[0] - b[3]), least(&|b| b[1] - b[3])),
            high: (-least(&|b| -b[0] - b[3]), -least(&|b| -b[1] - b[3])),
            depth: balls.iter().map(|b| b[2]).sum::<f64>() / balls.len().max(1) as f64,
            thick: -least(&|b| -b[3]),
        }
    }

    /// z of the front at a point of the sheet: the least z of all touching planes there.
    fn front(&self, (x, y): Point) -> f64 {
        self.planes.iter().map(|[near, a, b]| near - a * x - b * y).fold(f64::INFINITY, f64::min)
    }

    /// Volume between the fronts of two overlapping parts, px3: positive if this part hides the earlier one, negative if the earlier
    /// one hides it, 0 if the two do not overlap.
    fn hides(&self, earlier: &Self) -> f64 {
        let low = (self.low.0.max(earlier.low.0), self.low.1.max(earlier.low.1));
        let high = (self.high.0.min(earlier.high.0), self.high.1.min(earlier.high.1));
        if low.0 >= high.0 || low.1 >= high.1 {
            return 0.0;
        }
        let at = |k: u32, low: f64, high: f64| low + (high - low) * (f64::from(k) + 0.5) / f64::from(SAMPLES_PER_SIDE);
        let tie = TIE_SHARE * self.thick.min(earlier.thick);
        let mut sum = 0.0;
        for k in 0..SAMPLES_PER_SIDE * SAMPLES_PER_SIDE {
            let point = (at(k / SAMPLES_PER_SIDE, low.0, high.0), at(k % SAMPLES_PER_SIDE, low.1, high.1));
            if self.outline.contains(point) && earlier.outline.contains(point) {
                sum += self.front(point) - earlier.front(point) + tie;
            }
        }
        sum * (high.0 - low.0) * (high.1 - low.1) / f64::from(SAMPLES_PER_SIDE * SAMPLES_PER_SIDE)
    }
}

fn directions() -> impl Iterator<Item = [f64; 3]> {
    let ring = |ring: u32| {
        let (out, towards) = libm::sincos(f64::from(ring) / f64::from(RINGS) * TAU / 4.0);
        let slices = if ring == 0 { 1 } else { SLICES };
        (0..slices).map(move |slice| {
            let (sin, cos) = libm::sincos(TAU * f64::from(slice) / f64::from(SLICES));
            [out * cos, out * sin, towards]
        })
    };
    (0..RINGS).flat_map(ring)
}

/// Indices of the solids from the farthest to the nearest. Where solids hide each other in a cycle, the order draws the least volume
/// wrongly.
pub(crate) fn order(solids: &[Solid]) -> Vec<usize> {
    let n = solids.len();
    let mut hides = vec![vec![0.0; n]; n];
    for i in 0..n {
        for k in 0..i {
            let by = solids[i].hides(&solids[k]);
            (hides[i][k], hides[k][i]) = (by.max(0.0), (-by).max(0.0));
        }
    }
    let mut left: Vec<usize> = (0..n).collect();
    left.sort_by(|&a, &b| solids[a].depth.total_cmp(&solids[b].depth));
    let mut drawn = vec![];
    while !left.is_empty() {
        let wrong: Vec<f64> = left.iter().map(|&i| left.iter().map(|&k| hides[i][k]).sum()).collect();
        // The first of equals.
        let next = (0..left.len()).min_by(|&a, &b| wrong[a].total_cmp(&wrong[b])).unwrap_or(0);
        drawn.push(left.remove(next));
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_of_a_ball_and_of_a_slanted_bar_is_at_most_two_hundredths_too_near() {
        let ball = Solid::new(&[[1.0, 2.0, 3.0, 0.5]]);
        let (x, y) = (1.2, 1.9);
        let exact = 3.0 + f64::sqrt(0.25 - 0.04 - 0.01);
        let found = ball.front((x, y));
        assert!(found >= exact && found < exact + 0.02, "{found} {exact}");
        // A bar that comes nearer as it goes right: its front is a slanted line, off by the radius across it.
        let bar = Solid::new(&[[0.0, 0.0, 0.0, 0.1], [1.0, 0.0, 1.0, 0.1]]);
        let exact = 0.5 + 0.1 * f64::sqrt(2.0);
        let found = bar.front((0.5, 0.0));
        assert!(found >= exact - 1e-12 && found < exact + 0.02, "{found} {exact}");
    }

    #[test]
    fn a_bar_in_front_of_a_chest_is_drawn_last_although_its_mean_is_farther() {
        // The chest is deep; the bar passes before it on the slant, from far behind beside it to just before it.
        let chest = Solid::new(&[[0.0, 0.0, 0.0, 0.15], [0.0, 0.4, 0.0, 0.15]]);
        let bar = Solid::new(&[[0.9, 0.2, -0.9, 0.04], [0.1, 0.2, 0.2, 0.04]]);
        assert!(bar.depth < chest.depth);
        assert_eq!(order(&[bar, chest]), [1, 0]);
    }

    #[test]
    fn separate_parts_are_ordered_by_depth_and_a_cycle_has_an_order() {
        let far = || Solid::new(&[[5.0, 0.0, -1.0, 0.1]]);
        let near = || Solid::new(&[[0.0, 0.0, 1.0, 0.1]]);
        assert_eq!(order(&[near(), far()]), [1, 0]);
        // Three bars, each above the next.
        let bar = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            let [a, b] = [-1.0, 1.0].map(|end: f64| [0.3 * -sin + end * cos, 0.3 * cos + end * sin, 0.3 * end, 0.01]);
            Solid::new(&[a, b])
        };
        let mut places = order(&[bar(0.0), bar(TAU / 3.0), bar(2.0 * TAU / 3.0)]);
        places.sort_unstable();
        assert_eq!(places, [0, 1, 2]);
    }
}
