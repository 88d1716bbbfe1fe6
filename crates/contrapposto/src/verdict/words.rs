//! Says a verdict in one sentence.

use super::{Failure, Findings, Missed, Verdict, VerdictKind, Who};
use crate::model::{Model, plain_group_name, plain_name};
use crate::tasks::Unit;

/// A time from here on, s, is said as no limit: longer than a day.
const A_DAY: f64 = 86_400.0;

impl Findings {
    /// The verdict, with its sentence.
    pub(super) fn verdict(self, model: &Model) -> Verdict {
        let kind = self.kind();
        let sentence = match kind {
            VerdictKind::CannotBeDone => self.too_weak(model),
            VerdictKind::CannotStand => self.falls(),
            VerdictKind::NotReached => self.not_reached(),
            VerdictKind::HeldUntil => self.held_until(model),
            VerdictKind::Holds => self.holds(model),
        };
        let sentence = match self.interrupted {
            Some(time) => format!("Interrupted after {}; so far: {sentence}", how_long(time)),
            None => sentence,
        };
        let fails = self.fails.filter(|_| kind == VerdictKind::HeldUntil);
        let hardest = self.hardest.filter(|_| matches!(kind, VerdictKind::CannotBeDone | VerdictKind::Holds));
        Verdict {
            kind,
            seconds: fails.map(|failure| failure.time).or(self.asked.filter(|_| kind == VerdictKind::Holds)),
            range: fails.map(|failure| failure.range),
            who: fails.map(|failure| failure.who).or(hardest.map(|(group, _)| group.into())),
            sentence,
            missed: self.missed,
        }
    }

    fn too_weak(&self, model: &Model) -> String {
        let Some((group, time)) = self.hardest else { return String::new() };
        let when = time.filter(|time| *time > 0.0).map(|time| format!(" at {}", how_long(time)));
        format!(
            "Cannot be done: {} would need {} of its strength{} ({:.0} of {:.0} N m).",
            Who::from(group).name(model),
            percent(group.load),
            when.unwrap_or_default(),
            group.torque.abs(),
            group.torque.abs() / group.load
        )
    }

    fn falls(&self) -> String {
        let Some((missing, time)) = self.missing else { return String::new() };
        let when = time.filter(|time| *time > 0.0).map(|time| format!(" from {} on", how_long(time)));
        format!("Cannot stand: the supports do not hold the body{}; {missing}.", when.unwrap_or_default())
    }

    fn not_reached(&self) -> String {
        let Some(missed) = self.missed.first() else { return String::new() };
        format!("Not reached: {} is missed by {}.", missed.task, missed.by())
    }

    fn held_until(&self, model: &Model) -> String {
        let Some(Failure { who, time, range }) = self.fails else { return String::new() };
        let who = who.name(model);
        let range = in_words(range);
        if time <= 0.0 {
            return format!("Cannot be held: {who} fails at once ({range}).");
        }
        format!("Can be held {} ({range}), then {who} fails first.", how_long(time))
    }

    fn holds(&self, model: &Model) -> String {
        let hardest = self.hardest.filter(|(group, _)| group.load >= 0.005);
        let worked = hardest
            .map(|(group, _)| format!("{} at {} of its strength", Who::from(group).name(model), percent(group.load)));
        let worked = worked.unwrap_or_else(|| "no muscle works".to_owned());
        if model.coordinates().iter().all(|coordinate| coordinate.groups.is_none()) {
            return "In balance; no strength of this body is known, so nothing can be said of load and time."
                .to_owned();
        }
        match self.asked {
            Some(time) => format!("Holds through the run ({}); hardest worked: {worked}.", how_long(time)),
            None => format!("Holds without a limit by muscles; hardest worked: {worked}."),
        }
    }
}

impl Missed {
    /// `12.0 cm`, `3.4°`.
    pub fn by(&self) -> String {
        match self.unit {
            Some(Unit::Radian) => format!("{:.1}°", self.distance.to_degrees()),
            Some(Unit::Metre) if self.distance < 0.995 => format!("{:.1} cm", 100.0 * self.distance),
            Some(Unit::Metre) => format!("{:.2} m", self.distance),
            _ => format!("{:.3} (m and rad together)", self.distance),
        }
    }
}

impl Who {
    /// `right shoulder flexion`.
    pub fn name(&self, model: &Model) -> String {
        let coordinate = &model.coordinates()[self.coordinate];
        match &coordinate.groups {
            Some(groups) => plain_group_name(&groups[self.side.index()].name, &coordinate.name),
            None => plain_name(&coordinate.name),
        }
    }
}

/// `14 min to 27 min in two of three people`.
fn in_words((least, greatest): (f64, f64)) -> String {
    let most = if greatest < A_DAY { how_long(greatest) } else { "no limit".to_owned() };
    format!("{} to {most} for two of three people", how_long(least))
}

fn percent(share: f64) -> String {
    format!("{:.0}\u{a0}%", 100.0 * share)
}

/// `45 s`, `7.5 min`, `12 min`, `6.9 h`, `longer than a day`.
pub fn how_long(seconds: f64) -> String {
    match seconds {
        _ if seconds < 9.95 => format!("{seconds:.1}\u{a0}s"),
        _ if seconds < 100.0 => format!("{seconds:.0}\u{a0}s"),
        _ if seconds < 5970.0 => format!("{:.1}\u{a0}min", seconds / 60.0),
        _ if seconds < A_DAY => format!("{:.1}\u{a0}h", seconds / 3600.0),
        _ => "longer than a day".to_owned(),
    }
}
