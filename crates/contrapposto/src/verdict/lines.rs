//! Says what stands below the sentence of a verdict: a line for each finding, with its name.

use super::words::{A_DAY, asked_in_words, enumerated, has_no_strength, how_long, in_words, percent, slip_in_words};
use super::{Failure, Findings, HandLoad, TIRED, VerdictKind, Who, muscles_or_motors};
use crate::contact::Slip;
use crate::joint_torques::{GroupLoad, Hazard, judged_parts};
use crate::model::{Model, movements_in_words};

/// Load below which no muscle counts as working: half of the last digit that is shown. Derived.
const NO_WORK: f64 = 0.005;

/// A moment before this one, s, is the start. Assumed.
const AT_ONCE: f64 = 1.0;
/// So is one before this share of the asked time, if that is less. Assumed.
const AT_ONCE_SHARE: f64 = 0.1;
/// The greatest fatigue that is told of a group that has not failed: 100 % is failure.
const NOT_YET: f64 = 0.99;

/// Said beside hazards that are known, and where none is.
const ALSO_NOT_JUDGED: &str = "discs and discomfort are not judged";

/// A finding behind a verdict.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// `Fails first`, `Hardest worked`, `Most tired`, `Repeats`, `Relief`, `Hazard`, `Later`, `Grip`, `Missed besides`, `Slip` or `In words`.
    pub name: &'static str,
    /// The finding, without a full stop.
    pub text: String,
}

impl Line {
    /// Name of the lines about hazards for ligaments.
    pub const HAZARD: &'static str = "Hazard";

    /// `Hardest worked: right shoulder flexion, 17 % of its strength.`
    pub fn in_words(&self) -> String {
        format!("{}: {}.", self.name, self.text)
    }
}

