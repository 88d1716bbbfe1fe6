//! Reads positions, and orientations in the five ways to give them.

use super::compiler::Settings;
use super::error::{MjcfError, MjcfRule};
use super::item::Item;
use super::value::{Value, own_orientation};
use crate::model_ir::unit;
use nalgebra::{Isometry3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};

/// `pos` and orientation of a body, frame or inertial, which have no class.
pub(super) fn pose(item: Item<'_>, settings: &Settings) -> Result<Isometry3<f64>, MjcfError> {
    let position = Value::of(item, "pos").map(|v| v.numbers()).transpose()?.unwrap_or_default();
    let rotation = rotation(own_orientation(item)?, settings)?;
    Ok(Isometry3::from_parts(Translation3::from(position), rotation))
}

/// The rotation that an orientation attribute gives; none without one.
pub(super) fn rotation(value: Option<Value<'_>>, settings: &Settings) -> Result<UnitQuaternion<f64>, MjcfError> {
    let Some(value) = value else { return Ok(UnitQuaternion::identity()) };
    let direction = |v: Vector3<f64>| unit(v).ok_or_else(|| value.invalid(MjcfRule::Direction));
    match value.name {
        "quat" => {
            let [w, x, y, z] = value.numbers()?;
            let q = Quaternion::new(w, x, y, z);
            let largest = q.coords.amax();
            if largest < 1e-14 {
                return Err(value.invalid(MjcfRule::Direction));
            }
            Ok(UnitQuaternion::new_normalize(q / largest))
        }
        "axisangle" => {
            let [x, y, z, angle] = value.numbers()?;
            Ok(UnitQuaternion::from_axis_angle(&direction(Vector3::new(x, y, z))?, settings.angle(angle)))
        }
        "zaxis" => Ok(to_z(&direction(Vector3::from(value.numbers::<3>()?))?)),
        "xyaxes" => {
            let [x0, x1, x2, y0, y1, y2] = value.numbers()?;
            let x = direction(Vector3::new(x0, x1, x2))?;
            let y = direction(Vector3::new(y0, y1, y2))?.into_inner();
            let y = direction(y - x.into_inner() * x.dot(&y))?;
            let z = x.cross(&y);
            let matrix = nalgebra::Matrix3::from_columns(&[x.into_inner(), y.into_inner(), z]);
            Ok(UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(matrix)))
        }
        _ => {
            let angles: [f64; 3] = value.numbers()?;
            let mut turned = UnitQuaternion::identity();
            for (letter, angle) in settings.euler_sequence.iter().zip(angles) {
                let axis = match letter.to_ascii_lowercase() {
                    b'x' => Vector3::x_axis(),
                    b'y' => Vector3::y_axis(),
                    _ => Vector3::z_axis(),
                };
                let turn = UnitQuaternion::from_axis_angle(&axis, settings.angle(angle));
                turned = if letter.is_ascii_lowercase() { turned * turn } else { turn * turned };
            }
            Ok(turned)
        }
    }
}

/// The shortest turn that takes z to `axis`.
pub(super) fn to_z(axis: &Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), axis)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}
