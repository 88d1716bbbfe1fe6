//! Decides which postures are different ways to stand.
//!
//! Two postures are one way to stand if no joint of the body is farther away in one than in the other by more than 5 cm,
//! and no support carries more of the weight in one than in the other by more than a tenth. Both limits are assumed. Limbs that carry
//! nothing and have no task do not count: an arm to the front and an arm at the side are one way to stand, and the first of them is the answer. A posture in
//! which a group would need more than its strength is no way to stand where another posture needs less.

use nalgebra::Vector3;

use super::outcome::{Carried, RelaxedPosture, Work};
use crate::kinematics::Kinematics;
use crate::model::Model;

/// Distance between the places of a joint in two postures up to which both are one way to stand, m.
const SAME_JOINT: f64 = 0.05;
/// Difference between the shares of the weight on a support up to which two postures are one way to stand.
const SAME_SHARE: f64 = 0.1;

/// Most postures of an answer.
const MOST_POSTURES: usize = 5;

/// The first of the postures of each way to stand.
#[derive(Debug)]
pub(super) struct DifferentWays {
    /// By segment: its joint does not count.
    idle: Vec<bool>,
    pub(super) postures: Vec<RelaxedPosture>,
    /// Postures left out.
    pub(super) alike: usize,
    ways: Vec<WayToStand>,
}

impl DifferentWays {
    /// `idle`: by segment, whether the place of its joint does not count.
    pub(super) fn new(idle: Vec<bool>) -> Self {
        Self { idle, postures: vec![], alike: 0, ways: vec![] }
    }

    /// Takes the next posture, of more effort than those before; `kinematics` are those of the posture.
    pub(super) fn take(&mut self, model: &Model, kinematics: &Kinematics, posture: RelaxedPosture) {
        let way = WayToStand::of(model, kinematics, &posture.supports, &self.idle);
        let held = posture.work.iter().all(|work: &Work| work.relative_load() <= 1.0);
        let new = self.postures.len() < MOST_POSTURES && held && !self.ways.iter().any(|known| known.is_like(&way));
        if self.postures.is_empty() || new {
            self.postures.push(posture);
            self.ways.push(way);
        } else {
            self.alike += 1;
        }
    }
}

/// The places of the joints that count, and the shares of all supports.
#[derive(Clone, Debug)]
struct WayToStand {
    joints: Vec<Vector3<f64>>,
    shares: Vec<f64>,
}

impl WayToStand {
    fn of(model: &Model, kinematics: &Kinematics, supports: &[Carried], idle: &[bool]) -> Self {
        let segments = (0..model.segments().len()).filter(|&segment| !idle[segment]);
        Self {
            joints: segments.map(|segment| kinematics.placement(model, segment).translation.vector).collect(),
            shares: supports.iter().map(|support| support.share).collect(),
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        let far = |(a, b): (&Vector3<f64>, &Vector3<f64>)| (a - b).norm() > SAME_JOINT;
        let shifted = |(a, b): (&f64, &f64)| (a - b).abs() > SAME_SHARE;
        !self.joints.iter().zip(&other.joints).any(far) && !self.shares.iter().zip(&other.shares).any(shifted)
    }
}
