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

/// Movements of muscle groups, and what they do to a body in words that need no anatomy.
const MOVEMENTS: [(&str, &str); 40] = [
    ("shoulder flexion", "raises the arm forward"),
    ("shoulder extension", "pulls the arm down and back"),
    ("shoulder abduction", "raises the arm to the side"),
    ("shoulder adduction", "pulls the arm toward the body"),
    ("shoulder internal rotation", "turns the upper arm inward"),
    ("shoulder external rotation", "turns the upper arm outward"),
    ("elbow flexion", "bends the elbow"),
    ("elbow extension", "straightens the elbow"),
    ("forearm pronation", "turns the palm down"),
    ("forearm supination", "turns the palm up"),
    ("wrist flexion", "bends the hand toward the palm"),
    ("wrist extension", "bends the hand back"),
    ("wrist ulnar deviation", "bends the hand toward the little finger"),
    ("wrist radial deviation", "bends the hand toward the thumb"),
    ("hip flexion", "raises the thigh forward"),
    ("hip extension", "straightens the hip"),
    ("hip abduction", "moves the leg outward"),
    ("hip adduction", "moves the leg inward"),
    ("hip internal rotation", "turns the leg inward"),
    ("hip external rotation", "turns the leg outward"),
    ("knee flexion", "bends the knee"),
    ("knee extension", "straightens the knee"),
    ("ankle dorsiflexion", "raises the front of the foot"),
    ("ankle plantarflexion", "presses the front of the foot down"),
    ("subtalar inversion", "turns the sole inward"),
    ("subtalar eversion", "turns the sole outward"),
    ("mtp extension", "raises the toes"),
    ("mtp flexion", "presses the toes down"),
    ("lumbar extension", "straightens the low back"),
    ("lumbar flexion", "bends the low back forward"),
    ("lumbar lateral bending", "bends the low back to the side"),
    ("lumbar axial rotation", "twists the low back"),
    ("thoracic extension", "straightens the upper back"),
    ("thoracic flexion", "bends the upper back forward"),
    ("thoracic lateral bending", "bends the upper back to the side"),
    ("thoracic axial rotation", "twists the upper back"),
    ("neck extension", "holds the head up"),
    ("neck flexion", "bends the neck forward"),
    ("neck lateral bending", "bends the neck to the side"),
    ("neck axial rotation", "turns the head"),
];

/// The movements that a text names, in the order of the text, each with what it does; `None` where it names none that is known.
///
/// ```
/// use contrapposto::model::movements_in_words;
/// let words = movements_in_words("then right shoulder flexion fails first.").unwrap();
/// assert_eq!(words, "shoulder flexion raises the arm forward");
/// assert_eq!(movements_in_words("Holds."), None);
/// ```
pub fn movements_in_words(text: &str) -> Option<String> {
    let place = |(name, does): &(&'static str, &'static str)| text.find(name).map(|at| (at, format!("{name} {does}")));
    let mut named: Vec<(usize, String)> = MOVEMENTS.iter().filter_map(place).collect();
    named.sort_unstable();
    let words: Vec<String> = named.into_iter().map(|(_, words)| words).collect();
    (!words.is_empty()).then(|| words.join("; "))
}

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
    fn every_muscle_group_of_the_adult_has_a_movement_in_words_that_need_no_anatomy() {
        let model = crate::model::adult(&crate::model::Adult::default()).unwrap();
        for coordinate in model.coordinates() {
            for group in coordinate.groups.iter().flatten() {
                let name = plain_group_name(&group.name, &coordinate.name);
                let words = movements_in_words(&name);
                assert!(words.as_ref().is_some_and(|words| !words.contains(';')), "{name}: {words:?}");
            }
        }
        let text = "right hip extension; left elbow flexion and right elbow flexion";
        assert_eq!(
            movements_in_words(text).unwrap(),
            "hip extension straightens the hip; elbow flexion bends the elbow"
        );
    }

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
