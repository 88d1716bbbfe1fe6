//! Says a verdict in one sentence, or in two where ligaments are in hazard.

use super::missed::unit;
use super::{
    Failure, Findings, Missed, Nearest, PassedHazard, Verdict, VerdictKind, Who, burden_in_words, has_motors,
    muscles_or_motors,
};
use crate::contact::Slip;
use crate::model::{Model, plain_group_name, plain_name};
use crate::statics::{Load, LoadKind};
use crate::tasks::{PriorityLevel, Unit};

/// A direction with less than this share of a distance is not named.
const LEAST_PART: f64 = 0.05;
/// A load beyond so many times the strength is told in words: nobody is so weak, and angles or loads are wrong. Assumed.
const FAR_TOO_MUCH: f64 = 10.0;
/// Most coordinates out of range that a sentence names.
const MOST_DOUBTS: usize = 3;
/// From here on, s, minutes are said without a decimal: nobody knows them better.
const WHOLE_MINUTES: f64 = 597.0;
/// A time from here on, s, is said as no limit: longer than a day.
pub(crate) const A_DAY: f64 = 86_400.0;

impl Findings {
    /// The verdict, with its sentence.
    pub(super) fn verdict(self, model: &Model) -> Verdict {
        let kind = self.kind();
        let sentence = match kind {
            VerdictKind::CannotBeDone => self.too_weak(model),
            VerdictKind::CannotStand => self.falls(model),
            VerdictKind::NotReached => self.not_reached(),
            VerdictKind::HeldUntil => self.held_until(model),
            VerdictKind::Holds => self.holds(model),
        };
        let sentence = if kind.is_done() { sentence + &self.hazard(model).unwrap_or_default() } else { sentence };
        let sentence = match self.interrupted {
            Some(time) => format!("Interrupted after {}; so far: {sentence}", how_long(time)),
            None => sentence,
        };
        let sentence = match self.fast.map(percent) {
            Some(share) => {
                format!("{sentence} Each posture is judged at rest; the motion is fast in {share} of its frames.")
            }
            None if self.dynamics => format!("{sentence} Inertia of the motion counts."),
            None => sentence,
        };
        let is_told =
            kind == VerdictKind::CannotBeDone && self.hardest.is_some_and(|(group, _)| group.load > FAR_TOO_MUCH);
        let sentence = match self.out_of_range.is_empty() || is_told {
            true => sentence,
            false => format!("{sentence} This is in doubt: {}.", self.doubt(model)),
        };
        let (lines, slip) = (self.lines(model, kind, &sentence), self.noticed_slip());
        let fails = match kind {
            VerdictKind::HeldUntil => self.fails,
            VerdictKind::Holds => self.fails_later().copied(),
            _ => None,
        };
        let hardest = self.hardest.map(|(group, _)| Who::from(group));
        let names_hardest = kind == VerdictKind::Holds || kind == VerdictKind::CannotBeDone && self.is_too_weak();
        Verdict {
            kind,
            asked: self.asked,
            seconds: fails.map(|failure| failure.time).filter(|time| time.is_finite()),
            range: fails.map(|failure| failure.range),
            least: self.least.filter(|_| kind.is_done()),
            who: fails.map(|failure| failure.who).or(hardest.filter(|_| names_hardest)),
            hardest,
            tired: self.tired,
            fails_weaker: self.fails_weaker().map(|failure| failure.who),
            hazards: self.hazards,
            slip,
            passed: self.passed,
            hands: self.hands,
            sentence: muscles_or_motors(model, &sentence),
            lines,
            missed: self.missed,
        }
    }

