//! Defines surfaces that paths wrap over, and computes where a straight part of a path touches one of them.

mod cylinder;
mod cylinder_opensim;

use nalgebra::Vector3;

use super::path::PathRule;
use crate::model::Placement;

/// A surface fixed in a segment.
#[derive(Clone, Debug, PartialEq)]
pub struct WrapObject {
    /// Its name.
    pub name: String,
    /// Index of the segment that carries it; `None` for ground.
    pub segment: Option<usize>,
    /// Its axes in the segment's frame.
    pub pose: Placement,
    /// The half of it that paths may touch.
    pub quadrant: Quadrant,
    /// Whether paths wrap over it at all.
    pub active: bool,
    /// Its shape, about its own axes.
    pub shape: WrapShape,
}

/// The half of a surface that paths may touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quadrant {
    /// All of it: paths take the shorter way.
    #[default]
    All,
    /// The half on one side: index of the axis (0 for x), and whether it is the positive side.
    Half {
        /// 0 for x, 1 for y, 2 for z.
        axis: usize,
        /// Its positive side.
        positive: bool,
    },
}

impl Quadrant {
    /// The axis and whether a point lies on the side that paths may touch.
    fn on(axis: usize, positive: bool, point: &Vector3<f64>) -> bool {
        (point[axis] >= 0.0) == positive
    }
}

/// Shapes of surfaces, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WrapShape {
    /// A cylinder along z about the origin.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Its length.
        length: f64,
    },
}

/// Two points on a surface and the line between them, in the surface's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    pub(super) first: Vector3<f64>,
    pub(super) second: Vector3<f64>,
    /// Length of the line on the surface, m.
    pub(super) length: f64,
}

/// What a surface does to a straight part of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wrapping {
    /// An end of the part is inside.
    Inside,
    /// It does not touch.
    Free,
    /// It may lie on it: the part that it makes longer by the least counts.
    Touches(Contact),
    /// It would pass through.
    Crosses(Contact),
}

/// Circumstances of a part of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Manner {
    pub(super) rule: PathRule,
    /// The path has no other surface.
    pub(super) single: bool,
}

impl WrapObject {
    /// What it does to a part of a path between two points in its frame.
    pub(super) fn wrap(&self, from: &Vector3<f64>, to: &Vector3<f64>, manner: Manner) -> Wrapping {
        match (&self.shape, manner.rule) {
            (WrapShape::Cylinder { radius, length }, PathRule::Geodesic) => {
                cylinder::wrap(*radius, *length, self.quadrant, from, to)
            }
            (WrapShape::Cylinder { radius, length }, PathRule::OpenSim) => {
                cylinder_opensim::wrap(*radius, *length, self.quadrant, from, to, manner.single)
            }
        }
    }
}
