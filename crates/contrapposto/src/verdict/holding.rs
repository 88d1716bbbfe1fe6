//! Finds the muscle group that fails first in one posture that is held.

use super::Failure;
use super::spread::spread;
use crate::fatigue::LoadHistory;
use crate::joint_torques::GroupLoad;
use crate::model::Model;

/// The group that fails first when all groups were rested; `None` where all hold for ever.
pub(super) fn fails_first(model: &Model, groups: &[GroupLoad]) -> Option<Failure> {
    let group_of = |group: &GroupLoad| {
        let groups = model.coordinates().get(group.coordinate)?.groups.as_ref()?;
        Some(&groups[group.side.index()])
    };
    let tires = groups.iter().filter_map(|group| {
        let seconds = group_of(group)?.fatigue.endurance_time(group.load);
        seconds.is_finite().then_some((*group, seconds))
    });
    let (group, time) = tires.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let history = LoadHistory::constant(group.load);
    Some(Failure { who: group.into(), time, range: spread(group_of(&group)?, &history, 0.0) })
}
