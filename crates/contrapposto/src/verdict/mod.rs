//! States whether a job can be done, for how long, and which muscle group fails first.
//!
//! A verdict is of one kind, the first that applies:
//!
//! 1. [`VerdictKind::CannotBeDone`]: a muscle group would need more than its strength in a posture that is held, before another one fails; or a
//!    weight is more than a hand can hold ([`HandLoad`]). A posture that misses
//!    its most important target is the best of those that do not do the job, and nobody need hold it: it is judged by that;
//! 2. [`VerdictKind::CannotStand`]: the supports do not hold the body; of a posture that misses its target, too, it is not said. Supports
//!    that slide by more than [`Slip::GREATEST`] do not hold it, and the loads of such a posture are those of another job;
//! 3. [`VerdictKind::NotReached`]: the most important target, or one that is demanded, is missed;
//! 4. [`VerdictKind::HeldUntil`]: a group tires until it can no longer hold its load, before the end of the asked time;
//! 5. [`VerdictKind::Holds`]: none of these.
//!
//! While a support is put elsewhere nobody is judged: a step is a motion of a second or two, whose torques at rest say little.
//! Of a job that holds, the verdict says how long it could go on, were the posture of its end held on.
//!
//! A time comes with its spread ([`spread`]): over published laws of fatigue and over people of different strength.

mod amounts;
mod hands;
mod holding;
mod lines;
mod missed;
mod motion;
mod motors;
mod posture;
mod repeats;
mod run;
mod spread;
mod words;

use amounts::burden_in_words;
pub(crate) use amounts::{Amount, MOST_AMOUNTS, amounts, amounts_in_words};
pub use hands::HandLoad;
pub use lines::Line;
pub use missed::{MISSED_ANGLE, MISSED_DISTANCE, Missed, Nearest};
pub use motors::{has_motors, muscles_or_motors};
pub use posture::HeldPosture;
pub(crate) use spread::{failure, laws_and_variation};
pub use spread::{spread, spread_of_repeats};
pub(crate) use words::{A_DAY, asked_in_words};
pub use words::{error_in_words, how_long, slip_in_words};

use crate::contact::{Missing, Slip};
use crate::fatigue::Repetition;
use crate::joint_torques::{GroupLoad, Hazard};
use crate::model::Side;
use crate::statics::Load;

/// The kinds of verdicts, the first that applies first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum VerdictKind {
    /// A muscle group would need more than its strength.
    CannotBeDone,
    /// The supports do not hold the body.
    CannotStand,
    /// The most important target is missed.
    NotReached,
    /// A muscle group fails before the end of the asked time.
    HeldUntil,
    /// The job can be done.
    Holds,
}

impl VerdictKind {
    /// All, the first that applies first.
    pub const ALL: [Self; 5] = [Self::CannotBeDone, Self::CannotStand, Self::NotReached, Self::HeldUntil, Self::Holds];

    /// `cannot_be_done`, `cannot_stand`, `not_reached`, `held_until`, `holds`.
    pub fn word(self) -> &'static str {
        match self {
            Self::CannotBeDone => "cannot_be_done",
            Self::CannotStand => "cannot_stand",
            Self::NotReached => "not_reached",
            Self::HeldUntil => "held_until",
            Self::Holds => "holds",
        }
    }

    /// Whether the job can be done, if only for a time.
    pub fn is_done(self) -> bool {
        matches!(self, Self::HeldUntil | Self::Holds)
    }
}

/// A muscle group that a verdict names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Who {
    /// Coordinate of the group.
    pub coordinate: usize,
    /// The group of the coordinate, by the sign of its torque.
    pub side: Side,
    /// Active torque over strength: the greatest, or where the group fails that at this time.
    pub load: f64,
}

impl From<GroupLoad> for Who {
    fn from(GroupLoad { coordinate, side, load, .. }: GroupLoad) -> Self {
        Self { coordinate, side, load }
    }
}

/// The group that fails first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Failure {
    pub(crate) who: Who,
    /// Time of the failure, s.
    pub(crate) time: f64,
    /// Least and greatest of that time, s.
    pub(crate) range: (f64, f64),
}

/// Fatigue above which a group counts as tired at the end of a job that holds. Assumed: half of what it can bear.
pub const TIRED: f64 = 0.5;

