//! Assesses a recorded motion: which muscle group fails first, and where relief would lie.
//!
//! Postures come from outside: each at rest, or with speeds and accelerations, whose inertia is a part of `tau_e`. At each of them the
//! muscles give
//! `tau_a = -(tau_p + tau_e)` (Rodriguez & Boulic 2007, Eq. 1), contact forces of supports included; between two of them the relative
//! load of every group changes in a straight line, and the group tires under it by its own law. At the peaks of load and of fatigue
//! the hybrid minimisation says where relief would lie if that joint alone moved.
//! A motion can be one cycle of a job that repeats it for hours ([`AssessSettings::repetition`]).
//!
//! Passive torque grows e-fold within a few degrees at the end of a joint's range, and recorded angles have errors of that size: a straight elbow
//! recorded at 0 deg would need 13 N m of its extensors, at 5 deg 2.7. So a group that works against the passive torque of its own joint
//! is judged by the passive torque within [`AssessSettings::angle_error`] that asks least of it, but never by one that helps it. Groups whose
//! load comes from the external torque are not concerned.

mod acceleration;
mod cycle_search;
mod cycles;
mod error;
mod evaluation;
mod groups;
mod range;
mod repetition;
mod result;
mod settings;

use nalgebra::Vector3;

use crate::contact::{Condition, Missing};
use crate::joint_torques::Hazard;
use crate::kinematics::Kinematics;
use crate::model::{CoordinateKind, Model};
use crate::posture::Posture;
use crate::statics::Load;
pub use acceleration::{FAST_SHARE, acceleration};
pub use cycle_search::{ALIKE, NoCycles};
pub use cycles::{Curve, CycleGrid, CycleOrigin, Cycles, PERCENTS};
pub use error::AssessError;
use evaluation::Evaluation;
use groups::Groups;
pub use range::{NEARLY_ALL, is_in_doubt, share_outside};
pub use result::{
    AngleInDoubt, Assessment, GroupAssessment, Instant, Peak, PeakKind, PeakTorques, Proposal, RepeatedGroup,
};
pub use settings::{ANGLE_ERROR, AssessSettings, CRITICAL_LEVEL};

/// Share of its weight above which a body lacks a force in every instant for nothing to carry it. Assumed: measured ground reaction of a
/// walk leaves less in most of its instants, a motion without ground reaction leaves all of it.
const UNCARRIED: f64 = 0.5;
/// Longest motion, s: more than a day.
const LONGEST_MOTION: f64 = 1e5;

/// Assesses postures at rising times (s). `loads` adds what pulls on the body besides its weight at a time, in the posture that
/// the kinematics hold; every instant is shown to `record`.
///
/// # Errors
/// [`AssessError`] names the first instant that is not in order.
pub fn assess(
    model: &Model,
    motion: &[(f64, Posture)],
    mut loads: impl FnMut(f64, &Kinematics, &mut Vec<Load>),
    settings: &AssessSettings,
    mut record: impl FnMut(&Instant),
) -> Result<Assessment, AssessError> {
    if let (Some((first, _)), Some((last, _))) = (motion.first(), motion.last())
        && last - first > LONGEST_MOTION
    {
        return Err(AssessError::TooLong(last - first));
    }
    if !settings.rates.is_empty() && settings.rates.len() != motion.len() {
        return Err(AssessError::Rates { given: settings.rates.len(), needed: motion.len() });
    }
    let mut evaluation = Evaluation::new(model, settings)?;
    let mut groups = Groups::new(model, settings.repetition.is_some());
    let mut found = Assessment::of_motion(model, motion, settings);
    let mut centers: Vec<Vector3<f64>> = vec![];
    let mut before: Option<f64> = None;
    let mut uncarried = 0;
    for (index, (time, posture)) in motion.iter().enumerate() {
        if !time.is_finite() || before.is_some_and(|before| *time < before) {
            return Err(AssessError::Order { index, time: *time });
        }
        evaluation.update(index, *time, posture, &mut loads)?;
        groups.add(&mut evaluation, index, *time, before.map_or(0.0, |before| time - before));
        found.take_root(&evaluation, index, *time);
        found.take_hazards(&evaluation);
        uncarried += usize::from(found.take_uncarried(&evaluation));
        centers.extend(evaluation.torques.kinematics().center_of_mass(model));
        record(&Instant {
            index,
            time: *time,
            model: &evaluation.model,
            torques: &evaluation.torques,
            fatigue: &groups.fatigue,
            load: &groups.load,
            inertia: evaluation.inertia.as_ref(),
            contact: evaluation.contact.as_ref(),
        });
        before = Some(*time);
    }
    found.uncarried = found.uncarried.filter(|_| uncarried == motion.len() && !settings.root_held);
    (found.acceleration, found.fast_share) = acceleration(motion, &centers);
    found.groups = groups.summaries;
    found.repeat(model, motion, settings)?;
    for group in &mut found.groups {
        for (at, peak) in [(PeakKind::Load, group.peak_load), (PeakKind::Fatigue, group.peak_fatigue)] {
            if peak.value > 0.0 && (at == PeakKind::Load || peak.index != group.peak_load.index) {
                let (time, posture) = &motion[peak.index];
                evaluation.update(peak.index, *time, posture, &mut loads)?;
                evaluation.propose(group, at, *time, settings);
            }
        }
    }
    sort(&mut found.groups);
    Ok(found)
}

