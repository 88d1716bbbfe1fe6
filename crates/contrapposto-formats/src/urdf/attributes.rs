//! Reads attributes of an element.

use super::error::UrdfError;
use crate::numbers;
use crate::xml::{Node, Place};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// A required attribute.
pub(super) fn required<'a>(node: Node<'a>, attribute: &'static str) -> Result<&'a str, UrdfError> {
    node.attribute(attribute).ok_or_else(|| UrdfError::Missing { place: node.attribute_place(attribute) })
}

/// A required child element.
pub(super) fn required_child<'a>(node: Node<'a>, tag: &'static str) -> Result<Node<'a>, UrdfError> {
    node.child(tag).ok_or_else(|| UrdfError::MissingElement { place: node.place(), element: tag })
}

pub(super) fn number(node: Node<'_>, attribute: &'static str) -> Result<Option<f64>, UrdfError> {
    let Some(text) = node.attribute(attribute) else { return Ok(None) };
    Ok(Some(numbers::number(text, || node.attribute_place(attribute))?))
}

pub(super) fn vector(node: Node<'_>, attribute: &'static str) -> Result<Option<Vector3<f64>>, UrdfError> {
    let Some(text) = node.attribute(attribute) else { return Ok(None) };
    let mut values = [0.0; 3];
    numbers::fixed(text, &mut values, || node.attribute_place(attribute))?;
    Ok(Some(Vector3::from(values)))
}

/// `<origin xyz rpy>` of a joint or an inertial; the identity without one.
pub(super) fn origin(node: Node<'_>) -> Result<Isometry3<f64>, UrdfError> {
    let Some(origin) = node.child("origin") else { return Ok(Isometry3::identity()) };
    let xyz = vector(origin, "xyz")?.unwrap_or_default();
    let rpy = vector(origin, "rpy")?.unwrap_or_default();
    // Roll, pitch, yaw about the fixed axes x, y, z: what nalgebra calls Euler angles.
    let rotation = UnitQuaternion::from_euler_angles(rpy.x, rpy.y, rpy.z);
    Ok(Isometry3::from_parts(Translation3::from(xyz), rotation))
}

/// The place of a link or joint's name.
pub(super) fn name_place(node: Node<'_>) -> Place {
    node.attribute_place("name")
}
