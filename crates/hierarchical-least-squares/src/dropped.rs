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

#[cfg(test)]
mod tests {
    use super::*;

    /// Changes of a level that meets the limits `back` after it has dropped `dropped`, so many times; `moves`: with what blocks the step on which the
    /// iterate moves between, if anything does.
    fn repeated(times: usize, dropped: &[usize], moves: Option<usize>, back: &[usize]) -> Dropped {
        let mut level = Dropped::with_capacity();
        let bound = Constraint::Bound;
        for _ in 0..times {
            dropped.iter().for_each(|&i| level.drop(bound(i), Side::Upper));
            if let Some(i) = moves {
                level.iterate_moves(Some(Blocking { share: 0.5, constraint: bound(i), side: Side::Upper }));
            }
            back.iter().for_each(|&i| level.block(bound(i), Side::Upper));
        }
        level
    }

    fn held(level: &Dropped) -> Vec<usize> {
        (0..300).filter(|&i| level.is_held(Constraint::Bound(i))).collect()
    }

    #[test]
    fn a_constraint_that_comes_back_at_once_is_held_and_one_that_the_iterate_left_is_not() {
        assert_eq!(held(&repeated(RETURNS - 1, &[4], None, &[4])), []);
        assert_eq!(held(&repeated(RETURNS, &[4], None, &[4])), [4]);
        assert_eq!(held(&repeated(RETURNS, &[4, 7, 2], None, &[7, 2, 4])), [2, 4, 7]);
        // The step for which it was dropped is blocked by itself, with rounding for a way.
        assert_eq!(held(&repeated(RETURNS, &[7, 4], Some(4), &[4, 7])), [4]);
        assert_eq!(held(&repeated(RETURNS, &[4], Some(7), &[7, 4])), []);
        let mut level = repeated(RETURNS, &[4], None, &[4]);
        level.clear();
        assert_eq!(held(&level), []);
        level.drop(Constraint::Bound(4), Side::Lower);
        level.block(Constraint::Bound(4), Side::Upper);
        assert_eq!(level.returned, []);
    }

    #[test]
    fn a_level_remembers_the_last_constraints_that_it_dropped() {
        let all: Vec<usize> = (0..300).collect();
        let level = repeated(RETURNS, &all, None, &all);
        assert_eq!(held(&level), Vec::from_iter(300 - REMEMBERED..300));
        assert_eq!((level.dropped.len(), level.returned.len()), (REMEMBERED, REMEMBERED));
    }
}
