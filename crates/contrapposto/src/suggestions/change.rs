//! Lists the changes of a scenario that are tried, and carries them out.

use nalgebra::Vector3;

use super::job::Job;
use super::resting_hand::RestingHand;
use crate::equilibria::Mirror;
use crate::hybrid::Strategy;
use crate::joint_torques::Hazard;
use crate::kinematics::Kinematics;
use crate::model::{Model, plain_name};
use crate::posture::Posture;
use crate::simulation::{Scenario, TaskSettings};
use crate::statics::{Load, LoadKind};
use crate::tasks::{self, LookAt, LookAtGoal, PriorityLevel, Task};
use crate::verdict::HandLoad;

/// A target is moved so far, m.
const MOVED: f64 = 0.1;
/// Of a job in hazard a target is moved so far up, too, m: what is lifted begins on a shelf or a pallet. Assumed.
pub(super) const SHELF: f64 = 0.3;
/// A joint in hazard is asked to this share of the angle from which on there is one. Assumed.
const WITHIN_HAZARD: f64 = 2.0 / 3.0;
/// A lighter load is so much of the given one.
const LIGHTER: f64 = 0.8;
/// A load that a hand can hold is told in steps of this share of the given one, or in fine ones where that is less than a step.
const SHARE_STEP: f64 = 0.05;
const FINE_SHARE_STEP: f64 = 0.01;
/// Feet are one ahead of the other from this distance on, m.
const AHEAD: f64 = 0.05;

/// A change of a job.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// All targets of segments that carry nothing are moved, ground, m.
    Targets(Vector3<f64>, &'static str),
    /// Coordinates take other angles, as far as the targets allow.
    Joints(Vec<JointAngle>),
    /// All loads are so much of the given ones.
    Loads(f64),
    /// The whole body seeks relief by this strategy.
    Strategy(Strategy),
    /// Right and left change places at the start: the feet stand the other way round.
    OtherFoot,
    /// A free hand may be put down to rest.
    Hand(RestingHand),
    /// Two changes at once.
    Both(Box<[Change; 2]>),
}

/// Another angle of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointAngle {
    /// The coordinate.
    pub coordinate: usize,
    /// The angle in the job without the change, rad.
    pub before: f64,
    /// The angle that is asked for, rad.
    pub angle: f64,
}

/// The changes that make sense for a job that ends in these hazards, in a fixed order.
pub fn changes(job: &Job<'_>, hazards: &[Hazard]) -> Vec<Change> {
    let mut changes = vec![];
    let up = job.up();
    if let (Some(middle), Some(up)) = (job.middle_of_targets(), up) {
        changes.push(Change::Targets(-MOVED * up, "10 cm lower"));
        changes.push(Change::Targets(MOVED * up, "10 cm higher"));
        let toward = job.center_of_mass().map(|center| center - middle).map(|away| away - away.dot(&up) * up);
        if let Some(toward) = toward.filter(|away| away.norm() > 2.0 * MOVED) {
            changes.push(Change::Targets(MOVED * toward.normalize(), "10 cm nearer"));
        }
    }
    if let (false, Some(up), Some(_)) = (hazards.is_empty(), up, job.targets().first()) {
        changes.push(Change::Targets(SHELF * up, "30 cm higher"));
    }
    changes.extend(job.out_of_hazard(hazards).map(Change::Joints));
    changes.extend(job.lighter().map(Change::Loads));
    changes.extend(job.strategy.map(|kind| {
        Change::Strategy(match kind {
            Strategy::Active => Strategy::Passive,
            Strategy::Passive => Strategy::Active,
        })
    }));
    changes.extend(job.feet().map(|_| Change::OtherFoot));
    // Only a run puts a hand down.
    if job.asked.is_some() {
        changes.extend(RestingHand::all(job).into_iter().map(Change::Hand));
    }
    changes
}

