//! Judges one posture that is held.

use super::holding::failures;
use super::{Findings, Missed, Verdict};
use crate::contact::{Missing, Slip};
use crate::equilibria::{RelaxedPosture, Work};
use crate::joint_torques::{GroupLoad, Hazard};
use crate::model::Model;

/// A posture that is held, everybody rested at first.
#[derive(Clone, Debug, Default)]
pub struct HeldPosture {
    /// Groups at work.
    pub groups: Vec<GroupLoad>,
    /// What the supports lack; `None` in equilibrium.
    pub missing: Option<Missing>,
    /// Distance of the supports from their places.
    pub slip: Slip,
    /// Targets that are missed, the most important first.
    pub missed: Vec<Missed>,
    /// Coordinates in hazard.
    pub hazards: Vec<Hazard>,
}

impl HeldPosture {
    /// A posture of least effort with the targets that it misses.
    pub fn of_equilibrium(found: &RelaxedPosture, missed: Vec<Missed>) -> Self {
        let groups = found.work.iter().map(GroupLoad::from).collect();
        Self { groups, slip: found.relaxed.slip, missed, ..Self::default() }
    }
}

impl From<&Work> for GroupLoad {
    fn from(work: &Work) -> Self {
        let Work { coordinate, side, active, .. } = *work;
        Self { coordinate, side, torque: active, load: work.relative_load() }
    }
}

impl Verdict {
    /// Of a posture that is held as long as muscles can.
    ///
    /// ```
    /// use contrapposto::joint_torques::GroupLoad;
    /// use contrapposto::model::{Adult, Side, adult};
    /// use contrapposto::verdict::{HeldPosture, Verdict, VerdictKind};
    ///
    /// let model = adult(&Adult::right_arm())?;
    /// let coordinate = model.coordinate("elbow_flex_r").unwrap();
    /// let elbow = GroupLoad { coordinate, side: Side::Positive, torque: 35.0, load: 0.5 };
    /// let posture = HeldPosture { groups: vec![elbow], ..HeldPosture::default() };
    /// let verdict = Verdict::of_posture(&model, &posture);
    /// assert_eq!(verdict.kind, VerdictKind::HeldUntil);
    /// assert!(verdict.sentence.starts_with("Can be held 1.9"), "{}", verdict.sentence);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_posture(model: &Model, posture: &HeldPosture) -> Self {
        let hardest = posture.groups.iter().max_by(|a, b| a.load.total_cmp(&b.load));
        let later = failures(model, &posture.groups);
        let first = later.iter().min_by(|a, b| a.time.total_cmp(&b.time));
        Findings {
            hardest: hardest.map(|group| (*group, None)),
            missing: posture.missing.map(|missing| (missing, None)),
            slip: Some((posture.slip, None)),
            slides: posture.slip.exceeds(Slip::GREATEST).then_some((posture.slip, None)),
            missed: posture.missed.clone(),
            fails: first.filter(|failure| failure.time.is_finite()).copied(),
            later,
            hazards: posture.hazards.clone(),
            ..Findings::default()
        }
        .verdict(model)
    }

    /// Of a body for which no posture was found in which its supports hold it.
    pub fn of_fall(model: &Model, missing: Missing) -> Self {
        Findings { missing: Some((missing, None)), ..Findings::default() }.verdict(model)
    }
}
