//! Solves for postures by steps of prioritised least squares: for tasks without supports (inverse kinematics), and for
//! bodies on supports, with contact forces and effort.
//!
//! [`Engine`] makes a step, or a whole posture, from [`PriorityLevel`](crate::tasks::PriorityLevel)s. Ranges of motion
//! and the largest step always hold; then the levels follow in their order. On supports, posture and contact forces are
//! found together: friction and equilibrium of the root come first, then supports stay where they are, then no support
//! carries more than its greatest share, then the priority levels follow, of which one may be effort. The contact
//! forces of every posture are solved anew ([`crate::contact`]), so that the reported posture is in equilibrium
//! exactly.
//!
//! | File | Holds |
//! |---|---|
//! | `settings` | the problem as it is given |
//! | `iterate` | the present posture and all that follows from it |
//! | `linearisation` | rows and bounds of one step |
//! | `newton_level`, `multiplier_estimate` | a level with its second derivative |
//! | `step_rule`, `priority_rule`, `merit_rule` | the two rules by which steps are completed and judged |
//! | `engine` | the loop |
//! | `halved_step` | half of a step, or less, where all of it would lead away from tasks or break a share |
//! | `local_minima` | descents to local minima of effort |
//! | `slope` | how a torque changes along the motion that supports and tasks allow |
//! | `tolerances` | every tolerance, with its unit |

mod engine;
mod error;
mod halved_step;
mod iterate;
mod linearisation;
mod local_minima;
mod merit_rule;
mod multiplier_estimate;
mod newton_level;
mod options;
mod priority_rule;
mod report;
mod settings;
mod slope;
mod step_rule;
mod tolerances;

pub use engine::Engine;
pub use error::EngineError;
pub use options::{Options, Reason, Step};
pub(crate) use report::first_difference;
pub use report::{LevelError, RowError, SolvedPosture};
