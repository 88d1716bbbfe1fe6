//! From a posture to the lines of a stick figure, seen from the front and from the side.

use contrapposto::ik::Pose;
use contrapposto::ik::task::{Goal, Task};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto_formats::PoseScenario;
use contrapposto_plot::{PoseView, PoseViews};
use nalgebra::Vector3;

use crate::fail::Fail;

/// Shorter lines, m, are not drawn.
const SHORT: f64 = 1e-9;

pub(crate) type Lines = Vec<Vec<Vector3<f64>>>;

/// What is drawn beside the body.
#[derive(Default)]
struct Marks {
    targets: Vec<Vector3<f64>>,
    gazes: Vec<[Vector3<f64>; 2]>,
}

/// The picture of a solved pose.
pub(crate) fn pose_picture(scenario: &PoseScenario, pose: &Pose, subtitle: &str) -> Result<PoseViews, Fail> {
    let texts = [&scenario.title, subtitle];
    picture(&scenario.model, [&scenario.start, &pose.posture], &marks(scenario, pose)?, texts)
}

/// Places that the tasks of a pose ask for, ground, m.
pub(crate) fn targets(scenario: &PoseScenario, pose: &Pose) -> Result<Vec<Vector3<f64>>, Fail> {
    Ok(marks(scenario, pose)?.targets)
}

fn marks(scenario: &PoseScenario, pose: &Pose) -> Result<Marks, Fail> {
    let model = &scenario.model;
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &pose.posture).map_err(|error| Fail::job("picture", error))?;
    let center = kinematics.center_of_mass(model);
    let mut marks = Marks::default();
    for task in scenario.goals.iter().filter(|goal| !goal.hard).flat_map(|goal| &goal.tasks) {
        match task {
            Task::Point(task) => marks
                .targets
                .push(unasked(task.axes, task.target, || kinematics.station(model, task.segment, task.point))),
            Task::Placement(task) => marks.targets.push(task.target.translation.vector),
            Task::LookAt(task) => {
                marks.targets.push(task.target);
                marks.gazes.push([kinematics.station(model, task.segment, task.eye), task.target]);
            }
            Task::CenterOfMass(task) => {
                if let Goal::At { target, axes } = &task.goal {
                    marks.targets.push(unasked(*axes, *target, || center.unwrap_or(*target)));
                }
            }
            _ => {}
        }
    }
    Ok(marks)
}

/// A body before and after, from the front and from the side.
pub(crate) fn views(
    model: &Model,
    start: &Posture,
    end: &Posture,
    title: &str,
    subtitle: &str,
) -> Result<PoseViews, Fail> {
    picture(model, [start, end], &Marks::default(), [title, subtitle])
}

fn picture(model: &Model, postures: [&Posture; 2], marks: &Marks, texts: [&str; 2]) -> Result<PoseViews, Fail> {
    let mut kinematics = Kinematics::new(model);
    let mut sticks_at = |posture: &Posture| -> Result<Lines, Fail> {
        kinematics.update(model, posture).map_err(|error| Fail::job("picture", error))?;
        Ok(sticks(model, &kinematics))
    };
    let (start, end) = (sticks_at(postures[0])?, sticks_at(postures[1])?);
    let center = kinematics.center_of_mass(model);
    let [right, ahead, up] = directions(model);
    let side = |label: &str, across: Vector3<f64>| {
        let view = |p: &Vector3<f64>| [across.dot(p), up.dot(p)];
        let lines = |lines: &Lines| lines.iter().map(|line| line.iter().map(view).collect()).collect();
        PoseView {
            label: label.to_owned(),
            start: lines(&start),
            end: lines(&end),
            targets: marks.targets.iter().map(view).collect(),
            gazes: marks.gazes.iter().map(|gaze| [view(&gaze[0]), view(&gaze[1])]).collect(),
            center_of_mass: center.as_ref().map(view),
        }
    };
    Ok(PoseViews {
        title: texts[0].to_owned(),
        subtitle: texts[1].to_owned(),
        // Face to face with the body its right hand is on the left.
        views: vec![side("from the front", -right), side("from the right", ahead)],
    })
}

