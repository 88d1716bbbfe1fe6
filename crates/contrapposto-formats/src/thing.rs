//! Holds a thing of a scenario as a box, for drawings: a table, a held box, a wall.

use nalgebra::{Isometry3, Vector3};

/// A box that stands in ground, or that a segment carries.
#[derive(Clone, Debug, PartialEq)]
pub struct Thing {
    /// Name of the thing.
    pub name: String,
    /// Full lengths along its own axes, m.
    pub size: Vector3<f64>,
    /// Middle and axes of the thing, in ground or in the frame of the segment.
    pub place: Isometry3<f64>,
    /// Index of the segment that carries it; `None` for a thing in ground.
    pub segment: Option<usize>,
}
