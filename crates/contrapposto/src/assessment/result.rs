//! Holds what an assessment finds: groups, peaks and proposals.

use crate::contact::{ContactForces, Missing};
use crate::dynamics::Inertia;
use crate::fatigue::{LoadCycle, LoadHistory, Repetition};
use crate::hybrid::{Decision, Strategy};
use crate::joint_torques::{Hazard, JointTorques};
use crate::model::{Model, Side};

/// One instant of the motion.
#[derive(Debug)]
pub struct Instant<'a> {
    /// Number of the instant, counted from 0.
    pub index: usize,
    /// Time, s.
    pub time: f64,
    /// The model, with the strength of this instant where muscles give it.
    pub model: &'a Model,
    /// Posture and torques, contact forces included.
    pub torques: &'a JointTorques,
    /// Fatigue of the positive and negative group of every coordinate, 0..=1.
    pub fatigue: &'a [[f64; 2]],
    /// Active torque over strength of the same.
    pub load: &'a [[f64; 2]],
    /// Inertia, whose loads are among those of `torques`; none of a posture at rest.
    pub inertia: Option<&'a Inertia>,
    /// Contact forces; none without supports.
    pub contact: Option<&'a ContactForces>,
}

/// A value and when it was there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// The value.
    pub value: f64,
    /// Number of the instant.
    pub index: usize,
    /// Time of the peak, s.
    pub time: f64,
}

impl Peak {
    pub(super) fn take(&mut self, value: f64, index: usize, time: f64) {
        if value > self.value {
            *self = Self { value, index, time };
        }
    }
}

/// Load and fatigue of one group over the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupAssessment {
    /// Index of its coordinate.
    pub coordinate: usize,
    /// The group of the coordinate, by the sign of its torque.
    pub side: Side,
    /// Greatest active torque over strength.
    pub peak_load: Peak,
    /// Active torque at that peak, as it is judged ([`AssessSettings::angle_error`](super::AssessSettings::angle_error)), N m.
    pub peak_torque: f64,
    /// Angle and torques at that peak.
    pub at_peak: PeakTorques,
    /// Relative load over the motion.
    pub loads: LoadHistory,
    /// Relative load of every instant of a motion that is repeated; empty of another one.
    pub cycle: LoadCycle,
    /// Findings of a motion that is repeated.
    pub repeated: Option<RepeatedGroup>,
    /// Greatest fatigue, 0..=1: of one cycle, where the motion is repeated.
    pub peak_fatigue: Peak,
    /// Fatigue at the end: of the last cycle, where the motion is repeated.
    pub fatigue: f64,
    /// Relative load at the end.
    pub load: f64,
    /// Time at which the fatigue of the group first reached 1, s; of a motion that is repeated, from its first instant on.
    pub exhausted_at: Option<f64>,
    /// The instant in which the error of the recorded angle counts most; `None` where it counts nowhere.
    pub in_doubt: Option<AngleInDoubt>,
    /// Reliefs at both peaks, by both strategies; none where the group rested or has no falling passive curve.
    pub proposals: Vec<Proposal>,
}

impl GroupAssessment {
    /// Greatest fatigue in the motion, or where it is repeated in the last cycle.
    pub fn greatest_fatigue(&self) -> f64 {
        self.repeated.map_or(self.peak_fatigue.value, |repeated| repeated.fatigue)
    }
}

/// Load and fatigue of one group over a motion that is repeated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepeatedGroup {
    /// Share of a cycle, with its pause, in which the group works.
    pub duty: f64,
    /// Mean relative load over a cycle with its pause.
    pub mean_load: f64,
    /// Greatest fatigue in the last cycle of the job; 1 of a group that has failed.
    pub fatigue: f64,
    /// Time from the start of the job at which the group asks for relief, s; infinite where it never does, however long the motion is repeated.
    pub relief_at: f64,
    /// Time from the start of the job at which the group fails, s; infinite likewise.
    pub fails_at: f64,
}

/// Angle and torques of a coordinate at the greatest load of one of its groups.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PeakTorques {
    /// The angle, rad (m).
    pub angle: f64,
    /// External torque, N m.
    pub external: f64,
    /// Passive torque, as it is judged, N m.
    pub passive: f64,
    /// Strength of the group, N m.
    pub strength: f64,
    /// The part of the external torque that inertia gives, N m; 0 of a posture at rest.
    pub inertia: f64,
}

