//! Reads what the body does not pass through: its own parts, the floor, and the obstacles of the file.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{LARGEST, Model};
use contrapposto::tasks::{Clearance, Task, Thing};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::obstacle_text::ObstacleText;
use super::text::ScenarioText;
use crate::input_error::InputError;
use crate::toml_file::{Located, shown};

/// The obstacles of the file and of its things, by name.
pub(super) fn obstacles(at: &Located, texts: &[&ObstacleText]) -> Result<Vec<(String, Thing)>, InputError> {
    let named = |(i, text): (usize, &&ObstacleText)| Ok((text.name.clone(), obstacle(at, &i.to_string(), text)?));
    texts.iter().enumerate().map(named).collect()
}

/// The inequalities above all tasks: none for a body without shapes, or where the file turns them off. `standing`: the segments of
/// the supports, in the posture of `kinematics`.
pub(super) fn limits(
    at: &Located,
    text: &ScenarioText,
    obstacles: &[(String, Thing)],
    (model, standing): (&Model, &[usize]),
    kinematics: &Kinematics,
) -> Result<Vec<Task>, InputError> {
    let refuse = |path: &[&str], message: &str, help: &str| Err(at.key_error(path, message, Some(help.to_owned())));
    if text.model.file.is_some() {
        let help = "leave it out; only the built-in adult has them";
        if text.model.clearance.is_some() {
            return refuse(&["model", "clearance"], "the parts of a model file have no shapes", help);
        }
        if !obstacles.is_empty() {
            return refuse(&["obstacle"], "the parts of a model file have no shapes to keep off obstacles", help);
        }
    }
    if text.model.clearance == Some(false) {
        if !obstacles.is_empty() {
            let help = "leave out [[obstacle]], or `clearance = false`";
            return refuse(&["obstacle"], "with `clearance = false` the body passes through obstacles", help);
        }
        return Ok(vec![]);
    }
    let mut things = vec![Thing::floor(floor(model, standing, kinematics))];
    things.extend(obstacles.iter().map(|(_, thing)| *thing));
    Ok(Clearance::of_body(model, &things, standing).map(Task::Clearance).into_iter().collect())
}

/// The obstacles that have a size, for drawings.
pub(super) fn boxes(obstacles: &[(String, Thing)]) -> impl Iterator<Item = crate::Thing> {
    obstacles.iter().filter_map(|(name, thing)| match thing {
        Thing::Block { placement, half } => Some(crate::Thing::new(name, (2.0 * half).into(), *placement, None)),
        Thing::HalfSpace { .. } => None,
    })
}

/// Height of the floor, m: ground, or the lowest corner of a support if it lies deeper.
fn floor(model: &Model, standing: &[usize], kinematics: &Kinematics) -> f64 {
    let corners = standing.iter().flat_map(|&segment| {
        model.segments()[segment].patch.iter().map(move |corner| kinematics.station(model, segment, *corner).y)
    });
    corners.fold(0.0, f64::min)
}

fn obstacle(at: &Located, number: &str, text: &ObstacleText) -> Result<Thing, InputError> {
    let error = |key: &str, message: String| at.error(&["obstacle", number, key], message, None);
    let block = text.middle_m.is_some() || text.size_m.is_some() || text.turn_deg.is_some();
    let wall = text.normal.is_some() || text.point_m.is_some();
    let given = [text.middle_m, text.size_m, text.normal, text.point_m];
    if let Some(value) =
        given.into_iter().flatten().flatten().chain(text.turn_deg).find(|v| v.is_nan() || v.abs() > LARGEST)
    {
        return Err(error("name", format!("a number of `{}` is {}; 1e9 at most", text.name, shown(value))));
    }
    match (text.middle_m, text.size_m, text.normal, text.point_m) {
        (Some(middle), Some(size), ..) if !wall => {
            if let Some(length) = size.iter().find(|length| **length <= 0.0) {
                return Err(error("size_m", format!("a length is {} m; it must be greater than 0", shown(*length))));
            }
            let turn = text.turn_deg.unwrap_or(0.0).to_radians();
            let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), turn);
            let placement = Isometry3::from_parts(Vector3::from(middle).into(), turn);
            Ok(Thing::Block { placement, half: 0.5 * Vector3::from(size) })
        }
        (_, _, Some(normal), Some(point)) if !block => {
            let normal = Vector3::from(normal).try_normalize(1e-9);
            let normal = normal.ok_or_else(|| error("normal", "the normal of the wall has no length".to_owned()))?;
            Ok(Thing::HalfSpace { normal, offset: normal.dot(&Vector3::from(point)) })
        }
        _ => {
            let message = format!("`{}` is neither a block nor a wall", text.name);
            let help = "give `middle_m` and `size_m` of a block, or `normal` and `point_m` of a wall";
            Err(at.error(&["obstacle", number, "name"], message, Some(help.to_owned())))
        }
    }
}
