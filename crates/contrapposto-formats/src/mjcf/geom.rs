//! Computes mass, centre of mass and inertia of geoms, and of bodies made of them.

use super::attributes::Attributes;
use super::compiler::Settings;
use super::error::{MjcfError, MjcfRule, Unsupported};
use super::orientation::{rotation, to_z};
use super::value::Value;
use crate::model_ir::{SolidIr, SolidShape, turned, unit};
use contrapposto::muscle::{RoundShape, TendonGeom};
use nalgebra::{Isometry3, Matrix3, Translation3, Vector3};
use std::f64::consts::PI;

/// A rigid body's mass properties in some frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Solid {
    pub(super) mass: f64,
    pub(super) center: Vector3<f64>,
    /// About the centre of mass.
    pub(super) inertia: Matrix3<f64>,
}

impl Solid {
    /// The sum of solids in one frame.
    pub(super) fn sum(parts: &[Solid]) -> Solid {
        let mass: f64 = parts.iter().map(|p| p.mass).sum();
        if mass <= 0.0 {
            return Solid::default();
        }
        let center = parts.iter().map(|p| p.center * p.mass).sum::<Vector3<f64>>() / mass;
        let inertia = parts.iter().map(|p| p.inertia + point_inertia(p.mass, p.center - center)).sum();
        Solid { mass, center, inertia }
    }
}

/// Inertia of a point mass about the origin.
pub(super) fn point_inertia(mass: f64, at: Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() * at.norm_squared() - at * at.transpose()) * mass
}

const SHAPES: &[&str] = &["plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf"];

/// Mass of a geom in the frame of `outer`, or none if it is not asked for its mass.
pub(super) fn solid(
    geom: &Attributes<'_, '_>,
    outer: &Isometry3<f64>,
    settings: &Settings,
    moves: bool,
) -> Result<Option<Solid>, MjcfError> {
    let shape = geom.get("type").map_or(Ok(2), |v| v.keyword(SHAPES)).map(|i| SHAPES[i])?;
    let group = geom.number("group")?.unwrap_or(0.0);
    let fractional = |v: &Value<'_>| v.number().is_ok_and(|g| g.fract() != 0.0);
    if let Some(value) = geom.get("group").filter(fractional) {
        return Err(value.invalid(MjcfRule::Whole));
    }
    if group < settings.groups.0 || group > settings.groups.1 {
        return Ok(None);
    }
    if matches!(shape, "plane" | "hfield") {
        // Allowed on what does not move, where it adds no mass.
        return if moves { Err(MjcfError::invalid(geom.item, "type", MjcfRule::StaticShape)) } else { Ok(None) };
    }
    let mass = geom.number("mass")?;
    let density = geom.number("density")?.unwrap_or(1000.0);
    for (name, value) in [("mass", mass.unwrap_or(0.0)), ("density", density)] {
        if value < 0.0 {
            return Err(geom.get(name).map_or_else(
                || MjcfError::invalid(geom.item, name, MjcfRule::MassNotNegative),
                |v| v.invalid(MjcfRule::MassNotNegative),
            ));
        }
    }
    if mass.map_or(density == 0.0, |m| m == 0.0) {
        return Ok(None);
    }
    if matches!(shape, "mesh" | "sdf") || geom.get("mesh").is_some() {
        return Err(Unsupported::MeshMass.at(geom.item));
    }
    if let Some(value) = geom.get("shellinertia")
        && value.flag()?
    {
        return Err(Unsupported::ShellInertia.at_attribute(geom.item, "shellinertia"));
    }
    let (placed, size) = frame_and_size(geom, shape, settings)?;
    let (volume, moments) = shape_moments(shape, size);
    let mass = mass.unwrap_or(density * volume);
    let frame = outer * placed;
    let turn = frame.rotation.to_rotation_matrix();
    let inertia = turned(&Matrix3::from_diagonal(&(moments * mass)), turn.matrix());
    Ok(Some(Solid { mass, center: frame.translation.vector, inertia }))
}

/// The shape of a geom of segment number `segment` for contact, in the segment's frame; `None` of a mesh, a plane, a geom that touches
/// nothing, or one without a size.
pub(super) fn contact_shape(
    geom: &Attributes<'_, '_>,
    outer: &Isometry3<f64>,
    settings: &Settings,
    segment: usize,
) -> Result<Option<SolidIr>, MjcfError> {
    let shape = geom.get("type").map_or(Ok(2), |v| v.keyword(SHAPES)).map(|i| SHAPES[i])?;
    let touches = |name| Ok::<_, MjcfError>(geom.number(name)? != Some(0.0));
    let solid = !matches!(shape, "plane" | "hfield" | "mesh" | "sdf") && geom.get("mesh").is_none();
    if !(touches("contype")? | touches("conaffinity")?) || !solid {
        return Ok(None);
    }
    let (placed, [a, b, c]) = match frame_and_size(geom, shape, settings) {
        Err(MjcfError::Invalid { needs: MjcfRule::Size, .. }) => return Ok(None),
        found => found?,
    };
    let shape = match shape {
        "sphere" => SolidShape::Ellipsoid([a; 3]),
        "capsule" => SolidShape::Capsule { radius: a, half: b },
        "cylinder" => SolidShape::Cylinder { radius: a, half: b },
        "ellipsoid" => SolidShape::Ellipsoid([a, b, c]),
        _ => SolidShape::Box([a, b, c]),
    };
    Ok(Some(SolidIr { segment, pose: outer * placed, shape }))
}

