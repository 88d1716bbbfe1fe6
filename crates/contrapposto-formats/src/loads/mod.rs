//! Loads on a body from texts and measured tables: held weights, forces, and ground reactions.

mod external_loads;
mod force_doubts;
mod force_plates;
mod ground_reaction;
mod ground_reaction_error;
mod interpolation;
mod text;

pub use external_loads::{ExternalForce, ExternalLoads, ExternalLoadsError, external_loads};
pub use force_plates::{ForcePlateError, PlateOn};
pub use ground_reaction::GroundReaction;
pub use ground_reaction_error::GroundReactionError;
pub use text::{LoadTextError, force, no_segment, patch, weight};
