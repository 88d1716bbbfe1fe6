//! Chooses how far a rate may change in one time step.
//!
//! A step keeps tasks to first order. Where a task is out of reach, or tasks and supports leave hardly any motion, what a step leaves of second
//! order may be as large as what it gains, and the body would go back and forth by some millimetres. So steps are short once a task above
//! relief has been missed for a while and comes no nearer. While reliefs move, a step that leads farther from such a task is taken back, and
//! the next one is shorter.

use super::easiest::UNREACHED;

/// Greatest step, as a share of the usual one, while a task is missed and comes no nearer: what it leaves of second order is a 64th. Assumed.
const WHILE_MISSED: f64 = 0.125;
/// Steps in a row from which on a task counts as missed for a while: after an event the body has as many to recover. Assumed.
const A_WHILE: u32 = 10;
/// The next step after one that was taken back, as a share of that one. Assumed.
const AFTER_ONE_TAKEN_BACK: f64 = 0.3;
/// Growth of the greatest step from one step to the next. Assumed.
const GROWTH: f64 = 1.2;
/// A task is on its way where its error has fallen by more in a step, m or rad. Assumed: a tenth of a usual step of an arm.
const ON_ITS_WAY: f64 = 1e-3;
/// A task has come nearer where its error has fallen by more, m or rad: those below it may be farther then. Assumed.
const COMES_NEARER: f64 = 1e-4;

/// Greatest change of a rate in the next step, rad or m.
#[derive(Clone, Debug)]
pub(super) struct StepLength {
    greatest: f64,
    /// While reliefs move and no task is missed.
    next: f64,
    /// The least error of each level above relief since a level above it was on its way.
    least: Vec<f64>,
    /// Steps in a row in which a level was missed and none was on its way; [`A_WHILE`] where nothing is known.
    missed: u32,
}

impl StepLength {
    /// No step is greater than `greatest`, rad or m.
    pub(super) fn new(greatest: f64) -> Self {
        Self { greatest, next: greatest, least: vec![], missed: A_WHILE }
    }

    /// Of the next step; where no relief moves, the body is slowed down by tasks that are missed alone.
    pub(super) fn next(&self, reliefs_move: bool) -> f64 {
        let usual = if reliefs_move { self.next } else { self.greatest };
        if self.missed >= A_WHILE { usual.min(WHILE_MISSED * self.greatest) } else { usual }
    }

    /// Greatest step of all.
    pub(super) fn greatest(&self) -> f64 {
        self.greatest
    }

    /// Begins anew after an event.
    pub(super) fn restart(&mut self) {
        self.forget();
        self.missed = 0;
    }

    /// Forgets all steps so far.
    pub(super) fn forget(&mut self) {
        *self = Self::new(self.greatest);
    }

    /// Takes the errors of the levels above relief, the most important one first, before each step.
    pub(super) fn observe(&mut self, errors: impl Iterator<Item = f64>) {
        let (mut is_missed, mut is_on_its_way) = (false, false);
        for (k, error) in errors.enumerate() {
            is_missed |= error > UNREACHED;
            let Some(least) = self.least.get_mut(k) else {
                self.least.push(error);
                continue;
            };
            let nearer = *least - error;
            *least = least.min(error);
            if nearer > ON_ITS_WAY {
                is_on_its_way = true;
                self.least.truncate(k + 1);
            }
        }
        self.missed = if is_missed && !is_on_its_way { self.missed.saturating_add(1) } else { 0 };
    }

    /// Takes whether the last step, by so much, was taken back.
    pub(super) fn adapt(&mut self, taken_back: bool, largest: f64) {
        self.next = if taken_back { AFTER_ONE_TAKEN_BACK * largest } else { (GROWTH * self.next).min(self.greatest) };
    }
}

/// Whether the first error that has changed noticeably, of levels from the most important one on, has grown.
pub(super) fn leads_farther(now: impl Iterator<Item = f64>, before: &[f64]) -> bool {
    let mut changes = now.zip(before).map(|(now, before)| now - before);
    changes.find(|change| *change < -COMES_NEARER || *change > UNREACHED).is_some_and(|change| change > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_leads_farther_by_the_first_error_that_has_changed_noticeably() {
        let farther = |now: [f64; 3]| leads_farther(now.into_iter(), &[0.1, 0.2, 0.3]);
        assert!(!farther([0.1, 0.2, 0.3]) && !farther([0.1, 0.2 + 0.9 * UNREACHED, 0.3]));
        assert!(farther([0.1, 0.2 + 1.1 * UNREACHED, 0.3]) && farther([0.1, 0.2 + 1.1 * UNREACHED, 0.1]));
        assert!(!farther([0.1 - 1.1 * COMES_NEARER, 0.4, 0.3]), "a more important one is nearer");
        assert!(farther([0.1 - 0.9 * COMES_NEARER, 0.4, 0.3]), "but not noticeably");
    }

    #[test]
    fn steps_are_shorter_after_one_taken_back_and_grow_again_to_the_greatest() {
        let mut step = StepLength::new(0.02);
        step.restart();
        step.adapt(false, 0.02);
        assert_eq!(step.next(true), 0.02);
        step.adapt(true, 0.01);
        assert_eq!((step.next(true), step.next(false)), (0.003, 0.02));
        step.adapt(false, 0.003);
        assert!((step.next(true) - 0.0036).abs() < 1e-12);
        step.restart();
        assert_eq!(step.next(true), 0.02);
    }

    /// The greatest step after each of these errors, in hundredths.
    fn steps(step: &mut StepLength, errors: &[[f64; 2]]) -> Vec<f64> {
        let mut after = |errors: &[f64; 2]| {
            step.observe(errors.iter().copied());
            100.0 * step.next(false)
        };
        errors.iter().map(&mut after).collect()
    }

    #[test]
    fn steps_are_short_once_a_task_has_been_missed_for_a_while_and_none_comes_nearer() {
        let (short, usual) = (0.25, 2.0);
        let mut step = StepLength::new(0.02);
        assert_eq!(steps(&mut step, &[[0.0, 0.1], [0.0, 0.1 - 2.0 * ON_ITS_WAY]]), [short, usual], "it comes nearer");
        step.forget();
        assert_eq!(steps(&mut step, &[[0.0, 0.1], [0.0, 0.2], [0.0, 0.1]]), [short; 3], "it was as near once");
        step.restart();
        let mut expected = [usual; A_WHILE as usize];
        expected[A_WHILE as usize - 1] = short;
        assert_eq!(steps(&mut step, &[[0.0, 0.1]; A_WHILE as usize]), expected);
        assert_eq!(steps(&mut step, &[[0.0, 0.9 * UNREACHED]]), [usual], "nothing is missed");
        step.forget();
        let nearer = [[0.2, 0.1], [0.1, 0.4], [0.1, 0.3]];
        assert_eq!(
            steps(&mut step, &nearer),
            [short, usual, usual],
            "what was before the first came nearer does not count"
        );
    }
}
