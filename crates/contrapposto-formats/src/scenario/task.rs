//! What a task of a scenario means: names become indices, degrees radians, words the numbers they stand for.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{LARGEST, Model};
use contrapposto::tasks::{
    CenterOfMass, CenterOfMassGoal, Distance, Effort, HalfPlane, LookAt, Orientation, Placement, Point, Posture, Task,
    TaskError, half_planes,
};
use nalgebra::{Quaternion, Unit, UnitQuaternion, Vector3};

use super::Located;
use super::convert::{coordinate, shown};
use super::pose::{UNIT, rates, set};
use super::task_text::{PointText, TaskKindText, TaskText};
use crate::input_error::{InputError, suggestion};

/// A support polygon narrower than this, m, is none.
const NARROW: f64 = 0.01;

/// What tasks refer to: the body as it starts.
pub(super) struct Stage<'a> {
    pub(super) at: &'a Located<'a>,
    pub(super) model: &'a Model,
    pub(super) start: &'a contrapposto::posture::Posture,
    pub(super) kinematics: &'a Kinematics,
    /// Segments that carry weight.
    pub(super) supports: Vec<usize>,
}

/// The task number `i` of the file, counted from 0.
pub(super) fn task(stage: &Stage<'_>, i: usize, text: &TaskText) -> Result<Task, InputError> {
    let one = One { stage, text, number: i.to_string() };
    let takes = text.kind.keys();
    if let Some(key) = text.given().find(|key| !takes.contains(key)) {
        let message = format!("`{key}` does not go with a {} task", text.kind.word());
        return Err(one.key_error(key, message, Some(format!("it takes: {}", takes.join(", ")))));
    }
    let task = match text.kind {
        TaskKindText::Point => one.point()?,
        TaskKindText::Orientation => one.orientation()?,
        TaskKindText::Placement => one.placement()?,
        TaskKindText::LookAt => one.look_at()?,
        TaskKindText::Distance => one.distance()?,
        TaskKindText::CenterOfMass => one.center_of_mass()?,
        TaskKindText::Posture => one.posture()?,
        TaskKindText::Effort => one.effort()?,
    };
    task.check(stage.model).map_err(|error| one.error(place(&error), error.to_string(), None))?;
    Ok(task)
}

/// The key of the number that the science refuses.
fn place(error: &TaskError) -> &'static str {
    let what = match error {
        TaskError::Number { what, .. } | TaskError::Empty { what, .. } => *what,
        TaskError::Unable { .. } => "coordinates",
        _ => "",
    };
    let keys = [
        ("point (m)", "at_m"),
        ("target (m)", "target_m"),
        ("eye (m)", "eye_m"),
        ("lower limit (m)", "range_m"),
        ("upper limit (m)", "range_m"),
        ("margin (m)", "margin_m"),
        ("offset of an edge (m)", "polygon_m"),
        ("weight", "weights"),
        ("coordinate (all weights are 0)", "weights"),
        ("coordinates", "coordinates"),
        ("coordinate", "coordinates"),
    ];
    keys.iter().find(|(word, _)| *word == what).map_or("kind", |(_, key)| key)
}

/// One task of the file.
struct One<'a> {
    stage: &'a Stage<'a>,
    text: &'a TaskText,
    number: String,
}