impl Job<'_> {
    /// The mean of the targets, so that two hands come nearer alike, ground, m.
    pub(super) fn middle_of_targets(&self) -> Option<Vector3<f64>> {
        let targets = self.targets();
        let sum: Vector3<f64> = targets.iter().map(|(_, target, _)| target).sum();
        (!targets.is_empty()).then(|| sum / targets.len() as f64)
    }

    /// The share of the loads that is tried: four fifths, or less where no hand could hold that. `None` without loads, and where a hand
    /// could not hold a hundredth.
    fn lighter(&self) -> Option<f64> {
        if self.loads.iter().all(|loads| loads.is_empty()) {
            return None;
        }
        let hands = self.loads.iter().flat_map(|loads| HandLoad::all(self.model, loads));
        let share = hands.map(|hand| hand.most() / hand.weight).fold(f64::INFINITY, f64::min);
        let within = |step: f64| (share / step).floor() * step;
        match share >= LIGHTER {
            true => Some(LIGHTER),
            false => [SHARE_STEP, FINE_SHARE_STEP].map(within).into_iter().find(|share| *share > 0.0),
        }
    }

    /// Angles at which the coordinates in these hazards are in none; `None` without hazards, and where the posture is given.
    fn out_of_hazard(&self, hazards: &[Hazard]) -> Option<Vec<JointAngle>> {
        let angle = |&Hazard { coordinate, angle: before, row, .. }: &Hazard| {
            let limit = row.limit(&self.model.coordinates()[coordinate], before)?;
            Some(JointAngle { coordinate, before, angle: WITHIN_HAZARD * limit })
        };
        let angles: Vec<JointAngle> = hazards.iter().filter_map(angle).collect();
        (!angles.is_empty() && !self.levels.is_empty()).then_some(angles)
    }

    /// The foot that is ahead and the other one, of a body with a mirror image that stands on two segments of both sides alone, one ahead of
    /// the other.
    pub(super) fn feet(&self) -> Option<[String; 2]> {
        let model = self.model;
        let [a, b] = self.supports else { return None };
        let mut kinematics = Kinematics::new(model);
        if kinematics.update(model, self.start).is_err() || (a.share_max - b.share_max).abs() > 0.0 {
            return None;
        }
        let place = |segment: usize| kinematics.placement(model, segment).translation.vector.x;
        let names = [a, b].map(|support| plain_name(&model.segments()[support.segment].name));
        let pair =
            names.iter().any(|name| name.starts_with("right ")) && names.iter().any(|name| name.starts_with("left "));
        let ahead = place(a.segment) - place(b.segment);
        let [a, b] = names;
        let ordered = if ahead > 0.0 { [a, b] } else { [b, a] };
        (pair && ahead.abs() > AHEAD && Mirror::of(model).is_some()).then_some(ordered)
    }
}

impl Change {
    /// Whether it makes the loads lighter.
    pub(super) fn is_lighter(&self) -> bool {
        match self {
            Self::Loads(_) => true,
            Self::Both(two) => two.iter().any(Self::is_lighter),
            _ => false,
        }
    }

    /// Two changes at once; `None` of two loads, two moves along one line, or two of another kind that exclude each other.
    pub(super) fn with(&self, other: &Self) -> Option<Self> {
        let go_together = match (self, other) {
            (Self::Targets(a, _), Self::Targets(b, _)) => a.dot(b).abs() < 0.5 * a.norm() * b.norm(),
            (Self::Both(_), _) | (_, Self::Both(_)) => false,
            (Self::Hand(a), Self::Hand(b)) => a.support.segment != b.support.segment,
            (a, b) => std::mem::discriminant(a) != std::mem::discriminant(b),
        };
        go_together.then(|| Self::Both(Box::new([self.clone(), other.clone()])))
    }

    /// The scenario with the change.
    #[must_use]
    pub fn apply(&self, scenario: &Scenario) -> Scenario {
        if let Self::Both(two) = self {
            return two[1].apply(&two[0].apply(scenario));
        }
        let (job, mut changed) = (Job::from(scenario), scenario.clone());
        changed.tasks.iter_mut().for_each(|task| self.apply_to_level(&job, &mut task.goal));
        if let Some((place, goal)) = self.new_level(&job) {
            changed.tasks.insert(place, TaskSettings { goal, above_relief: false });
            let later = changed.events.iter_mut().flat_map(|event| &mut event.tasks);
            later.for_each(|(task, _)| *task += usize::from(*task >= place));
        }
        self.apply_to_loads(&mut changed.loads);
        for event in &mut changed.events {
            event.tasks.iter_mut().for_each(|(_, goal)| self.apply_to_level(&job, goal));
            event.loads.iter_mut().for_each(|loads| self.apply_to_loads(loads));
        }
        if let Self::Strategy(kind) = self {
            changed.strategy.kind = *kind;
            changed.strategies.fill(*kind);
        }
        if let Self::Hand(hand) = self {
            changed.rests.push(hand.rest(changed.supports.len()));
            changed.supports.push(hand.support.clone());
        }
        changed.start = self.start(&job);
        changed
    }

    /// Moves targets, and adds a level where the change asks for angles.
    pub fn apply_to_goals(&self, job: &Job<'_>, goals: &mut Vec<PriorityLevel>) {
        if let Self::Both(two) = self {
            return two.iter().for_each(|one| one.apply_to_goals(job, goals));
        }
        goals.iter_mut().for_each(|level| self.apply_to_level(job, level));
        if let Some((place, level)) = self.new_level(job) {
            goals.insert(place, level);
        }
    }

