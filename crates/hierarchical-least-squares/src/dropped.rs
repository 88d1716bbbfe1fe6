//! Remembers which constraints a level has dropped, and which of them it drops no more.
//!
//! Where more constraints meet than are independent, multipliers are not unique, and one may have the wrong sign in an optimal iterate. The constraint
//! is dropped, a step of rounding meets it again, and the same changes would follow each other without end (Nocedal & Wright 2006, "Numerical
//! Optimization", section 16.5: cycling). A constraint that has come back so [`RETURNS`] times stays until the level is solved.

use crate::tolerances::{REMEMBERED, RETURNS};
use crate::working_set::{Blocking, Constraint, Side};

/// The constraints that a level has dropped, as far as they are remembered.
#[derive(Clone, Debug, Default)]
pub(crate) struct Dropped {
    /// Constraints dropped since the iterate moved, with their sides.
    dropped: Vec<(Constraint, Side)>,
    /// Constraints that came back, and how often.
    returned: Vec<(Constraint, usize)>,
}

impl Dropped {
    pub(crate) fn with_capacity() -> Self {
        Self { dropped: Vec::with_capacity(REMEMBERED), returned: Vec::with_capacity(REMEMBERED) }
    }

    /// Forgets everything: a level begins.
    pub(crate) fn clear(&mut self) {
        self.dropped.clear();
        self.returned.clear();
    }

    /// Notes that a constraint is dropped, which is active at a side.
    pub(crate) fn drop(&mut self, constraint: Constraint, side: Side) {
        self.dropped.retain(|dropped| *dropped != (constraint, side));
        if self.dropped.len() == REMEMBERED {
            self.dropped.remove(0);
        }
        self.dropped.push((constraint, side));
    }

    /// Forgets the constraints dropped so far, since the iterate moves noticeably; but for the last one where no other constraint blocks the step.
    pub(crate) fn iterate_moves(&mut self, blocking: Option<Blocking>) {
        let Some(last) = self.dropped.last().copied() else { return };
        self.dropped.clear();
        if blocking.is_none_or(|blocking| (blocking.constraint, blocking.side) == last) {
            self.dropped.push(last);
        }
    }

    /// Notes whether a constraint that blocks a step comes back: to the side where it was when it was dropped, before the iterate has moved since, or on
    /// the very step for which it was dropped.
    pub(crate) fn block(&mut self, constraint: Constraint, side: Side) {
        if !self.dropped.contains(&(constraint, side)) {
            return;
        }
        if let Some((_, times)) = self.returned.iter_mut().find(|(returned, _)| *returned == constraint) {
            *times += 1;
        } else if self.returned.len() < REMEMBERED {
            self.returned.push((constraint, 1));
        }
    }

    /// Whether the level drops a constraint no more.
    pub(crate) fn is_held(&self, constraint: Constraint) -> bool {
        self.returned.iter().any(|(returned, times)| *returned == constraint && *times >= RETURNS)
    }
}
