//! Solves for a posture that meets tasks in strict order of priority.
//!
//! An [`Engine`] makes a step, or a whole posture, from [`PriorityLevel`](crate::tasks::PriorityLevel)s. Ranges of motion and the
//! largest step always hold; then the levels follow in their order, and no level costs one above it anything (Baerlocher &
//! Boulic 2004, "An inverse kinematics architecture enforcing an arbitrary number of strict priority levels").

mod curvature;
mod engine;
pub(crate) mod hold;

pub use engine::Engine;
pub(crate) use engine::bound_rates;