    /// The level that asks for angles, and its place among the levels of the job: below all targets, above effort and postures of rest.
    fn new_level(&self, job: &Job<'_>) -> Option<(usize, PriorityLevel)> {
        let Self::Joints(angles) = self else { return None };
        let rest = |task: &Task| matches!(task, Task::Effort(_) | Task::Posture(_));
        let place = job.levels.iter().position(|level| level.tasks.iter().any(rest)).unwrap_or(job.levels.len());
        let (mut target, mut weights) = (job.start.clone(), vec![0.0; job.model.rates().len()]);
        for &JointAngle { coordinate: i, angle, .. } in angles {
            target.values_mut()[i] = angle;
            job.model.coordinates()[i].rate.iter().for_each(|&rate| weights[rate] = 1.0);
        }
        Some((place, Task::Posture(tasks::Posture { target, weights }).into()))
    }

    /// Moves the targets of a level. An arm whose hand may be put down is no longer asked to hang.
    fn apply_to_level(&self, job: &Job<'_>, level: &mut PriorityLevel) {
        if let Self::Hand(hand) = self {
            level.tasks.retain(|task| !(task.hangs(job.model) && hand.is_moved_by(job.model, task)));
        }
        let Self::Targets(by, _) = self else { return };
        for task in level.tasks.iter_mut().filter(|_| !level.hard) {
            match task {
                Task::Point(point) if !job.carries(point.segment) => point.target += by,
                Task::Placement(placement) if !job.carries(placement.segment) => {
                    placement.target.translation.vector += by;
                }
                Task::LookAt(LookAt { goal: LookAtGoal::Place(target), .. }) => *target += by,
                _ => {}
            }
        }
    }

    /// Makes loads lighter.
    pub fn apply_to_loads(&self, loads: &mut [Load]) {
        let share = match self {
            Self::Loads(share) => share,
            Self::Both(two) => return two.iter().for_each(|one| one.apply_to_loads(loads)),
            _ => return,
        };
        for load in loads {
            match &mut load.kind {
                LoadKind::Weight(mass) => *mass *= share,
                LoadKind::Force(vector, _) | LoadKind::Couple(vector, _) => *vector *= *share,
            }
        }
    }

    /// The start with the change.
    pub fn start(&self, job: &Job<'_>) -> Posture {
        if let Self::Both(two) = self {
            return two[usize::from(two[1] == Self::OtherFoot)].start(job);
        }
        let mirror = if matches!(self, Self::OtherFoot) { Mirror::of(job.model) } else { None };
        mirror.map_or_else(|| job.start.clone(), |mirror| legs_of(job.model, job.start, &mirror.posture(job.start)))
    }
}

/// `start` with the coordinates of the legs and the root taken from `image`.
fn legs_of(model: &Model, start: &Posture, image: &Posture) -> Posture {
    let legs = ["hip", "knee", "ankle", "subtalar", "mtp", "pelvis"];
    let values = model.coordinates().iter().enumerate().map(|(i, coordinate)| {
        let mirrored = legs.iter().any(|leg| coordinate.name.starts_with(leg));
        if mirrored { image.values()[i] } else { start.values()[i] }
    });
    Posture::new(values.collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::contact::{Place, Support};
    use crate::model::{Adult, adult};

    /// The feet that change places, of the adult on these segments with the right thigh forward by so many degrees.
    fn feet(names: [&str; 2], degrees: f64, share_max: f64) -> Option<[String; 2]> {
        let model = adult(&Adult::default()).unwrap();
        let mut start = model.default_posture();
        start.values_mut()[model.coordinate("hip_flexion_r").unwrap()] = degrees.to_radians();
        let support = |(name, share_max): (&str, f64)| {
            let segment = model.segment(name).unwrap();
            let corners = model.segments()[segment].patch.clone();
            Support { segment, corners, normal: Vector3::y(), friction: 0.6, share_max, place: Place::Fixed }
        };
        let supports = [(names[0], 1.0), (names[1], share_max)].map(support);
        let job = Job {
            model: &model,
            start: &start,
            supports: &supports,
            limits: &[],
            rests: vec![],
            levels: vec![],
            loads: vec![],
            asked: None,
            strategy: None,
        };
        job.feet()
    }

    #[test]
    fn feet_change_places_only_where_a_right_and_a_left_one_stand_one_ahead_of_the_other_and_carry_alike() {
        let [right, left] = ["calcn_r", "calcn_l"];
        let [right_first, left_first] = [[right, left], [left, right]].map(|names| Some(names.map(plain_name)));
        assert_eq!(feet([right, left], 20.0, 1.0), right_first);
        assert_eq!(feet([left, right], 20.0, 1.0), right_first);
        assert_eq!(feet([right, left], -20.0, 1.0), left_first);
        assert_eq!(feet([right, left], 0.0, 1.0), None, "side by side");
        assert_eq!(feet([right, "toes_r"], 0.0, 1.0), None, "one foot");
        assert_eq!(feet([right, left], 20.0, 0.5), None, "one of them rests");
    }
}
