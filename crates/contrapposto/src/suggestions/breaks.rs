//! Computes how long a job can be done with breaks.

use super::trial::Suggestion;
use crate::assessment::{Assessment, GroupAssessment};
use crate::fatigue::{Breaks, FatigueLaw, LoadHistory, Repeated, Repetition};
use crate::model::{Model, MuscleGroup, Side};
use crate::simulation::{MuscleOutcome, Scenario, Summary};
use crate::verdict::{self, A_DAY, Verdict, VerdictKind};

/// A break comes after so much work, s.
pub const BREAK_EVERY: f64 = Breaks::SUGGESTED.work;
/// A break lasts so long, s.
pub const BREAK: f64 = Breaks::SUGGESTED.rest;
/// Piece of work under one load, s.
const WORK_PIECE: f64 = 1.0;
/// Fatigue that grows by less from break to break under the last loads of a run has reached its steady state.
const STEADY: f64 = 1e-6;

/// The loads of a muscle group in a job.
#[derive(Clone, Copy, Debug)]
pub struct Worked<'a> {
    /// Law and strength of the group.
    pub muscles: &'a MuscleGroup,
    /// Relative load of the group.
    pub loads: &'a LoadHistory,
    /// Relative load of the group at the end.
    pub end: f64,
    /// Fatigue of the group at the start, 0..=1.
    pub start: f64,
}

impl<'a> Worked<'a> {
    /// All groups of known strength in a run that tire by laws of their own; not those of muscles that tire one by one.
    pub fn in_run(scenario: &'a Scenario, summary: &'a Summary) -> Vec<Self> {
        let mut all = vec![];
        let of_muscles = |i: &usize| summary.muscles.as_ref().is_some_and(|muscles| muscles.coordinates.contains(i));
        for (i, coordinate) in scenario.model.coordinates().iter().enumerate().filter(|(i, _)| !of_muscles(i)) {
            let (Some(groups), course) = (&coordinate.groups, &summary.coordinates[i]) else { continue };
            all.extend(Side::BOTH.map(Side::index).map(|side| Self {
                muscles: &groups[side],
                loads: &course.loads[side],
                end: course.final_groups[side].load,
                start: scenario.start_fatigue[i][side],
            }));
        }
        all
    }

    /// All groups of known strength in a motion.
    pub fn in_motion(model: &'a Model, found: &'a Assessment) -> Vec<Self> {
        let worked = |group: &'a GroupAssessment| {
            let groups = model.coordinates()[group.coordinate].groups.as_ref()?;
            let muscles = &groups[group.side.index()];
            Some(Self { muscles, loads: &group.loads, end: group.load, start: 0.0 })
        };
        found.groups.iter().filter_map(worked).collect()
    }
}

