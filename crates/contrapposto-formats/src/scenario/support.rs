//! Reads what carries the body: segments with their patches, planes and friction.

use contrapposto::contact::{Place, Support};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{LARGEST, Model};
use nalgebra::Vector3;

use super::names;
use super::task_text::{OnText, PlaneText, SupportText};
use crate::input_error::InputError;
use crate::toml_file::{Located, shown};

/// Friction of a support that names none: shoe on floor.
const FRICTION: f64 = 0.6;
/// How far the middle of a patch may be from the plane it stands on, m.
const LARGEST_GAP: f64 = 0.05;

/// The segments of all supports, each named once; and checks their numbers.
pub(super) fn segments(at: &Located, model: &Model, texts: &[SupportText]) -> Result<Vec<usize>, InputError> {
    let mut segments: Vec<usize> = vec![];
    for (i, text) in texts.iter().enumerate() {
        let path = ["support", &i.to_string(), "segment"];
        let segment = names::segment(at, model, &path, &text.segment)?;
        if segments.contains(&segment) {
            let message = format!("`{}` is a support already", text.segment);
            return Err(at.error(&path, message, Some("keep one of the two".to_owned())));
        }
        check_numbers(at, i, text)?;
        segments.push(segment);
    }
    Ok(segments)
}

/// Checks the numbers of support number `i`.
fn check_numbers(at: &Located, i: usize, text: &SupportText) -> Result<(), InputError> {
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

/// All supports of a scenario, in its start. `segments`: those of [`segments`].
pub(super) fn supports(
    at: &Located,
    model: &Model,
    texts: &[SupportText],
    segments: &[usize],
    kinematics: &Kinematics,
) -> Result<Vec<Support>, InputError> {
    let support = |(i, (text, &segment)): (usize, (&SupportText, &usize))| {
        let reader = Reader { at, model, kinematics, text, segment, number: i.to_string() };
        let corners = reader.corners()?;
        let normal = reader.normal()?;
        if let OnText::Plane(PlaneText { point_m: Some(point), .. }) = text.on {
            reader.check_gap(&corners, normal, point.into())?;
        }
        let (friction, share_max) = (text.friction.unwrap_or(FRICTION), text.share_max.unwrap_or(1.0));
        Ok(Support { segment, corners, normal, friction, share_max, place: Place::Fixed })
    };
    texts.iter().zip(segments).enumerate().map(support).collect()
}

/// Reads one support.
struct Reader<'a> {
    at: &'a Located<'a>,
    model: &'a Model,
    kinematics: &'a Kinematics,
    text: &'a SupportText,
    segment: usize,
    number: String,
}

impl Reader<'_> {
    /// Corners of the patch in the segment's frame, m.
    fn corners(&self) -> Result<Vec<Vector3<f64>>, InputError> {
        let corners: Vec<Vector3<f64>> = match &self.text.corners_m {
            Some(corners) => corners.iter().copied().map(Vector3::from).collect(),
            None => self.model.segments()[self.segment].patch.clone(),
        };
        if corners.is_empty() {
            let message = format!("where `{}` touches its support is not known", self.text.segment);
            let help = "add `corners_m = [[x, y, z], ...]`, corners of the patch in the segment's frame".to_owned();
            return Err(self.error("segment", message, Some(help)));
        }
        Ok(corners)
    }

    /// The direction in which the support pushes.
    fn normal(&self) -> Result<Vector3<f64>, InputError> {
        let (normal, message) = match &self.text.on {
            OnText::Named(_) => {
                (-self.model.gravity(), "without gravity there is no ground; give a plane with its normal")
            }
            OnText::Plane(plane) => (Vector3::from(plane.normal), "the normal of the plane has no length"),
        };
        normal.try_normalize(1e-9).ok_or_else(|| self.error("on", message.to_owned(), None))
    }

    /// Checks that at the start the middle of the patch lies near the plane through `point`.
    fn check_gap(&self, corners: &[Vector3<f64>], normal: Vector3<f64>, point: Vector3<f64>) -> Result<(), InputError> {
        let stations = corners.iter().map(|corner| self.kinematics.station(self.model, self.segment, *corner));
        let middle = stations.sum::<Vector3<f64>>() / corners.len() as f64;
        let gap = normal.dot(&(middle - point));
        if gap.abs() <= LARGEST_GAP {
            return Ok(());
        }
        let message = format!(
            "at the start the patch of `{}` is {} m off this plane; {LARGEST_GAP} m at most",
            self.text.segment,
            shown((gap * 1e4).round() / 1e4)
        );
        let help = "change [posture], or the plane; a support stays where it is at the start".to_owned();
        Err(self.error("on", message, Some(help)))
    }

    fn error(&self, key: &str, message: String, help: Option<String>) -> InputError {
        self.at.error(&["support", &self.number, key], message, help)
    }
}
