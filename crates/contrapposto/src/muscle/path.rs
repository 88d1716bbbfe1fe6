//! Defines the path of a muscle: points on segments in order, and the surfaces that it may wrap over.

use nalgebra::Vector3;

use super::rule::WrapMethod;
use super::tendon::{Tendon, TendonGeom};
use super::wrap::WrapObject;
use crate::math::Function;
use crate::model::Placement;

/// A point of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPoint {
    /// Index of the segment that carries it; `None` for ground.
    pub segment: Option<usize>,
    /// Location in the segment's frame.
    pub location: Location,
}

/// Location of a point of a path in the frame of its segment.
#[derive(Clone, Debug, PartialEq)]
pub enum Location {
    /// Always at the same place, m.
    Fixed(Vector3<f64>),
    /// At one place, m, while a coordinate is in a range; else the path passes without the point.
    Conditional {
        /// The place, m.
        place: Vector3<f64>,
        /// Index of the coordinate.
        coordinate: usize,
        /// Range of the coordinate, rad or m.
        range: (f64, f64),
    },
    /// A function of one coordinate.
    Moving(Box<MovingPoint>),
}

/// The place of a point as a function of a coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct MovingPoint {
    /// The frame of the functions, in that of the segment.
    pub frame: Placement,
    /// Index of the coordinate; without one the functions are taken at zero.
    pub coordinate: Option<usize>,
    /// Range of the coordinate, rad or m: outside of it the point stays where it is at the nearer end.
    pub range: (f64, f64),
    /// x, y and z in `frame`, m.
    pub place: [Function; 3],
}

impl MovingPoint {
    /// The place in the segment's frame, m, and its derivative by the coordinate.
    pub(super) fn place_and_slope(&self, values: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        let at = self.coordinate.map_or(0.0, |c| values[c].max(self.range.0).min(self.range.1));
        let [x, y, z] = self.place.each_ref().map(|function| function.value_slope_curvature(at));
        let place = self.frame * nalgebra::Point3::new(x[0], y[0], z[0]);
        (place.coords, self.frame.rotation * Vector3::new(x[1], y[1], z[1]))
    }

    /// First and second derivative of the place by the coordinate, in the segment's frame; zero where the point does not move.
    pub(crate) fn slope_and_curvature(&self, values: &[f64]) -> [Vector3<f64>; 2] {
        let Some(at) = self.coordinate.map(|c| values[c]).filter(|_| !self.stays(values)) else {
            return [Vector3::zeros(); 2];
        };
        let [x, y, z] = self.place.each_ref().map(|function| function.value_slope_curvature(at));
        [1, 2].map(|order| self.frame.rotation * Vector3::new(x[order], y[order], z[order]))
    }

    /// The derivative of the place by the coordinate as OpenSim takes it: also outside of the range, with the coordinate's own value.
    pub(super) fn slope_beyond_range(&self, values: &[f64]) -> Vector3<f64> {
        let at = self.coordinate.map_or(0.0, |c| values[c]);
        let [x, y, z] = self.place.each_ref().map(|function| function.slope(at));
        self.frame.rotation * Vector3::new(x, y, z)
    }

    /// Whether the coordinate has left its range, so that the point does not move.
    pub(super) fn stays(&self, values: &[f64]) -> bool {
        self.coordinate.is_none_or(|c| values[c] < self.range.0 || values[c] > self.range.1)
    }
}

/// A surface that a path may wrap over.
#[derive(Clone, Debug, PartialEq)]
pub struct PathWrap {
    /// Index in [`Paths::wrap_objects`].
    pub object: usize,
    /// Method, for ellipsoids.
    pub method: WrapMethod,
    /// First and last point of the path between which it may wrap, by index; all for `None`.
    pub range: (Option<usize>, Option<usize>),
}

/// A path: points in order, and the surfaces that it may wrap over.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    /// At least two points; none where a tendon depends on coordinates only.
    pub points: Vec<PathPoint>,
    /// Surfaces, in the order in which they are tried.
    pub wraps: Vec<PathWrap>,
    /// A tendon of MuJoCo: all points are fixed, and it has no `wraps`.
    pub tendon: Option<Tendon>,
}

impl Path {
    /// The greatest number of surfaces that its line can touch.
    pub(super) fn surfaces(&self) -> usize {
        self.tendon.as_ref().map_or(self.wraps.len(), |tendon| tendon.parts.len())
    }
}

/// All paths of a body and the surfaces that they share.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Paths {
    /// The paths.
    pub paths: Vec<Path>,
    /// The surfaces.
    pub wrap_objects: Vec<WrapObject>,
    /// The surfaces of MuJoCo's tendons.
    pub geoms: Vec<TendonGeom>,
}
