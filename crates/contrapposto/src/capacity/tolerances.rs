//! Lists the limits of the search for the greatest force, with meaning and unit.

/// Residual of the equations without a force up to which the posture is held: a share of the strength of a joint, or of the weight.
pub(super) const HELD_WITHOUT_FORCE: f64 = 1e-9;
/// A force from here on has no limit, N.
pub(super) const NO_LIMIT: f64 = 1e6;
/// Gap between primal and dual program above which a direction is computed anew from rest, as a share of the force.
pub(super) const WIDEST_GAP: f64 = 1e-10;
/// Share of a limit that is left out as nothing.
pub(super) const LEAST_SHARE: f64 = 1e-6;
/// Greatest force of an edge of a pyramid, and of friction without a limit, body weights.
pub(super) const GREATEST_EDGE_FORCE: f64 = 2.0;
/// Rounds of the search for the weakest direction, each along the normal of the nearest plane.
pub(super) const WEAKEST_ROUNDS: usize = 20;
/// Decrease of the force in one of them, as a share, below which it ends.
pub(super) const WEAKER: f64 = 1e-9;
/// First and last step of the search around the strongest direction, rad.
pub(super) const STRONGEST_STEPS: (f64, f64) = (0.07, 1e-4);
