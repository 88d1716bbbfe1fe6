//! The terminal table of the greatest forces at a point.

use contrapposto_formats::{CapacityText, ForceText};

use super::plain_table;
use crate::output::{ResultSet, report_line};
use crate::view::capacity::{newtons, range};

/// Most limits of a direction that are listed, each with at least this share of the first one's share.
const MOST_LIMITS: usize = 2;
const LEAST_OF_FIRST: f64 = 0.25;

/// The first line, a table of directions, and what is assumed.
pub(crate) fn report(text: &CapacityText, folder: Option<&ResultSet>) -> String {
    let mut table = plain_table();
    table.set_header(["direction", "force", "two of three people", "limited by"]);
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
    let page = report_line(folder);
    format!("{}\n{title}{table}{assumed}{page}", text.sentence)
}

/// Cells of a direction.
pub(crate) fn row(name: &str, force: &ForceText) -> [String; 4] {
    let ends = [force.weaker_n, force.stronger_n].map(|force| force.unwrap_or(f64::INFINITY));
    [name.to_owned(), newtons(force.force_n), range(ends), limits(force)]
}

/// `right shoulder flexion`, `balance, friction`.
fn limits(force: &ForceText) -> String {
    let Some(first) = force.limits.first() else { return "nothing".to_owned() };
    let large = force.limits.iter().take(MOST_LIMITS).filter(|limit| limit.share >= LEAST_OF_FIRST * first.share);
    large.map(|limit| limit.name().to_owned()).collect::<Vec<_>>().join(", ")
}
