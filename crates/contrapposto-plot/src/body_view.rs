//! Projects bodies into views and measures their extent there. Bodies have axes x forward, y up, z to the right; a view has x right,
//! y up and z towards the viewer. The projection is orthographic, so lengths can be measured on paper.

use crate::axes::drawable;
use crate::body::{BodyPart, BodyPosture};
use crate::depth::Ball;
use crate::outline::MOST_CIRCLES;

/// Greatest number of parts of a body that are drawn, and of forces, targets and lines of sight.
pub(crate) const MOST_PARTS: usize = 120;

/// Greatest number of muscles that are drawn.
pub(crate) const MOST_MUSCLES: usize = 1000;

/// Surfaces and things that reach no farther than this beyond the rest, m, are drawn whole: tables and counters.
const WHOLE_BOX: f64 = 1.2;

/// Surfaces and things that reach farther, such as walls, are cut off at this distance beyond the rest, m.
const FARTHEST_BOX: f64 = 0.35;

/// A direction of view.
pub(crate) struct View {
    pub(crate) label: &'static str,
    /// Angle about the vertical, rad: 0 from the front, a quarter turn from the body's right.
    yaw: f64,
    /// Angle above the horizontal, rad.
    pitch: f64,
}

/// The views of every body, those of the report's page.
pub(crate) const VIEWS: [View; 3] = [
    View { label: "from the front", yaw: 0.0, pitch: 0.0 },
    View { label: "from the right", yaw: std::f64::consts::FRAC_PI_2, pitch: 0.0 },
    View { label: "three-quarter view", yaw: 0.55, pitch: 0.2 },
];

/// From above, forward at the top.
pub(crate) const ABOVE: View =
    View { label: "from above", yaw: std::f64::consts::PI, pitch: std::f64::consts::FRAC_PI_2 };

impl View {
    /// Coordinates of a point in the view.
    pub(crate) fn project(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let ((sy, cy), (sp, cp)) = (libm::sincos(self.yaw), libm::sincos(self.pitch));
        // From the front, the body's right hand is on the left.
        let (across, ahead) = (sy * x - cy * z, cy * x + sy * z);
        [across, cp * y - sp * ahead, cp * ahead + sp * y]
    }
}

/// The balls of a part that can be drawn.
pub(crate) fn balls(part: &BodyPart) -> impl Iterator<Item = Ball> + '_ {
    let good = |ball: &&Ball| ball.iter().all(|v| drawable(*v)) && ball[3] >= 0.0;
    part.balls.iter().filter(good).take(MOST_CIRCLES).copied()
}

/// A rectangle in a view, m; empty if it bounds nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
}

impl Bounds {
    pub(crate) const NOTHING: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    /// Bounds of a posture with its targets and forces; `length_per_newton` of arrows, m/N.
    pub(crate) fn of(posture: &BodyPosture, view: &View, length_per_newton: f64) -> Self {
        let mut bounds = Self::NOTHING;
        for [x, y, z, r] in posture.parts.iter().chain(&posture.start).take(2 * MOST_PARTS).flat_map(balls) {
            let [x, y, _] = view.project([x, y, z]);
            bounds.take([x - r, y - r]);
            bounds.take([x + r, y + r]);
        }
        let tips = posture.forces.iter().take(MOST_PARTS).map(|force| force.tip(length_per_newton));
        let of_loads = posture.loads.iter().take(MOST_PARTS).map(|load| load.tip_of_load(length_per_newton));
        let marks =
            tips.chain(of_loads).chain(posture.center_of_mass).chain(posture.ground_square().into_iter().flatten());
        marks.for_each(|mark| bounds.take_point(view, mark));
        // A target farther from the body than the body's size stays outside, so that the body is not drawn small.
        let size = bounds.size().into_iter().fold(0.0, f64::max);
        let near = bounds;
        for target in posture.targets.iter().take(MOST_PARTS) {
            let [x, y, _] = view.project(*target);
            if [x, y].into_iter().enumerate().all(|(k, v)| v >= near.low[k] - size && v <= near.high[k] + size) {
                bounds.take_point(view, *target);
            }
        }
        bounds.take_boxes(posture, view);
        bounds
    }

    /// Takes in surfaces and things: whole where they end near the rest, else a strip of them.
    fn take_boxes(&mut self, posture: &BodyPosture, view: &View) {
        if self.is_empty() {
            return;
        }
        let near = *self;
        for (corners, _) in posture.boxes() {
            let seen = corners.map(|corner| view.project(corner));
            let ends_near =
                |k: usize| seen.iter().all(|at| at[k] >= near.low[k] - WHOLE_BOX && at[k] <= near.high[k] + WHOLE_BOX);
            let margin = [0, 1].map(|k| if ends_near(k) { WHOLE_BOX } else { FARTHEST_BOX });
            let within = |at: [f64; 3], k: usize| at[k].clamp(near.low[k] - margin[k], near.high[k] + margin[k]);
            seen.iter().for_each(|at| self.take([within(*at, 0), within(*at, 1)]));
        }
    }

    fn take_point(&mut self, view: &View, point: [f64; 3]) {
        if point.into_iter().all(drawable) {
            let [x, y, _] = view.project(point);
            self.take([x, y]);
        }
    }

    fn take(&mut self, point: [f64; 2]) {
        for (k, value) in point.into_iter().enumerate() {
            self.low[k] = self.low[k].min(value);
            self.high[k] = self.high[k].max(value);
        }
    }

    pub(crate) fn with(mut self, other: &Self) -> Self {
        if !other.is_empty() {
            self.take(other.low);
            self.take(other.high);
        }
        self
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.low[0] > self.high[0]
    }

    /// Width and height, m; 0 if empty.
    pub(crate) fn size(&self) -> [f64; 2] {
        [0, 1].map(|k| (self.high[k] - self.low[k]).max(0.0))
    }

    /// Centre of the rectangle; the origin if empty.
    pub(crate) fn middle(&self) -> [f64; 2] {
        if self.is_empty() { [0.0; 2] } else { [0, 1].map(|k| 0.5 * (self.low[k] + self.high[k])) }
    }
}
