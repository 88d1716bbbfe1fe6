//! Follows how near a body whose hand rests comes to its tasks after an event.

use serde::{Deserialize, Serialize};

use super::easiest::first_difference;

/// A body that no task has come nearer to for so long is as near as its supports allow, s (assumed).
const NO_PROGRESS: f64 = 1.0;

/// The nearest that the body has been to its tasks since the last event.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Approach {
    /// The least errors, in the order of the levels.
    errors: Vec<f64>,
    /// Steps made when these were reached.
    since: u64,
    /// No hand is taken up for a task before the next event.
    pub(super) is_over: bool,
}

impl Approach {
    /// Takes the errors after so many `steps` of `step` seconds each; whether the body has come no nearer for [`NO_PROGRESS`].
    pub(super) fn stalls(&mut self, errors: &[f64], steps: u64, step: f64) -> bool {
        if self.errors.is_empty() || first_difference(errors.iter().copied(), &self.errors) < 0.0 {
            (self.errors, self.since) = (errors.to_vec(), steps);
        }
        (steps - self.since) as f64 * step >= NO_PROGRESS
    }

    pub(super) fn is_finite(&self) -> bool {
        self.errors.iter().all(|error| error.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps after which the body stalls, of those with these errors, a quarter of a second each.
    fn stalls(errors: &[[f64; 2]]) -> Vec<usize> {
        let mut approach = Approach::default();
        let mut stalls = |(i, errors): (usize, &[f64; 2])| approach.stalls(errors, 40 + i as u64, 0.25).then_some(i);
        errors.iter().enumerate().filter_map(&mut stalls).collect()
    }

    #[test]
    fn a_body_stalls_once_nothing_comes_nearer_for_a_second() {
        assert_eq!(stalls(&[[0.1, 0.2]; 6]), [4, 5]);
        let nearing: Vec<[f64; 2]> = (0..20).map(|i| [0.1 - 1e-3 * f64::from(i), 0.2]).collect();
        assert!(stalls(&nearing).is_empty());
    }

    #[test]
    fn a_task_of_higher_priority_decides_and_going_to_and_fro_is_no_progress() {
        // The second task comes nearer while the first one stays; then at the cost of the first one.
        assert!(stalls(&[[0.1, 0.5], [0.1, 0.4], [0.1, 0.3], [0.1, 0.2], [0.1, 0.1], [0.1, 0.0]]).is_empty());
        assert_eq!(stalls(&[[0.1, 0.5], [0.2, 0.4], [0.3, 0.3], [0.4, 0.2], [0.5, 0.1]]), [4]);
        assert_eq!(stalls(&[[0.1, 0.0], [0.2, 0.0], [0.15, 0.0], [0.2, 0.0], [0.15, 0.0]]), [4]);
    }
}
