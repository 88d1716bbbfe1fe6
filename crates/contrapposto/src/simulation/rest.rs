//! Defines places where the body may put a hand when a muscle group is tired.

use nalgebra::{Unit, UnitVector3, Vector3};

use crate::contact::{Place, Support, SupportError};
use crate::model::{LARGEST, Model};
use crate::tasks::{Bounds, Carried, Component, LookAt, LookAtGoal, PriorityLevel, Task, within_region};

/// A support that is not in use at the start. Its place is free: the region says where on its plane the patch may be put.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Number of the support in the scenario.
    pub support: usize,
    /// Height of the plane along the support's normal, m.
    pub height: f64,
    /// Normal of the patch toward the body, segment frame, of unit length; along the support's normal where the patch lies flat.
    pub inward: Vector3<f64>,
}

impl Rest {
    /// Whether the rest fits `supports` of `model`.
    fn check(&self, supports: &[Support], model: &Model) -> Result<(), SupportError> {
        let Some(support) = supports.get(self.support) else {
            return Err(SupportError::Rest { support: self.support, count: supports.len() });
        };
        let check = |ok: bool, what, value, accepted| {
            let segment = model.segments()[support.segment].name.clone();
            if ok { Ok(()) } else { Err(SupportError::Number { segment, what, value, accepted }) }
        };
        check(self.height.abs() <= LARGEST, "height of the plane (m)", self.height, "finite and at most 1e9 in size")?;
        let length = self.inward.norm();
        check((length - 1.0).abs() <= 1e-6, "length of the patch's normal", length, "1")?;
        let corners = match &support.place {
            Place::Free(region) => region.corners.len(),
            Place::Fixed => 0,
        };
        check(corners >= 3, "number of corners of the region", corners as f64, "at least 3")
    }

    /// The tasks of a patch that lies flat on its plane, within its region.
    pub(crate) fn lies(&self, support: &Support) -> [Task; 2] {
        let normal = Unit::new_normalize(support.normal);
        let direction: UnitVector3<f64> = Unit::new_normalize(self.inward);
        let on_plane =
            Component { of: Carried::Point(support.middle()), along: normal, limits: (self.height, self.height) };
        let components = std::iter::once(on_plane).chain(within_region(support)).collect();
        let goal = LookAtGoal::Direction(normal);
        [
            Task::LookAt(LookAt { segment: support.segment, eye: Vector3::zeros(), direction, goal }),
            Task::Bounds(Bounds { segment: support.segment, components }),
        ]
    }
}

/// Whether the rests fit the last of `supports`, one each, of `model`.
pub(super) fn check_rests(rests: &[Rest], supports: &[Support], model: &Model) -> Result<(), SupportError> {
    let first = supports.len().checked_sub(rests.len());
    for (i, rest) in rests.iter().enumerate() {
        if first.is_none_or(|first| rest.support != first + i) {
            return Err(SupportError::Rest { support: rest.support, count: supports.len() });
        }
        rest.check(supports, model)?;
    }
    Ok(())
}

/// The tasks of a level while the supports `in_use` are: a limb that a rest carries does not hang.
pub(super) fn goal_with(
    goal: &PriorityLevel,
    (rests, supports): (&[Rest], &[Support]),
    model: &Model,
    in_use: &[usize],
) -> PriorityLevel {
    let carried = |limb: usize| {
        let mut used = rests.iter().filter(|rest| in_use.contains(&rest.support));
        used.any(|rest| carries(model, limb, supports[rest.support].segment))
    };
    let mut goal = goal.clone();
    goal.tasks.retain(|task| !matches!(task, Task::Bounds(bounds) if task.hangs(model) && carried(bounds.segment)));
    goal
}

/// Whether `segment` is `limb` or hangs on it.
fn carries(model: &Model, limb: usize, segment: usize) -> bool {
    std::iter::successors(Some(segment), |&segment| model.segments()[segment].parent).any(|above| above == limb)
}

/// The `limits` of a body while the supports `in_use` are: a hand that rests on a thing touches it.
pub(super) fn limits_with(
    limits: &[Task],
    (rests, supports): (&[Rest], &[Support]),
    model: &Model,
    in_use: &[usize],
) -> Vec<Task> {
    let rests = rests.iter().filter(|rest| in_use.contains(&rest.support));
    let carrying: Vec<usize> = rests.map(|rest| supports[rest.support].segment).collect();
    let limit = |task: &Task| match task {
        Task::Clearance(clearance) if !carrying.is_empty() => {
            Task::Clearance(clearance.with_carrying(model, &carrying))
        }
        _ => task.clone(),
    };
    limits.iter().map(limit).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot go on says where")]

    use super::*;
    use crate::model::{Adult, adult};
    use crate::tasks::Point;

    #[test]
    fn an_arm_hangs_but_while_its_hand_rests_and_all_other_tasks_stay() {
        let model = adult(&Adult::default()).unwrap();
        let segment = |name: &str| model.segment(name).unwrap();
        let hangs = |name: &str| {
            let component =
                Component { of: Carried::Direction(-Vector3::y_axis()), along: -Vector3::y_axis(), limits: (0.9, 1.0) };
            Task::Bounds(Bounds { segment: segment(name), components: vec![component] })
        };
        let (hand, feet) = (segment("hand_l"), [segment("calcn_r"), segment("calcn_l")]);
        let support = |segment: usize| Support {
            segment,
            corners: model.segments()[segment].patch.clone(),
            normal: Vector3::y(),
            friction: 0.5,
            share_max: 1.0,
            place: Place::Fixed,
        };
        let supports = [support(feet[0]), support(feet[1]), support(hand)];
        let rests = [Rest { support: 2, height: 0.7, inward: Vector3::y() }];
        let point =
            Task::Point(Point { segment: hand, point: Vector3::zeros(), target: Vector3::zeros(), axes: [true; 3] });
        let tasks = vec![hangs("humerus_r"), hangs("humerus_l"), point];
        let goal = PriorityLevel { tasks: tasks.clone(), ..PriorityLevel::default() };
        let with = |in_use: &[usize]| goal_with(&goal, (&rests, &supports), &model, in_use).tasks;
        assert_eq!(with(&[0, 1]), tasks);
        assert_eq!(with(&[0, 1, 2]), [tasks[0].clone(), tasks[2].clone()]);
    }
}
