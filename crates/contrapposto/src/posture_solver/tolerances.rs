//! Every tolerance and factor of the posture solver, with its unit.
//!
//! "Share" is a number without unit, of the quantity that the text names. A step is in rad or m; an error is in the
//! unit of its row (m, rad, or a share of strength).

// Ranges, and differences along a motion.

/// rad or m. A coordinate that is outside its range by less was carried there by rounding.
pub(super) const RANGE_ROUNDING: f64 = 1e-9;
/// rad or m. Length of the motion to either side in a difference of torques along it.
pub(super) const SLOPE_STEP: f64 = 1e-4;
/// Share of the asked motion; a joint that moves by less is fixed by the constraints.
pub(super) const FREE_MOTION: f64 = 0.999;

// Estimate of the multipliers.

/// Unit of the row. A bound or row with less room is active.
pub(super) const NO_ROOM: f64 = 1e-9;
/// Share of a row's square. A row of which less is left beside the rows before it depends on them.
pub(super) const DEPENDENT_ROW: f64 = 1e-10;

// Newton level. The largest diagonal entry is that of its matrix.

/// Share of the largest diagonal entry, for rows and bounds above that are active: so large that curvature along them
/// does not matter.
pub(super) const WEIGHT_OF_ACTIVE_ROWS: f64 = 1e2;
/// Share of the largest diagonal entry; a direction of less curvature is flat, and left to the levels below.
pub(super) const FLAT_CURVATURE: f64 = 1e-6;
/// Share of the largest diagonal entry; along a direction of less curvature a motion must gain [`LEAST_GAIN`].
pub(super) const WEAK_CURVATURE: f64 = 1e-3;
/// Share of the square of the level's error.
pub(super) const LEAST_GAIN: f64 = 1e-12;
/// As [`WEIGHT_OF_ACTIVE_ROWS`], for the effort level: curvature along equations above must not look negative.
pub(super) const WEIGHT_OF_EQUATIONS: f64 = 10.0;
/// Share of the largest diagonal entry, added to every diagonal entry of the effort level.
pub(super) const FLAT_EFFORT: f64 = 1e-9;
/// Share of the largest diagonal entry; no regularisation is larger.
pub(super) const LARGEST_NEWTON_REGULARISATION: f64 = 10.0;
/// Factor of the regularisation after a matrix that was not positive, or a rejected step.
pub(super) const REGULARISATION_GROWTH: f64 = 4.0;
/// Share of the largest diagonal entry; the first regularisation of a matrix that is not positive.
pub(super) const REGULARISATION_START: f64 = 1e-4;

// Rule of strict priorities.

