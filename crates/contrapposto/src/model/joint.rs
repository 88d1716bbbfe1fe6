//! Defines the kinds of joints: how a segment may move against its parent.

use nalgebra::{Unit, Vector3};

use crate::math::Function;

/// An elementary motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Turns about an axis; one coordinate, rad.
    Hinge(Unit<Vector3<f64>>),
    /// Slides along an axis; one coordinate, m.
    Slide(Unit<Vector3<f64>>),
    /// Turns freely; four coordinates (unit quaternion w, x, y, z), three rates about the moved frame's own axes.
    Ball,
}

/// A joint as files name it; each is a chain of elementary motions, the first one nearest the parent.
#[derive(Clone, Debug, PartialEq)]
pub enum JointKind {
    /// No motion.
    Weld,
    /// One turning axis.
    Hinge(Unit<Vector3<f64>>),
    /// One sliding axis.
    Slide(Unit<Vector3<f64>>),
    /// Two turning axes through one point, the second carried by the first.
    Universal([Unit<Vector3<f64>>; 2]),
    /// Three turning axes through one point, each carried by the one before.
    Gimbal([Unit<Vector3<f64>>; 3]),
    /// Free rotation about a point.
    Ball,
    /// Three translations along the parent's axes, then free rotation.
    Free,
    /// Any chain of hinges, slides and balls, one coordinate (a ball four) each: six-coordinate roots.
    Chain(Vec<Motion>),
    /// A chain of hinges and slides driven by functions of the joint's coordinates (OpenSim's CustomJoint), and balls, each
    /// driven by the first of its four coordinates.
    Driven(Vec<(Motion, Drive)>),
}

/// The source of the value of an elementary motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// A coordinate itself, by its index.
    Coordinate(usize),
    /// A function of one coordinate, given by its index.
    Function(Function, usize),
    /// Always the same: rad or m.
    Fixed(f64),
}

impl Motion {
    /// Number of coordinates.
    pub fn coordinates(self) -> usize {
        if self == Self::Ball { 4 } else { 1 }
    }

    /// Number of rates, and so of torques.
    pub fn rates(self) -> usize {
        if self == Self::Ball { 3 } else { 1 }
    }
}

impl JointKind {
    /// The elementary motions, nearest the parent first.
    pub fn motions(&self) -> Vec<Motion> {
        match self {
            Self::Weld => vec![],
            Self::Hinge(axis) => vec![Motion::Hinge(*axis)],
            Self::Slide(axis) => vec![Motion::Slide(*axis)],
            Self::Universal(axes) => axes.iter().copied().map(Motion::Hinge).collect(),
            Self::Gimbal(axes) => axes.iter().copied().map(Motion::Hinge).collect(),
            Self::Ball => vec![Motion::Ball],
            Self::Free => {
                let slides = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()].map(Motion::Slide);
                slides.into_iter().chain([Motion::Ball]).collect()
            }
            Self::Chain(motions) => motions.clone(),
            Self::Driven(motions) => motions.iter().map(|(motion, _)| *motion).collect(),
        }
    }
}
