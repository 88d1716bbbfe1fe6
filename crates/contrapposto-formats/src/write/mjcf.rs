//! Writes a model as an MJCF file.
//!
//! Bodies lie in each other, all hinges and slides of a chain on one body, each with its axis and anchor in that body's frame.
//! MuJoCo refuses moving bodies without mass: such a segment gives its motions to the one that it carries; one that carries
//! none or several gets `FEATHER_MASS`. Gravity is the model's own. The file stands as the model does by default (`ref`).

use contrapposto::model::{Coordinate, JointKind, Model, Motion, Placement};
use contrapposto::passive::PassiveLaw;
use nalgebra::{Point3, UnitQuaternion, Vector3};

use super::exact::Orientation;
use super::law::{self, Part};
use super::mjcf_body::{Group, Joint, group, solid};
use super::names::Names;
use super::steps::resting;
use super::xml::{Xml, moments, number, numbers};
use super::{FEATHER_INERTIA, FEATHER_MASS, PLACEHOLDER_LIMIT, WriteError, Written, common, exact, listed, motor};
use crate::model_ir::{FREE_ENDINGS, Function};

/// Writes the model as an MJCF file.
///
/// Lost: passive laws other than one spring or polynomial a coordinate, couplings of more than the fourth power, names of
/// joints with several coordinates, segments without mass that move.
///
/// # Errors
/// [`WriteError`] for joints that functions drive, and for bodies with more than six degrees of freedom.
pub fn mjcf(model: &Model) -> Result<Written, WriteError> {
    let lost = common(model, |_| true)?;
    let mut writer = Writer::new(model, lost);
    writer.xml.open("mujoco", &[("model", model.name())]);
    writer.xml.leaf("compiler", &[("angle", "radian"), ("inertiafromgeom", "false")]);
    writer.xml.leaf("option", &[("gravity", &numbers(&model.gravity()))]);
    writer.xml.open("worldbody", &[]);
    // Segments still to be written, and after each the ends of the bodies that it is the last one of.
    let mut waiting = vec![];
    let mut children = vec![vec![]; model.segments().len()];
    for (index, segment) in model.segments().iter().enumerate().rev() {
        match segment.parent {
            Some(parent) => children[parent].push(index),
            None => waiting.push(Some(index)),
        }
    }
    while let Some(next) = waiting.pop() {
        let Some(index) = next else {
            writer.xml.close();
            continue;
        };
        let group = group(model, &children, index)?;
        writer.body(&group);
        waiting.push(None);
        waiting.extend(children[group.segment].iter().copied().map(Some));
    }
    writer.xml.close();
    writer.equalities();
    writer.losses();
    Ok(Written { text: writer.xml.finish(&writer.lost), lost: writer.lost })
}

struct Writer<'m> {
    model: &'m Model,
    xml: Xml,
    lost: Vec<String>,
    bodies: Names,
    joints: Names,
    /// Of each coordinate: name of its joint, and its value in the file's configuration.
    coordinates: Vec<(String, f64)>,
    /// Coordinates whose passive torque is lost.
    unsprung: Vec<String>,
    /// Frames of segments whose body stands otherwise.
    frames: Vec<Placement>,
}

impl<'m> Writer<'m> {
    fn new(model: &'m Model, lost: Vec<String>) -> Self {
        Self {
            model,
            xml: Xml::new(),
            lost,
            bodies: Names::new(&["world"], |_| true),
            joints: Names::new(&[], |_| true),
            coordinates: vec![(String::new(), 0.0); model.coordinates().len()],
            unsprung: vec![],
            frames: vec![Placement::identity(); model.segments().len()],
        }
    }

    /// Opens a body with its mass and joints.
    fn body(&mut self, group: &Group) {
        let segment = &self.model.segments()[group.segment];
        for &merged in &group.merged {
            let name = &self.model.segments()[merged].name;
            self.lost.push(format!(
                "Segment `{name}` has no mass, which MuJoCo refuses in what moves: its motions are those of `{}`.",
                segment.name
            ));
        }
        let parent = self.model.segments()[group.first].parent.map_or_else(Default::default, |p| self.frames[p]);
        let (pose, joints, frame) = group.placed(&parent.inverse());
        self.frames[group.segment] = frame;
        let name = self.bodies.keep("segment", &segment.name, &mut self.lost);
        let free = self.free(group);
        // A free joint stands as its body does.
        let stands = match free {
            true => resting(&self.model.coordinates()[segment.coordinates.clone()][3..]),
            false => pose.rotation,
        };
        let orientation = match exact::orientation(&stands) {
            Orientation::Quaternion(q) => ("quat", numbers(&q)),
            Orientation::Euler(angles) => ("euler", numbers(&angles)),
        };
        let position = numbers(&pose.translation.vector);
        let mut attributes = vec![("name", name.as_str()), ("pos", position.as_str())];
        if stands != UnitQuaternion::identity() {
            attributes.push((orientation.0, &orientation.1));
        }
        self.xml.open("body", &attributes);
        self.inertial(group, &name, &frame);
        if free {
            let first = segment.coordinates.start;
            let joint = self.joints.take(&segment.joint);
            self.xml.leaf("freejoint", &[("name", &joint)]);
            for (i, coordinate) in self.model.coordinates()[segment.coordinates.clone()].iter().enumerate() {
                self.coordinates[first + i] = (coordinate.name.clone(), coordinate.default);
            }
            return;
        }
        for joint in &joints {
            self.joint(joint, &self.model.segments()[joint.segment].joint);
        }
        self.note_names(group, &joints);
    }

