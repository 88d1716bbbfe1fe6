//! Directions of a body in ground, the axes of a page, and the units in which values are shown.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Coordinate, CoordinateKind, Model};
use contrapposto::posture::Posture;
pub(crate) use contrapposto_formats::animation::directions;
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Rotation of ground axes after which x is forward, y up and z right.
pub(crate) struct Turn(pub(crate) Rotation3<f64>);

impl Turn {
    pub(crate) fn point(&self, p: Vector3<f64>) -> [f64; 3] {
        (self.0 * p).into()
    }

    pub(crate) fn place(&self, place: &Isometry3<f64>) -> [f64; 7] {
        let [x, y, z] = self.point(place.translation.vector);
        let q = UnitQuaternion::from_rotation_matrix(&self.0) * place.rotation;
        [x, y, z, q.w, q.i, q.j, q.k]
    }
}

pub(crate) fn turn(model: &Model) -> Turn {
    let [right, ahead, up] = directions(model);
    Turn(Rotation3::from_matrix_unchecked(Matrix3::from_rows(&[ahead.transpose(), up.transpose(), right.transpose()])))
}

/// In degrees, slides in m.
pub(crate) fn visible(coordinate: &Coordinate, value: f64) -> f64 {
    if coordinate.kind == CoordinateKind::Rotation { value.to_degrees() } else { value }
}

/// Angle by which the pelvis hangs to its right, degrees.
pub(crate) fn pelvis_list(model: &Model, posture: &[f64]) -> Option<f64> {
    let pelvis = model.segment("pelvis")?;
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(posture.to_vec())).ok()?;
    let [right, _, up] = directions(model);
    let across = kinematics.placement(model, pelvis).rotation * right;
    Some(-libm::asin(across.dot(&up).clamp(-1.0, 1.0)).to_degrees())
}
