//! Adds the task `head upright` where a scenario says nothing of head and trunk, and `head level` where it says only the gaze.
//!
//! A person who stands, sits or leans looks ahead unless a task turns the head elsewhere. The task asks the head's up axis (that which
//! points up in the body's default posture) to point along minus gravity: two rows, above effort and below all other tasks. A person
//! whose hand is at work below the hips bends and looks there: with the head upright the neck would be at the end of its range.
//!
//! A gaze (`look_at`) leaves the roll of the head free, and least effort lets it hang to one side on the ligaments of the neck. A person
//! keeps the eyes level. The task asks the line from eye to eye to be horizontal: one row, above effort and below all other tasks. Who looks
//! at the own hands at work tilts the head as the trunk is tilted: with level eyes the neck would be bent sideways to the end of its range
//! above a trunk that leans, so nothing is added there.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::tasks::{Bounds, Carried, Component, LookAt, LookAtGoal, Task};
use nalgebra::{Unit, UnitVector3, Vector3};

use super::levels::{Level, add_above_effort};
use super::posture::free;
use super::stage::Stage;
use super::text::ScenarioText;
use crate::input_error::InputError;

/// Segment that the task turns.
const HEAD: &str = "head";
/// Segments of head and trunk: a task of one of them says where the head is, and the default is left out.
const HEAD_AND_TRUNK: [&str; 3] = [HEAD, "torso", "abdomen"];
/// Coordinates that turn the head against the trunk, in the built-in adult. Where none of them is free, the default is left out.
const NECK: [&str; 2] = ["neck_extension", "neck_bending"];
/// Segments of a hand at work.
const HANDS: [&str; 6] = ["hand_r", "hand_l", "radius_r", "radius_l", "ulna_r", "ulna_l"];
/// A gaze that meets its target nearer than this to the target of a hand, m, is on the work of that hand (assumed: a tool's length).
const AT_WORK: f64 = 0.4;
/// Segments whose joints are the hips.
const THIGHS: [&str; 2] = ["femur_r", "femur_l"];
/// Note for the reader where the task was added by default.
const UPRIGHT_NOTE: &str =
    "no task names head or trunk; `head upright` was added just above effort (`upright = false` leaves it out)";
const LEVEL_NOTE: &str = "a gaze leaves the tilt of the head free; `head level` was added just above effort (`upright = false` leaves it out)";

/// Adds the task, if the file asks for it or leaves it to the default. Returns a note for the reader where the file says nothing.
pub(super) fn add_upright(
    stage: &Stage<'_>,
    text: &ScenarioText,
    levels: &mut Vec<Level>,
) -> Result<Option<&'static str>, InputError> {
    let Stage { at, model, .. } = *stage;
    let (task, note) = match text.upright {
        Some(true) => {
            let task = upright(model).ok_or_else(|| {
                let help = "leave it out; a task of kind `look_at` or `orientation` turns any segment".to_owned();
                at.error(&["upright"], "the body has no segment `head`, or no gravity says where up is", Some(help))
            })?;
            (task, None)
        }
        Some(false) => return Ok(None),
        None => match default_task(stage, text, levels)? {
            Some((task, note)) => (task, Some(note)),
            None => return Ok(None),
        },
    };
    add_above_effort(levels, task.into(), model);
    Ok(note)
}

/// The content of tasks about head and trunk, the least first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Said {
    Nothing,
    /// A direction of the head, about which it may roll.
    Gaze,
    All,
}

/// The default of the built-in adult on supports, with a neck that is free, without a support of the head, and without a hand at work
/// below the hips: `head upright` where no task says anything of head and trunk, `head level` where tasks say only the gaze and it is not
/// on a hand at work. A posture task says all if it weighs a coordinate of the neck.
fn default_task(
    stage: &Stage<'_>,
    text: &ScenarioText,
    levels: &[Level],
) -> Result<Option<(Task, &'static str)>, InputError> {
    let (model, supports) = (stage.model, stage.supports);
    if text.model.file.is_some() || supports.is_empty() {
        return Ok(None);
    }
    let free = free(stage.at, model, text, |_| true)?;
    let neck: Vec<usize> = NECK.iter().filter_map(|name| model.coordinate(name)).filter(|&i| free[i]).collect();
    let lies = supports.iter().any(|&segment| model.segments()[segment].name == HEAD);
    let tasks = || levels.iter().flat_map(|level| &level.tasks.tasks);
    if neck.is_empty() || lies || tasks().any(|task| works_below_the_hips(stage, task)) {
        return Ok(None);
    }
    Ok(match tasks().map(|task| said(model, &neck, task)).max() {
        None | Some(Said::Nothing) => upright(model).map(|task| (task, UPRIGHT_NOTE)),
        Some(Said::Gaze) if !tasks().any(|gaze| tasks().any(|work| is_on_work(stage, gaze, work))) => {
            level(model).map(|task| (task, LEVEL_NOTE))
        }
        Some(Said::Gaze | Said::All) => None,
    })
}

