//! Adds the task `head upright` where a scenario says nothing of head and trunk.
//!
//! A person who stands, sits or leans looks ahead unless a task turns the head elsewhere. The task asks the head's up axis (that which
//! points up in the body's default posture) to point along minus gravity: two rows, above effort and below all other tasks. A person
//! whose hand is at work below the hips bends and looks there: with the head upright the neck would be at the end of its range.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::tasks::{LookAt, LookAtGoal, Task};
use nalgebra::{Unit, UnitVector3, Vector3};

use super::levels::Level;
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
/// Segments whose joints are the hips.
const THIGHS: [&str; 2] = ["femur_r", "femur_l"];
/// Note for the reader where the task was added by default.
const NOTE: &str =
    "no task names head or trunk; `head upright` was added just above effort (`upright = false` leaves it out)";

/// Adds the task, if the file asks for it or leaves it to the default. Returns a note for the reader where the file says nothing.
pub(super) fn add_upright(
    stage: &Stage<'_>,
    text: &ScenarioText,
    levels: &mut Vec<Level>,
) -> Result<Option<&'static str>, InputError> {
    let Stage { at, model, .. } = *stage;
    let wanted = match text.upright {
        Some(wanted) => wanted,
        None => is_default(stage, text, levels)?,
    };
    if !wanted {
        return Ok(None);
    }
    let task = task(model).ok_or_else(|| {
        let help = "leave it out; a task of kind `look_at` or `orientation` turns any segment".to_owned();
        at.error(&["upright"], "the body has no segment `head`, or no gravity says where up is", Some(help))
    })?;
    let effort = |level: &Level| level.tasks.tasks.iter().any(|task| matches!(task, Task::Effort(_)));
    let place = levels.iter().position(effort).unwrap_or(levels.len());
    let labels = vec![task.label(model)];
    levels.insert(place, Level { tasks: task.into(), labels, above_relief: false, added: true });
    Ok(text.upright.is_none().then_some(NOTE))
}

/// Whether the default asks for it: the built-in adult on supports, with a neck that is free, without a task of head or trunk, without
/// a support of the head, and without a hand at work below the hips. A posture task names the head if it weighs a coordinate of the
/// neck.
fn is_default(stage: &Stage<'_>, text: &ScenarioText, levels: &[Level]) -> Result<bool, InputError> {
    let (model, supports) = (stage.model, stage.supports);
    if text.model.file.is_some() || supports.is_empty() || task(model).is_none() {
        return Ok(false);
    }
    let free = free(stage.at, model, text, |_| true)?;
    let neck: Vec<usize> = NECK.iter().filter_map(|name| model.coordinate(name)).filter(|&i| free[i]).collect();
    let named = |segment: usize| HEAD_AND_TRUNK.contains(&model.segments()[segment].name.as_str());
    let says = |task: &Task| match task {
        Task::Point(task) => named(task.segment),
        Task::Orientation(task) => named(task.segment),
        Task::Placement(task) => named(task.segment),
        Task::LookAt(task) => named(task.segment),
        Task::Bounds(task) => named(task.segment),
        Task::Distance(task) => named(task.a.0) || named(task.b.0),
        Task::Posture(task) => {
            neck.iter().any(|&i| model.coordinates()[i].rate.is_some_and(|rate| task.weights[rate] > 0.0))
        }
        Task::CenterOfMass(_) | Task::Clearance(_) | Task::Effort(_) => false,
    };
    let lies = supports.iter().any(|&segment| model.segments()[segment].name == HEAD);
    let mut tasks = levels.iter().flat_map(|level| &level.tasks.tasks);
    Ok(!neck.is_empty() && !lies && !tasks.any(|task| says(task) || works_below_the_hips(stage, task)))
}

/// Whether a task takes a hand to a place that is lower than the hips are at the start.
fn works_below_the_hips(stage: &Stage<'_>, task: &Task) -> bool {
    let model = stage.model;
    let height = |place: &Vector3<f64>| -model.gravity().dot(place);
    let (segment, target) = match task {
        Task::Point(task) => {
            let mut target = stage.kinematics.station(model, task.segment, task.point);
            (0..3).filter(|&axis| task.axes[axis]).for_each(|axis| target[axis] = task.target[axis]);
            (task.segment, target)
        }
        Task::Placement(task) => (task.segment, task.target.translation.vector),
        _ => return false,
    };
    let hips = THIGHS.iter().filter_map(|name| model.segment(name));
    let mut hips = hips.map(|thigh| stage.kinematics.placement(model, thigh).translation.vector);
    HANDS.contains(&model.segments()[segment].name.as_str()) && hips.all(|hip| height(&target) < height(&hip))
}

/// The head's up axis along minus gravity; `None` for a body without head or gravity.
fn task(model: &Model) -> Option<Task> {
    let segment = model.segment(HEAD)?;
    let up: UnitVector3<f64> = Unit::try_new(-model.gravity(), 1e-9)?;
    let direction = Kinematics::new(model).placement(model, segment).rotation.inverse() * up;
    Some(Task::LookAt(LookAt { segment, eye: Vector3::zeros(), direction, goal: LookAtGoal::Direction(up) }))
}
