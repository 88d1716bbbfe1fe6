//! Lists every tolerance and limit of the crate, with its unit and the quantity that it is compared with.

/// Difference of two values of the row that rounding explains. Unit: share of `max(|limit|) + |a| |x|` of a row.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Distance of a residual from its predicted value after a full step. Unit: share of that rounding.
pub(crate) const REACHED: f64 = 0.1;

/// Residual below which a row beside much larger rows has no multiplier. Unit: that rounding.
pub(crate) const LIGHT_ROW: f64 = 10.0;

/// Residuals of a damped level, which are small everywhere. Unit: share of that rounding.
pub(crate) const LAST_DIGITS: f64 = 1e-3;

/// Part of the row outside the span of the rows before it. Unit: share of the norm of a row.
pub(crate) const INDEPENDENT: f64 = 1e-10;

/// Multiplier times norm of its row. Unit: share of `sum |r_i| |a_i|` of the level.
pub(crate) const MULTIPLIER: f64 = 1e-11;

/// Change of an unknown or of a row of unit norm. Unit: share of the norm of the step.
pub(crate) const NO_MOTION: f64 = 1e-14;

/// Difference of the ways to two limits below which a step meets both at once. Unit: share of the way.
pub(crate) const TIE: f64 = 1e-13;

/// Share of the way to a limit that is taken for certainly free: far below 1 beside the rounding of sums of ways.
pub(crate) const NEARLY_ALL: f64 = 1.0 - 1e-9;

/// Norm of a row. Unit: that of the coefficients.
pub(crate) const ZERO_ROW: f64 = 1e-60;

/// Coefficient, finite limit, damping: their squares and products stay finite. Unit: that of the coefficients.
pub(crate) const LARGEST_NUMBER: f64 = 1e60;

/// Pivot of the Gram matrix of a level of single unknowns. Unit: none (eigenvalues lie in 0..1).
pub(crate) const SINGULAR: f64 = 1e-6;

/// Diagonal entry of a triangular level, from which on down it is left to the general solver. Unit: share of the largest one.
pub(crate) const ILL_CONDITIONED: f64 = 1e-8;

/// Updated squared norm below which it is computed anew. Unit: share of a squared norm.
pub(crate) const NORM_UPDATE: f64 = 1e-3;

/// Remainder of a column in a least-squares problem. Unit: share of the first pivot.
pub(crate) const DEPENDENT_COLUMN: f64 = 1e-14;

/// Off-diagonal entry of a matrix whose eigenvalues are sought. Unit: share of the largest entry.
pub(crate) const OFF_DIAGONAL: f64 = 1e-17;

/// Steps to one minimum, with the residual computed anew each time. Unit: steps.
pub(crate) const REFINEMENTS: usize = 3;

/// Five or six are enough in practice. Unit: sweeps of Jacobi's method.
pub(crate) const SWEEPS: usize = 30;

/// Changes after which the solver stops: the first plus the second per row and unknown. Unit: changes of the working
/// set.
pub(crate) const CHANGES: usize = 100;

/// Changes after which the solver stops: the first plus the second per row and unknown. Unit: changes of the working
/// set.
pub(crate) const CHANGES_PER_ROW: usize = 10;

/// Changes after which light rows are judged by the level's scale, not by their own. Unit: divides that limit.
pub(crate) const CYCLING: usize = 4;

/// Times that a constraint comes back at once after it was dropped, from which on a level drops it no more. Unit: times.
pub(crate) const RETURNS: usize = 10;

/// Constraints that a level remembers to have dropped without moving, and that have come back. Unit: constraints.
pub(crate) const REMEMBERED: usize = 64;

/// Size from which the unknowns of the first level come first. Unit: unknowns.
pub(crate) const MANY_UNKNOWNS: usize = 32;

/// Rotations that a factor gathers before it is computed anew. Unit: rotations per column.
pub(crate) const ROTATIONS_PER_COLUMN: usize = 4;
