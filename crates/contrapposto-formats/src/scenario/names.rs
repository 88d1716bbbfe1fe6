//! Finds coordinates and segments by their names in a file.

use contrapposto::model::Model;

use crate::input_error::{InputError, suggestion};
use crate::toml_file::Located;

/// The coordinate of this name; the error points at the key at the end of `path`.
pub(super) fn coordinate(at: &Located, model: &Model, path: &[&str], name: &str) -> Result<usize, InputError> {
    model.coordinate(name).ok_or_else(|| {
        let help = suggestion(name, model.coordinates().iter().map(|c| c.name.as_str()));
        at.key_error(path, format!("the body has no coordinate `{name}`"), help)
    })
}

/// The segment of this name; the error points at the value at `path`.
pub(super) fn segment(at: &Located, model: &Model, path: &[&str], name: &str) -> Result<usize, InputError> {
    model.segment(name).ok_or_else(|| {
        let meant = segment_of_word(name).filter(|meant| model.segment(meant).is_some());
        let all = || suggestion(name, model.segments().iter().map(|s| s.name.as_str()));
        let help = meant.map(|meant| format!("did you mean `{meant}`?")).or_else(all);
        at.error(path, format!("the body has no segment `{name}`"), help)
    })
}

/// The segment of the built-in adult that a word of everyday language means: `right_foot` is `calcn_r`.
fn segment_of_word(word: &str) -> Option<String> {
    const PARTS: [(&str, &str); 11] = [
        ("foot", "calcn"),
        ("heel", "calcn"),
        ("forearm", "radius"),
        ("upper_arm", "humerus"),
        ("arm", "humerus"),
        ("shoulder", "humerus"),
        ("thigh", "femur"),
        ("upper_leg", "femur"),
        ("shank", "tibia"),
        ("lower_leg", "tibia"),
        ("calf", "tibia"),
    ];
    const MIDDLE: [(&str, &str); 7] = [
        ("trunk", "torso"),
        ("chest", "torso"),
        ("thorax", "torso"),
        ("back", "torso"),
        ("hip", "pelvis"),
        ("hips", "pelvis"),
        ("belly", "abdomen"),
    ];
    let part = |list: &[(&str, &'static str)], word: &str| list.iter().find(|(w, _)| *w == word).map(|(_, s)| *s);
    let sides = [("right_", "r"), ("left_", "l")];
    let of_side = sides.iter().find_map(|(prefix, side)| {
        word.strip_prefix(prefix).and_then(|word| part(&PARTS, word)).map(|segment| format!("{segment}_{side}"))
    });
    of_side.or_else(|| part(&MIDDLE, word).map(str::to_owned))
}
