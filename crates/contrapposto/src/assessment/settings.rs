//! Holds the settings of an assessment.

use crate::contact::Support;
use crate::dynamics::Rates;
use crate::joint_torques::JointMuscles;

/// Supports, ranges of passive torque, and the settings of the proposals.
#[derive(Clone, Debug)]
pub struct AssessSettings {
    /// The supports at every instant. Without supports the root is held as if by hand.
    pub supports: Vec<Support>,
    /// Speeds and accelerations of every instant, whose inertia counts; empty for postures at rest.
    pub rates: Vec<Rates>,
    /// Without supports: the root is held on purpose, and not said to be carried by nothing.
    pub root_held: bool,
    /// By coordinate: the range (rad) outside of which its passive torque stays what it is at the nearer end; empty for none.
    pub passive_ranges: Vec<Option<(f64, f64)>>,
    /// Muscles that give joints passive torque and strength in every posture, beside the laws of the model.
    pub muscles: Option<JointMuscles>,
    /// `R_min` of the proposals, 0..=1.
    pub minimum_decrease_ratio: f64,
    /// `eps` of the proposals, N m.
    pub torque_tolerance: f64,
}

impl Default for AssessSettings {
    fn default() -> Self {
        Self {
            supports: vec![],
            rates: vec![],
            root_held: false,
            passive_ranges: vec![],
            muscles: None,
            minimum_decrease_ratio: 0.9,
            torque_tolerance: 0.05,
        }
    }
}
