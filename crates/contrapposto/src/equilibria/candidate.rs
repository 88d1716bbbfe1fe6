//! Holds a posture that a solve of a search has reached, and decides which of them count as one.

use std::cmp::Ordering;

use nalgebra::Vector3;

use super::mirror::Mirror;
use super::way_to_stand::WayToStand;
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

    /// The effort up to which, where the least is so much.
    pub(super) fn limit(self, least: f64) -> f64 {
        self.multiple * least + self.besides
    }
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
    pub(super) way: WayToStand,
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

    /// Whether no group needs more than its strength.
    pub(super) fn is_held(&self) -> bool {
        self.relative_torques.iter().all(|[external, passive]| (external + passive).abs() <= 1.0)
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
    selected.retain(|i| effort(i) <= worth.limit(least));
}

/// Centre of mass of every segment, ground, m.
pub(super) fn places(model: &Model, kinematics: &Kinematics) -> Vec<Vector3<f64>> {
    let segments = model.segments().iter().enumerate();
    segments.map(|(i, segment)| kinematics.station(model, i, segment.center_of_mass)).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
impl Candidate {
    /// The adult with the right arm forward by so many degrees, at this effort; a group of the shoulder works at so much of its strength.
    pub(super) fn with_arm(model: &Model, degrees: f64, (effort, load): (f64, f64)) -> Self {
        let mut posture = model.default_posture();
        posture.values_mut()[model.coordinate("arm_flex_r").unwrap()] = f64::to_radians(degrees);
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, &posture).unwrap();
        let relaxed = SolvedPosture {
            posture,
            levels: vec![],
            effort,
            slip: crate::contact::Slip::default(),
            balance: crate::contact::Balance::Held,
            reason: crate::posture_solver::Reason::Converged,
            steps: 0,
        };
        Self {
            relaxed,
            excess: 0.0,
            raised_limbs: 0,
            relative_torques: vec![[-1.5 * load, 0.5 * load]],
            places: places(model, &kinematics),
            way: WayToStand::of(model, &kinematics, vec![]),
            starts: vec![],
        }
    }
}
