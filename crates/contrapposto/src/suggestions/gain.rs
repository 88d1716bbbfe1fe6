//! Says what a change gives: the times with it and without it.

use super::trial::Suggestion;
use crate::verdict::{A_DAY, Verdict, VerdictKind, how_long};

/// A time that sets a limit, in words; `None` without a limit.
fn limit(seconds: Option<f64>) -> Option<String> {
    seconds.filter(|seconds| *seconds < A_DAY).map(how_long)
}

/// ` instead of 6.5 min`; nothing where there was no limit before, or the same one.
fn instead(now: &str, before: Option<String>) -> String {
    before.filter(|before| before != now).map_or_else(String::new, |before| format!(" instead of {before}"))
}

impl Suggestion {
    /// `with the target of right hand 10 cm lower (height 1.85 m instead of 1.95 m) it can go on for about 11.2 min in all instead of 6.5 min (weaker
    /// people: 8.1 min instead of 3.9 min)`; beside the verdict on the job without the change.
    pub fn in_words(&self, before: &Verdict) -> String {
        let (change, gain) = (&self.change, self.gain(before));
        let last = |seconds: Option<f64>| seconds.filter(|seconds| *seconds < A_DAY).unwrap_or(f64::INFINITY);
        let shorter = last(self.seconds) < last(before.seconds) && limit(self.seconds) != limit(before.seconds);
        let but = if shorter { ", but for a shorter time" } else { "" };
        let hazard = match (before.hazards.len(), self.hazards) {
            (0, 0) => String::new(),
            (_, 0) => format!(", without ligaments in hazard{but}"),
            (joints, left) if left < joints => format!(", with ligaments in hazard at {left} of {joints} joints{but}"),
            _ => ", with ligaments in hazard".to_owned(),
        };
        let grip = match (before.hands.len(), self.hands) {
            (0, 0) => "",
            (_, 0) => ", with less than half of the strength of the grip",
            _ => ", with half of the strength of a grip or more",
        };
        format!("with {change} {gain}{hazard}{grip}")
    }

    /// The time, and that of weaker people where they fail before the end.
    fn gain(&self, before: &Verdict) -> String {
        let was_done = before.kind == self.kind;
        let (now, then) = (limit(self.seconds), limit(before.seconds).filter(|_| was_done));
        let asked = self.asked.map(how_long);
        let in_all = if asked.is_some() { " in all" } else { "" };
        let go_on = if asked.is_some() { "go on" } else { "be held" };
        let time = match (self.kind == VerdictKind::Holds, was_done, &now) {
            (true, true, None) if then.is_none() => return self.gain_of_weaker(before),
            (true, true, None) => format!("it can {go_on} without a limit{}", instead("", then)),
            (true, true, Some(now)) => format!("it can {go_on} for about {now}{in_all}{}", instead(now, then)),
            (true, false, _) => {
                let run =
                    asked.map_or_else(|| "it holds".to_owned(), |asked| format!("it holds through the run ({asked})"));
                match now {
                    Some(now) => format!("{run}, about {now}{in_all}"),
                    None if limit(self.least).is_none() => format!("{run} without a limit"),
                    None => format!("{run}, without a limit for the mean person"),
                }
            }
            (false, ..) => {
                let now = now.unwrap_or_else(|| how_long(0.0));
                match asked.filter(|_| !was_done) {
                    Some(asked) => format!("it can be held {now} of the {asked} asked"),
                    None => format!("it can be held {now}{}", instead(&now, then)),
                }
            }
        };
        time + &self.weaker(before)
    }

    /// ` (weaker people: 4.9 min instead of 3.9 min)`, where that is less than the time asked.
    fn weaker(&self, before: &Verdict) -> String {
        let short = |least: Option<f64>| least.zip(self.asked).is_some_and(|(least, asked)| least < asked);
        if !short(self.least) && !short(before.least) {
            return String::new();
        }
        let now = limit(self.least).unwrap_or_else(|| "no limit".to_owned());
        format!(" (weaker people: {now}{})", instead(&now, limit(before.least)))
    }

    /// The time of weaker people, where no muscle of the mean person fails with or without the change.
    fn gain_of_weaker(&self, before: &Verdict) -> String {
        let go_on = if self.asked.is_some() { "go on" } else { "hold it" };
        let Some(least) = self.least else { return "it stays without a limit".to_owned() };
        match (limit(Some(least)), limit(before.least)) {
            (None, None) => "it stays without a limit".to_owned(),
            (None, Some(before)) => {
                format!("weaker people can {go_on} without a limit, too, instead of {before} at the least")
            }
            (Some(now), before) => {
                format!("weaker people can {go_on} for {now} at the least{}", instead(&now, before))
            }
        }
    }
}
