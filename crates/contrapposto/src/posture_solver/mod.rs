//! Solves for postures by steps of strict priorities: without supports ([`inverse_kinematics`]), and with supports, contact forces
//! and effort ([`Engine`]).
//!
//! With supports, posture and contact forces are found together. Each step of the [`Engine`] is one lexicographic problem in the
//! changes of both: friction and equilibrium of the root first, then supports stay where they are, then no support carries more
//! than its greatest share, then the priority levels in their order, of which one may be effort. After every step the contact
//! forces are found anew for the posture reached ([`crate::contact`]), so that the reported posture is in equilibrium exactly.

mod engine;
mod error;
pub mod inverse_kinematics;
mod options;
mod probe;
mod report;

pub use engine::Engine;
pub use error::EngineError;
pub use options::{Options, Reason, Step};
pub use report::{LevelError, RowError, SolvedPosture};
