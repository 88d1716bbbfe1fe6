//! Defines surfaces that paths wrap over, and computes where a straight part of a path touches one of them.

mod contact;
mod cylinder;
mod cylinder_opensim;
mod ellipsoid;
mod ellipsoid_opensim;
mod geodesic;
mod nearest;
mod sphere;
mod spread;
mod tangency;
mod torus;
mod torus_opensim;

pub use contact::Quadrant;
pub(super) use contact::{Contact, Wrapping};
pub(crate) use spread::Spread;

use nalgebra::Vector3;

use super::rule::{PathRule, WrapMethod};
use crate::model::Placement;

/// A surface fixed in a segment.
#[derive(Clone, Debug, PartialEq)]
pub struct WrapObject {
    /// Name of the surface.
    pub name: String,
    /// Index of the segment that carries it; `None` for ground.
    pub segment: Option<usize>,
    /// Axes of the surface in the segment's frame.
    pub pose: Placement,
    /// The half of it that paths may touch.
    pub quadrant: Quadrant,
    /// Whether paths wrap over it at all.
    pub active: bool,
    /// Shape of the surface, about its own axes.
    pub shape: WrapShape,
}

/// Shapes of surfaces, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WrapShape {
    /// A cylinder along z about the origin.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Length.
        length: f64,
    },
    /// A sphere about the origin.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// An ellipsoid about the origin.
    Ellipsoid {
        /// Half axes along x, y and z.
        half_axes: Vector3<f64>,
    },
    /// A torus about z: a tube along a circle about the origin. Paths pass through it.
    Torus {
        /// Radius of the tube.
        tube: f64,
        /// Radius of the circle, above that of the tube.
        circle: f64,
    },
}

/// Rules by which a part of a path is laid over a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct WrapSettings {
    pub(super) rule: PathRule,
    pub(super) method: WrapMethod,
    /// The path has no other surface.
    pub(super) single: bool,
}

impl WrapObject {
    /// Outward normal at a point of the surface, both in the surface's frame.
    pub(crate) fn normal(&self, place: &Vector3<f64>) -> Vector3<f64> {
        self.shape.normal(place)
    }

    /// Spread of shortest lines on the surface beside the one that starts at a place in a direction, over a length, m.
    pub(crate) fn spread(&self, place: &Vector3<f64>, direction: &Vector3<f64>, length: f64) -> Spread {
        self.shape.spread(place, direction, length)
    }

    /// Lays the straight part of a path between two points, in the frame of the surface, over it. A search that ends in no number leaves the part straight.
    pub(super) fn wrap(&self, from: &Vector3<f64>, to: &Vector3<f64>, settings: WrapSettings) -> Wrapping {
        match self.laid(from, to, settings) {
            Wrapping::Touches(contact) | Wrapping::Crosses(contact) if !contact.is_finite() => Wrapping::Free,
            other => other,
        }
    }

    fn laid(&self, from: &Vector3<f64>, to: &Vector3<f64>, settings: WrapSettings) -> Wrapping {
        match (&self.shape, settings.rule) {
            (WrapShape::Cylinder { radius, length }, PathRule::Geodesic) => {
                cylinder::wrap(*radius, *length, self.quadrant, from, to)
            }
            (WrapShape::Cylinder { radius, length }, PathRule::OpenSim) => {
                cylinder_opensim::wrap(*radius, *length, self.quadrant, from, to, settings.single)
            }
            (WrapShape::Sphere { radius }, rule) => sphere::wrap(*radius, self.quadrant, from, to, rule),
            (WrapShape::Ellipsoid { half_axes }, PathRule::Geodesic) => {
                ellipsoid::wrap(half_axes, self.quadrant, from, to)
            }
            (WrapShape::Ellipsoid { half_axes }, PathRule::OpenSim) => {
                ellipsoid_opensim::wrap(half_axes, self.quadrant, settings.method, from, to)
            }
            (WrapShape::Torus { tube, circle }, PathRule::Geodesic) => {
                torus::wrap(*tube, *circle, self.quadrant, from, to)
            }
            (WrapShape::Torus { tube, circle }, PathRule::OpenSim) => {
                torus_opensim::wrap(*tube, *circle, self.quadrant, from, to, settings.single)
            }
        }
    }
}
