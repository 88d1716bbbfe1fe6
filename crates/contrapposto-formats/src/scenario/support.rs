//! What carries the body: segments become patches with corners, planes and friction.

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{LARGEST, Model};
use nalgebra::Vector3;

use super::Located;
use super::convert::shown;
use super::task_text::{OnText, SupportText};
use crate::input_error::{InputError, suggestion};

/// Friction of a support that names none: shoe on floor.
const FRICTION: f64 = 0.6;
/// How far the middle of a patch may be from the plane it stands on, m.
const NEAR: f64 = 0.05;

/// The segment of support number `i`; each may be named once.
pub(super) fn segment(
    at: &Located,
    model: &Model,
    i: usize,
    text: &SupportText,
    before: &[usize],
) -> Result<usize, InputError> {
    let path = ["support", &i.to_string(), "segment"];
    let Some(segment) = model.segment(&text.segment) else {
        let help = suggestion(&text.segment, model.segments().iter().map(|s| s.name.as_str()));
        return Err(at.error(&path, format!("the body has no segment `{}`", text.segment), help));
    };
    if before.contains(&segment) {
        let message = format!("`{}` is a support already", text.segment);
        return Err(at.error(&path, message, Some("keep one of the two".to_owned())));
    }
    Ok(segment)
}

/// Are the numbers of support number `i` in order?
pub(super) fn numbers(at: &Located, i: usize, text: &SupportText) -> Result<(), InputError> {
    let error = |key: &str, message: String| Err(at.error(&["support", &i.to_string(), key], message, None));
    for (key, value, most) in [("friction", text.friction, 10.0), ("share_max", text.share_max, 1.0)] {
        if let Some(value) = value.filter(|value| !(0.0..=most).contains(value)) {
            return error(key, format!("{key} is {}; it must lie in 0..{most}", shown(value)));
        }
    }
    if let Some(corners) = &text.corners_m
        && (!(1..=64).contains(&corners.len()) || corners.iter().flatten().any(|value| value.abs() > LARGEST))
    {
        return error("corners_m", "a patch has 1 to 64 corners, none farther than 1e9 m".to_owned());
    }
    if let OnText::Plane(plane) = &text.on
        && plane.normal.iter().chain(plane.point_m.iter().flatten()).any(|value| value.abs() > LARGEST)
    {
        return error("on", "a number of the plane is too large; 1e9 at most".to_owned());
    }
    Ok(())
}

/// All supports of a scenario, in its start.
pub(super) fn supports(
    at: &Located,
    model: &Model,
    texts: &[SupportText],
    kinematics: &Kinematics,
) -> Result<Vec<Support>, InputError> {
    let mut supports: Vec<Support> = vec![];
    for (i, text) in texts.iter().enumerate() {
        let before: Vec<usize> = supports.iter().map(|support| support.segment).collect();
        let segment = segment(at, model, i, text, &before)?;
        numbers(at, i, text)?;
        let number = i.to_string();
        let error =
            |key: &str, message: String, help: Option<String>| at.error(&["support", &number, key], message, help);
        let corners: Vec<Vector3<f64>> = match &text.corners_m {
            Some(corners) => corners.iter().copied().map(Vector3::from).collect(),
            None => model.segments()[segment].patch.clone(),
        };
        if corners.is_empty() {
            let message = format!("where `{}` touches its support is not known", text.segment);
            let help = "add `corners_m = [[x, y, z], ...]`, corners of the patch in the segment's frame".to_owned();
            return Err(error("segment", message, Some(help)));
        }
        let up = -model.gravity();
        let normal = match &text.on {
            OnText::Named(_) => up,
            OnText::Plane(plane) => Vector3::from(plane.normal),
        };
        let Some(normal) = normal.try_normalize(1e-9) else {
            let message = match &text.on {
                OnText::Named(_) => "without gravity there is no ground; give a plane with its normal".to_owned(),
                OnText::Plane(_) => "the normal of the plane has no length".to_owned(),
            };
            return Err(error("on", message, None));
        };
        if let OnText::Plane(plane) = &text.on
            && let Some(point) = plane.point_m
        {
            let stations = corners.iter().map(|corner| kinematics.station(model, segment, *corner));
            let middle = stations.sum::<Vector3<f64>>() / corners.len() as f64;
            let away = normal.dot(&(middle - Vector3::from(point)));
            if away.is_nan() || away.abs() > NEAR {
                let message = format!(
                    "at the start the patch of `{}` is {} m off this plane; {NEAR} m at most",
                    text.segment,
                    shown((away * 1e4).round() / 1e4)
                );
                let help = "change [posture], or the plane; a support stays where it is at the start".to_owned();
                return Err(error("on", message, Some(help)));
            }
        }
        let friction = text.friction.unwrap_or(FRICTION);
        supports.push(Support { segment, corners, normal, friction, share_max: text.share_max.unwrap_or(1.0) });
    }
    Ok(supports)
}
