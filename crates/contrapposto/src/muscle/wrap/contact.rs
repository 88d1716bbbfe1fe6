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
        /// Whether the half is that on the positive side.
        positive: bool,
    },
}

impl Quadrant {
    /// The axis and whether a point lies on the side that paths may touch.
    pub(super) fn on(axis: usize, positive: bool, point: &Vector3<f64>) -> bool {
        (point[axis] >= 0.0) == positive
    }
}

/// Shares of the straight line between two points at which it enters the unit sphere and leaves it; `None` unless it does both.
pub(super) fn crossings(from: &Vector3<f64>, to: &Vector3<f64>) -> Option<(f64, f64)> {
    let straight = to - from;
    let (square, half) = (straight.norm_squared(), from.dot(&straight));
    let root = half.mul_add(half, -square * (from.norm_squared() - 1.0)).sqrt();
    let (enters, leaves) = ((-half - root) / square, (root - half) / square);
    let between = |share: f64| share > 0.0 && share < 1.0;
    (between(enters) && between(leaves)).then_some((enters, leaves))
}

/// Two points on a surface and the line between them, in the surface's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::muscle) struct Contact {
    pub(in crate::muscle) first: Vector3<f64>,
    pub(in crate::muscle) second: Vector3<f64>,
    /// Length of the line on the surface, m.
    pub(in crate::muscle) length: f64,
}

impl Contact {
    pub(super) fn is_finite(&self) -> bool {
        let Self { first, second, length } = self;
        length.is_finite() && first.iter().chain(second).all(|number| number.is_finite())
    }
}

/// Relation of a surface to a straight part of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::muscle) enum Wrapping {
    /// An end of the part is inside.
    Inside,
    /// OpenSim counts it as touching, but has no line over it.
    WithoutLine,
    /// The part does not touch the surface.
    Free,
    /// The part may lie on the surface: of all such parts of the path, the one that becomes longer by the least does.
    Touches(Contact),
    /// The part would pass through the surface.
    Crosses(Contact),
}
