//! Reads URDF, a robot description's links and joints, as a [`ModelIr`].
//!
//! Links become segments, also those without mass; joints are walked depth first, children of a link by the name of their
//! joint (the order that the reference parser and Pinocchio use). Parts that do not matter at rest are counted in
//! [`ModelIr::ignored`].

mod attributes;
mod error;
mod joint;
mod link;
mod options;
mod tree;

pub use error::{UrdfError, UrdfRule};
pub use options::Options;

use crate::model_ir::{Ignored, ModelIr, first_too_large};
use crate::xml::{self, shorten};
use nalgebra::Vector3;

/// Gravity of URDF files, which have none of their own: m/s^2 along -z.
pub(crate) const GRAVITY: f64 = 9.81;

/// Reads a URDF file. `file_name` serves as the body's name if the robot has none.
///
/// # Errors
/// [`UrdfError`] with the place.
pub fn read(bytes: &[u8], file_name: &str, options: &Options) -> Result<ModelIr, UrdfError> {
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
            other => ignored.add(other, 1),
        }
    }
    let name = robot.attribute("name").filter(|n| !n.is_empty()).unwrap_or(file_name).to_owned();
    let mut body = ModelIr { name, gravity: Vector3::new(0.0, 0.0, -GRAVITY), ..ModelIr::default() };
    tree::build(&mut body, robot, &links, &joints, options, &mut ignored)?;
    if let Some(segment) = first_too_large(&body) {
        let value = body.segments.get(segment).map_or_else(String::new, |s| shorten(&s.name));
        return Err(UrdfError::Invalid { place: robot.place(), value, needs: UrdfRule::Overflow });
    }
    body.ignored = ignored.into_list();
    Ok(body)
}
