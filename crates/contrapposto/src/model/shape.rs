//! Defines the shapes of a body's parts: capsules, and which of them may meet.

use nalgebra::Vector3;

/// All points within a radius of a line segment that is fixed in a segment of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Index of the segment of the body.
    pub segment: usize,
    /// Ends of the line, in the frame of that segment, m; a sphere has two equal ones.
    pub ends: [Vector3<f64>; 2],
    /// Radius, m.
    pub radius: f64,
}

/// A part of the body that does not pass through others.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Unique name, e.g. `thigh_lower_r`.
    pub name: String,
    /// Place and size of the part.
    pub capsule: Capsule,
    /// Whether the part has a sole, which stands on things.
    pub sole: bool,
}
