//! Holds a posture that a solve of a search has reached, and decides which of them count as one.

use std::cmp::Ordering;

use nalgebra::Vector3;

use super::mirror::Mirror;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::posture_solver::SolvedPosture;

/// Postures count as one if at no joint the external or the passive torque differs by more than this share of strength.
const SAME_TORQUE: f64 = 0.05;
/// Postures count as two where a segment is farther away in one than in the other, m.
const SAME_PLACE: f64 = 0.3;
/// Effort up to which a posture is worth something: a multiple of the least, and this much besides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worth {
    multiple: f64,
    besides: f64,
}

impl Worth {
    /// To be converged from, since its effort can still fall: assumed, one muscle group at a third of its strength besides.
    pub(super) const START: Self = Self { multiple: 10.0, besides: 0.1 };
    /// To be an answer: assumed, one muscle group at 22 percent of its strength besides. Where a body can hang folded on its ligaments
    /// at no effort, standing upright stays an answer.
    pub(super) const ANSWER: Self = Self { multiple: 2.0, besides: 0.05 };
}

/// A posture that a solve has reached.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) relaxed: SolvedPosture,
    /// Load of supports beyond their greatest shares, shares of body weight.
    pub(super) excess: f64,
    /// Number of limbs without a task that are held up, though they hang in the start.
    pub(super) raised_limbs: usize,
    /// External and passive torque of every coordinate with muscles, as shares of strength.
    pub(super) relative_torques: Vec<[f64; 2]>,
    /// Centre of mass of every segment, ground, m.
    pub(super) places: Vec<Vector3<f64>>,
    /// Starts that led here, in words.
    pub(super) starts: Vec<String>,
}

impl Candidate {
    /// Whether at no joint the torques differ by more than [`SAME_TORQUE`], and no segment is farther away than [`SAME_PLACE`]: an arm
    /// that points up needs as little torque as one that hangs.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let pairs = self.relative_torques.iter().flatten().zip(other.relative_torques.iter().flatten());
        let far = |(a, b): (&Vector3<f64>, &Vector3<f64>)| (a - b).norm() > SAME_PLACE;
        pairs.into_iter().all(|(a, b)| (a - b).abs() <= SAME_TORQUE) && !self.places.iter().zip(&other.places).any(far)
    }

    /// Orders postures: those with fewer limbs held up come first, of them the one of less effort.
    pub(super) fn compare(&self, other: &Self) -> Ordering {
        let by_limbs = self.raised_limbs.cmp(&other.raised_limbs);
        by_limbs.then(self.relaxed.effort.total_cmp(&other.relaxed.effort))
    }

    /// The mirror image in which the `kept` coordinates stay as they are, where its posture fits the model; its other numbers are those of
    /// this posture.
    pub(super) fn image(&self, model: &Model, mirror: &Mirror, kept: &[usize]) -> Option<Self> {
        let mut image = self.clone();
        for (c, shares) in self.relative_torques.iter().enumerate() {
            let (partner, sign) = mirror.coordinate(c);
            image.relative_torques[partner] = shares.map(|share| sign * share);
        }
        image.relaxed.posture = mirror.posture(&self.relaxed.posture);
        for &c in kept {
            image.relaxed.posture.values_mut()[c] = self.relaxed.posture.values()[c];
            image.relative_torques[c] = self.relative_torques[c];
        }
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, &image.relaxed.posture).ok()?;
        image.places = places(model, &kinematics);
        Some(image)
    }

    /// Distance of the levels above `slot` and of the supports from their targets.
    pub(super) fn distance(&self, slot: usize) -> f64 {
        self.excess
            + self.relaxed.slip.length()
            + self.relaxed.levels[..slot].iter().map(|level| level.length).sum::<f64>()
    }
}

/// Leaves out of `selected`, indices into `found`, postures that need more effort than the easiest of them makes worth it.
pub(super) fn keep_worth(found: &[Candidate], selected: &mut Vec<usize>, worth: Worth) {
    let effort = |i: &usize| found[*i].relaxed.effort;
    let least = selected.iter().map(effort).fold(f64::INFINITY, f64::min);
    selected.retain(|i| effort(i) <= worth.multiple * least + worth.besides);
}

/// Centre of mass of every segment, ground, m.
pub(super) fn places(model: &Model, kinematics: &Kinematics) -> Vec<Vector3<f64>> {
    let segments = model.segments().iter().enumerate();
    segments.map(|(i, segment)| kinematics.station(model, i, segment.center_of_mass)).collect()
}
