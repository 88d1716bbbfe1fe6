//! Decides which postures are different ways to stand.
//!
//! Two postures are one way to stand if no joint of the body is farther away in one than in the other by more than 5 cm, wherever on the
//! floor the whole body stands, and no support carries more of the weight in one than in the other by more than a tenth. Both limits are
//! assumed. Limbs that carry nothing and have no task do not count: an arm to the front and an arm at the side are one way to stand, and the first of them is the answer. A posture in
//! which a group would need more than its strength is no way to stand where another posture needs less.
//!
//! The same with left and right exchanged, at the same effort, is one way to stand where that is asked for.

use nalgebra::Vector3;

use super::hanging_limbs::idle_segments;
use super::mirror::Mirror;
use super::outcome::{Carried, RelaxedPosture, Work};
use super::search::Search;
use crate::kinematics::Kinematics;
use crate::model::Model;

/// Distance between the places of a joint in two postures up to which both are one way to stand, m.
const SAME_JOINT: f64 = 0.05;
/// Difference between the shares of the weight on a support up to which two postures are one way to stand.
const SAME_SHARE: f64 = 0.1;

/// Difference between the efforts of two mirror images, as a share: both sides of a symmetric task take the same, but for where steps end.
const SAME_EFFORT: f64 = 0.01;

/// Most postures of an answer.
const MOST_POSTURES: usize = 5;

/// The first of the postures of each way to stand.
#[derive(Debug)]
pub(super) struct DifferentWays {
    /// By segment: its joint does not count.
    idle: Vec<bool>,
    /// Segments of the supports.
    supports: Vec<usize>,
    /// Set where mirror images are one way to stand.
    mirror: Option<Mirror>,
    pub(super) postures: Vec<RelaxedPosture>,
    /// Postures left out.
    pub(super) alike: usize,
    ways: Vec<WayToStand>,
}

impl DifferentWays {
    /// `mirror`: where mirror images are one way to stand.
    pub(super) fn new(search: &Search<'_>, mirror: Option<Mirror>) -> Self {
        let supports = search.supports.iter().map(|support| support.segment).collect();
        Self { idle: idle_segments(search), supports, mirror, postures: vec![], alike: 0, ways: vec![] }
    }

    /// Takes the next posture, of more effort than those before; `kinematics` are those of the posture.
    pub(super) fn take(&mut self, model: &Model, kinematics: &Kinematics, posture: RelaxedPosture) {
        let way = WayToStand::of(model, kinematics, &posture.supports);
        let held = posture.work.iter().all(|work: &Work| work.relative_load() <= 1.0);
        let is_known = |way: &WayToStand| self.ways.iter().position(|known| known.is_like(way, &self.idle));
        let effort = posture.relaxed.effort;
        let is_near = |known: &usize| effort <= (1.0 + SAME_EFFORT) * self.postures[*known].relaxed.effort;
        let image = self.mirror.as_ref().and_then(|mirror| way.image(mirror, &self.supports));
        let mirrored = image.and_then(|image| is_known(&image)).filter(is_near);
        let known = is_known(&way);
        if let (None, Some(known)) = (known, mirrored) {
            self.postures[known].mirrored = true;
        }
        let new = self.postures.len() < MOST_POSTURES && held && known.is_none() && mirrored.is_none();
        if self.postures.is_empty() || new {
            self.postures.push(posture);
            self.ways.push(way);
        } else {
            self.alike += 1;
        }
    }
}

/// The places of all joints, ground, m, and the shares of all supports.
#[derive(Clone, Debug)]
struct WayToStand {
    joints: Vec<Vector3<f64>>,
    shares: Vec<f64>,
    /// Against gravity; zero without gravity.
    up: Vector3<f64>,
}

impl WayToStand {
    fn of(model: &Model, kinematics: &Kinematics, supports: &[Carried]) -> Self {
        let segments = 0..model.segments().len();
        Self {
            joints: segments.map(|segment| kinematics.placement(model, segment).translation.vector).collect(),
            shares: supports.iter().map(|support| support.share).collect(),
            up: (-model.gravity()).try_normalize(0.0).unwrap_or_default(),
        }
    }

