//! Describes the way in which a body stands, and compares two of them.
//!
//! Two postures are one way to stand if no joint of the body is farther away in one than in the other by more than 5 cm, wherever on the
//! floor the whole body stands, and no support carries more of the weight in one than in the other by more than a tenth. Both limits are
//! assumed. Limbs that carry nothing and have no task do not count: an arm to the front and an arm at the side are one way to stand.

use nalgebra::Vector3;

use super::mirror::Mirror;
use crate::kinematics::Kinematics;
use crate::model::Model;

/// Distance between the places of a joint in two postures up to which both are one way to stand, m.
const SAME_JOINT: f64 = 0.05;
/// Difference between the shares of the weight on a support up to which two postures are one way to stand.
const SAME_SHARE: f64 = 0.1;

/// The places of all joints, ground, m, and the shares of all supports.
#[derive(Clone, Debug, Default)]
pub(super) struct WayToStand {
    joints: Vec<Vector3<f64>>,
    shares: Vec<f64>,
    /// Against gravity; zero without gravity.
    up: Vector3<f64>,
}

impl WayToStand {
    pub(super) fn of(model: &Model, kinematics: &Kinematics, shares: Vec<f64>) -> Self {
        let segments = 0..model.segments().len();
        Self {
            joints: segments.map(|segment| kinematics.placement(model, segment).translation.vector).collect(),
            shares,
            up: (-model.gravity()).try_normalize(0.0).unwrap_or_default(),
        }
    }

    /// Left and right exchanged; `None` where a support has no partner. `supports`: their segments.
    pub(super) fn image(&self, mirror: &Mirror, supports: &[usize]) -> Option<Self> {
        let mut image = self.clone();
        for (segment, joint) in self.joints.iter().enumerate() {
            image.joints[mirror.segment(segment)] = mirror.vector(*joint);
        }
        for (support, share) in supports.iter().zip(&self.shares) {
            let partner = supports.iter().position(|other| *other == mirror.segment(*support))?;
            image.shares[partner] = *share;
        }
        Some(image)
    }

    /// `idle`: by segment, whether its joint does not count.
    pub(super) fn is_like(&self, other: &Self, idle: &[bool]) -> bool {
        let shifted = |(a, b): (&f64, &f64)| (a - b).abs() > SAME_SHARE;
        let pairs = self.joints.iter().zip(&other.joints).zip(idle);
        let apart: Vec<Vector3<f64>> = pairs.filter(|(_, idle)| !**idle).map(|((a, b), _)| a - b).collect();
        // Elsewhere on the floor in the same posture all joints are as far apart.
        let mean = apart.iter().sum::<Vector3<f64>>() / apart.len().max(1) as f64;
        let elsewhere = mean - self.up * self.up.dot(&mean);
        let near = |shift: Vector3<f64>| apart.iter().all(|apart| (apart - shift).norm() <= SAME_JOINT);
        (near(Vector3::zeros()) || near(elsewhere)) && !self.shares.iter().zip(&other.shares).any(shifted)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::model::{Adult, adult};

    #[test]
    fn a_body_that_stands_elsewhere_on_the_floor_in_the_same_posture_stands_in_the_same_way() {
        let model = adult(&Adult::default()).unwrap();
        let idle = vec![false; model.segments().len()];
        let mut kinematics = Kinematics::new(&model);
        let mut way = |coordinate: &str, by: f64| {
            let mut posture = model.default_posture();
            posture.values_mut()[model.coordinate(coordinate).unwrap()] += by;
            kinematics.update(&model, &posture).unwrap();
            WayToStand::of(&model, &kinematics, vec![])
        };
        let start = way("pelvis_tx", 0.0);
        assert!(start.is_like(&way("pelvis_tx", 0.5), &idle) && start.is_like(&way("pelvis_tz", -0.5), &idle));
        assert!(!start.is_like(&way("pelvis_ty", 0.1), &idle) && !start.is_like(&way("pelvis_rotation", 0.5), &idle));
        // An arm that counts for nothing does not shift the others either.
        let raised = way("arm_flex_r", 1.6);
        let moved: Vec<bool> = raised.joints.iter().zip(&start.joints).map(|(a, b)| (a - b).norm() > 1e-9).collect();
        assert!(!start.is_like(&raised, &idle) && start.is_like(&raised, &moved));
    }
}
