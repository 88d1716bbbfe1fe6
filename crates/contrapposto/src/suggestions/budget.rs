//! Tries changes in an order within a budget of solver steps.

use super::change::Change;
use crate::verdict::Verdict;

/// A budget is at least so many solver steps: about twenty seconds on one core, enough for all changes of most
/// jobs of minutes and for two pairs of them. Assumed.
pub const LEAST_BUDGET: usize = 150_000;
/// A budget is so many times the solver steps of the job itself: on two cores, trials of a long job take about as long as the job. Assumed.
pub const BUDGET_FACTOR: usize = 2;

/// Limits of trials.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// No trial begins after so many solver steps.
    pub steps: usize,
    /// Trials at once, at least 1. The answers do not depend on it.
    pub threads: usize,
}

impl Budget {
    /// The budget of a job that took `steps` solver steps.
    pub fn of_job(steps: usize, threads: usize) -> Self {
        Self { steps: LEAST_BUDGET.max(BUDGET_FACTOR * steps), threads }
    }
}

/// The outcome of a trial.
#[derive(Clone, Debug, Default)]
pub struct Trial {
    /// Of the changed job; `None` where it is not in order, or the trial was left.
    pub verdict: Option<Verdict>,
    /// Solver steps that it took.
    pub steps: usize,
}

/// The trials of the first changes, in their order, until the budget is used up: a change is tried where the trials before it took
/// fewer steps than the budget.
pub(super) fn within(budget: Budget, changes: &[Change], trial: impl Fn(&Change) -> Trial + Sync) -> Vec<Trial> {
    let (mut trials, mut used) = (vec![], 0);
    let trial = &trial;
    for part in changes.chunks(budget.threads.max(1)) {
        if used >= budget.steps {
            return trials;
        }
        let outcomes: Vec<Trial> = std::thread::scope(|scope| {
            let runs: Vec<_> = part.iter().map(|change| scope.spawn(move || trial(change))).collect();
            // A change whose trial ends in a panic is none that helps.
            runs.into_iter().map(|run| run.join().unwrap_or_default()).collect()
        });
        for outcome in outcomes {
            if used >= budget.steps {
                return trials;
            }
            used += outcome.steps;
            trials.push(outcome);
        }
    }
    trials
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of six changes of 10, 20, ... steps that are tried.
    fn tried(steps: usize, threads: usize) -> usize {
        let changes: Vec<Change> = (1..=6).map(|i| Change::Loads(f64::from(i))).collect();
        let trial = |change: &Change| match change {
            Change::Loads(i) => Trial { verdict: None, steps: 10 * *i as usize },
            _ => Trial::default(),
        };
        let trials = within(Budget { steps, threads }, &changes, trial);
        assert!(trials.iter().enumerate().all(|(i, trial)| trial.steps == 10 * (i + 1)));
        trials.len()
    }

    #[test]
    fn a_change_is_tried_where_those_before_it_took_fewer_steps_than_the_budget_for_any_number_of_threads() {
        for threads in 0..=8 {
            for (steps, expected) in
                [(0, 0), (1, 1), (10, 1), (11, 2), (30, 2), (31, 3), (60, 3), (150, 5), (151, 6), (999, 6)]
            {
                assert_eq!(tried(steps, threads), expected, "{steps} steps on {threads} threads");
            }
        }
    }
}