    /// Left and right exchanged; `None` where a support has no partner. `supports`: their segments.
    fn image(&self, mirror: &Mirror, supports: &[usize]) -> Option<Self> {
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
    fn is_like(&self, other: &Self, idle: &[bool]) -> bool {
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
    use crate::contact::{Balance, Slip};
    use crate::equilibria::Stability;
    use crate::model::{Adult, Side, adult};
    use crate::posture_solver::{Reason, SolvedPosture};

    /// The adult with the right arm forward by so many degrees; its shoulder works at so much of its strength.
    fn posture(model: &Model, degrees: f64, load: f64) -> RelaxedPosture {
        let coordinate = model.coordinate("arm_flex_r").unwrap();
        let mut posture = model.default_posture();
        posture.values_mut()[coordinate] = f64::to_radians(degrees);
        let relaxed = SolvedPosture {
            posture,
            levels: vec![],
            effort: 0.0,
            slip: Slip::default(),
            balance: Balance::Held,
            reason: Reason::Converged,
            steps: 0,
        };
        let stability = Stability { equilibrium: None, directions: vec![], unstable: 0, without_energy: 0.0 };
        let work = Work { coordinate, side: Side::Positive, active: 10.0 * load, strength: 10.0, endurance: 60.0 };
        RelaxedPosture {
            relaxed,
            supports: vec![],
            stability,
            torques: [vec![], vec![]],
            work: vec![work],
            hanging: vec![],
            starts: vec![],
            mirrored: false,
        }
    }

    /// The arms (degrees) of the ways among postures with these arms and loads, and the number of postures left out.
    fn ways(all: &[(f64, f64)]) -> (Vec<f64>, usize) {
        let model = adult(&Adult::default()).unwrap();
        let idle = vec![false; model.segments().len()];
        let mut found =
            DifferentWays { idle, supports: vec![], mirror: None, postures: vec![], alike: 0, ways: vec![] };
        let mut kinematics = Kinematics::new(&model);
        for (degrees, load) in all {
            let posture = posture(&model, *degrees, *load);
            kinematics.update(&model, &posture.relaxed.posture).unwrap();
            found.take(&model, &kinematics, posture);
        }
        let arm = model.coordinate("arm_flex_r").unwrap();
        let arms = found.postures.iter().map(|one: &RelaxedPosture| one.relaxed.posture.values()[arm].to_degrees());
        (arms.map(f64::round).collect(), found.alike)
    }

    #[test]
    fn a_posture_that_is_known_beyond_strength_or_a_sixth_one_is_no_other_way_to_stand() {
        assert_eq!(ways(&[(0.0, 0.5), (2.0, 0.5), (40.0, 0.5), (41.0, 0.5)]), (vec![0.0, 40.0], 2));
        assert_eq!(ways(&[(0.0, 0.5), (40.0, 1.1), (80.0, 1.0)]), (vec![0.0, 80.0], 1));
        assert_eq!(ways(&[(0.0, 1.1)]), (vec![0.0], 0), "where no posture needs less");
        let seven: Vec<(f64, f64)> = (0..7).map(|k| (20.0 * f64::from(k), 0.5)).collect();
        assert_eq!(ways(&seven), (vec![0.0, 20.0, 40.0, 60.0, 80.0], 2));
    }

    #[test]
    fn a_body_that_stands_elsewhere_on_the_floor_in_the_same_posture_stands_in_the_same_way() {
        let model = adult(&Adult::default()).unwrap();
        let idle = vec![false; model.segments().len()];
        let mut kinematics = Kinematics::new(&model);
        let mut way = |coordinate: &str, by: f64| {
            let mut posture = model.default_posture();
            posture.values_mut()[model.coordinate(coordinate).unwrap()] += by;
            kinematics.update(&model, &posture).unwrap();
            WayToStand::of(&model, &kinematics, &[])
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
