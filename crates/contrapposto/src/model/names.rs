//! Says the names of coordinates, segments and muscle groups in plain words.

/// Short words in the names of OpenSim's bodies, and what they stand for.
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

/// The name of a coordinate or a segment in plain words.
///
/// ```
/// use contrapposto::model::plain_name;
/// assert_eq!(plain_name("hip_adduction_r"), "right hip adduction");
/// assert_eq!(plain_name("calcn_l"), "left foot");
/// ```
pub fn plain_name(name: &str) -> String {
    let (stem, side) = match name.rsplit_once('_') {
        Some((stem, "r")) => (stem, "right "),
        Some((stem, "l")) => (stem, "left "),
        _ => (name, ""),
    };
    // The shoulder, as its muscle groups call it.
    let shoulder = ["arm_flex", "arm_add", "arm_rot"].contains(&stem);
    let stem = if shoulder { stem.replacen("arm", "shoulder", 1) } else { stem.to_owned() };
    let words: Vec<&str> = stem.trim_end_matches("_angle").split('_').map(long).collect();
    format!("{side}{}", words.join(" "))
}

fn long(word: &str) -> &str {
    WORDS.iter().find(|(short, _)| *short == word).map_or(word, |(_, long)| long)
}

/// The name of a muscle group in plain words, with the side of its coordinate.
///
/// ```
/// use contrapposto::model::plain_group_name;
/// assert_eq!(plain_group_name("hip abduction", "hip_adduction_r"), "right hip abduction");
/// ```
pub fn plain_group_name(group: &str, coordinate: &str) -> String {
    let side = ["_r", "_l"].into_iter().find(|side| coordinate.ends_with(side) && !group.ends_with(side));
    plain_name(&format!("{group}{}", side.unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_coordinates_segments_and_groups_become_words() {
        assert_eq!(plain_name("hip_adduction_r"), "right hip adduction");
        assert_eq!(plain_name("knee_angle_l"), "left knee");
        assert_eq!(plain_name("calcn_r"), "right foot");
        assert_eq!(plain_name("elbow_flex_l"), "left elbow flexion");
        assert_eq!(plain_name("lumbar_extension"), "lumbar extension");
        assert_eq!(plain_name("arm_flex_r"), "right shoulder flexion");
        assert_eq!(plain_name("robot_arm_l"), "left robot arm");
        assert_eq!(plain_name("<b>"), "<b>");
        assert_eq!(plain_group_name("hip_abduction", "hip_adduction_r"), "right hip abduction");
    }
}