/// Number of steps in a row that hardly lower the error of a level: the level is out of reach.
pub(super) const STALLED_STEPS: usize = 6;
/// Share of the error before the step; a level that keeps more of it has stalled.
pub(super) const STALLED_ERROR: f64 = 0.8;
/// Share of the error before the step; a level whose linearised rows leave more of it has stalled.
pub(super) const STALLED_RESIDUAL: f64 = 0.5;
/// Share of the step before; the last level has stalled when steps shrink by less.
pub(super) const STALLED_STEP: f64 = 0.5;
/// Unit of the level. A level stalls only while the levels above it are nearer than this, all together.
pub(super) const LEVELS_ABOVE_NEAR: f64 = 0.05;
/// Unit of the level. While the levels above are nearer than this, half as many stalled steps are enough for the last
/// level.
pub(super) const LEVELS_ABOVE_MET: f64 = 1e-3;
/// rad or m. A Newton level has settled when no step is longer; levels below wait for that.
pub(super) const SETTLED_STEP: f64 = 1e-4;
/// Factor of [`SETTLED_STEP`] beyond which a Newton level that has settled is under way again.
pub(super) const UNSETTLED: f64 = 100.0;
/// Damping of a level for an error of 1, in the unit of its rows.
pub(super) const DAMPING: f64 = 2.0;
/// Unit of the level. Damping grows with errors up to this one.
pub(super) const LARGEST_DAMPED_ERROR: f64 = 1.0;
/// Unit of the level. A merit that grows by less has not grown.
pub(super) const MERIT_ROUNDING: f64 = 1e-12;
/// rad or m. A shorter step is never rejected.
pub(super) const LEAST_REJECTED_STEP: f64 = 1e-7;
/// Unit of the level. Multipliers are divided by its error, or by this if that is larger.
pub(super) const LEAST_ERROR: f64 = 1e-6;
/// Share of the rejected step: the trust radius after it.
pub(super) const SHRINK_AFTER_REJECTION: f64 = 0.25;
/// Part of the largest number of steps, one fifth, after which the largest step shrinks.
pub(super) const STEPS_BEFORE_COOLING: usize = 5;
/// Part of the largest number of steps, one quarter, in which it shrinks.
pub(super) const STEPS_OF_COOLING: usize = 4;
/// Unit of the level. Another start is kept where the first level that differs by more is nearer.
pub(super) const NEARER: f64 = 1e-5;
/// rad or m. A coordinate with a wider range, such as a free root, keeps its place in other starts.
pub(super) const WIDEST_RANGE: f64 = std::f64::consts::TAU;
/// By start: place of a joint, as a share of the way from the middle of its range to where the first start ended.
pub(super) const OTHER_STARTS: [f64; 2] = [0.0, -0.5];
/// Share of the step tolerance, to which the largest step then has shrunk.
pub(super) const COOLED_STEP: f64 = 0.1;

// Rule of the merit function.

/// Length, in the units of a level's rows, that one step takes on: on the way to a far target the body stays where
/// effort is little, and so comes to lower minima.
pub(super) const FEASIBILITY_STEP: f64 = 0.15;
/// Share of the merit; a merit that grows by less has not grown.
pub(super) const MERIT_SHARE_ROUNDING: f64 = 1e-12;
/// rad or m. A shorter step is never rejected.
pub(super) const LEAST_REJECTED_EFFORT_STEP: f64 = 1e-10;
/// Share of the step that raised the merit: the trust radius after it.
pub(super) const SHRINK_AFTER_RISE: f64 = 0.3;
/// Factor of the trust radius after a step that lowered the merit; of either rule.
pub(super) const TRUST_GROWTH: f64 = 2.0;
/// Shares of strength squared, by rad squared. Regularisation after a step that raised the merit, at least.
pub(super) const REGULARISATION_AFTER_RISE: f64 = 1e-3;
/// Factor of the regularisation after a step that lowered the merit.
pub(super) const REGULARISATION_DECAY: f64 = 0.25;
/// Shares of strength squared, by rad squared. Less regularisation counts as none.
pub(super) const LEAST_REGULARISATION: f64 = 1e-6;
/// Factor of the penalty from step to step, while no multiplier asks for more.
pub(super) const MERIT_PENALTY_DECAY: f64 = 0.7;
/// Factor of the largest multiplier: the penalty, at least.
pub(super) const MERIT_PENALTY_MARGIN: f64 = 1.5;
/// Number of steps in a row with little change of the merit that end a solve.
pub(super) const IDLE_STEPS: usize = 3;
/// Share of the trust radius; a longer step was cut short, and its little gain ends nothing.
pub(super) const CUT_SHORT: f64 = 0.9;
/// Steps of a body on supports from one attempt of a descent to the next, while it does not come to rest.
pub(super) const STEPS_BEFORE_DESCENT: usize = 50;
/// m or rad. Sum of the errors of the levels above effort from which on they may be out of reach: descents allow as much.
pub(super) const MISSED_LEVELS: f64 = 1e-3;
/// Steps in which a body on supports that can come nearer to levels above effort does so (assumed).
pub(super) const STEPS_OF_NEARING: usize = 5;
/// m or rad. Change of the sum of their errors in these steps up to which the levels count as out of reach (assumed).
pub(super) const LEAST_NEARING: f64 = 1e-5;
