//! URDF: a robot description's links and joints as a [`Body`].
//!
//! Links become segments, also those without mass; joints are walked depth first, children of a link by the name of their
//! joint (the order that the reference parser and Pinocchio use). What does not matter at rest is counted in
//! [`Body::ignored`].

mod error;
mod joint;
mod tree;

pub use error::{UrdfError, UrdfRule};

use crate::body::{Body, BodyRoot, BodySegment, first_too_large, turned};
use crate::numbers;
use crate::xml::{self, Limits, Node, Place, shorten};
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use std::collections::BTreeMap;

/// What the file does not say.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// How the root link is attached to the ground. `Free` adds `root_tx` ... `root_qz`.
    pub root: BodyRoot,
    /// Caps.
    pub limits: Limits,
}

/// Gravity of URDF files, which have none of their own: m/s^2 along -z.
pub const GRAVITY: f64 = 9.81;

/// A moment of inertia that is less than zero by no more than this, kg m2 a kg of its link, is zero and rounded.
const ROUNDING: f64 = 1e-15;

/// Reads a URDF file. `file_name` serves as the body's name if the robot has none.
///
/// # Errors
/// [`UrdfError`] with the place.
pub fn read(bytes: &[u8], file_name: &str, options: &Options) -> Result<Body, UrdfError> {
    let document = xml::parse(bytes, &options.limits)?;
    let robot = document.root();
    if robot.name() != "robot" {
        return Err(UrdfError::Root { place: robot.place() });
    }
    let mut ignored = Ignored::default();
    let mut links = Vec::new();
    let mut joints = Vec::new();
    for child in robot.children() {
        match child.name() {
            "link" => links.push(child),
            "joint" => joints.push(joint::Joint::read(child, &mut ignored)?),
            other => ignored.add(other),
        }
    }
    let name = robot.attribute("name").filter(|n| !n.is_empty()).unwrap_or(file_name).to_owned();
    let mut body = Body { name, gravity: Vector3::new(0.0, 0.0, -GRAVITY), ..Body::default() };
    tree::build(&mut body, robot, &links, &joints, options, &mut ignored)?;
    if let Some(segment) = first_too_large(&body) {
        let value = body.segments.get(segment).map_or_else(String::new, |s| shorten(&s.name));
        return Err(UrdfError::Invalid { place: robot.place(), value, needs: UrdfRule::Overflow });
    }
    body.ignored = ignored.0.into_iter().collect();
    Ok(body)
}

/// What was read past, by kind.
#[derive(Debug, Default)]
struct Ignored(BTreeMap<String, usize>);

impl Ignored {
    fn add(&mut self, kind: &str) {
        *self.0.entry(kind.to_owned()).or_default() += 1;
    }
}

/// A required attribute.
fn required<'a>(node: Node<'a>, attribute: &'static str) -> Result<&'a str, UrdfError> {
    node.attribute(attribute).ok_or_else(|| UrdfError::Missing { place: node.attribute_place(attribute) })
}

/// A required child element.
fn required_child<'a>(node: Node<'a>, tag: &'static str) -> Result<Node<'a>, UrdfError> {
    node.child(tag).ok_or_else(|| UrdfError::MissingElement { place: node.place(), element: tag })
}

fn number(node: Node<'_>, attribute: &'static str) -> Result<Option<f64>, UrdfError> {
    let Some(text) = node.attribute(attribute) else { return Ok(None) };
    Ok(Some(numbers::number(text, || node.attribute_place(attribute))?))
}

fn vector(node: Node<'_>, attribute: &'static str) -> Result<Option<Vector3<f64>>, UrdfError> {
    let Some(text) = node.attribute(attribute) else { return Ok(None) };
    let mut values = [0.0; 3];
    numbers::fixed(text, &mut values, || node.attribute_place(attribute))?;
    Ok(Some(Vector3::from(values)))
}

/// `<origin xyz rpy>` of a joint or an inertial; the identity without one.
fn origin(node: Node<'_>) -> Result<Isometry3<f64>, UrdfError> {
    let Some(origin) = node.child("origin") else { return Ok(Isometry3::identity()) };
    let xyz = vector(origin, "xyz")?.unwrap_or_default();
    let rpy = vector(origin, "rpy")?.unwrap_or_default();
    // Roll, pitch, yaw about the fixed axes x, y, z: what nalgebra calls Euler angles.
    let rotation = UnitQuaternion::from_euler_angles(rpy.x, rpy.y, rpy.z);
    Ok(Isometry3::from_parts(Translation3::from(xyz), rotation))
}

/// A link's segment, its joint still missing.
fn segment(link: Node<'_>, name: &str, ignored: &mut Ignored) -> Result<BodySegment, UrdfError> {
    let mut segment = BodySegment {
        name: name.to_owned(),
        parent: None,
        mass: 0.0,
        center_of_mass: Vector3::zeros(),
        inertia: Matrix3::zeros(),
        joint: "root".to_owned(),
        in_parent: Isometry3::identity(),
        in_segment: Isometry3::identity(),
        motions: Vec::new(),
    };
    for child in link.children() {
        if child.name() != "inertial" {
            ignored.add(child.name());
        }
    }
    let Some(inertial) = link.child("inertial") else { return Ok(segment) };
    if let Some(second) = link.children_named("inertial").nth(1) {
        return Err(UrdfError::Invalid { place: second.place(), value: name.to_owned(), needs: UrdfRule::OneInertial });
    }
    let mass = required_child(inertial, "mass")?;
    required(mass, "value")?;
    segment.mass = number(mass, "value")?.unwrap_or_default();
    let rule = |at: Node<'_>, attribute, value: f64, needs| UrdfError::Invalid {
        place: at.attribute_place(attribute),
        value: value.to_string(),
        needs,
    };
    if segment.mass < 0.0 {
        return Err(rule(mass, "value", segment.mass, UrdfRule::MassNotNegative));
    }
    let inertia = required_child(inertial, "inertia")?;
    let mut moments = [0.0; 6];
    for (moment, attribute) in moments.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
        required(inertia, attribute)?;
        *moment = number(inertia, attribute)?.unwrap_or_default();
    }
    let [xx, yy, zz, xy, xz, yz] = moments;
    for (value, attribute) in [(xx, "ixx"), (yy, "iyy"), (zz, "izz")] {
        if value < -ROUNDING * segment.mass {
            return Err(rule(inertia, attribute, value, UrdfRule::InertiaNotNegative));
        }
    }
    let frame = origin(inertial)?;
    let [xx, yy, zz] = [xx, yy, zz].map(|moment| moment.max(0.0));
    let own = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    segment.center_of_mass = frame.translation.vector;
    segment.inertia = turned(&own, frame.rotation.to_rotation_matrix().matrix());
    Ok(segment)
}

/// The place of a link or joint's name.
fn name_place(node: Node<'_>) -> Place {
    node.attribute_place("name")
}