    fn too_weak(&self, model: &Model) -> String {
        let too_heavy = self.hands.first().filter(|hand| hand.is_too_heavy() && !self.is_too_weak());
        if let Some(hand) = too_heavy {
            return format!("Cannot be done: {}.", hand.too_heavy_in_words(model));
        }
        let Some((group, time)) = self.hardest else { return String::new() };
        let when = time.filter(|time| *time > 0.0).map(|time| format!(" at {}", how_long(time))).unwrap_or_default();
        let (who, torque) = (Who::from(group).name(model), group.torque.abs());
        let strength = torque / group.load;
        if group.load <= FAR_TOO_MUCH {
            let share = percent(group.load);
            return format!(
                "Cannot be done: {who} would need {share} of its strength{when} ({torque:.0} of {strength:.0} N m)."
            );
        }
        let doubt = self.doubt(model);
        format!(
            "Cannot be done: {who} would need far more than its strength{when}: {torque:.0} N m, and has {strength:.1} N m there; {doubt}."
        )
    }

    /// `check the sign of right knee (knee_angle_r), which is outside of its range in 100 % of the time`, or what else to check.
    fn doubt(&self, model: &Model) -> String {
        let name = |i: usize| {
            let name = &model.coordinates()[i].name;
            format!("{} ({name})", plain_name(name))
        };
        let outside = |&(i, share): &(usize, f64)| {
            format!("{}, which is outside of its range in {} of the time", name(i), percent(share))
        };
        let all: Vec<String> = self.out_of_range.iter().take(MOST_DOUBTS).map(outside).collect();
        match all.as_slice() {
            [] => "check the signs and units of angles and loads".to_owned(),
            all => format!("check the sign of {}", all.join("; and of ")),
        }
    }

    fn falls(&self, model: &Model) -> String {
        let when =
            |time: Option<f64>| time.filter(|time| *time > 0.0).map(|time| format!(" from {} on", how_long(time)));
        if let Some((slip, time)) = self.slides {
            let when = when(time).unwrap_or_default();
            return format!("Cannot stand: supports slide by {}{when}.", slip_in_words(slip));
        }
        let Some((missing, time)) = self.missing else { return String::new() };
        let (when, under) = (when(time).unwrap_or_default(), burden_in_words(model, &self.loads));
        let doubt = self.heavier_than_the_body(model).unwrap_or_default();
        format!("Cannot stand: the supports do not hold the body{under}{when}; {missing}.{doubt}")
    }

    /// ` The body weighs 75 kg: are kilograms meant?`, of weights that are heavier than the body.
    fn heavier_than_the_body(&self, model: &Model) -> Option<String> {
        let weight = |load: &Load| if let LoadKind::Weight(mass) = load.kind { mass } else { 0.0 };
        let held: f64 = self.loads.iter().map(weight).sum();
        (held > model.mass()).then(|| format!(" The body weighs {:.0} kg: are kilograms meant?", model.mass()))
    }

    fn not_reached(&self) -> String {
        let Some(missed) = self.missed.iter().find(|missed| missed.decides) else { return String::new() };
        let why = if missed.contradicts { "; a more important target of the same part is elsewhere" } else { "" };
        let nearest = missed.nearest.filter(|_| !missed.contradicts).map(|nearest| format!(" {}", nearest.in_words()));
        format!("Not reached: {} is missed by {}{why}.{}", missed.task, missed.by(), nearest.unwrap_or_default())
    }

    fn held_until(&self, model: &Model) -> String {
        let Some(Failure { who, time, range }) = self.fails else { return String::new() };
        let (who, range) = (who.name(model), in_words(range));
        let done = if self.repeats.is_some() { "repeated" } else { "held" };
        if time <= 0.0 {
            return format!("Cannot be {done}: {who} fails at once ({range}).");
        }
        let for_ = if self.repeats.is_some() { "for " } else { "" };
        format!("Can be {done} {for_}{} ({range}), then {who} fails first.", self.held(time))
    }

    /// `10 min of the 2.0 h asked`, `598 s of the 600 s asked`, or `10 min` where no time was asked for.
    fn held(&self, time: f64) -> String {
        let Some(asked) = self.asked.filter(|asked| time < *asked && self.interrupted.is_none()) else {
            return how_long(time);
        };
        let words = [how_long(time), asked_in_words(asked)];
        let [time, asked] = if words[0] != words[1] {
            words
        } else if asked >= WHOLE_MINUTES && asked - time >= 6.0 {
            [(time / 6.0).floor() / 10.0, asked / 60.0].map(|minutes| format!("{minutes:.1}\u{a0}min"))
        } else {
            [time.floor(), asked].map(|seconds| format!("{seconds:.0}\u{a0}s"))
        };
        format!("{time} of the {asked} asked")
    }

