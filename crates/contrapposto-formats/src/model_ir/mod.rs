//! Holds the intermediate representation of a model: the common result of the OpenSim, URDF and MJCF readers, free of their syntax.
//!
//! Units rad, m, kg, N, N m. Defaults, classes, includes, degrees and Euler sequences have ended at the reader.

mod build;
mod ignored;
mod model;
mod muscles;
mod root;
mod sole;

pub use contrapposto::math::{Function, Spline, SplineError};
pub use contrapposto::model::{CoordinateKind, Coupling, Drive};
pub use model::{Imported, ModelIrError};
pub use muscles::{KindTally, MuscleTally, MusclesIr};
pub(crate) use root::FREE_ENDINGS;
pub use root::RootAttachment;

pub(crate) use build::{compose_couplings, first_too_large, near, polynomial, turned, unique_coordinates, unit};
pub(crate) use ignored::Ignored;

use nalgebra::{Isometry3, Matrix3, Vector3};

/// Greatest torque of a motor that a file can mean, N m; as of a muscle group in an overlay.
pub(crate) const MOST_STRENGTH: f64 = 1e6;

/// A model as its file describes it, resolved.
#[derive(Clone, Debug, Default)]
pub struct ModelIr {
    /// Name in the file.
    pub name: String,
    /// Gravity in the file's own ground axes, m/s^2.
    pub gravity: Vector3<f64>,
    /// The words of an OpenSim file about its origin.
    pub credits: Option<String>,
    /// Segments, parents before children.
    pub segments: Vec<SegmentIr>,
    /// All coordinates, in the file's order.
    pub coordinates: Vec<CoordinateIr>,
    /// Dependent coordinates.
    pub couplings: Vec<Coupling>,
    /// Passive torques on coordinates; several on one coordinate add up.
    pub passive: Vec<PassiveIr>,
    /// Greatest torques of coordinates, where the file limits its motors.
    pub strength: Vec<StrengthIr>,
    /// Shapes for contact.
    pub solids: Vec<SolidIr>,
    /// Named points (markers, sites): name, segment index, position in the segment's frame.
    pub stations: Vec<(String, usize, Vector3<f64>)>,
    /// Muscles.
    pub muscles: MusclesIr,
    /// Ignored elements, which do not matter to quasi-static torque: kind and count, sorted by kind.
    pub ignored: Vec<(String, usize)>,
}

/// A rigid part and its joint.
#[derive(Clone, Debug)]
pub struct SegmentIr {
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
    pub motions: Vec<MotionIr>,
}

/// One elementary motion of a joint.
#[derive(Clone, Debug)]
pub enum MotionIr {
    /// Turns about `axis` (unit length, in the frame before it) by `drive`, rad.
    Hinge {
        /// Unit axis.
        axis: Vector3<f64>,
        /// The source of the angle.
        drive: Drive,
    },
    /// Slides along `axis` by `drive`, m.
    Slide {
        /// Unit axis.
        axis: Vector3<f64>,
        /// The source of the distance.
        drive: Drive,
    },
    /// Turns freely: four coordinates (unit quaternion w, x, y, z), the first one named by index, the others following it.
    Ball {
        /// Index of the quaternion's w in [`ModelIr::coordinates`].
        first: usize,
    },
}

/// A coordinate as the file has it.
#[derive(Clone, Debug)]
pub struct CoordinateIr {
    /// Unique name.
    pub name: String,
    /// Whether it is an angle (rad), a distance (m) or a quaternion component.
    pub kind: CoordinateKind,
    /// Range as the file has it, rad or m; infinite where the file gives none.
    pub range: (f64, f64),
    /// Default value.
    pub default: f64,
    /// The file locks it.
    pub locked: bool,
    /// The file says that its range is a hard limit.
    pub clamped: bool,
}

/// A solid with which a segment touches other things.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidIr {
    /// Index of the segment.
    pub segment: usize,
    /// Middle and axes in the segment's frame.
    pub pose: Isometry3<f64>,
    /// Shape about the middle.
    pub shape: SolidShape,
}

/// Shapes of solids, m. A mesh is none: files of meshes are not read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolidShape {
    /// Half the lengths of a box.
    Box([f64; 3]),
    /// Semi-axes; three equal ones are a ball.
    Ellipsoid([f64; 3]),
    /// A cylinder along z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Half its length.
        half: f64,
    },
    /// A cylinder along z between two half balls.
    Capsule {
        /// The radius of all three.
        radius: f64,
        /// Half the length of the cylinder.
        half: f64,
    },
}

/// The greatest torque of the motor of one coordinate, the same at every angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrengthIr {
    /// Index of the coordinate, an angle.
    pub coordinate: usize,
    /// Greatest torque in the coordinate's positive and in its negative sense, N m, both positive.
    pub torque: [f64; 2],
}

/// A passive torque law on one coordinate.
#[derive(Clone, Debug)]
pub struct PassiveIr {
    /// Name in the file.
    pub name: String,
    /// Index of the coordinate.
    pub coordinate: usize,
    /// The law, in rad and N m (m and N for slides).
    pub law: PassiveLawIr,
}

/// Passive laws of the formats.
#[derive(Clone, Debug)]
pub enum PassiveLawIr {
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
    Expression(contrapposto::math::expression::Expression),
}