    /// Mass and inertia of a body in its frame in the file.
    fn inertial(&mut self, group: &Group, name: &str, frame: &Placement) {
        let segment = &self.model.segments()[group.segment];
        let turn = frame.rotation.to_rotation_matrix();
        if *frame != Placement::identity() {
            self.lost.push(format!("Segment `{name}` has the frame of its ball joint in the file."));
        }
        let inertia = match frame.rotation == UnitQuaternion::identity() {
            true => segment.inertia,
            false => turn.inverse() * segment.inertia * turn,
        };
        if group.feather {
            self.lost.push(format!(
                "Segment `{name}` has no mass, which MuJoCo refuses in what moves: it is {FEATHER_MASS:e} kg and {FEATHER_INERTIA:e} kg m^2."
            ));
            let (mass, inertia) = (number(FEATHER_MASS), numbers(&[FEATHER_INERTIA; 3]));
            self.xml.leaf("inertial", &[("pos", "0 0 0"), ("mass", &mass), ("diaginertia", &inertia)]);
        } else if segment.mass != 0.0 {
            let (inertia, changed) = solid(&inertia);
            if changed {
                self.lost.push(format!(
                    "The inertia of `{name}` is not that of a solid body; the file has a ball's of that size."
                ));
            }
            let center = frame.inverse() * Point3::from(segment.center_of_mass);
            let values = moments(&inertia);
            let full = values[3..].iter().any(|v| *v != 0.0);
            let (kind, values) = if full { ("fullinertia", &values[..]) } else { ("diaginertia", &values[..3]) };
            let (pos, mass, values) = (numbers(&center.coords), number(segment.mass), numbers(values));
            self.xml.leaf("inertial", &[("pos", &pos), ("mass", &mass), (kind, &values)]);
        }
    }

    /// Whether MuJoCo's own free joint is this one.
    fn free(&self, group: &Group) -> bool {
        let segment = &self.model.segments()[group.segment];
        let axes = JointKind::Free.motions();
        let own = &self.model.coordinates()[segment.coordinates.clone()];
        segment.parent.is_none()
            && [segment.in_parent, segment.in_segment].iter().all(|p| *p == Placement::identity())
            && segment.joint_kind.motions() == axes
            && own.len() == FREE_ENDINGS.len()
            && own.iter().zip(FREE_ENDINGS).all(|(c, ending)| c.name == format!("{}_{ending}", segment.joint))
            && own[..3].iter().all(|c| c.range == (f64::NEG_INFINITY, f64::INFINITY) && c.passive.is_none())
    }

    fn joint(&mut self, joint: &Joint, of: &str) {
        let (kind, axis, anchored) = match joint.motion {
            Motion::Hinge(axis) => ("hinge", Some(axis), true),
            Motion::Slide(axis) => ("slide", Some(axis), false),
            Motion::Ball => ("ball", None, true),
        };
        let coordinate = &self.model.coordinates()[joint.coordinate];
        let name = match kind {
            "ball" => self.joints.keep("joint", of, &mut self.lost),
            _ => self.joints.keep("coordinate", &coordinate.name, &mut self.lost),
        };
        self.coordinates[joint.coordinate] = (name.clone(), joint.reference);
        let axis = axis.map(|axis| numbers(&exact::axis(&axis)));
        let anchor = numbers(&joint.anchor);
        let (low, high) = coordinate.range;
        let range = numbers(&[low.max(-PLACEHOLDER_LIMIT), high.min(PLACEHOLDER_LIMIT)]);
        let torques = motor(coordinate).map(|[positive, negative]| numbers(&[-negative, positive]));
        let (reference, spring) = (number(joint.reference), self.spring(coordinate));
        let mut attributes = vec![("name", name.as_str())];
        if kind != "hinge" {
            attributes.push(("type", kind));
        }
        if anchored && joint.anchor != Vector3::zeros() {
            attributes.push(("pos", &anchor));
        }
        if let Some(axis) = &axis {
            attributes.push(("axis", axis));
            if low.is_finite() || high.is_finite() {
                if low < high {
                    attributes.push(("range", &range));
                } else {
                    self.lost.push(format!("The range of `{name}` is one value; the file has no limit there."));
                }
                if low.is_infinite() || high.is_infinite() {
                    self.lost.push(format!(
                        "`{name}` has a limit on one side; the other one is {PLACEHOLDER_LIMIT:e} in the file."
                    ));
                }
            }
        }
        if joint.reference != 0.0 {
            attributes.push(("ref", &reference));
        }
        if let Some(torques) = &torques {
            attributes.push(("actuatorfrcrange", torques));
        }
        if let Some((stiffness, rest)) = &spring {
            attributes.push(("stiffness", stiffness));
            if rest != "0" {
                attributes.push(("springref", rest));
            }
        }
        self.xml.leaf("joint", &attributes);
    }