    fn holds(&self, model: &Model) -> String {
        if has_no_strength(model) {
            return "In balance; no strength of this body is known, so nothing can be said of load and time."
                .to_owned();
        }
        let head = match self.asked {
            Some(time) if self.repeats.is_some() => format!("Can be repeated for the {} asked", asked_in_words(time)),
            Some(time) if self.recorded => format!("Holds through the motion ({})", how_long(time)),
            Some(time) => format!("Can be held for all of the {} asked", asked_in_words(time)),
            None => "Holds without a limit by muscles".to_owned(),
        };
        let reached = self.asked.zip(self.least).is_some_and(|(asked, least)| least >= asked);
        let too = if reached && self.hands.is_empty() && !has_motors(model) {
            ", also for weaker people (the weakest sixth);"
        } else {
            ","
        };
        let hardest = || match self.hardest_load() {
            Some(group) => {
                let share = percent(group.load);
                format!("{too} hardest worked: {} at {share} of its strength", Who::from(group).name(model))
            }
            None => "; no muscle works".to_owned(),
        };
        format!("{head}{}.", self.weaker(model).unwrap_or_else(hardest))
    }

    /// `, but in weaker people (the weakest sixth) right shoulder flexion fails within 3.9 min`: two of three people lie within the range, one in six below it.
    fn weaker(&self, model: &Model) -> Option<String> {
        let Failure { who, range: (least, _), .. } = match self.asked {
            Some(_) => self.fails_weaker()?,
            None => self.weakest()?,
        };
        let who = who.name(model);
        let near = self.asked.is_some_and(|asked| how_long(asked) == how_long(*least));
        Some(if near {
            format!(", but in weaker people (the weakest sixth) {who} fails shortly before the end")
        } else if *least > 0.0 {
            format!(", but in weaker people (the weakest sixth) {who} fails within {}", how_long(*least))
        } else {
            format!(", but weaker people (the weakest sixth) are too weak for it ({who})")
        })
    }

    /// ` Hazard for ligaments: low back bent forward by 60°.`, `... right and left knee hyperextended by 5° for 3.2 min.` where it is over.
    fn hazard(&self, model: &Model) -> Option<String> {
        let at_end = self.hazards.iter().map(|hazard| hazard.posture_in_words(model));
        let passed = self.passed.iter().map(|PassedHazard { hazard, seconds, .. }| {
            format!("{} for {}", hazard.posture_in_words(model), how_long(*seconds))
        });
        let list = of_both_sides(&at_end.chain(passed).collect::<Vec<_>>());
        (!list.is_empty()).then(|| format!(" Hazard for ligaments: {}.", enumerated(&list)))
    }
}

/// No group of the body has a strength.
pub(super) fn has_no_strength(model: &Model) -> bool {
    model.coordinates().iter().all(|coordinate| coordinate.groups.is_none())
}

/// `right and left knee ...` for `right knee ...` and `left knee ...` of the same words.
fn of_both_sides(parts: &[String]) -> Vec<String> {
    let has = |part: &String| parts.contains(part);
    let both = |part: &String| match (part.strip_prefix("right "), part.strip_prefix("left ")) {
        (Some(rest), _) if has(&format!("left {rest}")) => Some(format!("right and left {rest}")),
        (_, Some(rest)) if has(&format!("right {rest}")) => None,
        _ => Some(part.clone()),
    };
    parts.iter().filter_map(both).collect()
}

/// `a`, `a and b`, `a, b and c`.
pub(super) fn enumerated(parts: &[String]) -> String {
    match parts {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => parts.concat(),
    }
}

