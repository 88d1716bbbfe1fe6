//! Reads mass, inertia and shapes for contact of a link.

use super::attributes::{number, origin, required, required_child, vector};
use super::error::{UrdfError, UrdfRule};
use crate::model_ir::{Ignored, SegmentIr, SolidIr, SolidShape, turned};
use crate::xml::Node;
use nalgebra::{Isometry3, Matrix3, Vector3};

/// A moment of inertia that is less than zero by no more than this, kg m2 a kg of its link, is zero and rounded.
const ROUNDING: f64 = 1e-15;

/// A link's segment, its joint still missing.
pub(super) fn segment(link: Node<'_>, name: &str, ignored: &mut Ignored) -> Result<SegmentIr, UrdfError> {
    let mut segment = SegmentIr {
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
        if !matches!(child.name(), "inertial" | "collision") {
            ignored.add(child.name(), 1);
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

/// The shapes for contact of a link, the segment number `segment`. Meshes, and shapes without a size above 0, are counted.
pub(super) fn solids(link: Node<'_>, segment: usize, ignored: &mut Ignored) -> Result<Vec<SolidIr>, UrdfError> {
    let mut solids = vec![];
    for collision in link.children_named("collision") {
        let node = collision.child("geometry").and_then(|geometry| geometry.children().next());
        match node.map_or(Ok(None), shape_of)? {
            Some(shape) => solids.push(SolidIr { segment, pose: origin(collision)?, shape }),
            None => ignored.add("collision that is no box, cylinder, capsule or sphere", 1),
        }
    }
    Ok(solids)
}

fn shape_of(node: Node<'_>) -> Result<Option<SolidShape>, UrdfError> {
    let size = |name| Ok::<_, UrdfError>(number(node, name)?.filter(|size| *size > 0.0));
    let round = |radius: Option<f64>, length: Option<f64>| radius.zip(length.map(|length| length / 2.0));
    Ok(match node.name() {
        "box" => {
            let half = vector(node, "size")?.map(|size| size / 2.0).filter(|half| half.min() > 0.0);
            half.map(|half| SolidShape::Box(half.into()))
        }
        "sphere" => size("radius")?.map(|radius| SolidShape::Ellipsoid([radius; 3])),
        "cylinder" => {
            round(size("radius")?, size("length")?).map(|(radius, half)| SolidShape::Cylinder { radius, half })
        }
        "capsule" => round(size("radius")?, size("length")?).map(|(radius, half)| SolidShape::Capsule { radius, half }),
        _ => None,
    })
}
