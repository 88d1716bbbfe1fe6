//! Computes the accelerations of a moving body, and the torques that its inertia gives at every joint.
//!
//! By d'Alembert's principle the inertia of a segment of mass `m`, centre `c` and inertia `I` about it, which turns with `omega`, is a
//! force and a couple that act on the segment like any other load (ground axes, N and N m):
//!
//! ```text
//! f = -m a_c                     a_c acceleration of the centre, m/s^2
//! n = -(I alpha + omega x I omega)
//! ```
//!
//! So inertia is a part of the external torque of Eq. 1, and the equation stays as it is. Accelerations are carried from the root to
//! the ends and forces from the ends to the root: together the recursive Newton-Euler algorithm (Luh, Walker & Paul 1980, in the form
//! of Featherstone 2008, "Rigid Body Dynamics Algorithms", section 5.3). `docs/dynamics.md` derives all of it.

mod acceleration;
mod backward;
mod error;
mod inertia;
mod motion;
mod residual_analysis;
mod sampling;

pub use acceleration::{Acceleration, SpeedError};
pub use error::MotionError;
pub use inertia::{Inertia, InertiaError};
pub use motion::{Moving, Rates, differentiate};
pub use residual_analysis::suggested_cutoff;
pub use sampling::{PUBLISHED_CUTOFF, Smoothing};
