//! The picture of a solved pose: the body, its start, and its targets.

use contrapposto::kinematics::Kinematics;
use contrapposto::posture_solver::SolvedPosture;
use contrapposto::tasks::{CenterOfMassGoal, LookAtGoal, Task};
use contrapposto_formats::PoseScenario;
use contrapposto_plot::{BodyFigure, BodyPosture};
use nalgebra::Vector3;

use super::axes::turn;
use super::body;
use super::held::held;
use super::muscle_work::MusclesAtWork;
use super::stage::Stage;
use crate::fail::Fail;

/// Marks beside the body, ground, m.
#[derive(Default)]
struct Marks {
    targets: Vec<Vector3<f64>>,
    /// Lines of sight: eye and target.
    gazes: Vec<[Vector3<f64>; 2]>,
    /// Of mass.
    center: Option<Vector3<f64>>,
}

/// The picture of a solved pose.
pub(crate) fn pose_picture(
    scenario: &PoseScenario,
    (pose, muscles): (&SolvedPosture, Option<&MusclesAtWork<'_>>),
    subtitle: &str,
) -> Result<BodyFigure, Fail> {
    let mut posture = pose_posture(scenario, pose)?;
    posture.muscles = muscles.map_or(Ok(vec![]), |muscles| muscles.drawn(0, pose.posture.values()))?;
    posture.start = body::parts(&scenario.model, scenario.start.values(), None)?;
    Ok(BodyFigure {
        title: scenario.title.clone(),
        subtitle: subtitle.to_owned(),
        target: "target".to_owned(),
        postures: vec![posture],
    })
}

/// The body of a solved pose, with its targets.
fn pose_posture(scenario: &PoseScenario, pose: &SolvedPosture) -> Result<BodyPosture, Fail> {
    let model = &scenario.model;
    let held = held(model, &pose.posture, &scenario.loads, &scenario.supports)?;
    let stage = Stage::still(&scenario.supports, &scenario.things, &scenario.loads);
    let mut posture = body::held_body(model, &stage, &held)?;
    let (turn, marks) = (turn(model), marks(scenario, pose)?);
    posture.targets = marks.targets.into_iter().map(|at| turn.point(at)).collect();
    posture.gazes = marks.gazes.into_iter().map(|gaze| gaze.map(|at| turn.point(at))).collect();
    posture.center_of_mass = posture.center_of_mass.or_else(|| marks.center.map(|center| turn.point(center)));
    Ok(posture)
}

fn marks(scenario: &PoseScenario, pose: &SolvedPosture) -> Result<Marks, Fail> {
    let model = &scenario.model;
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &pose.posture).map_err(|error| Fail::job("picture", error))?;
    let center = kinematics.center_of_mass(model);
    let mut marks = Marks { center, ..Marks::default() };
    for task in scenario.goals.iter().filter(|goal| !goal.hard).flat_map(|goal| &goal.tasks) {
        match task {
            Task::Point(task) => marks
                .targets
                .push(unasked(task.axes, task.target, || kinematics.station(model, task.segment, task.point))),
            Task::Placement(task) => marks.targets.push(task.target.translation.vector),
            Task::LookAt(task) => {
                let LookAtGoal::Place(target) = task.goal else { continue };
                marks.targets.push(target);
                marks.gazes.push([kinematics.station(model, task.segment, task.eye), target]);
            }
            Task::CenterOfMass(task) => {
                if let CenterOfMassGoal::At { target, axes } = &task.goal {
                    marks.targets.push(unasked(*axes, *target, || center.unwrap_or(*target)));
                }
            }
            _ => {}
        }
    }
    Ok(marks)
}

/// A target on some axes only: the others are where the body is.
fn unasked(axes: [bool; 3], mut target: Vector3<f64>, present: impl Fn() -> Vector3<f64>) -> Vector3<f64> {
    for k in (0..3).filter(|&k| !axes[k]) {
        target[k] = present()[k];
    }
    target
}
