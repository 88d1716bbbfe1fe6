//! The terminal table of a population.

use contrapposto_sweep::{People, Population, QUANTILES};

use super::plain_table;
use crate::output::{ResultSet, page_line};
use crate::view::population::PopulationText;
use crate::view::words::{holding_time, share_in_words};

/// The answer, its reasons, a table of women and men, and what is counted how.
pub(crate) fn report(text: &PopulationText, found: &Population, folder: Option<&ResultSet>) -> String {
    let mut table = plain_table();
    table.set_header(["", "can hold it", "95 % interval", "P5", "P50", "P95"]);
    for (name, people) in ["women", "men"].into_iter().zip(&found.sexes) {
        table.add_row(row(name, people));
    }
    let reasons: String = text.reasons.iter().map(|reason| format!("{reason}\n")).collect();
    let title = if text.title.is_empty() { String::new() } else { format!("{}\n", text.title) };
    let notes: String = text.notes.iter().map(|note| format!("{note}\n")).collect();
    let files = page_line(folder, "population.html");
    format!("{}\n{reasons}{title}{table}\n{notes}{files}", text.sentence)
}

fn row(name: &str, people: &People) -> [String; 6] {
    let [low, high] = people.interval.map(share_in_words);
    let [p5, p50, p95] = QUANTILES.map(|share| people.quantile(share).map_or("unknown".to_owned(), holding_time));
    let share = people.share().map_or("unknown".to_owned(), share_in_words);
    [name.to_owned(), share, format!("{low} to {high}"), p5, p50, p95]
}
