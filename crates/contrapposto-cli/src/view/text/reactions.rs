//! The terminal table of forces that press joints together.

use contrapposto_formats::ReactionText;

use super::plain_table;
use crate::view::words::{moment_in_words, plain};

/// Most rows: hips, knees, ankles and the lower back.
const MOST_PRESSED_JOINTS: usize = 7;

/// The joints that are pressed together most, with the time (s) where there are several; empty where no compression is known.
pub(crate) fn reaction_table(mut joints: Vec<(&str, &ReactionText, Option<f64>)>) -> String {
    joints.retain(|(_, reaction, _)| reaction.compression_n.is_some());
    let force = |reaction: &ReactionText| reaction.compression_n.unwrap_or(0.0);
    joints.sort_by(|a, b| force(b.1).total_cmp(&force(a.1)));
    if joints.is_empty() {
        return String::new();
    }
    let timed = joints.iter().any(|(_, _, time)| time.is_some());
    let mut table = plain_table();
    let header = ["joint", "pressed together by, N", "body weights", "along"];
    table.set_header(header.into_iter().chain(timed.then_some("at")));
    for (name, reaction, time) in joints.iter().take(MOST_PRESSED_JOINTS) {
        let mut row = vec![
            (*name).to_owned(),
            reaction.compression_n.map_or_else(String::new, |force| format!("{force:.0}")),
            reaction.body_weights.map_or_else(String::new, |weights| format!("{weights:.2}")),
            reaction.along.as_deref().map_or_else(String::new, plain),
        ];
        row.extend(time.map(moment_in_words));
        table.add_row(row);
    }
    format!("{table}\n")
}
