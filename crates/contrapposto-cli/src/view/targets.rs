//! Finds the targets of tasks in every frame, and the points of the body that are to reach them, as pages draw them.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::{Event, Scenario};
use contrapposto::tasks::{CenterOfMassGoal, LookAtGoal, PriorityLevel, Task};
use contrapposto_report::Target;
use nalgebra::Vector3;

use super::axes::turn;
use super::frame::Frame;
use super::stage::EVENT_TOLERANCE;
use super::words::plain;
use crate::fail::Fail;

/// A point of the body that is nearer to its target, m, in all frames reaches it.
const REACHED_DISTANCE: f64 = 5e-3;

/// The name of a part, its target, and the point that is to reach it.
type Found = (String, Vector3<f64>, Option<Vector3<f64>>);

/// The targets of the tasks that are in force at the time of each frame, in the axes of the page.
pub(crate) fn targets<'a>(
    model: &Model,
    frames: &[Frame],
    tasks_at: impl Fn(f64) -> Vec<&'a Task>,
) -> Result<Vec<Target>, Fail> {
    let (turn, mut kinematics) = (turn(model), Kinematics::new(model));
    let mut targets: Vec<Target> = vec![];
    for frame in frames {
        let updated = kinematics.update(model, &Posture::new(frame.posture.clone()));
        updated.map_err(|error| Fail::job("report", error))?;
        let found = tasks_at(frame.time).into_iter().filter_map(|task| target(model, &kinematics, task));
        for (k, (label, at, from)) in found.enumerate() {
            if k == targets.len() {
                targets.push(Target { label, ..Target::default() });
            }
            targets[k].at.push(turn.point(at));
            targets[k].from.extend(from.map(|from| turn.point(from)));
        }
    }
    Ok(targets)
}

/// The targets of a run that a point of the body misses in some frame.
pub(crate) fn missed_targets(scenario: &Scenario, frames: &[Frame]) -> Result<Vec<Target>, Fail> {
    let due = |time: f64| scenario.events.iter().filter(move |event: &&Event| event.time <= time + EVENT_TOLERANCE);
    let tasks_at = |time: f64| {
        let mut goals: Vec<&PriorityLevel> = scenario.tasks.iter().map(|task| &task.goal).collect();
        due(time).flat_map(|event| &event.tasks).for_each(|(i, goal)| goals[*i] = goal);
        goals.into_iter().flat_map(|goal| &goal.tasks).collect()
    };
    let mut targets = targets(&scenario.model, frames, tasks_at)?;
    let far =
        |(at, from): (&[f64; 3], &[f64; 3])| (Vector3::from(*at) - Vector3::from(*from)).norm() > REACHED_DISTANCE;
    targets.retain(|target| target.at.iter().zip(&target.from).any(far));
    Ok(targets)
}

/// The target of a task that has one.
fn target(model: &Model, kinematics: &Kinematics, task: &Task) -> Option<Found> {
    let name = |segment: usize| plain(&model.segments()[segment].name);
    let station = |segment: usize, point: Vector3<f64>| kinematics.station(model, segment, point);
    match task {
        Task::Point(task) => {
            let from = station(task.segment, task.point);
            Some((name(task.segment), unasked(task.axes, task.target, from), Some(from)))
        }
        Task::Placement(task) => Some((name(task.segment), task.target.translation.vector, None)),
        Task::LookAt(task) => match task.goal {
            LookAtGoal::Place(target) => Some((name(task.segment), target, None)),
            LookAtGoal::Direction(_) => None,
        },
        Task::CenterOfMass(task) => match &task.goal {
            CenterOfMassGoal::At { target, axes } => {
                let from = kinematics.center_of_mass(model)?;
                Some(("centre of mass".to_owned(), unasked(*axes, *target, from), Some(from)))
            }
            _ => None,
        },
        _ => None,
    }
}

/// A target on some axes only: the others are where the body is.
fn unasked(axes: [bool; 3], target: Vector3<f64>, present: Vector3<f64>) -> Vector3<f64> {
    Vector3::from_fn(|k, _| if axes[k] { target[k] } else { present[k] })
}
