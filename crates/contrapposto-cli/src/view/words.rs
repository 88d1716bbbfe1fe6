//! Names and values in plain words.

use contrapposto::model::Model;
pub(crate) use contrapposto::model::{plain_group_name as group, plain_name as plain};
use contrapposto::simulation::FootStep;
pub(crate) use contrapposto::verdict::how_long;

use super::axes::visible;

/// Times from here on, s, count as no limit.
pub(crate) const A_DAY: f64 = 86_400.0;
/// Most rows of a table that a reader is shown.
pub(crate) const MOST_ROWS: usize = 10;
/// Most joints, muscle groups or directions of a posture that are listed.
pub(crate) const MOST_JOINTS_SHOWN: usize = 3;

/// `right hip flexion (hip_flexion_r)`: a coordinate in plain words, and its name where that is another one.
pub(crate) fn joint(name: &str) -> String {
    let plain = plain(name);
    if plain == name { plain } else { format!("{plain} ({name})") }
}

/// A moment of a motion or run, with a digit more than [`how_long`]: `0.52 s`, `52.0 s`, `7.95 min`, `33.4 min`, `1.667 h`. `clock` of the page does the same.
pub(crate) fn moment_in_words(seconds: f64) -> String {
    match seconds {
        _ if seconds < 9.95 => format!("{seconds:.2}\u{a0}s"),
        _ if seconds < 100.0 => format!("{seconds:.1}\u{a0}s"),
        _ if seconds < 597.0 => format!("{:.2}\u{a0}min", seconds / 60.0),
        _ if seconds < 5970.0 => format!("{:.1}\u{a0}min", seconds / 60.0),
        _ => format!("{:.3}\u{a0}h", seconds / 3600.0),
    }
}

/// `to relieve right hip flexion`: what a step was for.
pub(crate) fn why(model: &Model, step: &FootStep) -> String {
    match step.relieves {
        Some((coordinate, _)) => format!("to relieve {}", plain(&model.coordinates()[coordinate].name)),
        None => "to come nearer to a task".to_owned(),
    }
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

/// A distance from 1 m on in metres: `1.37 m`, `193 m`; `None` of a shorter one.
pub(crate) fn metres(distance: f64) -> Option<String> {
    match distance {
        _ if distance < 0.9995 => None,
        _ if distance < 9.995 => Some(format!("{distance:.2} m")),
        _ if distance < 99.95 => Some(format!("{distance:.1} m")),
        _ => Some(format!("{distance:.0} m")),
    }
}

/// `70 %`, in one piece; more than ten times is said so.
pub(crate) fn percent(share: f64) -> String {
    if share > 10.0 { "more than 1000\u{a0}%".to_owned() } else { format!("{:.0}\u{a0}%", 100.0 * share) }
}

/// `70 %` of people or of a variance: a share other than 0 and 1 is never rounded to 0 % or 100 %.
pub(crate) fn share_in_words(share: f64) -> String {
    match 100.0 * share {
        all if all > 0.0 && all <= 0.5 => "less than 1\u{a0}%".to_owned(),
        all if all >= 99.5 && share < 1.0 => "more than 99\u{a0}%".to_owned(),
        _ => percent(share),
    }
}

/// The time of a body of a population: `3.4 min`, `no limit` by muscles, `not done` to the end for another reason than fatigue.
pub(crate) fn holding_time(minutes: f64) -> String {
    match minutes {
        f64::INFINITY => "no limit".to_owned(),
        0.0 => "not done".to_owned(),
        minutes => how_long(60.0 * minutes),
    }
}

/// Shares of the weight of body and loads: each share of the body's weight as a share of what all supports carry.
pub(crate) fn shares_of_all(of_body: &[f64]) -> Vec<f64> {
    let all: f64 = of_body.iter().sum();
    if all > 0.0 { of_body.iter().map(|share| share / all).collect() } else { of_body.to_vec() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_from_one_metre_on_have_three_digits_and_shorter_ones_are_left_to_smaller_units() {
        assert_eq!(metres(0.999), None);
        let shown = [1.0, 1.374, 12.34, 192.920_941].map(metres);
        assert_eq!(shown.map(Option::unwrap), ["1.00 m", "1.37 m", "12.3 m", "193 m"]);
    }

    #[test]
    fn a_moment_has_a_digit_more_than_a_time() {
        let shown = [0.52, 52.04, 477.0, 6001.2].map(|time| (how_long(time), moment_in_words(time)));
        let expected = [("0.5 s", "0.52 s"), ("52 s", "52.0 s"), ("8.0 min", "7.95 min"), ("1.7 h", "1.667 h")];
        for ((time, moment), expected) in shown.iter().zip(expected) {
            assert_eq!((time.replace('\u{a0}', " ").as_str(), moment.replace('\u{a0}', " ").as_str()), expected);
        }
    }

    #[test]
    fn a_joint_has_one_plain_name_with_the_coordinate_in_brackets() {
        assert_eq!(joint("hip_flexion_r"), "right hip flexion (hip_flexion_r)");
        assert_eq!(joint("q1"), "q1");
    }

    #[test]
    fn only_nobody_is_0_percent_and_only_all_are_100_percent() {
        let shown = [0.0, 0.003, 0.005, 0.0051, 0.5, 0.994, 0.995, 0.997, 1.0 - f64::EPSILON, 1.0].map(share_in_words);
        let expected =
            ["0", "less than 1", "less than 1", "1", "50", "99", "more than 99", "more than 99", "more than 99", "100"];
        assert_eq!(shown, expected.map(|number| format!("{number}\u{a0}%")));
        let percents = (0..=1000).map(|count| share_in_words(f64::from(count) / 1000.0).replace('\u{a0}', " "));
        let named = percents.enumerate().filter(|(_, text)| text == "0 %" || text == "100 %");
        assert_eq!(named.map(|(count, _)| count).collect::<Vec<_>>(), [0, 1000]);
    }

    #[test]
    fn the_first_letter_becomes_large() {
        assert_eq!(sentence("élan"), "Élan");
    }
}
