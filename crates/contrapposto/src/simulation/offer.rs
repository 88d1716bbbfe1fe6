//! Names a change of what carries the body, which a relief may try.

use super::sample::StepKind;

/// A change of a support that may be tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Offer {
    /// Number of the support in the scenario.
    pub(super) number: usize,
    pub(super) kind: StepKind,
    /// A hand is taken off that keeps the body from a task: on the way the tasks are left, and no group needs more than where the way begins.
    pub(super) for_a_task: bool,
}
