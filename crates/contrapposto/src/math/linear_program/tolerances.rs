//! Lists the constants of linear programs, with meaning and unit.

/// Reduced cost, as a share of the largest cost, below which no unknown can raise the value.
pub(super) const REDUCED_COST: f64 = 1e-11;
/// Smallest entry of the tableau that counts.
pub(super) const LEAST_PIVOT: f64 = 1e-9;
/// Steps of one phase after which the first unknown that raises the value is taken, not the best.
pub(super) const STEPS_TO_BLAND: usize = 2000;
/// Most steps of one phase.
pub(super) const SIMPLEX_STEPS: usize = 20_000;
/// Relative size of a value below which it counts as inside its bounds in steps of the dual simplex method.
pub(super) const INSIDE: f64 = 1e-11;
/// Most steps of the dual simplex method from one column to the next.
pub(super) const DUAL_STEPS: usize = 300;
