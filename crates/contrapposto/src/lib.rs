//! Ready and relaxed human postures: active, passive and external joint torque, fatigue, and the hybrid minimisation of
//! Rodriguez & Boulic 2007 ("Simulating reactive/passive postures by means of a human active torque hybrid minimization").
//!
//! At rest, `active + passive + external = 0` at every joint (Eq. 1). A tired muscle group is relieved either where
//! muscles work well (the active strategy: ready postures) or where ligaments carry the load (the passive strategy:
//! relaxed ones). [`hybrid::minimise`] decides for one joint, [`simulation::run`] for a body over time.
//!
//! Pure functions on plain values: this crate reads no files and prints nothing; only [`batch`] starts threads, as many as it is asked to. Units are rad, m, kg,
//! N, N m and s; torques act in the direction of their coordinate.
//!
//! ```
//! use contrapposto::model::{Adult, adult};
//! use contrapposto::{kinematics::Kinematics, statics::ExternalTorque};
//!
//! // How heavy is a forearm, held level with the upper arm hanging?
//! let model = adult(&Adult::right_arm())?;
//! let elbow = model.coordinate("elbow_flex_r").unwrap();
//! let mut posture = model.default_posture();
//! posture.values_mut()[elbow] = 90f64.to_radians();
//! let mut kinematics = Kinematics::new(&model);
//! kinematics.update(&model, &posture)?;
//! let mut external = ExternalTorque::new(&model);
//! external.update(&model, &kinematics, &[])?;
//! assert!((external.torques()[elbow] + 2.90).abs() < 0.01); // N m, extending
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Inertia comes from given speeds and accelerations ([`dynamics`]); nothing is integrated in time, and there is no skin. [`muscle`] computes muscles with paths at rest. [`posture_solver`] finds postures
//! from tasks in strict priority, [`equilibria`] those of least effort on their supports, [`simulation`] moves a body that tires.

// Unit tests share bodies with the tests outside, which know this crate by its name.
#[cfg(test)]
extern crate self as contrapposto;

pub mod assessment;
pub mod batch;
pub mod capacity;
pub mod constraint;
pub mod contact;
pub mod dynamics;
mod effort;
pub mod equilibria;
pub mod fatigue;
pub mod hybrid;
pub mod joint_torques;
pub mod kinematics;
pub mod math;
pub mod model;
pub mod muscle;
pub mod passive;
pub mod posture;
pub mod posture_solver;
pub mod simulation;
pub mod statics;
pub mod strength;
pub mod suggestions;
pub mod tasks;
pub mod toml_value;
pub mod tracking;
pub mod verdict;
