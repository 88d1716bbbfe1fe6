//! Lists the tolerances of marker tracking, with meaning and unit.

/// First-order optimality from which on a frame is solved: the greatest cosine between the weighted residual and its change along a
/// coordinate.
pub(super) const OPTIMALITY: f64 = 1e-8;
/// Change of all markers along a coordinate, as a share of the greatest one, that is rounding: markers on the axis of a joint.
pub(super) const NO_CHANGE: f64 = 1e-10;
/// Decrease of the objective that the next step predicts, as a share of it, below which a frame is solved.
pub(super) const PREDICTED_DECREASE: f64 = 1e-10;
/// Weighted residual, m, below which residuals count as this one: positions have no more digits.
pub(super) const LEAST_RESIDUAL: f64 = 1e-5;
/// Longest step of an angle, rad: a longer one could end a turn away.
pub(super) const LONGEST_TURN: f64 = 0.5;
/// Most steps of a frame, refused ones counted.
pub(super) const MOST_STEPS_A_FRAME: usize = 200;
/// Damping that is always there, as a share of the diagonal: coordinates that no marker determines stay.
pub(super) const LEAST_DAMPING: f64 = 1e-10;
/// Damping after the first refused step, as a share of the diagonal.
pub(super) const FIRST_DAMPING: f64 = 1e-3;
/// Factor of the damping after a refused step; its inverse after a good one.
pub(super) const DAMPING_FACTOR: f64 = 10.0;
/// Greatest damping; a frame whose steps are refused up to it ends.
pub(super) const MOST_DAMPING: f64 = 1e12;
/// Share of the greatest diagonal entry that the damping of every coordinate has at least.
pub(super) const LEAST_DIAGONAL: f64 = 1e-3;
/// Actual decrease, as a share of the predicted one, from which on a step is taken.
pub(super) const ACCEPTED_DECREASE: f64 = 1e-4;
/// Actual decrease, as a share of the predicted one, from which on the damping falls.
pub(super) const GOOD_DECREASE: f64 = 0.5;
/// Change of the objective, as a share of it, that is rounding.
pub(super) const ROUNDED_CHANGE: f64 = 1e-13;
/// Multiplier of a limit, as a share of the greatest one, that has no sign.
pub(super) const NO_MULTIPLIER: f64 = 1e-13;
/// Root mean square of the marker errors of the first frame, m, from which on other directions of the body are tried. Assumed.
pub(super) const TURNED_STARTS_FROM: f64 = 0.03;
/// Share of the objective that a start with a turned body may leave to be taken. Assumed.
pub(super) const BETTER_START: f64 = 0.99;
/// Share of the objective that a start with other limbs may leave to be taken: less than that is the accuracy of a solution.
/// Assumed.
pub(super) const BETTER_LIMB: f64 = 0.999_999;
/// Angle between two turns of the body, rad, below which they are one.
pub(super) const SAME_TURN: f64 = 1e-6;