/// A muscle group that is tired.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tired {
    /// The group with its load.
    pub who: Who,
    /// Fatigue of the group, 0..=1.
    pub fatigue: f64,
    /// Under its load of the end it tires no further, or recovers.
    pub lasts: bool,
}

/// A hazard of a run that was over at its end.
#[derive(Clone, Debug, PartialEq)]
pub struct PassedHazard {
    /// At the moment when ligaments carried most.
    pub hazard: Hazard,
    /// Time of that moment, s.
    pub time: f64,
    /// Time for which there was a hazard in all, s.
    pub seconds: f64,
}

/// A hazard that lasted less, s, was a motion, and is not reported. Assumed.
const LEAST_HAZARD: f64 = 5.0;

/// The answer to a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Kind of the verdict.
    pub kind: VerdictKind,
    /// The time that was asked for, s; `None` where none was.
    pub asked: Option<f64>,
    /// Time for which the job can be done, s: until `who` fails; of a job that holds, with the posture of its end held on. `None` where no
    /// muscle sets a limit, and where the job cannot be done.
    pub seconds: Option<f64>,
    /// Least and greatest time until a group fails first, s, over published laws and two of three people: of people of mean strength that is `who`;
    /// infinite where none ever fails.
    pub range: Option<(f64, f64)>,
    /// Least time until any group fails, s, over published laws and two of three people; infinite where none ever fails. `None` where the
    /// job cannot be done, and of a fast motion.
    pub least: Option<f64>,
    /// The muscle group that is too weak or fails first; where none does, the one with the greatest load.
    pub who: Option<Who>,
    /// The group with the greatest load.
    pub hardest: Option<Who>,
    /// Of a run that can be done, the group with the greatest fatigue at the end.
    pub tired: Option<Tired>,
    /// Of a run that holds, the group that fails before its end in people whose strength is one standard deviation below the mean, or
    /// by another published law.
    pub fails_weaker: Option<Who>,
    /// Coordinates that ligaments carry at an angle where that is a hazard: at the end of a run, at the worst of a motion.
    pub hazards: Vec<Hazard>,
    /// Distance of the supports from their places where it exceeds [`Slip::NOTICED`]; of a run the greatest, and when, s.
    pub slip: Option<(Slip, Option<f64>)>,
    /// Hazards of a run that were over at its end.
    pub passed: Vec<PassedHazard>,
    /// Weights in hands that are much for the grip, the heaviest first.
    pub hands: Vec<HandLoad>,
    /// The first line of every result: one sentence, and those about hazards and motion.
    pub sentence: String,
    /// The findings behind it, which stand below it.
    pub lines: Vec<Line>,
    /// Targets that are missed, the most important first.
    pub missed: Vec<Missed>,
}

impl Verdict {
    /// Nothing needs to change: the job holds, for the weaker of two of three people, too, who can begin it at least where no time is asked; no group is tired at its end, no
    /// coordinate is or was in hazard, and no weight is much for a grip.
    pub fn has_reserve(&self) -> bool {
        let tired = self.tired.is_some_and(|tired| tired.fatigue > TIRED);
        let hazard = !self.hazards.is_empty() || !self.passed.is_empty() || !self.hands.is_empty();
        let too_weak = self.least.is_some_and(|least| least <= 0.0);
        self.kind == VerdictKind::Holds && self.fails_weaker.is_none() && !tired && !hazard && !too_weak
    }

    /// The sentence and the lines below it, each on a line of its own.
    pub fn in_words(&self) -> String {
        let lines = self.lines.iter().map(|line| line.in_words() + "\n");
        std::iter::once(format!("{}\n", self.sentence)).chain(lines).collect()
    }

    /// Number of coordinates in hazard at the end and of hands with much weight.
    pub(crate) fn risks(&self) -> usize {
        self.hazards.len() + self.hands.len()
    }
}

/// A motion that is repeated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Repeats {
    /// Length of the motion, s.
    pub(crate) cycle: f64,
    pub(crate) repetition: Repetition,
    /// The group that asks for relief first, and when, s.
    pub(crate) relief: Option<(Who, f64)>,
}

