//! Writes forces and moments that joints transmit, for JSON files.

use contrapposto::joint_torques::JointReaction;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use serde::Serialize;

/// Force and moment that a joint transmits to the segment beyond it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReactionText {
    /// Force on the segment beyond the joint, N.
    pub force_n: [f64; 3],
    /// Moment on it about the joint's centre, N m.
    pub moment_nm: [f64; 3],
    /// The segment beyond the joint: both are in its axes.
    pub frame: String,
    /// Part of the force along a bone, positive where the joint is pressed together, N; `null` between bones without a length.
    pub compression_n: Option<f64>,
    /// The segment that is this bone.
    pub along: Option<String>,
    /// Compression over the weight of the body.
    pub body_weights: Option<f64>,
}

impl ReactionText {
    /// The reaction of the joint before `segment`, in the posture of `kinematics`.
    pub fn new(model: &Model, kinematics: &Kinematics, segment: usize, reaction: &JointReaction) -> Self {
        let to_segment = kinematics.placement(model, segment).rotation.inverse();
        let weight = model.mass() * model.gravity().norm();
        let name = |segment: usize| model.segments()[segment].name.clone();
        let compression_n = reaction.compression.map(|compression| compression.force);
        Self {
            force_n: (to_segment * reaction.force).into(),
            moment_nm: (to_segment * reaction.moment).into(),
            frame: name(segment),
            compression_n,
            along: reaction.compression.map(|compression| name(compression.along)),
            body_weights: compression_n.filter(|_| weight > 0.0).map(|force| force / weight),
        }
    }
}
