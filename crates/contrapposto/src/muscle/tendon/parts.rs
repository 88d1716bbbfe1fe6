//! Defines the parts of a tendon of MuJoCo, and the surfaces that they pass round.

use nalgebra::Vector3;

use crate::model::Placement;

/// A sphere or cylinder that tendons pass round.
#[derive(Clone, Debug, PartialEq)]
pub struct TendonGeom {
    /// Name of the geom.
    pub name: String,
    /// Index of the segment that carries it; `None` for ground.
    pub segment: Option<usize>,
    /// Axes of the geom in the segment's frame.
    pub pose: Placement,
    /// Shape of the geom.
    pub shape: RoundShape,
    /// Radius of the geom, m.
    pub radius: f64,
}

/// Shapes that tendons pass round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoundShape {
    /// A sphere about the origin.
    Sphere,
    /// A cylinder without ends along z through the origin.
    Cylinder,
}

/// The parts of a path between its points, by MuJoCo's rule.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tendon {
    /// The line between each point of the path and the next one.
    pub parts: Vec<TendonPart>,
    /// Coordinates that lengthen the tendon directly: index, and length for each rad or m.
    pub coordinates: Vec<(usize, f64)>,
}

/// The line between two points of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonPart {
    /// Factor of its length and tension: 1 over the divisor of its pulley; 0 where one branch ends and the next one begins.
    pub weight: f64,
    /// The surface that it may pass round.
    pub around: Option<Around>,
}

/// A surface that a part of a tendon may pass round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around {
    /// Index in [`crate::muscle::Paths::geoms`].
    pub geom: usize,
    /// The point on whose side the line passes; if it is inside of the surface, so is the line.
    pub side: Option<SidePoint>,
}

/// A point fixed in a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SidePoint {
    /// Index of the segment; `None` for ground.
    pub segment: Option<usize>,
    /// In the segment's frame, m.
    pub place: Vector3<f64>,
}
