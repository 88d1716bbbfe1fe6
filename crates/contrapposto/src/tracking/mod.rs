//! Finds the postures in which the markers of a body lie nearest to measured ones: inverse kinematics by weighted least squares.
//!
//! In every frame the free coordinates `q` minimise, within hard limits,
//!
//! ```text
//! f(q) = 1/2 ( sum_m w_m |x_m(q) - o_m|^2 / sum_m w_m  +  sum_c w_c (q_c - v_c)^2 )
//! ```
//!
//! with the markers `m` that the frame has at `o_m` (m, ground), coordinates `c` with wanted values `v_c` (rad, m), and their weights. It
//! is the objective of OpenSim's inverse kinematics, which divides the sum over markers by their weights (Simbody's `Markers::calcGoal`);
//! OpenSim's manual leaves the division out. Couplings hold exactly.
//!
//! The gradient is that of forces `w_m (x_m - o_m)` at the markers, and the second derivative of their positions is the gradient of the
//! torque of these forces (`statics`); so each step is a Newton step, or a Gauss-Newton step where Newton's matrix is not positive
//! definite (`objective.rs`), within the limits (`limited_step.rs`), damped as Levenberg and Marquardt do (`tracker.rs`).

mod goals;
mod limited_step;
mod motion;
mod objective;
mod starts;
mod tolerances;
mod tracker;

pub use goals::{CoordinateGoal, Goals, GoalsError, MarkerGoal};
pub use motion::{TrackedFrame, TrackingError, track};
pub use starts::first_posture;
pub use tracker::{Solved, Tracker};
