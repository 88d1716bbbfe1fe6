//! Sizes the capsule and the iliotibial tract of a hip, which muscles lack, as one band against adduction beside the muscles.
//!
//! In the modified Ober test a person lies on one side, and the upper leg, relaxed and straight, sinks to an adduction of 24.6 degrees (standard
//! deviation between people 7.3; 600 limbs, Ferber et al. 2010, abstract). There the passive torque of the hip balances the weight of the leg:
//!
//! ```text
//! tau_band(q) = -A exp(k (q - theta))          A = m g l + tau_m
//! ```
//!
//! with the moment `m g l` of the leg's weight and the passive torque `tau_m` of the model's own muscles (negative: against adduction) at the
//! adduction `theta`, the hip else at zero and all other joints at their defaults. The size is `derived` (how the leg was let go was not
//! verified); the rate `k` is that of the built-in curve, which is `assumed`.

use nalgebra::{Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};

use super::muscles::JointMuscles;
use crate::kinematics::Kinematics;
use crate::model::{Model, Placement, Side};
use crate::muscle::{Band, Bushing, Musculature};
use crate::posture::{Posture, PostureError};

/// Mean and standard deviation of the adduction to which a relaxed leg sinks, degrees (Ferber et al. 2010, modified Ober test).
const OBER_DEG: (f64, f64) = (24.6, 7.3);
/// Rate of the band, 1/rad: that of the built-in curve of hip adduction (assumed).
const HIP_TRACT_RATE: f64 = 8.0;

/// The band at one hip.
#[derive(Clone, Debug, PartialEq)]
pub struct HipTract {
    /// The band about the hip.
    pub bushing: Bushing,
    /// Adduction to which the leg sinks in the test, rad.
    pub angle: f64,
    /// Moment of the leg's weight there, N m.
    pub of_leg: f64,
    /// Passive torque of the muscles against adduction there, N m.
    pub of_muscles: f64,
}

impl HipTract {
    /// Torque of the band against adduction at the angle of the test, N m; 0 where the muscles alone hold the leg.
    pub fn torque(&self) -> f64 {
        (self.of_leg - self.of_muscles).max(0.0)
    }
}

/// The band beside `muscles` at the hip whose adduction is the coordinate `adduction` in the sense `sense`, of a person whose leg sinks by so many
/// standard deviations (0: mean) more than others'. `None` where that is no rotation between two segments of which one has weight.
///
/// # Errors
/// [`PostureError`] where the body cannot take the posture of the test.
pub fn hip_tract(
    model: &Model,
    muscles: &Musculature,
    (adduction, sense): (usize, Side),
    deviations: f64,
) -> Result<Option<HipTract>, PostureError> {
    let Some(leg) = model.segments.iter().position(|segment| segment.coordinates.contains(&adduction)) else {
        return Ok(None);
    };
    let (Some(trunk), Some(rate)) = (model.segments[leg].parent, model.coordinates[adduction].rate) else {
        return Ok(None);
    };
    let Some(element) = model.elements.iter().position(|of| *of == Some(rate)) else { return Ok(None) };
    let sign = if sense == Side::Positive { 1.0 } else { -1.0 };
    let angle = (OBER_DEG.0 + deviations * OBER_DEG.1).to_radians();
    let mut posture = model.default_posture();
    posture.values_mut()[model.segments[leg].coordinates.clone()].fill(0.0);
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &posture)?;
    let axis = sign * kinematics.axes[element];
    let Some(bushing) = bushing_about(model, &kinematics, (trunk, leg), axis) else { return Ok(None) };
    posture.values_mut()[adduction] = sign * angle;
    let (of_leg, of_muscles) = in_test(model, muscles, &posture, (leg, adduction), axis)?;
    let found = HipTract { bushing, angle, of_leg, of_muscles: -sign * of_muscles };
    let band = Band { axis: 0, torque: found.torque(), angle, rate: HIP_TRACT_RATE };
    Ok((of_leg > 0.0).then(|| HipTract { bushing: Bushing { bands: vec![band], ..found.bushing.clone() }, ..found }))
}

