//! Lists the changes of a scenario that are tried, and carries them out.

use nalgebra::Vector3;

use crate::equilibria::Mirror;
use crate::hybrid::Strategy;
use crate::kinematics::Kinematics;
use crate::model::{Model, plain_name};
use crate::posture::Posture;
use crate::simulation::Scenario;
use crate::statics::{Load, LoadKind};
use crate::tasks::{LookAt, LookAtGoal, PriorityLevel, Task};

/// A target is moved so far, m.
const MOVED: f64 = 0.1;
/// A lighter load is so much of the given one.
const LIGHTER: f64 = 0.8;
/// Feet are one ahead of the other from this distance on, m.
const AHEAD: f64 = 0.05;

/// A change of a job.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// All targets of segments that carry nothing are moved, ground, m.
    Targets(Vector3<f64>, &'static str),
    /// All loads are so much of the given ones.
    Loads(f64),
    /// The whole body seeks relief by this strategy.
    Strategy(Strategy),
    /// Right and left change places at the start: the feet stand the other way round.
    OtherFoot,
}

/// The changes that make sense for a scenario, in a fixed order.
pub fn changes(scenario: &Scenario) -> Vec<Change> {
    let model = &scenario.model;
    let mut changes = vec![];
    let up = (-model.gravity()).try_normalize(1e-9);
    if let (Some(&(_, target)), Some(up)) = (targets(scenario).first(), up) {
        changes.push(Change::Targets(-MOVED * up, "10 cm lower"));
        changes.push(Change::Targets(MOVED * up, "10 cm higher"));
        let mut kinematics = Kinematics::new(model);
        let center = kinematics.update(model, &scenario.start).ok().and_then(|()| kinematics.center_of_mass(model));
        let toward = center.map(|center| center - target).map(|away| away - away.dot(&up) * up);
        if let Some(toward) = toward.filter(|away| away.norm() > 2.0 * MOVED) {
            changes.push(Change::Targets(MOVED * toward.normalize(), "10 cm nearer"));
        }
    }
    let has_loads = !scenario.loads.is_empty() || scenario.events.iter().any(|event| event.loads.is_some());
    changes.extend(has_loads.then_some(Change::Loads(LIGHTER)));
    let kind = scenario.strategy.kind;
    if scenario.strategies.iter().all(|strategy| *strategy == kind)
        && scenario.events.iter().all(|event| event.strategies.is_none())
    {
        changes.push(Change::Strategy(match kind {
            Strategy::Active => Strategy::Passive,
            Strategy::Passive => Strategy::Active,
        }));
    }
    changes.extend(one_foot_is_ahead(scenario).then_some(Change::OtherFoot));
    changes
}

/// Segments that carry nothing and are asked to a place, and these places, ground, m.
fn targets(scenario: &Scenario) -> Vec<(usize, Vector3<f64>)> {
    let carries = |segment: usize| scenario.supports.iter().any(|support| support.segment == segment);
    let tasks = scenario.tasks.iter().flat_map(|task| &task.goal.tasks);
    let target = |task: &Task| match task {
        Task::Point(point) => Some((point.segment, point.target)),
        Task::Placement(placement) => Some((placement.segment, placement.target.translation.vector)),
        _ => None,
    };
    tasks.filter_map(target).filter(|(segment, _)| !carries(*segment)).collect()
}

/// Whether the body stands on two segments of both sides alone, one ahead of the other, and has a mirror image.
fn one_foot_is_ahead(scenario: &Scenario) -> bool {
    let model = &scenario.model;
    let [a, b] = scenario.supports.as_slice() else { return false };
    let mut kinematics = Kinematics::new(model);
    if kinematics.update(model, &scenario.start).is_err() || (a.share_max - b.share_max).abs() > 0.0 {
        return false;
    }
    let place = |segment: usize| kinematics.placement(model, segment).translation.vector.x;
    let names = [a, b].map(|support| plain_name(&model.segments()[support.segment].name));
    let pair =
        names.iter().any(|name| name.starts_with("right ")) && names.iter().any(|name| name.starts_with("left "));
    pair && (place(a.segment) - place(b.segment)).abs() > AHEAD && Mirror::of(model).is_some()
}

impl Change {
    /// The scenario with the change.
    #[must_use]
    pub fn apply(&self, scenario: &Scenario) -> Scenario {
        let mut changed = scenario.clone();
        match self {
            Self::Targets(by, _) => {
                let carries: Vec<usize> = scenario.supports.iter().map(|support| support.segment).collect();
                let levels = changed.tasks.iter_mut().map(|task| &mut task.goal);
                let later = changed.events.iter_mut().flat_map(|event| &mut event.tasks).map(|(_, goal)| goal);
                levels.chain(later).for_each(|level| move_targets(level, *by, &carries));
            }
            Self::Loads(share) => {
                let later = changed.events.iter_mut().filter_map(|event| event.loads.as_mut());
                std::iter::once(&mut changed.loads).chain(later).flatten().for_each(|load| scale(load, *share));
            }
            Self::Strategy(kind) => {
                changed.strategy.kind = *kind;
                changed.strategies.fill(*kind);
            }
            Self::OtherFoot => {
                if let Some(mirror) = Mirror::of(&scenario.model) {
                    changed.start = legs_of(&scenario.model, &scenario.start, &mirror.posture(&scenario.start));
                }
            }
        }
        changed
    }

    /// `the target of right hand 10 cm lower`.
    pub fn in_words(&self, scenario: &Scenario) -> String {
        match self {
            Self::Targets(_, how) => {
                let mut names: Vec<String> = vec![];
                for (segment, _) in targets(scenario) {
                    let name = plain_name(&scenario.model.segments()[segment].name);
                    if !names.contains(&name) {
                        names.push(name);
                    }
                }
                format!("the target of {} {how}", names.join(" and "))
            }
            Self::Loads(share) => format!("{:.0}\u{a0}% less load", 100.0 * (1.0 - share)),
            Self::Strategy(Strategy::Active) => "relief by the active strategy".to_owned(),
            Self::Strategy(Strategy::Passive) => "relief by the passive strategy".to_owned(),
            Self::OtherFoot => "the other foot ahead".to_owned(),
        }
    }
}

fn move_targets(level: &mut PriorityLevel, by: Vector3<f64>, carries: &[usize]) {
    for task in &mut level.tasks {
        match task {
            Task::Point(point) if !carries.contains(&point.segment) => point.target += by,
            Task::Placement(placement) if !carries.contains(&placement.segment) => {
                placement.target.translation.vector += by;
            }
            Task::LookAt(LookAt { goal: LookAtGoal::Place(target), .. }) => *target += by,
            _ => {}
        }
    }
}

fn scale(load: &mut Load, share: f64) {
    match &mut load.kind {
        LoadKind::Weight(mass) => *mass *= share,
        LoadKind::Force(vector, _) | LoadKind::Couple(vector, _) => *vector *= share,
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
