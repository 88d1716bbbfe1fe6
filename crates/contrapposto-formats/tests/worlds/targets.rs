//! Errors of the tasks that no relief may make worse.

use contrapposto::simulation::{Sample, Scenario};

/// Such an error may grow by so much while nothing changes, m or rad: what a step of the solver leaves beside its linear model.
const MOST_RISE: f64 = 1e-3;

/// Errors of the tasks above relief since the last change of loads, targets or supports.
#[derive(Clone, Debug, Default)]
pub(crate) struct Targets {
    /// The least error of each level so far.
    least: Vec<f64>,
    /// Events that have happened.
    events: usize,
    /// The greatest rise of an error above the least one, and when that was, s.
    worst: (f64, f64),
}

impl Targets {
    pub(crate) fn take(&mut self, scenario: &Scenario, sample: &Sample) {
        let events = scenario.events.partition_point(|event| event.time <= sample.time + 1e-9);
        if events > self.events || sample.stepping {
            self.events = events;
            self.least.clear();
        }
        self.least.resize(scenario.tasks.len(), f64::INFINITY);
        let errors = &sample.standing.unwrap().errors;
        for ((least, error), task) in self.least.iter_mut().zip(errors).zip(&scenario.tasks) {
            if task.above_relief && error - *least > self.worst.0 {
                self.worst = (error - *least, sample.time);
            }
            *least = least.min(*error);
        }
    }

    pub(crate) fn are_kept(&self, name: &str) {
        let (rise, time) = self.worst;
        println!("  errors above relief rise by {rise:.1e} at most");
        assert!(rise < MOST_RISE, "{name}: an error rises by {rise} at {time} s");
    }
}