/// Frames of the band, alike in ground in the posture of `kinematics`: x along `axis`, y upward.
fn bushing_about(
    model: &Model,
    kinematics: &Kinematics,
    (trunk, leg): (usize, usize),
    axis: Vector3<f64>,
) -> Option<Bushing> {
    let x = axis.try_normalize(0.0)?;
    let up = -model.gravity;
    let y = (up - x * x.dot(&up)).try_normalize(0.0)?;
    let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, x.cross(&y)]));
    let in_trunk = kinematics.placement(model, trunk);
    let center = in_trunk * Point3::from(model.segments[leg].in_parent.translation.vector);
    let at = Placement::from_parts(center.coords.into(), UnitQuaternion::from_rotation_matrix(&axes));
    let in_leg = kinematics.placement(model, leg);
    Some(Bushing {
        name: format!("capsule and iliotibial tract of {}", model.segments[leg].name),
        segments: [Some(trunk), Some(leg)],
        frames: [in_trunk.inverse() * at, in_leg.inverse() * at],
        rotational_stiffness: Vector3::zeros(),
        translational_stiffness: Vector3::zeros(),
        bands: vec![],
    })
}

/// Moment of the leg's weight about the axis, of a person who lies on the other side, and passive torque of the muscles by the coordinate, N m.
fn in_test(
    model: &Model,
    muscles: &Musculature,
    posture: &Posture,
    (leg, adduction): (usize, usize),
    axis: Vector3<f64>,
) -> Result<(f64, f64), PostureError> {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture)?;
    // Gravity of the person who lies pulls the leg into adduction: it is that of the person who stands, turned about the axis.
    let pull = axis.cross(&model.gravity);
    let trunk = model.segments[leg].parent;
    let center = model.segments[leg].in_parent.translation.vector;
    let center = trunk.map_or(center, |trunk| (kinematics.placement(model, trunk) * Point3::from(center)).coords);
    let is_of_leg =
        |segment: usize| std::iter::successors(Some(segment), |&of| model.segments[of].parent).any(|of| of == leg);
    let moment = |segment: usize| {
        let of = &model.segments[segment];
        let at = kinematics.placement(model, segment) * Point3::from(of.center_of_mass);
        of.mass * axis.dot(&(at.coords - center).cross(&pull))
    };
    let of_leg = (0..model.segments.len()).filter(|&segment| is_of_leg(segment)).map(moment).sum();
    let Some(rate) = model.coordinates[adduction].rate else { return Ok((of_leg, 0.0)) };
    let mut of_muscles = JointMuscles::new(model, muscles.clone(), &[rate], &[]);
    of_muscles.update(model, posture, &kinematics)?;
    Ok((of_leg, of_muscles.passive_torques()[0][rate]))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::model::{Adult, adult};

    #[test]
    fn frames_of_a_band_have_x_along_any_axis_and_y_as_upright_as_that_allows() {
        let model = adult(&Adult::default()).unwrap();
        let mut posture = model.default_posture();
        posture.values_mut()[model.coordinate("hip_flexion_r").unwrap()] = 0.4;
        let mut kinematics = Kinematics::new(&model);
        kinematics.update(&model, &posture).unwrap();
        let [trunk, leg] = ["pelvis", "femur_r"].map(|name| model.segment(name).unwrap());
        for axis in [Vector3::x(), Vector3::new(0.5, 0.6, 0.2), Vector3::new(-0.1, -0.9, 0.3)] {
            let x = axis.normalize();
            let y = (Vector3::y() - x * x.y).normalize();
            let bushing = bushing_about(&model, &kinematics, (trunk, leg), axis).unwrap();
            for (frame, segment) in bushing.frames.iter().zip([trunk, leg]) {
                let at = kinematics.placement(&model, segment) * frame;
                for (found, expected) in [(Vector3::x(), x), (Vector3::y(), y), (Vector3::z(), x.cross(&y))] {
                    assert!(
                        (at.rotation * found - expected).norm() < 1e-12,
                        "{axis}: {} {expected}",
                        at.rotation * found
                    );
                }
                let hip = kinematics.placement(&model, leg).translation.vector;
                assert!((at.translation.vector - hip).norm() < 1e-12);
            }
        }
        assert!(bushing_about(&model, &kinematics, (trunk, leg), Vector3::y()).is_none(), "an upright axis has no up");
    }
}