/// The job of a run or motion with a break of a minute after every ten minutes of work: in a break no group has a load; between breaks each has
/// that of the job, and after the job that of its end. `verdict` is that of the job, `begin` the time of its start, s. Time counts work and breaks.
/// `muscles` are those that tire one by one in a run. `None` where the job is too short for a break.
pub fn with_breaks(
    (groups, muscles): (&[Worked<'_>], Option<&MuscleOutcome>),
    asked: f64,
    (begin, end): (f64, f64),
    verdict: &Verdict,
) -> Option<Suggestion> {
    if asked <= BREAK_EVERY {
        return None;
    }
    let longest = A_DAY.max(asked);
    let [weaker, mean] = muscles.and_then(|muscles| muscles.with_breaks).unwrap_or_default();
    let [mut first, mut least] = [mean, weaker].map(|time| time.map_or(longest, |time| time.min(longest)));
    for group in groups {
        let course = Course { group, begin, end: end - begin };
        first = first.min(course.failure(&group.muscles.fatigue, 1.0, first));
        if group.end <= 0.0 {
            continue;
        }
        let (laws, variation) = verdict::laws_and_variation(group.muscles);
        least = laws.iter().fold(least, |least, law| least.min(course.failure(law, 1.0 - variation, least)));
    }
    Some(suggestion(verdict, asked, (first, longest), least))
}

/// As [`with_breaks`], of a motion that is repeated. `None` where it has breaks, or is too short for one.
pub fn with_breaks_in_repeats(model: &Model, found: &Assessment, verdict: &Verdict) -> Option<Suggestion> {
    let asked = found.repetition.filter(|repetition| repetition.breaks.is_none() && repetition.every <= BREAK_EVERY)?;
    if asked.seconds <= BREAK_EVERY {
        return None;
    }
    let repetition = Repetition { breaks: Some(Breaks::SUGGESTED), ..asked };
    let longest = A_DAY.max(asked.seconds);
    let (mut first, mut least) = (longest, longest);
    for group in &found.groups {
        let Some(groups) = &model.coordinates()[group.coordinate].groups else { continue };
        let muscles = &groups[group.side.index()];
        first = first.min(Repeated::new(&muscles.fatigue, &group.cycle, 1.0, repetition).time_of(0.0, 1.0));
        least = least.min(verdict::spread_of_repeats(muscles, &group.cycle, repetition).0);
    }
    Some(suggestion(verdict, asked.seconds, (first, longest), least))
}

/// The suggestion, given the first failure of the mean person and the least of two of three people; from `longest` on they are no limit, s.
fn suggestion(verdict: &Verdict, asked: f64, (first, longest): (f64, f64), least: f64) -> Suggestion {
    let kind = if first >= asked { VerdictKind::Holds } else { VerdictKind::HeldUntil };
    Suggestion {
        change: "a break of a minute every ten minutes".to_owned(),
        kind,
        asked: Some(asked),
        seconds: (first < longest).then_some(first),
        least: Some(if least < longest { least } else { f64::INFINITY }),
        hazards: verdict.hazards.len(),
        hazard: None,
        hands: verdict.hands.len(),
        load: verdict.hardest.map(|group| group.load),
        lighter: false,
        both: false,
    }
}

/// The loads of a group over work, which begins at `begin` and lasts `end` s; after that they stay the same.
struct Course<'a> {
    group: &'a Worked<'a>,
    begin: f64,
    end: f64,
}

impl Course<'_> {
    fn load_at(&self, work: f64) -> f64 {
        if work < self.end { self.group.loads.at(self.begin + work) } else { self.group.end }
    }

    /// Time at which the group fails by a law, with so many times the mean strength, s of work and breaks; infinite if not until `longest`.
    fn failure(&self, law: &FatigueLaw, strength: f64, longest: f64) -> f64 {
        let without_breaks = verdict::failure(law, self.group.loads, strength, self.group.start);
        let never = self.group.loads.pieces().iter().all(|(_, load)| *load <= 0.0);
        if never || without_breaks - self.begin >= longest {
            return f64::INFINITY;
        }
        let load_at = |work: f64| self.load_at(work) / strength;
        let (mut state, mut time, mut work) = (law.start(self.group.start, load_at(0.0)), 0.0, 0.0);
        let (mut until_break, mut before_break) = (BREAK_EVERY, f64::NEG_INFINITY);
        while time < longest {
            if until_break <= 0.0 {
                let level = state.level(load_at(work));
                if work > self.end && level <= before_break + STEADY {
                    return f64::INFINITY;
                }
                state = law.advance(state, 0.0, BREAK);
                time += BREAK;
                (until_break, before_break) = (BREAK_EVERY, level);
                continue;
            }
            let load = load_at(work);
            state = law.advance(state, load, WORK_PIECE);
            (time, work, until_break) = (time + WORK_PIECE, work + WORK_PIECE, until_break - WORK_PIECE);
            if load > 1.0 || load > 0.0 && state.level(load) >= 1.0 {
                return time;
            }
        }
        f64::INFINITY
    }
}