impl Nearest {
    /// `It ends at 0.40, 1.97, 0.20 m (ground axes x, y, z); from there the target lies 62.9 cm higher and 3.1 cm along +z.`
    fn in_words(&self) -> String {
        let [x, y, z] = [self.at.x, self.at.y, self.at.z];
        let whole = self.to_target.norm();
        let counts = |part: f64| part.abs() > LEAST_PART * whole;
        let rise = self.to_target.dot(&self.up);
        let mut parts: Vec<String> = vec![];
        if counts(rise) {
            parts.push(format!("{} {}", length(rise.abs()), if rise > 0.0 { "higher" } else { "lower" }));
        }
        let level = self.to_target - rise * self.up;
        for (part, axis) in level.iter().zip(["x", "y", "z"]).filter(|(part, _)| counts(**part)) {
            parts.push(format!("{} along {}{axis}", length(part.abs()), if *part > 0.0 { "+" } else { "\u{2212}" }));
        }
        let at = format!("{x:.2}, {y:.2}, {z:.2}").replace('-', "\u{2212}");
        format!("It ends at {at} m (ground axes x, y, z); from there the target lies {}.", enumerated(&parts))
    }
}

impl Missed {
    /// `12.0 cm`, `3.4°`.
    pub fn by(&self) -> String {
        by(self.distance, self.unit)
    }
}

/// The error of a level in words: `12.0 cm`, `3.4°`.
pub fn error_in_words(level: &PriorityLevel, error: f64) -> String {
    by(error, unit(level))
}

/// An error in its unit.
fn by(error: f64, unit: Option<Unit>) -> String {
    match unit {
        Some(Unit::Radian) => format!("{:.1}°", error.to_degrees()),
        Some(Unit::Metre) => length(error),
        _ => format!("{error:.3} (m and rad together)"),
    }
}

/// `12.0 cm`, from a metre on `1.23 m`.
fn length(metres: f64) -> String {
    if metres < 0.995 { format!("{:.1} cm", 100.0 * metres) } else { format!("{metres:.2} m") }
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

/// `between 14 min and 27 min for two of three people`, `14 min to no limit for two of three people`.
pub(super) fn in_words((least, greatest): (f64, f64)) -> String {
    let least = how_long(least);
    if greatest < A_DAY {
        format!("between {least} and {} for two of three people", how_long(greatest))
    } else {
        format!("{least} to no limit for two of three people")
    }
}

/// `5.3 cm and 2.1°`.
pub fn slip_in_words(slip: Slip) -> String {
    format!("{} and {:.1}°", length(slip.distance), slip.angle.to_degrees())
}

pub(super) fn percent(share: f64) -> String {
    format!("{:.0}\u{a0}%", 100.0 * share)
}

/// A time that a job asks for: also one longer than a day has its number.
pub(crate) fn asked_in_words(seconds: f64) -> String {
    if seconds < A_DAY { how_long(seconds) } else { format!("{:.0}\u{a0}h", seconds / 3600.0) }
}

/// `45 s`, `7.5 min`, `12 min`, `6.9 h`, `longer than a day`.
pub fn how_long(seconds: f64) -> String {
    match seconds {
        _ if seconds < 9.95 => format!("{seconds:.1}\u{a0}s"),
        _ if seconds < 100.0 => format!("{seconds:.0}\u{a0}s"),
        _ if seconds < WHOLE_MINUTES => format!("{:.1}\u{a0}min", seconds / 60.0),
        _ if seconds < 5970.0 => format!("{:.0}\u{a0}min", seconds / 60.0),
        _ if seconds < A_DAY => format!("{:.1}\u{a0}h", seconds / 3600.0),
        _ => "longer than a day".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minutes_from_ten_on_have_no_decimal_and_a_time_asked_always_has_its_number() {
        let shown = [9.9, 9.96, 99.0, 596.0, 597.1, 2941.0, 5971.0, 90_000.0].map(how_long);
        let expected = ["9.9 s", "10 s", "99 s", "9.9 min", "10 min", "49 min", "1.7 h", "longer than a day"];
        assert_eq!(shown.map(|text| text.replace('\u{a0}', " ")), expected);
        assert_eq!([7200.0, 90_000.0].map(asked_in_words), ["2.0\u{a0}h", "25\u{a0}h"]);
    }
}