    /// Stiffness and rest of a law that is one spring, or the reason why it is lost.
    fn spring(&mut self, coordinate: &Coordinate) -> Option<(String, String)> {
        let law = coordinate.passive.as_ref()?;
        let found = match law {
            PassiveLaw::Sum(_) => law::summands(law).and_then(|parts| one_spring(&parts)),
            _ => None,
        };
        match found {
            Some((coefficients, _)) if coefficients.is_empty() => None,
            Some((coefficients, rest)) => Some((numbers(&coefficients), number(rest))),
            None => {
                self.unsprung.push(coordinate.name.clone());
                None
            }
        }
    }

    fn note_names(&mut self, group: &Group, joints: &[Joint]) {
        for &index in group.merged.iter().chain([&group.segment]) {
            let joint = &self.model.segments()[index].joint;
            let own: Vec<&str> = joints
                .iter()
                .filter(|j| j.segment == index)
                .map(|j| self.coordinates[j.coordinate].0.as_str())
                .collect();
            if !own.is_empty() && own != [joint.as_str()] {
                self.lost.push(format!("Joint `{joint}` has the names of its motions in the file: {}.", listed(&own)));
            }
        }
    }

    /// Couplings and locks.
    fn equalities(&mut self) {
        let coordinates = self.model.coordinates();
        let locked: Vec<usize> =
            (0..coordinates.len()).filter(|&c| coordinates[c].locked && coordinates[c].rate.is_some()).collect();
        if self.model.couplings().is_empty() && locked.is_empty() {
            return;
        }
        self.xml.open("equality", &[]);
        for coupling in self.model.couplings() {
            let [(dependent, y), (independent, x)] =
                [coupling.dependent, coupling.independent].map(|c| self.coordinates[c].clone());
            match shifted(&coupling.function, x, y) {
                Some(powers) => {
                    let powers = numbers(&powers);
                    self.xml.leaf("joint", &[("joint1", &dependent), ("joint2", &independent), ("polycoef", &powers)]);
                }
                None => self
                    .lost
                    .push(format!("`{dependent}` follows `{independent}` by a curve; in the file it moves by itself.")),
            }
        }
        for c in locked {
            let (name, reference) = &self.coordinates[c];
            let default = coordinates[c].default;
            if self.model.is_dependent(c) {
                self.lost.push(format!("`{name}` follows another coordinate; its lock is not written."));
            } else {
                let at = exact::near(default - reference, |v| reference + v == default);
                self.xml.leaf("joint", &[("joint1", name), ("polycoef", &numbers(&[at, 0.0, 0.0, 0.0, 0.0]))]);
            }
        }
        self.xml.close();
    }

    fn losses(&mut self) {
        if !self.unsprung.is_empty() {
            let names: Vec<&str> = self.unsprung.iter().map(String::as_str).collect();
            self.lost.push(format!("Passive torques that are no springs are not written: {}.", listed(&names)));
        }
        if self.model.segments().iter().any(|s| s.joint_kind == JointKind::Weld) {
            self.lost.push("Welds have no names in the file.".to_owned());
        }
    }
}

/// Coefficients and rest of the parts together, where MuJoCo has such a spring.
fn one_spring(parts: &[Part<'_>]) -> Option<(Vec<f64>, f64)> {
    match parts {
        [] => Some((vec![], 0.0)),
        [Part::Polynomial { coefficients, rest }] if coefficients.len() <= 3 => Some((coefficients.to_vec(), *rest)),
        [Part::Spring { stiffness, rest }] => Some((vec![*stiffness], *rest)),
        _ => {
            let springs = parts.iter().map(|part| match part {
                Part::Spring { stiffness, rest } => Some((*stiffness, *rest)),
                _ => None,
            });
            let all: Vec<(f64, f64)> = springs.collect::<Option<_>>()?;
            let stiffness: f64 = all.iter().map(|(k, _)| k).sum();
            let torque: f64 = all.iter().map(|(k, rest)| k * rest).sum();
            (stiffness != 0.0).then(|| (vec![stiffness], torque / stiffness))
        }
    }
}

/// Powers of `x - x0` that give `y - y0`, up to the fourth.
fn shifted(function: &Function, x0: f64, y0: f64) -> Option<[f64; 5]> {
    let mut powers = [0.0; 5];
    let given = match function {
        Function::Constant(value) => vec![*value],
        Function::Linear { slope, intercept } => vec![*intercept, *slope],
        Function::Polynomial(coefficients) => coefficients.clone(),
        _ => return None,
    };
    if given.iter().skip(5).any(|&c| c != 0.0) {
        return None;
    }
    for &coefficient in given.iter().take(5).rev() {
        for k in (1..5).rev() {
            powers[k] = powers[k - 1] + x0 * powers[k];
        }
        powers[0] = coefficient + x0 * powers[0];
    }
    powers[0] -= y0;
    Some(powers)
}
