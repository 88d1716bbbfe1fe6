//! Reads tasks: names become indices, degrees radians, and words the numbers they stand for.

use contrapposto::model::{LARGEST, Placement as Pose};
use contrapposto::tasks::{
    CenterOfMass, CenterOfMassGoal, Distance, Effort, LookAt, LookAtGoal, Orientation, Placement, Point, Posture, Task,
    TaskError,
};
use nalgebra::{Quaternion, Unit, UnitQuaternion, UnitVector3, Vector3};

use super::error_keys::task_path;
use super::names;
use super::polygon::polygon;
use super::posture::{UNIT, rates, set};
use super::stage::Stage;
use super::task_text::{COMMON_KEYS, PointText, TaskKindText, TaskText};
use crate::input_error::InputError;
use crate::toml_file::shown;

/// The task number `i` of the file, counted from 0.
pub(super) fn task(stage: &Stage<'_>, i: usize, text: &TaskText) -> Result<Task, InputError> {
    let reader = Reader { stage, text, number: i.to_string() };
    reader.check_keys()?;
    let task = match text.kind {
        TaskKindText::Point => reader.point()?,
        TaskKindText::Orientation => reader.orientation()?,
        TaskKindText::Placement => reader.placement()?,
        TaskKindText::LookAt => reader.look_at()?,
        TaskKindText::Distance => reader.distance()?,
        TaskKindText::CenterOfMass => reader.center_of_mass()?,
        TaskKindText::Posture => reader.posture()?,
        TaskKindText::Effort => reader.effort()?,
    };
    task.check(stage.model).map_err(|error| reader.refuse(&error))?;
    Ok(task)
}

/// Reads one task of the file.
struct Reader<'a> {
    stage: &'a Stage<'a>,
    text: &'a TaskText,
    number: String,
}