/// The share of instants in which a coordinate lies outside of its range by more than the error of recorded angles, where that puts its sign,
/// unit or zero in doubt.
fn out_of_range(model: &Model, motion: &[(f64, Posture)], i: usize) -> Option<f64> {
    let coordinate = &model.coordinates()[i];
    if coordinate.kind == CoordinateKind::Quaternion || model.is_dependent(i) {
        return None;
    }
    let values: Vec<f64> = motion.iter().filter_map(|(_, posture)| posture.values().get(i).copied()).collect();
    let error = if coordinate.kind == CoordinateKind::Rotation { ANGLE_ERROR } else { 0.0 };
    let range = (coordinate.range.0 - error, coordinate.range.1 + error);
    is_in_doubt(&values, range).then(|| share_outside(values, range))
}

impl Assessment {
    /// The findings before the first instant.
    fn of_motion(model: &Model, motion: &[(f64, Posture)], settings: &AssessSettings) -> Self {
        let out_of_range = (0..model.coordinates().len()).filter_map(|i| Some((i, out_of_range(model, motion, i)?)));
        Self {
            dynamics: !settings.rates.is_empty(),
            repetition: settings.repetition,
            out_of_range: out_of_range.collect(),
            ..Self::default()
        }
    }

    /// Whether loads leave a body without supports more than half of its weight; takes in what the first such instant lacks.
    fn take_uncarried(&mut self, evaluation: &Evaluation<'_>) -> bool {
        let (force, moment) = evaluation.residual();
        let weight = evaluation.model.mass() * evaluation.model.gravity().norm();
        let falls = evaluation.contact.is_none() && force > UNCARRIED * weight;
        if falls && self.uncarried.is_none() {
            let condition = if evaluation.is_loaded() { Condition::Other } else { Condition::NoSupport };
            self.uncarried = Some(Missing { force, moment, condition });
        }
        falls
    }

    /// Takes in the hazards of an instant.
    fn take_hazards(&mut self, evaluation: &Evaluation<'_>) {
        let torques = &evaluation.torques;
        for (i, coordinate) in evaluation.model.coordinates().iter().enumerate() {
            let Some(rate) = coordinate.rate else { continue };
            let ((external, passive), angle) = (torques.external_and_passive(rate), torques.angles()[i]);
            let Some(row) = Hazard::at(coordinate, angle, external, passive) else { continue };
            let new = Hazard { coordinate: i, angle, external, passive, row };
            match self.hazards.iter_mut().find(|hazard| hazard.coordinate == i) {
                Some(hazard) if hazard.passive.abs() < passive.abs() => *hazard = new,
                Some(_) => {}
                None => self.hazards.push(new),
            }
        }
    }

    /// Takes in what the root lacks at an instant.
    fn take_root(&mut self, evaluation: &Evaluation<'_>, index: usize, time: f64) {
        let (force, moment) = evaluation.residual();
        self.residual_force.take(force, index, time);
        self.residual_moment.take(moment, index, time);
        self.unheld += usize::from(evaluation.is_out_of_balance());
        if self.unheld == 1 && self.missing.is_none() {
            self.missing = evaluation.missing().map(|missing| (missing, time));
        }
    }
}

/// Groups that fail first come first, then those of greater fatigue, then those of greater load.
fn sort(groups: &mut [GroupAssessment]) {
    let failure = |group: &GroupAssessment| group.exhausted_at.unwrap_or(f64::INFINITY);
    groups.sort_by(|a, b| {
        let greater = |of: fn(&GroupAssessment) -> f64| of(b).total_cmp(&of(a));
        let first = failure(a).total_cmp(&failure(b));
        first.then(greater(GroupAssessment::greatest_fatigue)).then(greater(|g| g.peak_load.value))
    });
}