impl Findings {
    /// The lines below the sentence of a verdict of this kind.
    pub(super) fn lines(&self, model: &Model, kind: VerdictKind, sentence: &str) -> Vec<Line> {
        let mut lines = vec![];
        let mut line = |name: &'static str, text: Option<String>| {
            lines.extend(text.map(|text| Line { name, text: muscles_or_motors(model, &text) }));
        };
        if kind.is_done() && !has_no_strength(model) {
            line("Fails first", self.fails_first(model, kind));
            line("Hardest worked", self.hardest_worked(model));
            line("Most tired", self.most_tired(model));
        }
        if kind == VerdictKind::HeldUntil {
            line("Later", self.overload(model));
        }
        if kind.is_done()
            && let Some(repeats) = &self.repeats
        {
            line("Repeats", Some(repeats.in_words()));
            line("Relief", repeats.relief_in_words(model));
        }
        if kind.is_done() {
            self.hazards_in_words(model).into_iter().for_each(|text| line(Line::HAZARD, Some(text)));
            line(Line::HAZARD, self.no_hazard(model));
            line("Grip", self.hands_in_words(model));
        }
        line("Missed besides", self.missed_besides());
        line("Slip", self.slip_in_words().filter(|_| kind != VerdictKind::CannotStand));
        let named = lines.iter().fold(sentence.to_owned(), |all, line| all + " " + &line.text);
        lines.extend(movements_in_words(&named).map(|text| Line { name: "In words", text }));
        lines
    }

    /// The load of the hardest worked group, if any works.
    pub(super) fn hardest_load(&self) -> Option<GroupLoad> {
        self.hardest.map(|(group, _)| group).filter(|group| group.load >= NO_WORK)
    }

    /// `right shoulder flexion (16 % of its strength), after about 6.6 min, counted from the start, if the last posture is kept (...)`; of a job that is not held
    /// to its end `..., after 7.1 min (...)`.
    fn fails_first(&self, model: &Model, kind: VerdictKind) -> Option<String> {
        self.asked?;
        let first = match kind {
            VerdictKind::HeldUntil => self.fails.as_ref(),
            _ => self.fails_later().filter(|failure| failure.time < A_DAY),
        };
        if let Some(Failure { who, time, range }) = first {
            let (load, name) = (percent(who.load), who.name(model));
            let (time, range) = (how_long(*time), in_words(*range));
            if kind == VerdictKind::HeldUntil {
                return Some(format!("{name} ({load} of its strength), after {time} ({range})"));
            }
            let weaker = self.of_weaker_beyond(model).map_or_else(String::new, |weaker| format!("; {weaker}"));
            let on = self.on();
            return Some(format!(
                "{name} ({load} of its strength), after about {time}, counted from the start, {on} ({range}){weaker}"
            ));
        }
        let Some(Failure { who, range: (least, _), .. }) = self.weakest() else {
            return (!self.later.is_empty()).then(|| format!("no muscle, {}", self.on()));
        };
        let of_weaker = self.of_weaker_beyond(model).unwrap_or_else(|| {
            let (who, least) = (who.name(model), how_long(*least));
            format!("in weaker people (the weakest sixth) {who} within {least}")
        });
        Some(format!("no muscle of a person of mean strength; {of_weaker}"))
    }

    /// `in weaker people (the weakest sixth) right hip extension only after 49 min, beyond the 20 min asked`; `None` where it fails before, or never.
    fn of_weaker_beyond(&self, model: &Model) -> Option<String> {
        let (asked, Failure { who, range: (least, _), .. }) = (self.asked?, self.weakest()?);
        let (who, after, asked) =
            (who.name(model), how_long(*least), (*least >= asked).then(|| asked_in_words(asked))?);
        let when = if after == asked {
            format!("shortly after the {asked} asked")
        } else {
            format!("only after {after}, beyond the {asked} asked")
        };
        Some(format!("in weaker people (the weakest sixth) {who} {when}"))
    }

    /// The job after its end.
    fn on(&self) -> &'static str {
        if self.repeats.is_some() { "if it is repeated on" } else { "if the last posture is kept" }
    }

    /// `right hip extension, 17 % of its strength; it fails later, after about 32 min`, or `..., 17 % of its strength at 7.9 min (11 % at the end)`.
    fn hardest_worked(&self, model: &Model) -> Option<String> {
        let time = self.hardest?.1;
        let group = self.hardest_load()?;
        let greatest = percent(group.load);
        let is_it = |who: &Who| (who.coordinate, who.side) == (group.coordinate, group.side);
        let own = self.later.iter().find(|failure| is_it(&failure.who));
        let end = time
            .filter(|_| self.repeats.is_none())
            .zip(own.map(|own| percent(own.who.load)).filter(|end| *end != greatest));
        let end = end.map(|(time, end)| match how_long(time) {
            _ if time < self.asked.map_or(AT_ONCE, |asked| AT_ONCE.min(AT_ONCE_SHARE * asked)) => {
                format!(" at the start ({end} at the end)")
            }
            at if self.asked.map(how_long).as_ref() == Some(&at) => {
                format!(" shortly before the end ({end} at the end)")
            }
            at => format!(" at {at} ({end} at the end)"),
        });
        let first = self.asked.and(self.fails_later()).filter(|first| first.time < A_DAY && !is_it(&first.who));
        let apart = first.zip(own).filter(|(first, own)| how_long(first.time) != how_long(own.time));
        let fails = apart.map(|(_, own)| match own.time {
            time if time < A_DAY => format!("; it fails later, after about {}", how_long(time)),
            _ if self.repeats.is_some() => "; it does not fail, however long it goes on".to_owned(),
            _ => "; it does not fail at its load of the end".to_owned(),
        });
        let name = Who::from(group).name(model);
        Some(format!("{name}, {greatest} of its strength{}{}", end.unwrap_or_default(), fails.unwrap_or_default()))
    }

    /// `right shoulder flexion, 82 % at the end (at 100 % it fails)`, `..., 100 %, at which it fails`.
    fn most_tired(&self, model: &Model) -> Option<String> {
        let tired = self.tired.filter(|tired| tired.fatigue >= NO_WORK)?;
        let lasts = match (tired.lasts && tired.fatigue > TIRED, self.repeats) {
            (false, _) => "",
            (true, Some(_)) => "; it does not fail, however long it goes on",
            (true, None) => "; under this load it tires no further",
        };
        let who = tired.who.name(model);
        Some(match tired.fatigue >= 1.0 {
            true => format!("{who}, {}, at which it fails", percent(tired.fatigue)),
            false => {
                format!("{who}, {} at the end (at 100\u{a0}% it fails){lasts}", percent(tired.fatigue.min(NOT_YET)))
            }
        })
    }

    /// `at 5.0 min right hip extension would need 130 % of its strength`, of a group that is too weak after another one has failed.
    fn overload(&self, model: &Model) -> Option<String> {
        let (group, time) = self.hardest.filter(|(group, _)| group.load > 1.0)?;
        let (who, when) = (Who::from(group).name(model), how_long(time?));
        Some(format!("at {when} {who} would need {} of its strength", percent(group.load)))
    }

    /// Each hazard: the posture, the torque, its time where that is known, and the finding of the study, which is told once.
    fn hazards_in_words(&self, model: &Model) -> Vec<String> {
        let now = self.hazards.iter().map(|hazard| (hazard, self.seconds_in_hazard(hazard), ""));
        let over = self.passed.iter().map(|passed| (&passed.hazard, Some(passed.seconds), ", over at the end"));
        let mut told: Vec<&str> = vec![];
        let in_words = |(hazard, seconds, over): (&Hazard, Option<f64>, &str)| {
            let long = seconds.map_or_else(String::new, |seconds| format!(" for {}{over}", how_long(seconds)));
            let limit = hazard.row.seconds().zip(seconds).is_some_and(|(limit, seconds)| seconds > limit);
            let limit = if limit { "; that is longer than the study allowed" } else { "" };
            let shorter = match hazard.row.seconds().zip(seconds) {
                Some((limit, seconds)) if seconds < limit && !told.contains(&hazard.row.finding.as_str()) => {
                    format!("; the study has no figure for {}", how_long(seconds))
                }
                _ => String::new(),
            };
            let finding = hazard.row.finding.as_str();
            let finding = if told.contains(&finding) { String::new() } else { format!("; {finding}") };
            told.push(&hazard.row.finding);
            format!("{}{long}{finding}{limit}{shorter}", hazard.in_words(model))
        };
        let mut all: Vec<String> = now.chain(over).map(in_words).collect();
        all.last_mut().into_iter().for_each(|last| *last += &format!("; {ALSO_NOT_JUDGED}"));
        all
    }

    /// `none is known for the ligaments of low back, knees and hips at these angles; discs and discomfort are not judged`; `None` where nothing is
    /// judged, or where there was a hazard for a moment.
    fn no_hazard(&self, model: &Model) -> Option<String> {
        let none = self.hazards.is_empty() && self.passed.is_empty() && self.in_hazard.is_empty();
        let parts: Vec<String> = judged_parts(model).into_iter().map(str::to_owned).collect();
        let known = none && !parts.is_empty() && !has_no_strength(model);
        known.then(|| {
            let parts = enumerated(&parts);
            format!("none is known for the ligaments of {parts} at these angles; {ALSO_NOT_JUDGED}")
        })
    }

    /// Time for which a coordinate was in hazard in all, s.
    fn seconds_in_hazard(&self, hazard: &Hazard) -> Option<f64> {
        self.in_hazard.iter().find(|(coordinate, _)| *coordinate == hazard.coordinate).map(|(_, seconds)| *seconds)
    }

    /// `its fatigue is not judged; the right hand holds 245 N, 51 % of the mean strength of a man's grip`.
    fn hands_in_words(&self, model: &Model) -> Option<String> {
        let hands: Vec<String> = self.hands.iter().map(|hand: &HandLoad| hand.in_words(model)).collect();
        (!hands.is_empty()).then(|| format!("its fatigue is not judged; {}", enumerated(&hands)))
    }

    /// `look at head by 3.4° (of lower priority)`: the targets that the sentence does not name.
    fn missed_besides(&self) -> Option<String> {
        // The sentence names the first that decides.
        let named = self.missed.iter().position(|missed| missed.decides);
        let lower = self.missed.iter().enumerate().filter(|(i, _)| Some(*i) != named).map(|(_, missed)| missed);
        let list: Vec<String> = lower.map(|missed| format!("{} by {}", missed.task, missed.by())).collect();
        (!list.is_empty()).then(|| format!("{} (of lower priority)", list.join(", ")))
    }

    /// The greatest slip of the supports and its time, s, where it counts.
    pub(super) fn noticed_slip(&self) -> Option<(Slip, Option<f64>)> {
        self.slip.filter(|(slip, _)| slip.exceeds(Slip::NOTICED))
    }

    /// `the supports slid by 0.2 cm and 0.3° (the greatest slip, at 12 s)`.
    fn slip_in_words(&self) -> Option<String> {
        let (slip, time) = self.noticed_slip()?;
        let when = time.map_or(String::new(), |time| format!(" (the greatest slip, at {})", how_long(time)));
        Some(format!("the supports slid by {}{when}", slip_in_words(slip)))
    }
}
