//! Holds what came of the muscles of a run.

use serde::{Deserialize, Serialize};

use crate::model::Side;

/// Place of the person whose strength is a standard deviation below the mean.
const WEAKER_PERSON: usize = 0;
/// Place of the person of mean strength.
pub(super) const MEAN_PERSON: usize = 1;

/// The end of what the muscles of one person can give.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MuscleFailure {
    /// First time at which the muscles cannot give all torques, s.
    pub time: f64,
    /// The group with the greatest share in the limit then: its coordinate and side; `None` where no group has one.
    pub who: Option<(usize, Side)>,
}

/// One muscle over a run, of a person of mean strength.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MuscleSummary {
    /// The group that the muscle works for, whose parameters of fatigue it has: its coordinate and side; `None` of a muscle that turns no joint.
    pub works_for: Option<(usize, Side)>,
    /// Load, 0 to 1: active tension over the greatest of a rested muscle.
    pub load: f64,
    /// Greatest load, and when that was, s.
    pub peak_load: (f64, f64),
    /// Tension, that of passive fibres included, N.
    pub tension: f64,
    /// The same at the greatest load, N.
    pub peak_tension: f64,
    /// Share that is fatigued, 0 to 1.
    pub fatigued: f64,
    /// First time at which the muscle gave all that fatigue had left it, s.
    pub exhausted_at: Option<f64>,
}

/// The muscles of a run at its end.
#[derive(Clone, Debug, PartialEq)]
pub struct MuscleOutcome {
    /// By muscle of the model.
    pub muscles: Vec<MuscleSummary>,
    /// Of people whose strength is a standard deviation below the mean, the mean, and one above: when their muscles fail, during the run or if its
    /// last posture is held on; `None` if not within a day.
    pub failures: [Option<MuscleFailure>; 3],
    /// With the breaks that are suggested ([`Breaks::SUGGESTED`](crate::fatigue::Breaks::SUGGESTED)): when the muscles of people whose strength is a
    /// standard deviation below the mean, and of the mean, fail, s of work and breaks; `None` if not within a day. Nothing of a run that is too
    /// short for a break.
    pub with_breaks: Option<[Option<f64>; 2]>,
    /// Coordinates whose groups have the fatigue of muscles.
    pub coordinates: Vec<usize>,
}

impl MuscleOutcome {
    /// Least and greatest time (s) at which the muscles of people of different strength fail: for the group that then limits the mean person; for that of
    /// the weaker person the least one only; never for others. `None` of a group that tires by a law of its own.
    pub fn spread_of(&self, group: (usize, Side)) -> Option<(f64, f64)> {
        let times = self.failures.map(|failure| failure.map_or(f64::INFINITY, |failure| failure.time));
        let limits = |person: usize| self.failures[person].is_some_and(|failure| failure.who == Some(group));
        let (least, greatest) = times.iter().fold((f64::INFINITY, 0f64), |(l, g), time| (time.min(l), time.max(g)));
        let spread = match (limits(MEAN_PERSON), limits(WEAKER_PERSON)) {
            (true, _) => (least, greatest),
            (false, true) => (times[WEAKER_PERSON], f64::INFINITY),
            (false, false) => (f64::INFINITY, f64::INFINITY),
        };
        self.coordinates.contains(&group.0).then_some(spread)
    }

    /// Whether the muscles that give a group its strength fail, and limit the mean person at another group.
    pub(crate) fn fails_beside(&self, group: (usize, Side)) -> bool {
        self.coordinates.contains(&group.0)
            && self.failures[MEAN_PERSON].is_some_and(|failure| failure.who.is_some_and(|who| who != group))
    }

    /// For how long a group could go on to hold its load after the time `end`, s, given that time by its own fatigue and load; `None` for ever. The group
    /// that then limits the mean person fails with the muscles.
    pub fn seconds_left(&self, (coordinate, side): (usize, Side), end: f64, own: Option<f64>) -> Option<f64> {
        let MuscleFailure { time, who } = self.failures[MEAN_PERSON]?;
        let left = (time - end).max(0.0);
        if who == Some((coordinate, side)) { Some(left) } else { Some(own?.max(left)) }
    }
}
