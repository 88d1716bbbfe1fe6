//! Names and decisions in plain words.

use contrapposto::hybrid::{Carrier, Decision, Equilibrium, Outcome};
use contrapposto::model::{Model, Side};

use super::film::{Event, Frame, What};
use super::visible;

/// `hip_adduction_r` is `right hip adduction`, `calcn_l` is `left foot`.
pub(crate) fn plain(name: &str) -> String {
    let (stem, side) = match name.rsplit_once('_') {
        Some((stem, "r")) => (stem, "right "),
        Some((stem, "l")) => (stem, "left "),
        _ => (name, ""),
    };
    let words: Vec<&str> = stem.trim_end_matches("_angle").split('_').map(long).collect();
    format!("{side}{}", words.join(" "))
}

fn long(word: &str) -> &str {
    WORDS.iter().find(|(short, _)| *short == word).map_or(word, |(_, long)| long)
}

/// Short words in OpenSim's names.
const WORDS: [(&str, &str); 8] = [
    ("add", "adduction"),
    ("calcn", "foot"),
    ("dev", "deviation"),
    ("flex", "flexion"),
    ("mtp", "toes"),
    ("pro", "pronation"),
    ("rot", "rotation"),
    ("sup", "supination"),
];

/// The name of a muscle group, with the side of its coordinate.
pub(crate) fn group(name: &str, coordinate: &str) -> String {
    let side = ["_r", "_l"].into_iter().find(|side| coordinate.ends_with(side) && !name.ends_with(side));
    plain(&format!("{name}{}", side.unwrap_or_default()))
}

/// The first letter large.
pub(crate) fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// `a, b and c`.
pub(crate) fn list(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

/// `21.8°`, `0.120 m`.
pub(crate) fn value(model: &Model, i: usize, value: f64) -> String {
    let coordinate = &model.coordinates()[i];
    let slides = coordinate.kind == contrapposto::model::CoordinateKind::Translation;
    let value = visible(coordinate, value);
    let text = if slides { format!("{value:.3} m") } else { format!("{value:.1}°") };
    text.replace('-', "\u{2212}")
}

/// `70 %`, in one piece.
pub(crate) fn percent(share: f64) -> String {
    format!("{:.0}\u{a0}%", 100.0 * share)
}

/// `45 s`, `7.5 min`, `12 min`, `6.9 h`, `longer than a day`.
pub(crate) fn how_long(seconds: f64) -> String {
    match seconds {
        _ if seconds < 100.0 => format!("{seconds:.0}\u{a0}s"),
        _ if seconds < 597.0 => format!("{:.1}\u{a0}min", seconds / 60.0),
        _ if seconds < 6000.0 => format!("{:.0}\u{a0}min", seconds / 60.0),
        _ if seconds < 86_400.0 => format!("{:.1}\u{a0}h", seconds / 3600.0),
        _ => "longer than a day".to_owned(),
    }
}

/// The group that gives up first when a posture is held from a rested start and nobody shifts, and after how many seconds; none
/// where all can hold for ever.
pub(crate) fn fails_first(model: &Model, frame: &Frame) -> Option<(String, f64)> {
    let time = |i: usize| {
        let groups = model.coordinates()[i].groups.as_ref()?;
        let time = groups[Side::of(frame.active(i)).index()].fatigue.endurance_time(frame.load[i]);
        time.is_finite().then_some((i, time))
    };
    let (i, time) = (0..frame.load.len()).filter_map(time).min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((working(model, i, frame)?, time))
}

/// The name of the group of a coordinate that works.
pub(crate) fn working(model: &Model, i: usize, frame: &Frame) -> Option<String> {
    let coordinate = &model.coordinates()[i];
    let groups = coordinate.groups.as_ref()?;
    Some(group(&groups[Side::of(frame.active(i)).index()].name, &coordinate.name))
}

/// The name of the more tired group of a coordinate, and how tired it is.
pub(crate) fn tired(model: &Model, i: usize, frame: &Frame) -> Option<(String, f64)> {
    let coordinate = &model.coordinates()[i];
    let [positive, negative] = frame.fatigue.as_ref()?[i];
    let side = usize::from(negative > positive);
    let groups = coordinate.groups.as_ref()?;
    Some((group(&groups[side].name, &coordinate.name), positive.max(negative)))
}

/// What was decided, and about what.
pub(crate) fn decision(model: &Model, event: &Event, frame: &Frame) -> String {
    let i = event.coordinate;
    let name = sentence(&plain(&model.coordinates()[i].name));
    let tired = match tired(model, i, frame) {
        Some((group, fatigue)) => format!("muscles of {group} are at {} fatigue", percent(fatigue)),
        None => "it asks for relief".to_owned(),
    };
    match &event.what {
        What::Decided(decision) => {
            let from = value(model, i, frame.posture[i]);
            let goal = decision.goal.map(|goal| value(model, i, goal)).unwrap_or_default();
            let answer = sentence(&answer(decision, &from, &goal));
            format!("{name}: {tired}. {answer} (case {})", decision.case)
        }
        What::Waits => {
            format!(
                "{name}: {tired}, but something more important holds it, or relief cost more than it gave: it waits."
            )
        }
        What::Recovered => format!("{name}: its muscles are rested; it needs no relief any more."),
    }
}

/// Where relief lies, as the second half of a sentence about a joint.
pub(crate) fn answer(decision: &Decision, from: &str, goal: &str) -> String {
    let go = if from == goal { format!("it stays at {from}") } else { format!("it goes from {from} to {goal}") };
    match (decision.outcome, decision.equilibrium) {
        (Outcome::Stay, _) => format!("it stays at {from}: muscles hold next to nothing there."),
        (Outcome::None, _) => format!("it stays at {from}: the printed tables find no goal."),
        (Outcome::AtLimit, _) => format!("{go}, the end of its range, where least is left for muscles."),
        (Outcome::Active, None) => format!("{go}, where muscles work well and hold least."),
        (Outcome::Active, Some(_)) => format!("{go}, where it balances in the middle of its range."),
        (Outcome::Passive, Some(Equilibrium::Stable(Carrier::Gravity))) => {
            format!("{go}, where it hangs by its own weight.")
        }
        (Outcome::Passive, _) => format!("{go}, where ligaments carry it."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_words() {
        assert_eq!(plain("hip_adduction_r"), "right hip adduction");
        assert_eq!(plain("knee_angle_l"), "left knee");
        assert_eq!(plain("calcn_r"), "right foot");
        assert_eq!(plain("elbow_flex_l"), "left elbow flexion");
        assert_eq!(plain("lumbar_extension"), "lumbar extension");
        assert_eq!(plain("<b>"), "<b>");
        assert_eq!(group("hip_abduction", "hip_adduction_r"), "right hip abduction");
        assert_eq!(sentence("élan"), "Élan");
    }
}
