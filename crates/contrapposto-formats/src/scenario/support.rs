//! Reads what carries the body: segments with their patches, planes and friction.

use contrapposto::contact::{Place, Support};
use contrapposto::model::{LARGEST, Model};
use nalgebra::Vector3;

use super::names;
use super::surface::Resting;
use super::task_text::{GroundText, OnText, SupportText};
use crate::input_error::InputError;
use crate::toml_file::{Located, shown};

/// Friction of a support that names none: shoe on floor.
const FRICTION: f64 = 0.6;
/// Highest step, m.
const HIGHEST_STEP: f64 = 2.0;
/// Segments of the built-in adult that stand on the floor unless the file says otherwise.
pub(super) const FEET: [&str; 6] = ["calcn_r", "calcn_l", "toes_r", "toes_l", "talus_r", "talus_l"];
/// Segments whose patch is flesh: it takes the shape of its surface (assumed).
const SOFT: [&str; 5] = ["pelvis", "abdomen", "torso", "femur_r", "femur_l"];

/// The segments of all supports, each named once; and checks their numbers.
pub(super) fn segments(at: &Located, model: &Model, texts: &[&SupportText]) -> Result<Vec<usize>, InputError> {
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
    if let Some(step) = text.step_m.filter(|step| !(0.0..=HIGHEST_STEP).contains(step)) {
        return error(
            "step_m",
            format!("step_m is {} m; it must lie in 0..{HIGHEST_STEP}, above the floor", shown(step)),
        );
    }
    if let Some(OnText::Plane(plane)) = &text.on
        && plane.normal.iter().chain(plane.point_m.iter().flatten()).any(|value| value.abs() > LARGEST)
    {
        return error("on", "a number of the plane is too large; 1e9 at most".to_owned());
    }
    Ok(())
}

/// All supports of a scenario with their planes. `segments`: those of [`segments`]. `built_in`: the body is the built-in adult.
pub(super) fn resting(
    at: &Located,
    built_in: bool,
    model: &Model,
    (texts, segments): (&[&SupportText], &[usize]),
) -> Result<Vec<Resting>, InputError> {
    let resting = |(i, (&text, &segment)): (usize, (&&SupportText, &usize))| {
        let name = model.segments()[segment].name.as_str();
        let reader = Reader { at, model, text, segment, number: i.to_string() };
        let corners = reader.corners()?;
        let on = reader.on(built_in && FEET.contains(&name))?;
        let normal = reader.normal(on)?;
        let (height, on_floor) = match on {
            OnText::Named(GroundText::Ground) => (None, false),
            OnText::Named(GroundText::Floor) => (Some(text.step_m.unwrap_or(0.0)), true),
            OnText::Plane(plane) => (plane.point_m.map(|point| normal.dot(&Vector3::from(point))), false),
        };
        let (friction, share_max) = (text.friction.unwrap_or(FRICTION), text.share_max.unwrap_or(1.0));
        let support = Support { segment, corners, normal, friction, share_max, place: Place::Fixed };
        Ok(Resting { support, height, on_floor, soft: SOFT.contains(&name) })
    };
    texts.iter().zip(segments).enumerate().map(resting).collect()
}

/// Reads one support.
struct Reader<'a> {
    at: &'a Located<'a>,
    model: &'a Model,
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

    /// The surface: that of the file, else the floor for a foot and under a step, else level ground.
    fn on(&self, foot: bool) -> Result<OnText, InputError> {
        let floor = OnText::Named(GroundText::Floor);
        let otherwise = if foot || self.text.step_m.is_some() { floor } else { OnText::Named(GroundText::Ground) };
        let on = self.text.on.unwrap_or(otherwise);
        if self.text.step_m.is_some() && !matches!(on, OnText::Named(GroundText::Floor)) {
            let help = Some("leave out one of the two; a plane has its height in `point_m`".to_owned());
            let path = ["support", &self.number, "step_m"];
            return Err(self.at.key_error(&path, "`step_m` goes with `on = \"floor\"`", help));
        }
        Ok(on)
    }

    /// The direction in which the support pushes.
    fn normal(&self, on: OnText) -> Result<Vector3<f64>, InputError> {
        let (normal, message) = match on {
            OnText::Named(_) => (
                -self.model.gravity(),
                "without gravity there is neither floor nor ground; give a plane with its normal",
            ),
            OnText::Plane(plane) => (Vector3::from(plane.normal), "the normal of the plane has no length"),
        };
        normal.try_normalize(1e-9).ok_or_else(|| self.error("on", message.to_owned(), None))
    }

    fn error(&self, key: &str, message: String, help: Option<String>) -> InputError {
        self.at.error(&["support", &self.number, key], message, help)
    }
}
