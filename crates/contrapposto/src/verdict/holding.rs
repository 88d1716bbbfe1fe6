//! Computes when muscle groups fail in a posture that is held.

use super::spread::spread;
use super::{Failure, Findings, Tired, Who};
use crate::fatigue::LoadHistory;
use crate::joint_torques::GroupLoad;
use crate::model::{Model, MuscleGroup};

/// Time at which every group fails that was rested at first; infinite where the group holds for ever.
pub(super) fn failures(model: &Model, groups: &[GroupLoad]) -> Vec<Failure> {
    let failure = |group: &GroupLoad| {
        let muscles = &model.coordinates().get(group.coordinate)?.groups.as_ref()?[group.side.index()];
        let range = spread(muscles, &LoadHistory::constant(group.load), 0.0);
        Some(Failure { who: (*group).into(), time: muscles.fatigue.endurance_time(group.load), range })
    };
    groups.iter().filter_map(failure).collect()
}

/// Least time of all failures, s; infinite of none.
pub(super) fn least<'a>(failures: impl IntoIterator<Item = &'a Failure>) -> f64 {
    failures.into_iter().map(|failure| failure.range.0).fold(f64::INFINITY, f64::min)
}

/// A muscle group at the end of a run or motion.
pub(super) struct GroupAtEnd<'a> {
    /// The group, with its load at the end.
    pub(super) who: Who,
    /// Law and strength of the group.
    pub(super) muscles: &'a MuscleGroup,
    /// Relative load until then.
    pub(super) history: &'a LoadHistory,
    /// Fatigue at the start, 0..=1.
    pub(super) start: f64,
    /// Fatigue at the end.
    pub(super) fatigue: f64,
    /// For how long it could go on to hold its load, s; `None` for ever.
    pub(super) seconds_left: Option<f64>,
    /// Least and greatest time at which it fails between people, s, where it does not tire by a law of its own.
    pub(super) of_people: Option<(f64, f64)>,
}

impl GroupAtEnd<'_> {
    fn spread(&self) -> (f64, f64) {
        self.of_people.unwrap_or_else(|| spread(self.muscles, self.history, self.start))
    }

    /// Time at which the group fails under its load at the time `end`, s after `start`; `None` where the group did not work. Of a group that rests at the
    /// end only weaker people, or another law, fail: before.
    fn failure(&self, (start, end): (f64, f64)) -> Option<Failure> {
        if self.history.pieces().iter().all(|(_, load)| *load <= 0.0) {
            return None;
        }
        if self.who.load <= 0.0 {
            let (least, greatest) = self.spread();
            let range = (least - start, greatest - start);
            return least.is_finite().then_some(Failure { who: self.who, time: f64::INFINITY, range });
        }
        let time = end + self.seconds_left.unwrap_or(f64::INFINITY);
        let (least, greatest) = self.spread();
        let range = (least.min(time) - start, greatest.max(time) - start);
        Some(Failure { who: self.who, time: time - start, range })
    }
}

impl Findings {
    /// Takes in how long the posture of the end could be held on; `span` is the start and the end of the job, s. Of a job in which a group
    /// fails only the range of the time, which is that of whichever group fails first, and the most tired group.
    pub(super) fn take_end(&mut self, groups: &[GroupAtEnd<'_>], span: (f64, f64)) {
        let later: Vec<Failure> = groups.iter().filter_map(|group| group.failure(span)).collect();
        self.least = Some(least(later.iter().chain(&self.fails)));
        let greatest = later.iter().chain(&self.fails).map(|failure| failure.range.1).fold(f64::INFINITY, f64::min);
        if let (Some(fails), Some(least)) = (&mut self.fails, self.least) {
            fails.range = (least, greatest.max(fails.time));
        }
        let most = groups.iter().max_by(|a, b| a.fatigue.total_cmp(&b.fatigue));
        let holds = self.fails.is_none();
        self.tired = most.map(|group| {
            let lasts = holds && group.seconds_left.is_none();
            Tired { who: group.who, fatigue: group.fatigue, lasts }
        });
        if holds {
            self.later = later;
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot go on says where")]

    use super::*;
    use crate::model::{Adult, Side, adult};

    /// At 300 s a group fails in people of mean strength; in weaker ones another does at 60 s, in stronger ones a third at 500 s.
    #[test]
    fn the_range_of_a_job_is_that_of_whichever_group_fails_first() {
        let model = adult(&Adult::default()).unwrap();
        let coordinate = model.coordinate("arm_flex_r").unwrap();
        let muscles = &model.coordinates()[coordinate].groups.as_ref().unwrap()[0];
        let who = Who { coordinate, side: Side::Positive, load: 0.2 };
        let history = LoadHistory::constant(0.2);
        let group = |left: f64, range: (f64, f64)| GroupAtEnd {
            who,
            muscles,
            history: &history,
            start: 0.0,
            fatigue: 0.9,
            seconds_left: Some(left),
            of_people: Some(range),
        };
        let groups = [group(0.0, (120.0, 700.0)), group(1000.0, (60.0, 900.0)), group(100.0, (90.0, 500.0))];
        let range = |time: f64| {
            let fails = Some(Failure { who, time, range: (120.0, 700.0) });
            let mut findings = Findings { fails, ..Findings::default() };
            findings.take_end(&groups, (0.0, 400.0));
            (findings.fails.unwrap().range, findings.least)
        };
        assert_eq!(range(300.0), ((60.0, 500.0), Some(60.0)));
        // The time of the mean person lies within.
        assert_eq!(range(600.0).0, (60.0, 600.0));
    }
}
