//! Finds which way is up, left and ahead of a rig that stands.

use contrapposto::model::Placement;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::names::Assignment;

/// Cosine of the greatest angle between a leg or the trunk and the vertical of a rig that stands: 45 deg (assumed; skeletons of captures stand with
/// their legs up to 25 deg apart).
const UPRIGHT: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Cosine of the greatest angle between the line of the hips and an axis of the file that is taken for it: 10 deg (assumed).
const ALONG_AXIS: f64 = 0.984_8;
/// Lengths below this share of a leg are none.
pub(super) const NO_LENGTH: f64 = 1e-6;

/// Up, left and ahead in the axes of a file: unit vectors at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigAxes {
    /// Against gravity: an axis of the file.
    pub up: Vector3<f64>,
    /// From the right hip to the left one.
    pub left: Vector3<f64>,
    /// The direction that the body faces.
    pub ahead: Vector3<f64>,
}

impl RigAxes {
    /// The axes of a rig in a pose; `None` where it does not stand upright.
    pub fn of(assignment: &Assignment, placed: &[Placement]) -> Option<Self> {
        let at = |segment: &str| placed[assignment.needed(segment)].translation.vector;
        let mid = |stem: &str| (at(&format!("{stem}_r")) + at(&format!("{stem}_l"))) / 2.0;
        let (hips, ankles, shoulders) = (mid("femur"), mid("calcn"), mid("humerus"));
        let axis = (shoulders - ankles).iamax();
        let mut up = Vector3::zeros();
        up[axis] = (shoulders - ankles)[axis].signum();
        let legs = ["_r", "_l"].map(|side| at(&format!("femur{side}")) - at(&format!("calcn{side}")));
        let is_upright = |v: &Vector3<f64>| v.dot(&up) > UPRIGHT * v.norm();
        if !legs.iter().chain([&(shoulders - hips)]).all(is_upright) {
            return None;
        }
        let across = at("femur_l") - at("femur_r");
        let level = across - up * across.dot(&up);
        let mut left = level.try_normalize(NO_LENGTH * legs[0].norm())?;
        let nearest = left.iamax();
        if left[nearest].abs() > ALONG_AXIS {
            let sign = left[nearest].signum();
            left = Vector3::zeros();
            left[nearest] = sign;
        }
        let ahead = left.cross(&up);
        [up, left, ahead].iter().all(|v| v.iter().all(|x| x.is_finite())).then_some(Self { up, left, ahead })
    }

    /// The rotation from the axes of the file to ground: x ahead, y up, z right.
    pub fn to_ground(&self) -> UnitQuaternion<f64> {
        let rows = [self.ahead, self.up, -self.left].map(|v| v.transpose());
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows)))
    }

    /// `y`, `-z`: the axis of the file that points up.
    pub fn up_word(&self) -> String {
        let axis = self.up.iamax();
        format!("{}{}", if self.up[axis] < 0.0 { "-" } else { "" }, ["x", "y", "z"][axis])
    }
}
