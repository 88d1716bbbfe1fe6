//! Computes the torques that weight, other loads and passive tissue give at every joint of a body at rest.
//!
//! `active + passive + external = 0` (Rodriguez & Boulic 2007, Eq. 1). Torques act in the direction of the coordinate;
//! robotics' generalised gravity has the opposite sign of our external torque.

mod external;
mod fold;
mod load;
mod passive_arc;
mod passive_gradient;
mod passive_torque;
mod path_curvature;
mod path_tension;

pub use external::ExternalTorque;
pub use fold::Gradient;
pub use load::{FixedIn, Load, LoadError, LoadKind, LoadQuantity};
pub use passive_torque::{PassiveTorque, PassiveTorqueError};
pub use path_tension::{PathTension, PathTensionError};