/// The content of one task about head and trunk.
fn said(model: &Model, neck: &[usize], task: &Task) -> Said {
    let named = |segment: usize| HEAD_AND_TRUNK.contains(&model.segments()[segment].name.as_str());
    let says = match task {
        Task::LookAt(task) if model.segments()[task.segment].name == HEAD => return Said::Gaze,
        Task::Point(task) => named(task.segment),
        Task::Orientation(task) => named(task.segment),
        Task::Placement(task) => named(task.segment),
        Task::LookAt(task) => named(task.segment),
        Task::Bounds(task) => named(task.segment),
        Task::Distance(task) => named(task.a.0) || named(task.b.0),
        Task::Height(task) => named(task.segment),
        Task::Posture(task) => {
            neck.iter().any(|&i| model.coordinates()[i].rate.is_some_and(|rate| task.weights[rate] > 0.0))
        }
        Task::CenterOfMass(_) | Task::Clearance(_) | Task::Effort(_) => false,
    };
    if says { Said::All } else { Said::Nothing }
}

/// Whether a task takes a hand to a place that is lower than the hips are at the start.
fn works_below_the_hips(stage: &Stage<'_>, task: &Task) -> bool {
    let model = stage.model;
    let height = |place: &Vector3<f64>| -model.gravity().dot(place);
    let hips = THIGHS.iter().filter_map(|name| model.segment(name));
    let mut hips = hips.map(|thigh| stage.kinematics.placement(model, thigh).translation.vector);
    hand_target(stage, task).is_some_and(|target| hips.all(|hip| height(&target) < height(&hip)))
}

/// Whether a gaze meets its target where a task takes a hand.
fn is_on_work(stage: &Stage<'_>, gaze: &Task, work: &Task) -> bool {
    let Task::LookAt(LookAt { goal: LookAtGoal::Place(place), .. }) = gaze else { return false };
    hand_target(stage, work).is_some_and(|target| (target - place).norm() < AT_WORK)
}

/// The place to which a task takes a hand, ground, m; `None` of other tasks.
fn hand_target(stage: &Stage<'_>, task: &Task) -> Option<Vector3<f64>> {
    let model = stage.model;
    let (segment, target) = match task {
        Task::Point(task) => {
            let mut target = stage.kinematics.station(model, task.segment, task.point);
            (0..3).filter(|&axis| task.axes[axis]).for_each(|axis| target[axis] = task.target[axis]);
            (task.segment, target)
        }
        Task::Placement(task) => (task.segment, task.target.translation.vector),
        _ => return None,
    };
    HANDS.contains(&model.segments()[segment].name.as_str()).then_some(target)
}

/// The head's up axis along minus gravity; `None` for a body without head or gravity.
fn upright(model: &Model) -> Option<Task> {
    let (segment, up, direction) = up_axis(model)?;
    Some(Task::LookAt(LookAt { segment, eye: Vector3::zeros(), direction, goal: LookAtGoal::Direction(up) }))
}

/// The head's axis from one side to the other square to gravity; `None` for a body without head or gravity.
fn level(model: &Model) -> Option<Task> {
    let (segment, up, direction) = up_axis(model)?;
    // The head of the built-in adult looks along its x.
    let across = Unit::try_new(Vector3::x().cross(&direction), 1e-9)?;
    let component = Component { of: Carried::Direction(across), along: up, limits: (0.0, 0.0) };
    Some(Task::Bounds(Bounds { segment, components: vec![component] }))
}

/// The head, upward in ground, and the head's axis that points there in the default posture.
fn up_axis(model: &Model) -> Option<(usize, UnitVector3<f64>, UnitVector3<f64>)> {
    let segment = model.segment(HEAD)?;
    let up: UnitVector3<f64> = Unit::try_new(-model.gravity(), 1e-9)?;
    Some((segment, up, Kinematics::new(model).placement(model, segment).rotation.inverse() * up))
}
