//! Defines the half of a surface that paths may touch, and what a surface does to a straight part of a path.

use nalgebra::Vector3;

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
    pub(super) fn on(axis: usize, positive: bool, point: &Vector3<f64>) -> bool {
        (point[axis] >= 0.0) == positive
    }
}

/// Whether the straight line between two points enters the unit sphere and leaves it.
pub(super) fn passes_through(from: &Vector3<f64>, to: &Vector3<f64>) -> bool {
    let straight = to - from;
    let (square, half) = (straight.norm_squared(), from.dot(&straight));
    let root = half.mul_add(half, -square * (from.norm_squared() - 1.0)).sqrt();
    let inside = |share: f64| share > 0.0 && share < 1.0;
    inside((-half - root) / square) && inside((root - half) / square)
}

/// Two points on a surface and the line between them, in the surface's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::muscle) struct Contact {
    pub(in crate::muscle) first: Vector3<f64>,
    pub(in crate::muscle) second: Vector3<f64>,
    /// Length of the line on the surface, m.
    pub(in crate::muscle) length: f64,
}

/// What a surface does to a straight part of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::muscle) enum Wrapping {
    /// An end of the part is inside.
    Inside,
    /// It does not touch.
    Free,
    /// It may lie on it: the part that it makes longer by the least counts.
    Touches(Contact),
    /// It would pass through.
    Crosses(Contact),
}
