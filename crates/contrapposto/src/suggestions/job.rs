//! Gathers the parts of a job that changes of it concern.

use nalgebra::Vector3;

use crate::contact::Support;
use crate::equilibria::Search;
use crate::hybrid::Strategy;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture::Posture;
use crate::simulation::Scenario;
use crate::statics::Load;
use crate::tasks::{PriorityLevel, Task};

/// The parts of a job that changes concern.
#[derive(Clone, Debug)]
pub struct Job<'a> {
    /// The body.
    pub model: &'a Model,
    /// Posture of the body at the start.
    pub start: &'a Posture,
    /// The supports that carry it, as far as they are known.
    pub supports: &'a [Support],
    /// Inequalities above all tasks.
    pub limits: &'a [Task],
    /// Segments that may rest already.
    pub rests: Vec<usize>,
    /// Tasks, the most important first.
    pub levels: Vec<&'a PriorityLevel>,
    /// The loads at the start, and those of every event that changes them.
    pub loads: Vec<&'a [Load]>,
    /// The time that is asked for, s.
    pub asked: Option<f64>,
    /// The strategy of the whole body; `None` where there are several, and where nobody seeks relief.
    pub strategy: Option<Strategy>,
}

impl<'a> From<&'a Scenario> for Job<'a> {
    fn from(scenario: &'a Scenario) -> Self {
        let kind = scenario.strategy.kind;
        let is_one = scenario.strategies.iter().all(|strategy| *strategy == kind)
            && scenario.events.iter().all(|event| event.strategies.is_none());
        Self {
            model: &scenario.model,
            start: &scenario.start,
            supports: scenario.supports_at_start(),
            limits: &scenario.limits,
            rests: scenario.rests.iter().map(|rest| scenario.supports[rest.support].segment).collect(),
            levels: scenario.tasks.iter().map(|task| &task.goal).collect(),
            loads: std::iter::once(scenario.loads.as_slice())
                .chain(scenario.events.iter().filter_map(|event| event.loads.as_deref()))
                .collect(),
            asked: Some(scenario.run.end()),
            strategy: is_one.then_some(kind),
        }
    }
}

impl<'a> From<&Search<'a>> for Job<'a> {
    fn from(search: &Search<'a>) -> Self {
        Self {
            model: search.model,
            start: search.start,
            supports: search.supports,
            limits: search.limits,
            rests: vec![],
            levels: search.goals.iter().collect(),
            loads: vec![search.loads],
            asked: None,
            strategy: None,
        }
    }
}

impl Job<'_> {
    /// Segments that carry nothing and are asked to a place, these places, ground, m, and the axes on which they are asked.
    pub(super) fn targets(&self) -> Vec<(usize, Vector3<f64>, [bool; 3])> {
        let tasks = self.levels.iter().filter(|level| !level.hard).flat_map(|level| &level.tasks);
        let target = |task: &Task| match task {
            Task::Point(point) => Some((point.segment, point.target, point.axes)),
            Task::Placement(placement) => Some((placement.segment, placement.target.translation.vector, [true; 3])),
            _ => None,
        };
        tasks.filter_map(target).filter(|(segment, ..)| !self.carries(*segment)).collect()
    }

    /// Upward, of length 1; `None` without gravity.
    pub(super) fn up(&self) -> Option<Vector3<f64>> {
        (-self.model.gravity()).try_normalize(1e-9)
    }

    /// Centre of mass at the start, ground, m.
    pub(super) fn center_of_mass(&self) -> Option<Vector3<f64>> {
        let mut kinematics = Kinematics::new(self.model);
        kinematics.update(self.model, self.start).ok().and_then(|()| kinematics.center_of_mass(self.model))
    }

    pub(super) fn carries(&self, segment: usize) -> bool {
        self.supports.iter().any(|support| support.segment == segment)
    }
}
