//! Judges one posture that is held.

use super::holding::{failures, least};
use super::{Findings, HandLoad, Missed, Verdict};
use crate::assessment::Assessment;
use crate::contact::{Missing, Slip};
use crate::equilibria::{Equilibria, RelaxedPosture, Search, Work};
use crate::joint_torques::{GroupLoad, Hazard};
use crate::model::Model;
use crate::statics::Load;

/// A posture that is held, everybody rested at first.
#[derive(Clone, Debug, Default)]
pub struct HeldPosture {
    /// Groups at work.
    pub groups: Vec<GroupLoad>,
    /// The force and moment that the supports lack; `None` in equilibrium.
    pub missing: Option<Missing>,
    /// Distance of the supports from their places.
    pub slip: Slip,
    /// Targets that are missed, the most important first.
    pub missed: Vec<Missed>,
    /// Coordinates in hazard.
    pub hazards: Vec<Hazard>,
    /// Weights in hands that are much for the grip.
    pub hands: Vec<HandLoad>,
    /// Loads on the body, which the sentence names where the supports do not hold it.
    pub loads: Vec<Load>,
}

impl HeldPosture {
    /// A posture of least effort with the targets that it misses.
    pub fn of_equilibrium(found: &RelaxedPosture, missed: Vec<Missed>) -> Self {
        let groups = found.work.iter().map(GroupLoad::from).collect();
        Self { groups, slip: found.relaxed.slip, missed, ..Self::default() }
    }
}

/// One posture that was assessed, held at rest.
impl From<&Assessment> for HeldPosture {
    fn from(found: &Assessment) -> Self {
        let groups = found.groups.iter().filter(|group| group.peak_load.value > 0.0).map(|group| GroupLoad {
            coordinate: group.coordinate,
            side: group.side,
            torque: group.peak_torque,
            load: group.peak_load.value,
        });
        let missing = found.missing.map(|(missing, _)| missing);
        Self { groups: groups.collect(), missing, hazards: found.hazards.clone(), ..Self::default() }
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
            least: Some(least(&later)),
            fails: first.filter(|failure| failure.time.is_finite()).copied(),
            later,
            hazards: posture.hazards.clone(),
            hands: posture.hands.clone(),
            loads: posture.loads.clone(),
            ..Findings::default()
        }
        .verdict(model)
    }

    /// Of a search for postures of least effort: that of the first one; `None` where it found none.
    pub fn of_equilibria(search: &Search<'_>, found: &Equilibria) -> Option<Self> {
        let (model, best) = (search.model, found.postures.first()?);
        let lengths = best.relaxed.levels.iter().map(|level| level.length);
        let missed = Missed::of_levels(model, &best.relaxed.posture, search.goals.iter().zip(lengths));
        let of = |torques: &[f64]| -> Vec<f64> {
            model.coordinates().iter().map(|coordinate| coordinate.rate.map_or(0.0, |rate| torques[rate])).collect()
        };
        let values = best.relaxed.posture.values();
        let hazards = Hazard::of_posture(model, values, &of(&best.torques[0]), &of(&best.torques[1]));
        let hands = HandLoad::all(model, search.loads);
        let posture = HeldPosture { hazards, hands, ..HeldPosture::of_equilibrium(best, missed) };
        Some(Self::of_posture(model, &posture))
    }

    /// Of a body for which no posture was found in which its supports hold it under these loads.
    pub fn of_fall(model: &Model, missing: Missing, loads: &[Load]) -> Self {
        let loads = loads.to_vec();
        Findings { missing: Some((missing, None)), loads, ..Findings::default() }.verdict(model)
    }
}
