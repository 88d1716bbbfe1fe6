//! Writes what became of the muscles of a file, by kind.

use std::collections::BTreeMap;
use std::fmt::Write;

use contrapposto_formats::model_ir::KindTally;

use super::plain_table;

/// A table of kinds with the numbers of those read, left out and refused, and the reasons; nothing without muscles.
pub(super) fn muscle_counts(kinds: &BTreeMap<String, KindTally>) -> String {
    if kinds.is_empty() {
        return String::new();
    }
    let mut table = plain_table();
    table.set_header(["muscles and their paths", "read", "left out", "refused"]);
    for (kind, tally) in kinds {
        let numbers = [tally.read, tally.left_out, tally.refused].map(|number| number.to_string());
        table.add_row([std::slice::from_ref(kind), &numbers].concat());
    }
    let mut text = format!("\n{table}\n");
    for (kind, tally) in kinds {
        for (reason, number) in &tally.reasons {
            let _ = writeln!(text, "  {number} {kind}: {reason}");
        }
    }
    text
}
