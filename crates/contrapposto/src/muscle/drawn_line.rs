//! Computes points along the line of a path, with its arcs on surfaces, for pictures.
//!
//! Between the corners at which the line meets and leaves a surface, the points lie on the geodesic `x'' = -k n` that starts in the direction
//! of the straight part before, with normal curvature `k` and normal `n`, integrated by Runge and Kutta's method of fourth order. What its end
//! misses of the second corner is taken away in proportion to the length: of a line that is no geodesic (one of OpenSim's rule) the
//! points are near the surface, not on it.

use nalgebra::Vector3;

use super::geometry::PathGeometry;
use super::path::{Path, Paths};
use super::routing::{CornerOrigin, FrameInGround};
use super::tendon::RoundShape;
use super::tolerances::{ARC_POINTS, ARC_STEPS};
use super::wrap::WrapShape;

/// A point of a drawn line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnPoint {
    /// Place in ground, m.
    pub place: Vector3<f64>,
    /// Index of the segment that carries it; `None` for ground.
    pub segment: Option<usize>,
    /// Number of the point in its path: the same in all postures.
    pub number: usize,
    /// Whether a branch of a tendon begins here, so that no line leads to this point from the one before.
    pub begins: bool,
}

impl Path {
    /// Greatest number of points of its drawn line: [`DrawnPoint::number`] is less.
    pub fn drawn_points(&self) -> usize {
        self.points.len() + ARC_POINTS * self.surfaces()
    }
}

impl PathGeometry {
    /// Points along the line of a path in the posture of the last update, from its first point to its last one.
    pub fn drawn(&self, paths: &Paths, path: usize) -> Vec<DrawnPoint> {
        let of = &paths.paths[path];
        let nodes = &self.line(path).nodes;
        let mut drawn: Vec<DrawnPoint> = vec![];
        for (at, node) in nodes.iter().enumerate() {
            let begins = at > 0 && nodes[at - 1].weight == 0.0;
            let point = |place, number| DrawnPoint { place, segment: node.segment, number, begins };
            match node.kind {
                CornerOrigin::Point(number) => drawn.push(point(node.place, number)),
                CornerOrigin::On(wrap) => {
                    let (Some(before), Some(off)) = (at.checked_sub(1).map(|i| &nodes[i]), nodes.get(at + 1)) else {
                        continue;
                    };
                    let ends = [before.place, node.place, off.place];
                    let length = self.line(path).on_surface.get(wrap).copied().unwrap_or_default().abs();
                    let first = of.points.len() + ARC_POINTS * wrap;
                    let arc = self.surface(paths, of, wrap).map(|(frame, shape)| arc(frame, &shape, ends, length));
                    let places = arc.unwrap_or([node.place; ARC_POINTS]);
                    drawn.extend(places.into_iter().enumerate().map(|(k, place)| point(place, first + k)));
                }
                // It is the last point of the arc.
                CornerOrigin::Off(_) => {}
            }
        }
        drawn
    }

    /// Frame in ground and shape of the surface of a path's wrap, or of a tendon's part.
    fn surface(&self, paths: &Paths, path: &Path, wrap: usize) -> Option<(&FrameInGround, WrapShape)> {
        let Some(tendon) = &path.tendon else {
            let object = path.wraps.get(wrap)?.object;
            return Some((self.object_frame(object), paths.wrap_objects[object].shape));
        };
        let geom = tendon.parts.get(wrap)?.around?.geom;
        let radius = paths.geoms[geom].radius;
        let shape = match paths.geoms[geom].shape {
            RoundShape::Sphere => WrapShape::Sphere { radius },
            RoundShape::Cylinder => WrapShape::Cylinder { radius, length: f64::INFINITY },
        };
        Some((self.geom_frame(geom), shape))
    }
}

/// Points on a surface, from the second of three places, all in ground, to the third one.
fn arc(
    (axes, origin): &FrameInGround,
    shape: &WrapShape,
    ends: [Vector3<f64>; 3],
    length: f64,
) -> [Vector3<f64>; ARC_POINTS] {
    let [before, first, second] = ends.map(|place| axes.tr_mul(&(place - origin)));
    let normal = shape.normal(&first);
    let ahead = if (first - before).norm() > 0.0 { first - before } else { second - first };
    let direction = (ahead - ahead.dot(&normal) * normal).try_normalize(0.0).unwrap_or_default();
    let step = length / ((ARC_POINTS - 1) * ARC_STEPS) as f64;
    let mut places = [first; ARC_POINTS];
    let mut state = (first, direction);
    for place in &mut places[1..] {
        state = (0..ARC_STEPS).fold(state, |state, _| stepped(shape, state, step));
        *place = state.0;
    }
    let missed = second - state.0;
    let last = (ARC_POINTS - 1) as f64;
    let mut share = 0.0;
    places.map(|place| {
        let corrected = place + missed * (share / last);
        share += 1.0;
        axes * corrected + origin
    })
}

/// One step along a geodesic.
fn stepped(shape: &WrapShape, state: (Vector3<f64>, Vector3<f64>), step: f64) -> (Vector3<f64>, Vector3<f64>) {
    let rates = |(place, direction): (Vector3<f64>, Vector3<f64>)| {
        (direction, -shape.normal_curvature(&place, &direction) * shape.normal(&place))
    };
    let moved = |by: (Vector3<f64>, Vector3<f64>), step: f64| (state.0 + step * by.0, state.1 + step * by.1);
    let a = rates(state);
    let b = rates(moved(a, step / 2.0));
    let c = rates(moved(b, step / 2.0));
    let d = rates(moved(c, step));
    moved(((a.0 + 2.0 * (b.0 + c.0) + d.0) / 6.0, (a.1 + 2.0 * (b.1 + c.1) + d.1) / 6.0), step)
}