impl Reader<'_> {
    /// Refuses a key that tasks of other kinds take.
    fn check_keys(&self) -> Result<(), InputError> {
        let (word, takes) = self.text.kind.word_and_keys();
        let given = self.stage.at.keys(&["task", &self.number]);
        match given.into_iter().find(|key| !COMMON_KEYS.contains(key) && !takes.contains(key)) {
            None => Ok(()),
            Some(key) => {
                let help = format!("it takes: {}", takes.join(", "));
                Err(self.key_error(key, format!("`{key}` does not go with a {word} task"), Some(help)))
            }
        }
    }

    /// The error of the science crate at the key that it concerns, or at the kind where the file does not have this key.
    fn refuse(&self, error: &TaskError) -> InputError {
        let path = [&["task", self.number.as_str()], task_path(error)].concat();
        if self.stage.at.holds(&path) {
            return self.stage.at.error(&path, error.to_string(), None);
        }
        self.error("kind", error.to_string(), None)
    }

    fn point(&self) -> Result<Task, InputError> {
        let segment = self.segment(None)?;
        let point = self.at();
        let target = self.place(|| self.stage.kinematics.station(self.stage.model, segment, point))?;
        Ok(Task::Point(Point { segment, point, target, axes: self.axes()? }))
    }

    fn orientation(&self) -> Result<Task, InputError> {
        let segment = self.segment(None)?;
        Ok(Task::Orientation(Orientation { segment, target: self.rotation(segment)? }))
    }

    fn placement(&self) -> Result<Task, InputError> {
        let segment = self.segment(None)?;
        let point = self.at();
        let place = self.place(|| self.stage.kinematics.station(self.stage.model, segment, point))?;
        let target = Pose::from_parts(place.into(), self.rotation(segment)?);
        Ok(Task::Placement(Placement { segment, point, target }))
    }

    fn look_at(&self) -> Result<Task, InputError> {
        let segment = self.segment(Some("head"))?;
        let eye = self.text.eye_m.map_or(self.stage.model.segments()[segment].center_of_mass, Vector3::from);
        let direction = self.unit("direction", self.text.direction.unwrap_or([1.0, 0.0, 0.0]))?;
        Ok(Task::LookAt(LookAt { segment, eye, direction, goal: self.end_of_gaze()? }))
    }

    /// `target_m` or `target_direction` of a gaze.
    fn end_of_gaze(&self) -> Result<LookAtGoal, InputError> {
        match (self.text.target_m, self.text.target_direction) {
            (Some(target), None) => Ok(LookAtGoal::Place(target.into())),
            (None, Some(_)) if self.text.eye_m.is_some() => {
                let help = "leave it out: a direction is the same from every point".to_owned();
                Err(self.key_error("eye_m", "`eye_m` does not go with `target_direction`", Some(help)))
            }
            (None, Some(direction)) => Ok(LookAtGoal::Direction(self.unit("target_direction", direction)?)),
            (Some(_), Some(_)) => {
                let help = "keep one of `target_m` and `target_direction`".to_owned();
                Err(self.key_error("target_direction", "two targets are given", Some(help)))
            }
            (None, None) => Err(self.error("kind", "a look_at task needs `target_m`, or `target_direction`", None)),
        }
    }

    fn unit(&self, key: &str, direction: [f64; 3]) -> Result<UnitVector3<f64>, InputError> {
        let direction = self.bounded(key, direction.into())?;
        Unit::try_new(direction, 1e-9).ok_or_else(|| self.error(key, "the direction has no length", None))
    }

    fn distance(&self) -> Result<Task, InputError> {
        let end = |key: &'static str, end: &Option<PointText>| {
            let Some(end) = end else {
                let help = Some(format!("{key} = {{ segment = \"hand_r\", at_m = [0, 0, 0] }}"));
                return Err(self.error("kind", format!("a distance task needs `{key}`"), help));
            };
            let segment = self.named(&["task", &self.number, key, "segment"], &end.segment)?;
            Ok((segment, end.at_m.map_or_else(Vector3::zeros, Vector3::from)))
        };
        let (a, b) = (end("a", &self.text.a)?, end("b", &self.text.b)?);
        let (lower, upper) = match (self.text.range_m, self.text.distance_m) {
            (Some([lower, upper]), None) => (lower, upper),
            (None, Some(distance)) if (0.0..=LARGEST).contains(&distance) => (distance, distance),
            (None, Some(distance)) => {
                let message = format!("distance_m is {}; it must be between 0 and 1e9", shown(distance));
                return Err(self.error("distance_m", message, None));
            }
            _ => {
                let help = Some("give one of `range_m = [least, greatest]` and `distance_m`".to_owned());
                return Err(self.error("kind", "a distance task needs a distance or a range", help));
            }
        };
        if a == b {
            return Err(self.error("b", "both ends are the same point", None));
        }
        Ok(Task::Distance(Distance { a, b, lower, upper }))
    }

    fn center_of_mass(&self) -> Result<Task, InputError> {
        let text = self.text;
        let placed = text.target_m.is_some() || text.target.is_some();
        let (other, foreign): (_, &[&str]) =
            if placed { ("a target", &["polygon_m", "margin_m"]) } else { ("a polygon", &["axes"]) };
        let held = |key: &&&str| self.stage.at.holds(&["task", &self.number, key]);
        if let Some(key) = foreign.iter().find(held) {
            let message = format!("`{key}` does not go with {other}");
            let help =
                "the centre of mass is asked to a place (target_m, axes) or over a polygon (polygon_m, margin_m)";
            return Err(self.key_error(key, message, Some(help.to_owned())));
        }
        let goal = if placed {
            let (model, kinematics) = (self.stage.model, self.stage.kinematics);
            let target = self.place(|| kinematics.center_of_mass(model).unwrap_or_else(Vector3::zeros))?;
            CenterOfMassGoal::At { target, axes: self.axes()? }
        } else {
            CenterOfMassGoal::Inside {
                polygon: polygon(self.stage, &self.number, text)?,
                margin: text.margin_m.unwrap_or(0.0),
            }
        };
        Ok(Task::CenterOfMass(CenterOfMass { goal }))
    }

    fn posture(&self) -> Result<Task, InputError> {
        let (at, model) = (self.stage.at, self.stage.model);
        let mut task = Posture::whole(model, self.stage.start.clone());
        if let Some(names) = &self.text.coordinates {
            let asked = self.coordinates(names)?;
            let asked: Vec<usize> = asked.into_iter().flat_map(|coordinate| rates(model, coordinate)).collect();
            for (rate, weight) in task.weights.iter_mut().enumerate() {
                *weight = if asked.contains(&rate) { 1.0 } else { 0.0 };
            }
        }
        for (name, &weight) in self.text.weights.iter().flatten() {
            let path = ["task", &self.number, "weights", name];
            let index = names::coordinate(at, model, &path, name)?;
            if !(0.0..=1e6).contains(&weight) {
                let message = format!("the weight is {}; it must lie in 0..1e6", shown(weight));
                return Err(at.error(&path, message, None));
            }
            rates(model, index).into_iter().for_each(|rate| task.weights[rate] = weight);
        }
        if let Some(values) = &self.text.values {
            set(at, model, &["task", &self.number, "values"], values, &mut task.target)?;
        }
        // Quaternions to length 1.
        task.target.displace(model, &vec![0.0; model.rates().len()]);
        Ok(Task::Posture(task))
    }

    fn effort(&self) -> Result<Task, InputError> {
        let model = self.stage.model;
        let task = match &self.text.coordinates {
            Some(names) => Effort { coordinates: self.coordinates(names)? },
            None => Effort::whole(model),
        };
        if task.coordinates.is_empty() && self.text.coordinates.is_none() {
            let help = Some("lay an overlay with `strength` over the model".to_owned());
            return Err(self.error("kind", "no strength of this body is known", help));
        }
        Ok(Task::Effort(task))
    }

    fn coordinates(&self, names: &[String]) -> Result<Vec<usize>, InputError> {
        if names.is_empty() {
            let help = Some("leave it out for all of them".to_owned());
            return Err(self.error("coordinates", "the list names no coordinate", help));
        }
        let mut found = vec![];
        for (i, name) in names.iter().enumerate() {
            let path = ["task", &self.number, "coordinates", &i.to_string()];
            let index = names::coordinate(self.stage.at, self.stage.model, &path, name)?;
            if found.contains(&index) {
                return Err(self.stage.at.error(&path, format!("`{name}` stands twice"), None));
            }
            found.push(index);
        }
        Ok(found)
    }

    /// `target_m`, or where it is at the start.
    fn place(&self, at_start: impl Fn() -> Vector3<f64>) -> Result<Vector3<f64>, InputError> {
        match (self.text.target_m, self.text.target) {
            (Some(target), None) => Ok(target.into()),
            // Of a placement, the rotation may be the start's.
            (Some(target), Some(_)) if self.text.kind == TaskKindText::Placement && !self.turned() => Ok(target.into()),
            (Some(_), Some(_)) => {
                Err(self.key_error("target", "two targets are given", Some("keep one of them".to_owned())))
            }
            (None, Some(_)) => Ok(at_start()),
            (None, None) => {
                let message =
                    format!("a {} task needs `target_m`, or `target = \"start\"`", self.text.kind.word_and_keys().0);
                Err(self.error("kind", message, None))
            }
        }
    }

    /// Whether the file gives a rotation.
    fn turned(&self) -> bool {
        self.text.target_quaternion.is_some() || self.text.target_deg.is_some()
    }

    fn rotation(&self, segment: usize) -> Result<UnitQuaternion<f64>, InputError> {
        let text = self.text;
        match (text.target_quaternion, text.target_deg) {
            (Some(_), Some(_)) => {
                Err(self.key_error("target_deg", "two rotations are given", Some("keep one of them".to_owned())))
            }
            (Some([w, x, y, z]), None) => {
                self.no_start()?;
                let quaternion = Quaternion::new(w, x, y, z);
                if quaternion.norm().is_nan() || (quaternion.norm() - 1.0).abs() > UNIT {
                    let message =
                        format!("the quaternion has length {}; it must have length 1", shown(quaternion.norm()));
                    return Err(self.error("target_quaternion", message, Some("its order is w, x, y, z".to_owned())));
                }
                Ok(UnitQuaternion::new_normalize(quaternion))
            }
            (None, Some(degrees)) => {
                self.no_start()?;
                let [x, y, z] = self.bounded("target_deg", degrees.into())?.map(f64::to_radians).into();
                Ok(UnitQuaternion::from_euler_angles(x, y, z))
            }
            (None, None) if text.target.is_some() => {
                Ok(self.stage.kinematics.placement(self.stage.model, segment).rotation)
            }
            (None, None) => {
                let kind = self.text.kind.word_and_keys().0;
                let message = format!("a {kind} task needs `target_quaternion`, `target_deg`, or `target = \"start\"`");
                Err(self.error("kind", message, None))
            }
        }
    }

    /// A rotation of its own leaves `target = "start"` nothing to say, unless the place is the start's.
    fn no_start(&self) -> Result<(), InputError> {
        let for_place = self.text.kind == TaskKindText::Placement && self.text.target_m.is_none();
        if self.text.target.is_none() || for_place {
            return Ok(());
        }
        Err(self.key_error("target", "two targets are given", Some("keep one of them".to_owned())))
    }

    fn axes(&self) -> Result<[bool; 3], InputError> {
        let Some(axes) = &self.text.axes else { return Ok([true; 3]) };
        let mut asked = [false; 3];
        for letter in axes.chars() {
            match ['x', 'y', 'z'].iter().position(|axis| *axis == letter) {
                Some(axis) if !asked[axis] => asked[axis] = true,
                _ => {
                    let help = Some("write the letters of the axes asked for, such as \"xz\"".to_owned());
                    return Err(self.error("axes", format!("`{axes:.40}` names no ground axes"), help));
                }
            }
        }
        if asked == [false; 3] {
            return Err(self.error("axes", "no axis is asked for", Some("leave it out for all three".to_owned())));
        }
        Ok(asked)
    }

    fn at(&self) -> Vector3<f64> {
        self.text.at_m.map_or_else(Vector3::zeros, Vector3::from)
    }

    fn bounded(&self, key: &str, vector: Vector3<f64>) -> Result<Vector3<f64>, InputError> {
        match vector.iter().find(|v| v.abs() > LARGEST) {
            Some(value) => Err(self.error(key, format!("{} is too large; 1e9 at most", shown(*value)), None)),
            None => Ok(vector),
        }
    }

    fn segment(&self, otherwise: Option<&str>) -> Result<usize, InputError> {
        let kind = self.text.kind.word_and_keys().0;
        match (&self.text.segment, otherwise) {
            (Some(name), _) => self.named(&["task", &self.number, "segment"], name),
            (None, Some(name)) => self.stage.model.segment(name).ok_or_else(|| {
                let message = format!("the body has no segment `{name}`; a {kind} task needs `segment`");
                self.error("kind", message, None)
            }),
            (None, None) => Err(self.error("kind", format!("a {kind} task needs `segment`"), None)),
        }
    }

    fn named(&self, path: &[&str], name: &str) -> Result<usize, InputError> {
        names::segment(self.stage.at, self.stage.model, path, name)
    }

    fn error(&self, key: &str, message: impl Into<String>, help: Option<String>) -> InputError {
        self.stage.at.error(&["task", &self.number, key], message, help)
    }

    fn key_error(&self, key: &str, message: impl Into<String>, help: Option<String>) -> InputError {
        self.stage.at.key_error(&["task", &self.number, key], message, help)
    }
}
