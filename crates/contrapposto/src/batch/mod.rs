//! Computes many postures of one model at once: statics in blocks of eight, and solvers for many targets, in as many threads as the
//! caller gives.
//!
//! Statics need about a tenth of the time of one posture after another ([`Statics`]), because one instruction computes a number of up to
//! eight postures. A result is the same to the bit whatever stands beside it: for any number of postures, any place among them, any
//! number of threads, and any width of the processor's registers. The results agree with [`crate::kinematics::Kinematics`],
//! [`crate::statics::ExternalTorque`] and [`crate::joint_torques::JointTorques`] to rounding, `1e-12` of the largest of their kind,
//! because sine and cosine are computed in another way.
//!
//! Contact forces are none of the statics of a batch: a body on supports is computed posture by posture through [`over`].
//!
//! ```
//! use contrapposto::batch::{Statics, Table, Wanted};
//! use contrapposto::model::{Adult, adult};
//!
//! // The elbow of an arm that lifts from hanging to level.
//! let model = adult(&Adult::right_arm())?;
//! let elbow = model.coordinate("elbow_flex_r").unwrap();
//! let mut postures = Table::of_postures(&model, 91);
//! for degrees in 0..91 {
//!     postures.set(elbow, degrees, (degrees as f64).to_radians());
//! }
//! let mut statics = Statics::new(&model, Wanted::default())?;
//! statics.update(&model, &postures, &[], 2)?;
//! let torques: Vec<f64> = statics.external_torque(elbow).collect();
//! assert!((torques[90] + 2.90).abs() < 0.01); // N m, extending
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod coordinates;
mod error;
mod gradient;
mod kernel;
mod lanes;
mod loads;
mod plan;
mod rows;
mod sin_cos;
mod statics;
mod table;
mod targets;
mod worker;

pub use error::BatchError;
pub use statics::{Statics, Wanted};
pub use table::Table;
pub use targets::over;
