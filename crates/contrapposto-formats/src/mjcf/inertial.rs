//! Reads mass and inertia of a body from its `<inertial>` or its geoms.

use super::attributes::Attributes;
use super::compiler::{MassFrom, Settings};
use super::error::{MjcfError, MjcfRule, Unsupported};
use super::geom::{Solid, solid};
use super::item::Item;
use super::options::Options;
use super::orientation::pose;
use super::schema;
use super::value::{Value, check, own_orientation};
use crate::model_ir::{Ignored, turned};
use nalgebra::{Isometry3, Matrix3, SymmetricEigen, Vector3};

/// A body's mass in its own frame, bounds and balance applied; total mass is not scaled yet.
pub(super) fn mass(
    body: Item<'_>,
    inertial: Option<(Item<'_>, Isometry3<f64>)>,
    geoms: &[(Attributes<'_, '_>, Isometry3<f64>)],
    settings: &Settings,
    moves: bool,
) -> Result<Solid, MjcfError> {
    let explicit = inertial.map(|(item, frame)| explicit(item, &frame, settings)).transpose()?;
    let from_geoms = match settings.mass_from {
        MassFrom::Inertial => false,
        MassFrom::Geoms => true,
        MassFrom::InertialOrGeoms => explicit.is_none(),
    };
    let mut parts = vec![];
    if from_geoms {
        for (geom, frame) in geoms {
            parts.extend(solid(geom, frame, settings, moves)?);
        }
    }
    let summed = if from_geoms && (!parts.is_empty() || explicit.is_none()) {
        Solid::sum(&parts)
    } else {
        explicit.unwrap_or_default()
    };
    bounded(body, summed, settings)
}

/// A body's mass, or none where it comes from a mesh and the caller does without.
pub(super) fn known(
    found: Result<Solid, MjcfError>,
    options: &Options,
    ignored: &mut Ignored,
) -> Result<Solid, MjcfError> {
    match found {
        Err(MjcfError::Unsupported { what: Unsupported::MeshMass, .. }) if options.omit_mesh_mass => {
            ignored.add("mass of a body that comes from a mesh: the body has none, and torques would be wrong", 1);
            Ok(Solid::default())
        }
        found => found,
    }
}

fn explicit(item: Item<'_>, frame: &Isometry3<f64>, settings: &Settings) -> Result<Solid, MjcfError> {
    check(item, schema::INERTIAL)?;
    let required = |name: &'static str| {
        Value::of(item, name).ok_or_else(|| MjcfError::Missing { place: item.attribute_place(name) })
    };
    required("pos")?;
    let mass = required("mass")?;
    let own = frame * pose(item, settings)?;
    let inertia = match (Value::of(item, "diaginertia"), Value::of(item, "fullinertia")) {
        (Some(_), Some(full)) => return Err(full.invalid(MjcfRule::FullInertiaAlone)),
        (None, None) => Matrix3::zeros(),
        (Some(diagonal), None) => {
            let moments = Vector3::from(diagonal.numbers::<3>()?);
            if moments.min() < 0.0 {
                return Err(diagonal.invalid(MjcfRule::InertiaNotNegative));
            }
            Matrix3::from_diagonal(&moments)
        }
        (None, Some(full)) => {
            if own_orientation(item)?.is_some() {
                return Err(full.invalid(MjcfRule::FullInertiaAlone));
            }
            let [xx, yy, zz, xy, xz, yz] = full.numbers()?;
            let matrix = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            if principal(&matrix).is_none_or(|(moments, _)| moments.min() <= 0.0) {
                return Err(full.invalid(MjcfRule::PositiveDefinite));
            }
            matrix
        }
    };
    let value = mass.number()?;
    if value < 0.0 {
        return Err(mass.invalid(MjcfRule::MassNotNegative));
    }
    let inertia = turned(&inertia, own.rotation.to_rotation_matrix().matrix());
    Ok(Solid { mass: value, center: own.translation.vector, inertia })
}

/// Principal moments and axes; none if the numbers overflow.
fn principal(inertia: &Matrix3<f64>) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    let largest = inertia.amax();
    if largest == 0.0 {
        return Some((Vector3::zeros(), Matrix3::identity()));
    }
    if !largest.is_finite() || largest < 1e-300 {
        return None;
    }
    let eigen = SymmetricEigen::try_new(inertia / largest, 1e-15, 1000)?;
    Some((eigen.eigenvalues * largest, eigen.eigenvectors))
}

fn bounded(body: Item<'_>, mut solid: Solid, settings: &Settings) -> Result<Solid, MjcfError> {
    solid.mass = solid.mass.max(settings.least_mass);
    let overflow = || MjcfError::invalid(body, "name", MjcfRule::Overflow);
    let (mut moments, axes) = principal(&solid.inertia).ok_or_else(overflow)?;
    let before = moments;
    moments = moments.map(|m| m.max(settings.least_inertia));
    let largest = moments.max();
    if largest > (moments.sum() - largest) * (1.0 + 1e-9) + 1e-14 {
        if !settings.balance {
            return Err(MjcfError::invalid(body, "name", MjcfRule::Triangle));
        }
        moments = Vector3::repeat(moments.mean());
    }
    if moments != before {
        solid.inertia = turned(&Matrix3::from_diagonal(&moments), &axes);
    }
    Ok(solid)
}
