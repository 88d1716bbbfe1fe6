//! Ready and relaxed human postures.
pub mod constraint;
pub mod fatigue;
pub mod hybrid;
pub mod kinematics;
pub mod math;
pub mod model;
pub mod passive;
pub mod posture;
pub mod statics;
pub mod strength;
