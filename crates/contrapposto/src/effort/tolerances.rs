//! Lists the constants of the descent, its quadratic programs and basin hopping, with meaning and unit.
//!
//! Regularisation is counted in units of the largest diagonal entry of the Gauss-Newton matrix among the rates; constraint
//! violations have the units of their rows (m, rad, shares of body weight).

// Derivatives by differences (`hessian.rs`).

/// Largest change of a rate in the difference of gradients, rad or m.
pub(super) const DIFFERENCE_STEP: f64 = 1e-5;
/// Change of an angle in the difference of passive slopes, rad or m.
pub(super) const PASSIVE_DIFFERENCE_STEP: f64 = 1e-4;
/// A support's row with less left of it than this share, after projection, depends on the rows before it.
pub(super) const INDEPENDENT_ROW: f64 = 1e-6;

// Quadratic program (`qp.rs`).

/// Weight of the squares of working-set rows in `M`, against the largest diagonal entry.
pub(super) const WORKING_SET_WEIGHT: f64 = 10.0;
/// Share of the largest diagonal entry of each kind (rates, forces) that is always added to the diagonal.
pub(super) const DIAGONAL_SHARE: f64 = 1e-10;
/// Share of the largest diagonal entry among the forces that a unit of regularisation adds to the diagonal of each force. Forces that cancel each
/// other within a support have no curvature of their own: without this a mixed part of a thousandth of the matrix needs a regularisation of thousands.
pub(super) const FORCES_SHARE: f64 = 1e-3;
/// Changes of the working set, of many constraints at once, after which the dual method finds it. Also the number of its attempts with the
/// squares of bounds and limits.
pub(super) const WORKING_SET_CHANGES: usize = 3;
/// Violation of a row or bound from which it joins the working set of the dual method, beside the length of the row.
pub(super) const QP_VIOLATION: f64 = 1e-10;
/// Part of a constraint outside the span of the working set below which it depends on that; share of its length. Also the slope of a multiplier, as
/// a share of the largest, from which it falls.
pub(super) const DEPENDENT_CONSTRAINT: f64 = 1e-10;
/// Violation, beside its length, of a row or bound that the others exclude, above which the program is contradictory. Assumed: rounding leaves less.
pub(super) const CONTRADICTION: f64 = 1e-6;
/// Most changes of the dual method for each row and unknown.
pub(super) const DUAL_CHANGES: usize = 2;
/// Work of a program with its derivatives and the step that it gives, and changes of the dual method that are a unit of work: fitted to `relax` of
/// fifteen scenarios, 0.23 ms and 0.024 ms where a unit of the engine's steps takes 0.12 ms.
pub(super) const WORK_OF_PROGRAM: usize = 2;
/// See [`WORK_OF_PROGRAM`].
pub(super) const DUAL_CHANGES_OF_A_UNIT: usize = 5;
/// Bounds violated by at least this share of the worst violation join the working set together.
pub(super) const JOINING_SHARE: f64 = 0.3;
/// Relative size below which a violation, multiplier or change is zero.
pub(super) const QP_ZERO: f64 = 1e-12;
/// A bound whose multiplier has the wrong sign leaves when its size is above this share of the gradient's entry.
pub(super) const LEAVING_MULTIPLIER: f64 = 1e3 * QP_ZERO;
/// Square of the length below which a row is zero.
pub(super) const ZERO_ROW: f64 = 1e-12;
/// Least regularisation other than none: the first that is tried, and that after a rejected step.
pub(super) const FIRST_REGULARISATION: f64 = 1e-4;
/// Factor from one regularisation to the next while the matrix is not positive definite.
pub(super) const REGULARISATION_FACTOR: f64 = 3.0;
/// Regularisation above which the program counts as unsolvable.
pub(super) const LARGEST_REGULARISATION: f64 = 1e6;

// Descent (`sqp.rs`).

/// Decrease of the merit, as a share of the predicted one, from which a step is accepted.
pub(super) const ACCEPTED_SHARE: f64 = 1e-4;
/// Share of the predicted decrease below which a second-order correction is tried, and above which steps may lengthen.
pub(super) const GOOD_AGREEMENT: f64 = 0.7;
/// Violation beyond the predicted one, times the penalty, as a share of the predicted decrease, from which it is corrected.
pub(super) const WORTH_CORRECTING: f64 = 0.2;
/// Changes of the merit below this share of it are rounding errors.
pub(super) const ROUNDING_SHARE: f64 = 1e-11;
/// A step that predicts less than this share of the merit is the last one.
pub(super) const PREDICTED_ROUNDING: f64 = 1e-13;
/// Largest change of a rate in one step below which the descent has converged, rad or m.
pub(super) const LEAST_STEP: f64 = 1e-10;
/// Factor by which the penalty falls from step to step, down to its least size.
pub(super) const PENALTY_DECAY: f64 = 0.7;
/// Least size of the penalty, as a multiple of the largest multiplier.
pub(super) const PENALTY_MARGIN: f64 = 1.5;
/// Contradictory programs in a row after which a descent ends that violates constraints by more than [`SEARCH_VIOLATION`]: it does not come nearer to
/// them. Assumed.
pub(super) const CONTRADICTIONS: usize = 10;
/// Least regularisation after an accepted step that agreed badly.
pub(super) const RAISED_REGULARISATION: f64 = 1e-5;
/// Regularisation below which it is set to none.
pub(super) const NO_REGULARISATION: f64 = 1e-7;

// Basin hopping (`basin_hopping.rs`).

/// Largest perturbation of a coordinate, as a share of its range.
pub(super) const PERTURBED_SHARE: f64 = 0.7;
/// Share of the coordinates that are perturbed, neighbours in the model's order.
pub(super) const PERTURBED_COORDINATES: f64 = 0.7;
/// Largest range that counts in a perturbation, rad or m.
pub(super) const LARGEST_RANGE: f64 = 2.0;
/// Share by which a local minimum must be lower to replace the lowest one.
pub(super) const LEAST_IMPROVEMENT: f64 = 1e-3;
/// Sum of constraint violations that is allowed during the search.
pub(super) const SEARCH_VIOLATION: f64 = 1e-3;
/// Sum of constraint violations that is allowed in the answer.
pub(super) const FINAL_VIOLATION: f64 = 1e-9;
