//! Describes a segment and its joint, as given to the builder.

use nalgebra::{Matrix3, Vector3};

use super::Placement;
use super::coordinate::CoordinateSpec;
use super::joint::JointKind;

/// A segment and its joint as given to the builder.
#[derive(Clone, Debug)]
pub struct SegmentSpec {
    /// Unique name.
    pub name: String,
    /// Name of the parent segment; `None` joins it to ground.
    pub parent: Option<String>,
    /// Mass, kg, not negative.
    pub mass: f64,
    /// Centre of mass in the segment's frame, m.
    pub center_of_mass: Vector3<f64>,
    /// Inertia about the centre of mass, kg m^2.
    pub inertia: Matrix3<f64>,
    /// Name of the joint.
    pub joint: String,
    /// Kind of the joint.
    pub kind: JointKind,
    /// The joint's resting frame in the parent's frame.
    pub in_parent: Placement,
    /// The joint's moved frame in this segment's frame.
    pub in_segment: Placement,
    /// One spec for every hinge and slide of the joint, in the order of its motions. A ball takes none, or four whose
    /// defaults count: its components are named `{joint}_qw` and so on, so a joint has one ball at most.
    pub coordinates: Vec<CoordinateSpec>,
}
