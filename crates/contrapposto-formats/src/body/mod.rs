//! A body as model files describe it, resolved: what OpenSim, URDF and MJCF readers produce, and nothing of their syntax.
//!
//! Units rad, m, kg, N, N m. Defaults, classes, includes, degrees and Euler sequences have ended at the reader.

mod build;
mod model;
mod root;

pub use contrapposto::math::{Function, Spline, SplineError};
pub use model::{BodyError, Imported};
pub use root::{BodyRoot, FREE_ENDINGS};

pub(crate) use build::{compose_couplings, first_too_large, near, polynomial, turned, unique_coordinates, unit};

use nalgebra::{Isometry3, Matrix3, Vector3};

/// A resolved body.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// Name in the file.
    pub name: String,
    /// Gravity in the file's own ground axes, m/s^2.
    pub gravity: Vector3<f64>,
    /// Segments, parents before children.
    pub segments: Vec<BodySegment>,
    /// All coordinates, in the file's order.
    pub coordinates: Vec<BodyCoordinate>,
    /// Coordinates that follow another one.
    pub couplings: Vec<Coupling>,
    /// Passive torques on coordinates; several on one coordinate add up.
    pub passive: Vec<BodyPassive>,
    /// Named points (markers, sites): name, segment index, position in the segment's frame.
    pub stations: Vec<(String, usize, Vector3<f64>)>,
    /// What was read past because it does not matter to quasi-static torque: kind and count, sorted by kind.
    pub ignored: Vec<(String, usize)>,
}

/// A rigid part and its joint.
#[derive(Clone, Debug)]
pub struct BodySegment {
    /// Unique name.
    pub name: String,
    /// Index of the parent segment; `None` for ground.
    pub parent: Option<usize>,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the segment's frame, m.
    pub center_of_mass: Vector3<f64>,
    /// Inertia about the centre of mass in the segment's axes, kg m^2.
    pub inertia: Matrix3<f64>,
    /// Name of the joint to the parent.
    pub joint: String,
    /// The joint's resting frame in the parent's frame.
    pub in_parent: Isometry3<f64>,
    /// The joint's moved frame in this segment's frame.
    pub in_segment: Isometry3<f64>,
    /// Elementary motions from the parent outward: the frame of each is carried by the one before.
    pub motions: Vec<BodyMotion>,
}

/// One elementary motion of a joint.
#[derive(Clone, Debug)]
pub enum BodyMotion {
    /// Turns about `axis` (unit length, in the frame before it) by `drive`, rad.
    Hinge {
        /// Unit axis.
        axis: Vector3<f64>,
        /// What gives the angle.
        drive: Drive,
    },
    /// Slides along `axis` by `drive`, m.
    Slide {
        /// Unit axis.
        axis: Vector3<f64>,
        /// What gives the distance.
        drive: Drive,
    },
    /// Turns freely: four coordinates (unit quaternion w, x, y, z), the first one named by index, the others following it.
    Ball {
        /// Index of the quaternion's w in [`Body::coordinates`].
        first: usize,
    },
}

/// What gives the value of an elementary motion.
#[derive(Clone, Debug)]
pub enum Drive {
    /// The coordinate itself.
    Coordinate(usize),
    /// A function of one coordinate.
    Function(Function, usize),
    /// Always the same.
    Constant(f64),
}

/// A coordinate as the file has it.
#[derive(Clone, Debug)]
pub struct BodyCoordinate {
    /// Unique name.
    pub name: String,
    /// Whether it is an angle (rad), a distance (m) or a quaternion component.
    pub kind: BodyCoordinateKind,
    /// Range as the file has it, rad or m; infinite where the file gives none.
    pub range: (f64, f64),
    /// Default value.
    pub default: f64,
    /// The file locks it.
    pub locked: bool,
    /// The file says that its range is a hard limit.
    pub clamped: bool,
}

/// What a coordinate's number means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyCoordinateKind {
    /// Angle, rad.
    Rotation,
    /// Distance, m.
    Translation,
    /// Component of a unit quaternion.
    Quaternion,
}

/// `dependent = function(independent)`.
#[derive(Clone, Debug)]
pub struct Coupling {
    /// Index of the coordinate that follows.
    pub dependent: usize,
    /// Index of the coordinate that leads.
    pub independent: usize,
    /// How.
    pub function: Function,
}

/// A passive torque law on one coordinate.
#[derive(Clone, Debug)]
pub struct BodyPassive {
    /// Name in the file.
    pub name: String,
    /// Index of the coordinate.
    pub coordinate: usize,
    /// The law, in rad and N m (m and N for slides).
    pub law: PassiveLawText,
}

/// Passive laws of the formats.
#[derive(Clone, Debug)]
pub enum PassiveLawText {
    /// OpenSim CoordinateLimitForce: stiffnesses per rad, limits and transition in rad.
    CoordinateLimitForce(contrapposto::passive::CoordinateLimitForce),
    /// OpenSim ExponentialCoordinateLimitForce.
    DoubleExponential(contrapposto::passive::DoubleExponential),
    /// `torque = -stiffness (q - rest)` (SpringGeneralizedForce, MJCF stiffness and springref).
    Spring {
        /// N m/rad.
        stiffness: f64,
        /// rad.
        rest: f64,
    },
    /// `torque = -(k1 x + k2 x |x| + ...)`-like polynomial of the format; coefficients of x^1.. in the format's own form,
    /// `x = q - rest`.
    Polynomial {
        /// Coefficients from x^1 upward, applied as `torque = -sum k_i x^i`.
        coefficients: Vec<f64>,
        /// rad.
        rest: f64,
    },
    /// OpenSim ExpressionBasedCoordinateForce: torque as an expression of `q` (and `qdot`, zero at rest).
    Expression(crate::expression::Expression),
}