/// A target on some axes only: the others are where the body is.
fn unasked(axes: [bool; 3], mut target: Vector3<f64>, present: impl Fn() -> Vector3<f64>) -> Vector3<f64> {
    for k in (0..3).filter(|&k| !axes[k]) {
        target[k] = present()[k];
    }
    target
}

/// Right, ahead and up in ground: up is against gravity (y without any), ahead the ground's x axis, or z where x is upright.
pub(crate) fn directions(model: &Model) -> [Vector3<f64>; 3] {
    let up = (-model.gravity()).try_normalize(0.0).unwrap_or_else(Vector3::y);
    let x = if up.x.abs() > 0.9 { Vector3::z() } else { Vector3::x() };
    let ahead = (x - up * up.dot(&x)).normalize();
    [ahead.cross(&up), ahead, up]
}

/// Lines of the body: those that join the joints of every segment; a last segment through its centre of mass to as far beyond;
/// a circle for the head.
pub(crate) fn sticks(model: &Model, kinematics: &Kinematics) -> Lines {
    let segments = model.segments();
    let origin = |segment: usize| kinematics.placement(model, segment).translation.vector;
    let mut joints: Vec<Vec<Vector3<f64>>> = (0..segments.len()).map(|s| vec![origin(s)]).collect();
    for (child, segment) in segments.iter().enumerate() {
        if let Some(parent) = segment.parent {
            joints[parent].push(origin(child));
        }
    }
    let mut lines = vec![];
    for (s, joints) in joints.into_iter().enumerate() {
        if joints.len() > 1 {
            lines.extend(joined(&joints));
            continue;
        }
        let (start, center) = (joints[0], kinematics.station(model, s, segments[s].center_of_mass));
        let reach = center - start;
        if segments[s].name.eq_ignore_ascii_case("head") && reach.norm() > SHORT {
            let radius = 0.7 * reach.norm();
            lines.push(vec![start, start + 0.3 * reach]);
            lines.extend(circle(center, radius, model));
        } else {
            lines.push(vec![start, start + 2.0 * reach]);
        }
    }
    lines.retain(|line| line.windows(2).any(|pair| (pair[1] - pair[0]).norm() > SHORT));
    lines
}

/// A line from the first point to one of the others, and from that line the shortest ones to all the rest, whichever is the least
/// to draw: a spine and shoulders.
fn joined(points: &[Vector3<f64>]) -> Lines {
    let (first, rest) = (points[0], &points[1..]);
    let drawn = |end: &Vector3<f64>| -> Lines {
        let spine = end - first;
        let from = |point: &Vector3<f64>| {
            let share = if spine.norm() > SHORT { (point - first).dot(&spine) / spine.norm_squared() } else { 0.0 };
            first + share.clamp(0.0, 1.0) * spine
        };
        std::iter::once(vec![first, *end]).chain(rest.iter().map(|point| vec![from(point), *point])).collect()
    };
    let ink = |lines: &Lines| -> f64 { lines.iter().map(|line| (line[1] - line[0]).norm()).sum() };
    rest.iter().map(drawn).min_by(|a, b| ink(a).total_cmp(&ink(b))).unwrap_or_default()
}

/// A ring seen from the front and one seen from the side: a ball in both views.
fn circle(center: Vector3<f64>, radius: f64, model: &Model) -> Lines {
    const CORNERS: u32 = 32;
    let [right, ahead, up] = directions(model);
    let ring = |across: Vector3<f64>| {
        let corner = |i: u32| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(CORNERS)).sin_cos();
            center + radius * (cos * across + sin * up)
        };
        (0..=CORNERS).map(corner).collect()
    };
    vec![ring(right), ring(ahead)]
}
