//! Adds the task that arms without work hang.
//!
//! Least effort uses an idle arm as a counterweight: it is held behind the body for hours to spare the lumbar spine a little. A person lets it
//! hang. The task asks the line from shoulder to elbow to point down within [`NEUTRAL`]: one row an arm, above effort and below all other tasks.
//! Within that angle, effort decides.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::statics::Load;
use contrapposto::tasks::{Bounds, Carried, Component, PriorityLevel, Task};
use nalgebra::{Unit, UnitVector3};

use super::levels::{Level, add_above_effort};
use super::posture::free;
use super::stage::Stage;
use super::text::ScenarioText;
use crate::input_error::InputError;

/// The segments of each arm, the upper arm first.
const ARMS: [[&str; 4]; 2] =
    [["humerus_r", "ulna_r", "radius_r", "hand_r"], ["humerus_l", "ulna_l", "radius_l", "hand_l"]];
/// Coordinates that lift each arm, in the built-in adult. Where none of them is free, the arm is left out.
const SHOULDERS: [[&str; 2]; 2] = [["arm_flex_r", "arm_add_r"], ["arm_flex_l", "arm_add_l"]];
/// Greatest angle between a hanging upper arm and the vertical, rad: up to 20 deg of flexion and of extension an upper arm counts as neutral
/// (McAtamney & Corlett 1993, RULA, step 1; of the trunk there, of the vertical here; for abduction assumed).
const NEUTRAL: f64 = 20.0 * std::f64::consts::PI / 180.0;
/// Note for the reader where the task was added by default.
const ARMS_HANG_NOTE: &str = "no task names an arm that carries nothing; that it hangs was added just above effort (`arms_hang = false` leaves it out)";

/// Adds the task for arms that hang at the start and that no task, no support and no load names, if the file asks for it or leaves it to the
/// default: that of the built-in adult on supports. An arm whose hand a rest may carry hangs until it does. Returns a note for the reader where
/// the file says nothing.
pub(super) fn add_hanging_arms(
    stage: &Stage<'_>,
    text: &ScenarioText,
    loads: &[Load],
    levels: &mut Vec<Level>,
) -> Result<Option<&'static str>, InputError> {
    let Stage { at, model, supports, .. } = *stage;
    let by_default = text.model.file.is_none() && !supports.is_empty();
    if !text.arms_hang.unwrap_or(by_default) {
        return Ok(None);
    }
    let free = free(at, model, text, |_| true)?;
    let is_named = |segment: usize| {
        let tasks = levels.iter().flat_map(|level| &level.tasks.tasks);
        supports.contains(&segment)
            || loads.iter().any(|load| load.segment == segment)
            || tasks.into_iter().any(|task| task.concerns(model, segment))
    };
    let task = |(arm, shoulder): (&[&str; 4], &[&str; 2])| {
        let (upper, axis) = axis(model, arm)?;
        let down: UnitVector3<f64> = Unit::try_new(model.gravity(), 1e-9)?;
        let hangs_at_start = stage.kinematics.direction(model, upper, axis.into_inner()).dot(&down) > 0.0;
        let is_idle = !arm.iter().filter_map(|name| model.segment(name)).any(is_named);
        let limits = (libm::cos(NEUTRAL), f64::INFINITY);
        let component = Component { of: Carried::Direction(axis), along: down, limits };
        let mut turns = shoulder.iter().filter_map(|name| model.coordinate(name)).peekable();
        let can_move = turns.peek().is_none() || turns.any(|coordinate| free[coordinate]);
        (hangs_at_start && is_idle && can_move)
            .then(|| Task::Bounds(Bounds { segment: upper, components: vec![component] }))
    };
    let tasks: Vec<Task> = ARMS.iter().zip(&SHOULDERS).filter_map(task).collect();
    if !tasks.is_empty() {
        add_above_effort(levels, PriorityLevel { tasks, ..PriorityLevel::default() }, model);
        return Ok(text.arms_hang.is_none().then_some(ARMS_HANG_NOTE));
    }
    if text.arms_hang.is_some() && !ARMS.iter().any(|arm| model.segment(arm[0]).is_some()) {
        let help = "leave it out; a task of kind `look_at` turns any segment".to_owned();
        return Err(at.error(&["arms_hang"], "the body has no segment `humerus_r` or `humerus_l`", Some(help)));
    }
    Ok(None)
}

/// An upper arm and its axis from the shoulder to the elbow, segment frame; `None` for a body without it.
fn axis(model: &Model, [upper, forearm, ..]: &[&str; 4]) -> Option<(usize, UnitVector3<f64>)> {
    let (upper, forearm) = (model.segment(upper)?, model.segment(forearm)?);
    let kinematics = Kinematics::new(model);
    let elbow = kinematics.placement(model, forearm).translation.vector;
    let local = kinematics.placement(model, upper).inverse_transform_point(&elbow.into());
    Some((upper, Unit::try_new(local.coords, 1e-9)?))
}