/// A geom of a segment, `None` for the world, as a surface that tendons pass round.
pub(super) fn surface(
    geom: &Attributes<'_, '_>,
    segment: Option<usize>,
    outer: &Isometry3<f64>,
    settings: &Settings,
) -> Result<TendonGeom, MjcfError> {
    let kind = geom.get("type").map_or(Ok(2), |v| v.keyword(SHAPES)).map(|i| SHAPES[i])?;
    let shape = match kind {
        _ if geom.get("mesh").is_some() => return Err(Unsupported::TendonShape.at(geom.item)),
        "sphere" => RoundShape::Sphere,
        "cylinder" => RoundShape::Cylinder,
        _ => return Err(Unsupported::TendonShape.at(geom.item)),
    };
    let (placed, [radius, ..]) = frame_and_size(geom, kind, settings)?;
    let name = geom.item.attribute("name").unwrap_or_default().to_owned();
    Ok(TendonGeom { name, segment, pose: outer * placed, shape, radius })
}

/// Frame of a geom, and the sizes that its shape needs.
fn frame_and_size(
    geom: &Attributes<'_, '_>,
    shape: &str,
    settings: &Settings,
) -> Result<(Isometry3<f64>, [f64; 3]), MjcfError> {
    let mut size = geom.merged("size")?;
    let placed = match geom.get("fromto") {
        Some(fromto) => {
            let (frame, half) = segment(&fromto, geom, shape)?;
            match shape {
                "capsule" | "cylinder" => size[1] = half,
                _ => size = [size[0], size[0], half],
            }
            frame
        }
        None => {
            let position = geom.numbers("pos")?.unwrap_or_default();
            Isometry3::from_parts(Translation3::from(position), rotation(geom.orientation()?, settings)?)
        }
    };
    let needed = match shape {
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        _ => 3,
    };
    if size[..needed].iter().any(|&s| s <= 0.0) {
        return Err(MjcfError::invalid(geom.item, "size", MjcfRule::Size));
    }
    Ok((placed, size))
}

/// Frame and half length of `fromto`; z along it.
fn segment(fromto: &Value<'_>, geom: &Attributes<'_, '_>, shape: &str) -> Result<(Isometry3<f64>, f64), MjcfError> {
    if !matches!(shape, "capsule" | "cylinder" | "box" | "ellipsoid") {
        return Err(fromto.invalid(MjcfRule::FromtoShape));
    }
    let (middle, along) = middle(fromto, geom)?;
    let axis = unit(along).ok_or_else(|| fromto.invalid(MjcfRule::FromtoLength))?;
    Ok((Isometry3::from_parts(Translation3::from(middle), to_z(&axis)), along.norm() / 2.0))
}

/// Middle and difference of the two points of `fromto`, which excludes a position.
pub(super) fn middle(fromto: &Value<'_>, item: &Attributes<'_, '_>) -> Result<(Vector3<f64>, Vector3<f64>), MjcfError> {
    if let Some(position) = item.get("pos")
        && position.numbers::<3>()? != [0.0; 3]
    {
        return Err(position.invalid(MjcfRule::PosOrFromto));
    }
    let [a, b, c, x, y, z] = fromto.numbers()?;
    let (from, to) = (Vector3::new(a, b, c), Vector3::new(x, y, z));
    Ok((from / 2.0 + to / 2.0, to - from))
}

/// Volume, and principal moments per unit of mass.
fn shape_moments(shape: &str, [a, b, c]: [f64; 3]) -> (f64, Vector3<f64>) {
    match shape {
        "sphere" => (4.0 / 3.0 * PI * a.powi(3), Vector3::repeat(0.4 * a * a)),
        "capsule" => {
            // A cylinder of half length b between two half balls of radius a.
            let (cylinder, ball) = (2.0 * PI * a * a * b, 4.0 / 3.0 * PI * a.powi(3));
            let across = cylinder * (a * a / 4.0 + b * b / 3.0) + ball * (0.4 * a * a + b * b + 0.75 * a * b);
            let along = cylinder * a * a / 2.0 + ball * 0.4 * a * a;
            (cylinder + ball, Vector3::new(across, across, along) / (cylinder + ball))
        }
        "cylinder" => {
            let across = a * a / 4.0 + b * b / 3.0;
            (2.0 * PI * a * a * b, Vector3::new(across, across, a * a / 2.0))
        }
        "ellipsoid" => (4.0 / 3.0 * PI * a * b * c, Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) / 5.0),
        _ => (8.0 * a * b * c, Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) / 3.0),
    }
}
