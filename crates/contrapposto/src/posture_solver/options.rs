//! Settings of the posture solver, and the outcome of a step.

use hierarchical_least_squares::Status;

/// Limits of a step, and when steps end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest change of any joint angle or distance in one step, rad or m.
    pub max_step: f64,
    /// Largest number of steps of each start of a solve.
    pub max_steps: usize,
    /// Steps end when every change is at most this, rad or m.
    pub step_tolerance: f64,
    /// A level counts as reached when the length of its error is at most this, in the units of its rows.
    pub level_tolerance: f64,
    /// With effort: steps end when three in a row change the merit function by at most this share of it.
    pub merit_tolerance: f64,
    /// With effort: a step that raises the merit function is rejected. Without rejection every step counts, and only
    /// the next one is shorter: for a body in motion.
    pub reject_steps: bool,
    /// With effort: local minima that a solve compares before its steps; 1 for the nearest one, 0 for steps alone,
    /// which stay nearest to the start.
    pub local_minima: usize,
}

impl Options {
    /// For tasks without supports: long steps.
    pub const fn inverse_kinematics() -> Self {
        Self { max_step: 0.6, max_steps: 300, local_minima: 0, ..Self::least_effort() }
    }

    /// For postures of least effort: steps as short as a second derivative is good for.
    pub const fn least_effort() -> Self {
        Self {
            max_step: 0.3,
            max_steps: 200,
            step_tolerance: 1e-9,
            level_tolerance: 1e-6,
            merit_tolerance: 1e-9,
            reject_steps: true,
            local_minima: 12,
        }
    }
}

/// The outcome of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Largest change, rad or m.
    pub largest: f64,
    /// The step before this one was rejected: this one began where that one had begun.
    pub rejected_previous: bool,
    /// Status of the linearised problem.
    pub status: Status,
    /// Number of changes of its working set.
    pub changes: usize,
}

/// Changes of a working set that take as long as the rest of a step (fitted to five searches of whole bodies: 0.1 ms and 0.3 ms).
const CHANGES_OF_A_STEP: usize = 3;

/// Work of a step of a descent to a local minimum (fitted to `relax` of four scenarios: it takes 2.3 to 2.8 times as long as a unit of work of the
/// other steps).
pub(super) const WORK_OF_DESCENT_STEP: usize = 3;

impl Step {
    /// A measure of the time that the step took, which is the same on every machine: 1, and 1 for every three changes of the working set.
    pub fn work(&self) -> usize {
        1 + self.changes / CHANGES_OF_A_STEP
    }
}

/// The reason for which a solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Every level is reached.
    Reached,
    /// Steps have become as small as [`Options::step_tolerance`], or no longer lower the merit function; a level that
    /// is not reached is as near as the levels above it allow.
    Converged,
    /// The largest number of steps was made.
    StepLimit,
}
