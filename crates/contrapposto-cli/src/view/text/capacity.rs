//! The terminal table of the greatest forces at a point.

use contrapposto_formats::{CapacityText, ForceText};

use super::plain_table;
use crate::output::ResultSet;
use crate::view::capacity::newtons;
use crate::view::words::percent;

/// Most limits of a direction that are listed.
const MOST_LIMITS: usize = 2;

/// The first line, a table of directions, and what is assumed.
pub(crate) fn report(text: &CapacityText, folder: Option<&ResultSet>) -> String {
    let mut table = plain_table();
    table.set_header(["direction", "force", "two of three people", "limits (share)"]);
    let extremes = [("weakest", &text.weakest), ("strongest", &text.strongest)];
    for (name, force) in extremes {
        if let Some(force) = force {
            table.add_row(row(&format!("{name}: {}", force.toward), force));
        }
    }
    for force in &text.main {
        table.add_row(row(&force.toward, force));
    }
    let table = if text.main.is_empty() { String::new() } else { format!("{table}\n") };
    let title = if text.title.is_empty() { String::new() } else { format!("{} ({})\n", text.title, text.posture) };
    let assumed: String = text.assumptions.iter().map(|sentence| format!("{sentence}\n")).collect();
    let page = folder.map_or(String::new(), |folder| format!("report: {}\n", folder.path("report.html").display()));
    format!("{}\n{title}{table}{assumed}{page}", text.sentence)
}

/// Cells of a direction.
pub(crate) fn row(name: &str, force: &ForceText) -> [String; 4] {
    let people = format!("{} to {}", newtons(force.weaker_n), newtons(force.stronger_n));
    [name.to_owned(), newtons(force.force_n), people, limits(force)]
}

/// `right shoulder flexion 80 %, balance 12 %`.
fn limits(force: &ForceText) -> String {
    let listed = force.limits.iter().take(MOST_LIMITS).map(|limit| match limit.share {
        share if share > 0.0 => format!("{} {}", limit.name(), percent(share)),
        _ => limit.name().to_owned(),
    });
    let listed: Vec<String> = listed.collect();
    if listed.is_empty() { "nothing".to_owned() } else { listed.join(", ") }
}
