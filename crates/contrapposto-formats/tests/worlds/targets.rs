//! Errors of the tasks that no relief may make worse, and of the supports, which come before all tasks: how far they are off their places, and what
//! they carry beyond their greatest share.

use contrapposto::contact::Slip;
use contrapposto::simulation::{Sample, Scenario};

/// Such an error may grow by so much while nothing changes, m or rad: what a step of the solver leaves beside its linear model.
const MOST_RISE: f64 = 1e-3;
/// A task has come nearer where its error has fallen by more, m or rad: those below it may be farther then, however little it gains.
const NEARER: f64 = 1e-6;

/// Errors of the supports and of the tasks above relief since the last change of loads, targets or supports, or since one above them has come
/// nearer.
#[derive(Clone, Debug, Default)]
pub(crate) struct Targets {
    /// Places, shares, then by task, the most important first: its least error so far, and its error from which on it has come nearer.
    tasks: Vec<(f64, f64)>,
    /// Events that have happened.
    events: usize,
    /// The greatest rise of an error above the least one, and when that was, s.
    worst: (f64, f64),
}

impl Targets {
    pub(crate) fn take(&mut self, scenario: &Scenario, sample: &Sample) {
        let events = scenario.events.partition_point(|event| event.time <= sample.time + 1e-9);
        // Supports come first: while they slide, which the run says and from some millimetres on ends for, tasks may give, and while they come nearer to
        // their places.
        let standing = sample.standing.unwrap();
        let slides = standing.slip.exceeds(Slip::NOTICED);
        if events > self.events || sample.stepping || slides {
            self.events = events;
            self.tasks.clear();
        }
        let carried = standing.contacts.iter().zip(&scenario.supports).filter(|(_, support)| support.share_max < 1.0);
        let beyond: f64 = carried.map(|(contact, support)| (contact.share - support.share_max).max(0.0)).sum();
        let tasks = standing.errors.iter().zip(&scenario.tasks);
        let errors = tasks.filter(|(_, task)| task.above_relief).map(|(error, _)| *error);
        self.errors([standing.slip.length(), beyond].into_iter().chain(errors), sample.time);
    }

    /// Takes the errors of the supports' places, of the shares and of the tasks above relief.
    fn errors(&mut self, errors: impl Iterator<Item = f64>, time: f64) {
        for (k, error) in errors.enumerate() {
            self.tasks.resize(self.tasks.len().max(k + 1), (error, error));
            let (least, before) = &mut self.tasks[k];
            if error - *least > self.worst.0 {
                self.worst = (error - *least, time);
            }
            *least = least.min(error);
            if error < *before - NEARER {
                *before = error;
                self.tasks.truncate(k + 1);
            }
        }
    }

    pub(crate) fn are_kept(&self, name: &str) {
        let (rise, time) = self.worst;
        println!("  errors above relief rise by {rise:.1e} at most");
        assert!(rise < MOST_RISE, "an error rises by {rise} at {time} s: {name}");
    }
}

#[test]
fn a_task_may_come_farther_only_while_one_above_it_comes_nearer() {
    let worst = |samples: &[[f64; 2]]| {
        let (mut targets, mut time) = (Targets::default(), 0.0);
        for errors in samples {
            time += 0.1;
            targets.errors(errors.iter().copied(), time);
        }
        targets.worst.0
    };
    assert_eq!(worst(&[[0.3, 0.0], [0.2, 0.5], [0.1, 0.7]]), 0.0);
    assert_eq!(worst(&[[0.3, 0.0], [0.3, 0.25]]), 0.25);
    assert_eq!(worst(&[[0.3, 0.0], [0.2, 0.5], [0.3, 0.4], [0.2, 0.75]]), 0.35, "it came nearer once only");
    assert_eq!(worst(&[[0.25, 0.0], [0.5, 0.0]]), 0.25);
}