impl One<'_> {
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
        let target = contrapposto::model::Placement::from_parts(place.into(), self.rotation(segment)?);
        Ok(Task::Placement(Placement { segment, point, target }))
    }

    fn look_at(&self) -> Result<Task, InputError> {
        let segment = self.segment(Some("head"))?;
        let Some(target) = self.text.target_m else {
            return Err(self.error("kind", "a look_at task needs `target_m`", None));
        };
        let eye = self.text.eye_m.map_or(self.stage.model.segments()[segment].center_of_mass, Vector3::from);
        let direction = Vector3::from(self.text.direction.unwrap_or([1.0, 0.0, 0.0]));
        let direction = self.bounded("direction", direction)?;
        let Some(direction) = Unit::try_new(direction, 1e-9) else {
            return Err(self.error("direction", "the direction has no length", None));
        };
        Ok(Task::LookAt(LookAt { segment, eye, direction, target: target.into() }))
    }

    fn distance(&self) -> Result<Task, InputError> {
        let end = |key: &'static str, end: &Option<PointText>| {
            let Some(end) = end else {
                let help = Some(format!("{key} = {{ segment = \"hand_r\", at_m = [0, 0, 0] }}"));
                return Err(self.error("kind", format!("a distance task needs `{key}`"), help));
            };
            let segment = self.known_segment(&["task", &self.number, key, "segment"], &end.segment)?;
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
        let (other, spoilt) = if placed {
            ("a target", [("polygon_m", text.polygon_m.is_some()), ("margin_m", text.margin_m.is_some())])
        } else {
            ("a polygon", [("axes", text.axes.is_some()), ("axes", false)])
        };
        if let Some((key, _)) = spoilt.into_iter().find(|(_, given)| *given) {
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
            CenterOfMassGoal::Inside { polygon: self.polygon()?, margin: text.margin_m.unwrap_or(0.0) }
        };
        Ok(Task::CenterOfMass(CenterOfMass { goal }))
    }

    /// Corners as the file gives them, or the joints of the supports.
    fn polygon(&self) -> Result<Vec<HalfPlane>, InputError> {
        let model = self.stage.model;
        let gravity = model.gravity();
        let up = gravity.iamax();
        if gravity.norm() == 0.0 {
            let help = Some("give `target_m`".to_owned());
            return Err(self.error("kind", "without gravity nothing stands over a polygon", help));
        }
        let horizontal: Vec<usize> = (0..3).filter(|axis| *axis != up).collect();
        let letters: String = horizontal.iter().map(|&axis| ["x", "y", "z"][axis]).collect::<Vec<_>>().join(", ");
        let asked = format!("give polygon_m = [[{letters}], ...] with three corners or more, or `target_m`");
        let (key, points) = match &self.text.polygon_m {
            Some(corners) => {
                let mut points = vec![];
                for (i, corner) in corners.iter().enumerate() {
                    let mut point = Vector3::zeros();
                    for (axis, value) in horizontal.iter().zip(corner) {
                        if value.abs() > LARGEST {
                            let path = ["task", &self.number, "polygon_m", &i.to_string()];
                            let message = format!("a corner is at {} m; 1e9 at most", shown(*value));
                            return Err(self.stage.at.error(&path, message, None));
                        }
                        point[*axis] = *value;
                    }
                    points.push(point);
                }
                ("polygon_m", points)
            }
            None if self.stage.supports.is_empty() => {
                let help = Some(format!("add a [[support]], {asked}"));
                return Err(self.error("kind", "no support is there to stand over", help));
            }
            None => ("kind", self.joints_of_supports()),
        };
        let polygon = half_planes(&points, gravity);
        let width = |edge: &HalfPlane| points.iter().map(|p| -edge.excess(p)).fold(0.0, f64::max);
        if polygon.len() < 3 || polygon.iter().any(|edge| width(edge) < NARROW) {
            let message = match key {
                "kind" => "the joints of the supports lie on a line, over which nobody stands",
                _ => "the polygon is narrower than a centimetre",
            };
            return Err(self.error(key, message, Some(asked)));
        }
        Ok(polygon)
    }

    /// Where each support begins, and where the segments that it carries do, at the start.
    fn joints_of_supports(&self) -> Vec<Vector3<f64>> {
        let model = self.stage.model;
        let carries =
            |support: usize, segment: usize| segment == support || model.segments()[segment].parent == Some(support);
        let ends = |&support: &usize| (0..model.segments().len()).filter(move |&segment| carries(support, segment));
        let supports = self.stage.supports.iter();
        supports.flat_map(ends).map(|s| self.stage.kinematics.placement(model, s).translation.vector).collect()
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
            let index = coordinate(at, model, &path, name)?;
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
            let index = coordinate(self.stage.at, self.stage.model, &path, name)?;
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
                let message = format!("a {} task needs `target_m`, or `target = \"start\"`", self.text.kind.word());
                Err(self.error("kind", message, None))
            }
        }
    }

    /// Does the file say how the segment is to be turned?
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
                let kind = text.kind.word();
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
        let kind = self.text.kind.word();
        match (&self.text.segment, otherwise) {
            (Some(name), _) => self.known_segment(&["task", &self.number, "segment"], name),
            (None, Some(name)) => self.stage.model.segment(name).ok_or_else(|| {
                let message = format!("the body has no segment `{name}`; a {kind} task needs `segment`");
                self.error("kind", message, None)
            }),
            (None, None) => Err(self.error("kind", format!("a {kind} task needs `segment`"), None)),
        }
    }

    fn known_segment(&self, path: &[&str], name: &str) -> Result<usize, InputError> {
        let model = self.stage.model;
        model.segment(name).ok_or_else(|| {
            let help = suggestion(name, model.segments().iter().map(|s| s.name.as_str()));
            self.stage.at.error(path, format!("the body has no segment `{name}`"), help)
        })
    }

    fn error(&self, key: &str, message: impl Into<String>, help: Option<String>) -> InputError {
        self.stage.at.error(&["task", &self.number, key], message, help)
    }

    fn key_error(&self, key: &str, message: impl Into<String>, help: Option<String>) -> InputError {
        self.stage.at.key_error(&["task", &self.number, key], message, help)
    }
}
