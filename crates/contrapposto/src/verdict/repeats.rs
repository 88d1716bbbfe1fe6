//! Judges a motion that is repeated for hours.

use super::holding::least;
use super::spread::spread_of_repeats;
use super::words::how_long;
use super::{Failure, Findings, Repeats, Tired, Who};
use crate::assessment::{Assessment, GroupAssessment};
use crate::fatigue::{Breaks, Repetition};
use crate::model::Model;

impl Findings {
    /// Takes in what becomes of the groups of a motion of `cycle` seconds when it is repeated.
    pub(super) fn take_repeats(&mut self, model: &Model, found: &Assessment, cycle: f64) {
        let Some(repetition) = found.repetition else { return };
        let asked = repetition.seconds;
        self.asked = Some(asked);
        let all: Vec<Failure> = found.groups.iter().filter_map(|group| failure(model, group, repetition)).collect();
        let first = all.iter().min_by(|a, b| a.time.total_cmp(&b.time)).copied();
        self.least = Some(least(&all));
        self.fails = first.filter(|failure| failure.time < asked);
        if self.fails.is_none() {
            self.later = all;
        }
        let times = found.groups.iter().filter_map(|group| Some((who(group), group.repeated?.relief_at)));
        let relief = times.filter(|(_, time)| *time < asked).min_by(|a, b| a.1.total_cmp(&b.1));
        self.repeats = Some(Repeats { cycle, repetition, relief });
        let most = found.groups.iter().max_by(|a, b| a.greatest_fatigue().total_cmp(&b.greatest_fatigue()));
        self.tired = most.filter(|_| self.fails.is_none()).map(|group| Tired {
            who: who(group),
            fatigue: group.greatest_fatigue(),
            lasts: group.repeated.is_some_and(|repeated| repeated.fails_at.is_infinite()),
        });
    }
}

/// The group with its greatest load.
fn who(group: &GroupAssessment) -> Who {
    Who { coordinate: group.coordinate, side: group.side, load: group.peak_load.value }
}

/// The time at which a group fails, however long the motion is repeated; `None` of a group that does not work.
fn failure(model: &Model, group: &GroupAssessment, repetition: Repetition) -> Option<Failure> {
    let muscles = &model.coordinates()[group.coordinate].groups.as_ref()?[group.side.index()];
    let time = group.repeated?.fails_at;
    let works = !group.cycle.is_idle();
    works.then(|| Failure { who: who(group), time, range: spread_of_repeats(muscles, &group.cycle, repetition) })
}

impl Repeats {
    /// `the motion of 1.2 s, 6000 times in 2.0 h, every 3.0 s, with a break of 10 min after every 50 min`.
    pub(super) fn in_words(&self) -> String {
        let Repetition { seconds, every, breaks } = self.repetition;
        let pause = if every > self.cycle { format!(", every {}", how_long(every)) } else { String::new() };
        let breaks = match breaks {
            Some(Breaks { work, rest }) => {
                format!(", with a break of {} after every {} of work", how_long(rest), how_long(work))
            }
            None => String::new(),
        };
        let (cycle, times) = (how_long(self.cycle), self.repetition.cycles());
        format!("the motion of {cycle}, {times} times in {}{pause}{breaks}", how_long(seconds))
    }

    /// `right hip extension asks for it first, after 24 min`.
    pub(super) fn relief_in_words(&self, model: &Model) -> Option<String> {
        let (who, time) = self.relief?;
        Some(format!("{} asks for it first, after {}", who.name(model), how_long(time)))
    }
}