/// The instant in which the error of a recorded angle counts most for a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleInDoubt {
    /// Time, s.
    pub time: f64,
    /// The recorded angle, rad.
    pub angle: f64,
    /// Load at the recorded angle, as a share of strength.
    pub recorded_load: f64,
    /// Load within the error of the angle, where it is least.
    pub judged_load: f64,
    /// Active torque at the recorded angle, N m.
    pub recorded_torque: f64,
    /// Active torque as it is judged, N m.
    pub judged_torque: f64,
}

impl AngleInDoubt {
    /// Takes in another instant, with its recorded and its judged load, where these differ most so far.
    pub(super) fn take(known: &mut Option<Self>, (recorded, judged): (f64, f64), new: impl FnOnce() -> Self) {
        let most = known.map_or(0.0, |known| known.recorded_load - known.judged_load);
        if recorded - judged > most {
            *known = Some(new());
        }
    }
}

/// Passive torque over external torque from which on a muscle that opposes it is judged at another angle alone (assumed); from an equal one
/// on in part.
pub(super) const LIGAMENT_RATIO: f64 = 2.0;

impl PeakTorques {
    /// The muscle works against the joint's own tissue: its torque `-(external + passive)` opposes the passive torque, which is greater than
    /// the external torque in size. A body at rest rarely does so: its measured angles are mostly counted from a wrong zero.
    pub fn works_against_ligaments(&self) -> bool {
        let active = -(self.external + self.passive);
        active * self.passive < 0.0 && self.passive.abs() > self.external.abs()
    }
}

/// The peak at which a relief is proposed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeakKind {
    /// Greatest load.
    Load,
    /// Greatest fatigue.
    Fatigue,
}

/// A relief that the hybrid minimisation proposes.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// At which peak.
    pub at: PeakKind,
    /// Time of the peak, s.
    pub time: f64,
    /// Value of the coordinate there, rad.
    pub angle: f64,
    /// The strategy asked for.
    pub strategy: Strategy,
    /// Case, goal and outcome.
    pub decision: Decision,
    /// The same in a plain sentence.
    pub sentence: String,
}

/// The result of an assessment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assessment {
    /// Every group of known strength: those that fail first, then by fatigue, then by load.
    pub groups: Vec<GroupAssessment>,
    /// Coordinates in hazard, each where passive tissue carries most.
    pub hazards: Vec<Hazard>,
    /// Coordinates that lie outside of their ranges in nearly all instants, with the share of these.
    pub out_of_range: Vec<(usize, f64)>,
    /// Greatest force that the root lacked, N: neither loads nor supports gave it.
    pub residual_force: Peak,
    /// Greatest moment that it lacked, N m.
    pub residual_moment: Peak,
    /// Number of instants in which the supports could not hold the root.
    pub unheld: usize,
    /// Force and torque that the supports lack in the first of these instants, and its time, s.
    pub missing: Option<(Missing, f64)>,
    /// Inertia counts in all torques.
    pub dynamics: bool,
    /// The motion is one cycle of a job that repeats it.
    pub repetition: Option<Repetition>,
    /// Force and torque that a body without supports lacks, where in every instant more than half of its weight is carried by no load.
    pub uncarried: Option<Missing>,
    /// Greatest acceleration of the centre of mass, m/s^2.
    pub acceleration: Peak,
    /// Share of the instants in which it was above 1 m/s^2, so that a posture at rest says little.
    pub fast_share: f64,
}

#[cfg(test)]
mod tests {
    use super::PeakTorques;

    #[test]
    fn a_muscle_against_a_passive_torque_above_the_load_works_against_ligaments() {
        let against =
            |external, passive| PeakTorques { external, passive, ..PeakTorques::default() }.works_against_ligaments();
        assert!(against(-8.0, -22.9), "both push one way, mostly the ligament");
        assert!(against(2.0, -10.0), "the load pushes the other way, and less");
        assert!(against(-8.0, -10.0), "more than half of it");
        assert!(!against(-8.0, -7.0), "mostly the load");
        assert!(!against(-20.0, 10.0), "the ligament helps");
        assert!(!against(0.0, 0.0));
    }
}
