//! Names and values in plain words.

use contrapposto::model::Model;

use super::axes::visible;

/// Most rows of a table that a reader is shown.
pub(crate) const MOST_ROWS: usize = 10;
/// Most joints, muscle groups or directions of a posture that are listed.
pub(crate) const MOST_JOINTS_SHOWN: usize = 3;

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
