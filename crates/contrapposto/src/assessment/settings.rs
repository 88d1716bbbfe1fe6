//! Holds the settings of an assessment.

use crate::contact::Support;
use crate::dynamics::Rates;
use crate::fatigue::Repetition;
use crate::joint_torques::JointMuscles;

/// Error of recorded joint angles, rad: 5 deg. Inter-session errors of marker-based gait analysis are mostly below it (McGinley, Baker, Wolfe &
/// Morris 2009, Gait & Posture 29:360-369, abstract, recalled); of elbow extension by goniometer it is the smallest detectable difference
/// to a degree (4.2 deg, Cleffken et al. 2007, J. Shoulder Elbow Surg., abstract), and half the greatest error against radiographs (10.3 deg,
/// Chapleau et al. 2011, Clin. Orthop. Relat. Res. 469:3134-3140, abstract).
pub const ANGLE_ERROR: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// Fatigue at which a muscle group asks for relief. Chosen, as the default of scenarios: the paper gives no number.
pub const CRITICAL_LEVEL: f64 = 0.6;

/// Supports, ranges of passive torque, the error of the angles, and the settings of the proposals.
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
    /// Error of the joint angles, rad; 0 for exact ones, [`ANGLE_ERROR`] for measured ones. A group that works against the passive torque of
    /// its own joint, where that outweighs the external torque, is judged by the passive torque within this error of the angle at which it asks
    /// least of the group.
    pub angle_error: f64,
    /// The motion is one cycle of a job that repeats it.
    pub repetition: Option<Repetition>,
    /// Fatigue at which a group of a repeated job asks for relief, 0..=1.
    pub critical_level: f64,
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
            angle_error: 0.0,
            repetition: None,
            critical_level: CRITICAL_LEVEL,
            minimum_decrease_ratio: 0.9,
            torque_tolerance: 0.05,
        }
    }
}
