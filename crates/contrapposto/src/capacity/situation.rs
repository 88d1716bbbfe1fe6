//! Defines a body that exerts a force: its posture, loads and supports, and the point of the force.

use nalgebra::Vector3;

use crate::contact::{Support, SupportError};
use crate::joint_torques::{JointMuscles, JointTorquesError};
use crate::model::Model;
use crate::posture::Posture;
use crate::statics::Load;

/// A body in a posture, with its loads and supports. Without supports its root is held as if by hand.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// The body.
    pub model: &'a Model,
    /// Posture of the body.
    pub posture: &'a Posture,
    /// Loads of the body besides weight.
    pub loads: &'a [Load],
    /// Supports of the body.
    pub supports: &'a [Support],
    /// Muscles that share the torques of the joints whose strength they give; `None`: every group alone has its strength.
    pub muscles: Option<&'a JointMuscles>,
}

/// A fixed point of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// Index of the segment.
    pub segment: usize,
    /// The point, segment frame, m.
    pub point: Vector3<f64>,
}

/// The reason for which a capacity was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CapacityError {
    /// Posture or loads do not fit the model.
    #[error(transparent)]
    Torques(#[from] JointTorquesError),
    /// A support does not fit the model.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// There is no such segment.
    #[error("a force at segment number {segment}; the model has {count} segments")]
    Segment {
        /// The index given.
        segment: usize,
        /// Number of segments.
        count: usize,
    },
    /// The point is no point.
    #[error("a force at {value} m in the segment's frame; every number must be finite and at most 1e9 in size")]
    Point {
        /// The number.
        value: f64,
    },
    /// No muscle group of the body has a known strength.
    #[error("no strength of `{model}` is known, so that nothing limits a force; lay strengths over it with an overlay")]
    NoStrength {
        /// The model.
        model: String,
    },
}