/// The findings of a job.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    /// The time that was asked for, s.
    pub(crate) asked: Option<f64>,
    /// The group with the greatest load; when, s, where that matters.
    pub(crate) hardest: Option<(GroupLoad, Option<f64>)>,
    /// The force and moment that the supports lack; when, s, where that matters.
    pub(crate) missing: Option<(Missing, Option<f64>)>,
    /// Distance of the supports from their places: the greatest of a run, when, s, where that matters.
    pub(crate) slip: Option<(Slip, Option<f64>)>,
    /// Distance of supports that do not hold the body; since when, s, where that matters.
    pub(crate) slides: Option<(Slip, Option<f64>)>,
    /// All targets that are missed, the most important first.
    pub(crate) missed: Vec<Missed>,
    /// The group that fails first.
    pub(crate) fails: Option<Failure>,
    /// Time at which every group that works at the end would fail, were the posture of the end held on.
    pub(crate) later: Vec<Failure>,
    /// Least time until any group fails, s, over published laws and two of three people; infinite where none fails.
    pub(crate) least: Option<f64>,
    /// The group with the greatest fatigue at the end.
    pub(crate) tired: Option<Tired>,
    /// Coordinates in hazard.
    pub(crate) hazards: Vec<Hazard>,
    /// Coordinates that were in hazard in a run, with the time in all, s.
    pub(crate) in_hazard: Vec<(usize, f64)>,
    /// Hazards of a run that were over at its end.
    pub(crate) passed: Vec<PassedHazard>,
    /// Weights in hands that are much for the grip, the heaviest first.
    pub(crate) hands: Vec<HandLoad>,
    /// Loads on the body, where the supports do not hold it.
    pub(crate) loads: Vec<Load>,
    /// Coordinates of a motion that lie outside of their ranges in nearly all instants, with the share of these.
    pub(crate) out_of_range: Vec<(usize, f64)>,
    /// Share of the instants of a motion whose acceleration a posture at rest leaves out, where the motion is fast.
    pub(crate) fast: Option<f64>,
    /// A recorded motion, not a run.
    pub(crate) recorded: bool,
    /// Inertia of the motion counts.
    pub(crate) dynamics: bool,
    /// The motion is repeated.
    pub(crate) repeats: Option<Repeats>,
    /// The run was left before its end, at that time, s.
    pub(crate) interrupted: Option<f64>,
}

impl Findings {
    /// The group that would fail first, were the posture of the end held on: by the time of the mean person; where that is no limit, by the
    /// least of the range. `None` where no group ever fails.
    fn fails_later(&self) -> Option<&Failure> {
        let first = self.later.iter().min_by(|a, b| a.time.total_cmp(&b.time).then(a.range.0.total_cmp(&b.range.0)));
        first.filter(|failure| failure.range.0.is_finite())
    }

    /// The group that fails first in weaker people, or by another published law, within a day.
    fn weakest(&self) -> Option<&Failure> {
        let first = self.later.iter().min_by(|a, b| a.range.0.total_cmp(&b.range.0));
        first.filter(|failure| failure.range.0 < A_DAY)
    }

    /// The group that fails before the asked time in weaker people, or by another published law.
    fn fails_weaker(&self) -> Option<&Failure> {
        self.weakest().filter(|failure| self.asked.is_some_and(|asked| failure.range.0 < asked))
    }

    /// Whether a group would need more than its strength. One that failed before under a load within its strength has ended the job.
    fn is_too_weak(&self) -> bool {
        let Some((group, time)) = self.hardest else { return false };
        let ended = |failure: &Failure| failure.who.load <= 1.0 && time.is_some_and(|time| failure.time < time);
        group.load > 1.0 && !self.fails.as_ref().is_some_and(ended)
    }

    /// The kind, by precedence.
    fn kind(&self) -> VerdictKind {
        let misses = self.missed.iter().any(|missed| missed.decides);
        let ends_in_a_fall = self.missing.is_some_and(|(_, time)| time.is_some());
        if self.slides.is_some() {
            VerdictKind::CannotStand
        } else if misses && !ends_in_a_fall {
            VerdictKind::NotReached
        } else if self.is_too_weak() || self.hands.first().is_some_and(HandLoad::is_too_heavy) {
            VerdictKind::CannotBeDone
        } else if self.missing.is_some() {
            VerdictKind::CannotStand
        } else if self.fails.is_some() {
            VerdictKind::HeldUntil
        } else {
            VerdictKind::Holds
        }
    }
}
