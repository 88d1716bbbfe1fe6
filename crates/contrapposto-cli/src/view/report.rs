//! `report.html`, one module a command.

pub(crate) mod assessment;
pub(crate) mod capacity;
pub(crate) mod comparison;
pub(crate) mod equilibria;
mod figure;
mod narrative;
pub(crate) mod population;
pub(crate) mod pose;
pub(crate) mod run;

use contrapposto::model::Model;
use contrapposto::suggestions::{Advice, LargestLoad};
use contrapposto::verdict::{Verdict, has_motors, muscles_or_motors};
use contrapposto_report::{Fact, Report, Table};

/// Puts the verdict and the changes of the job at the head of a page.
fn answer(report: &mut Report, verdict: &Verdict, advice: &Advice) {
    report.headline.clone_from(&verdict.sentence);
    report.facts.extend(verdict.lines.iter().map(|line| Fact { name: line.name.to_owned(), text: line.text.clone() }));
    let largest = |largest: &LargestLoad| Fact { name: LargestLoad::NAME.to_owned(), text: largest.in_words() };
    report.facts.extend(advice.largest.as_ref().map(largest));
    let (columns, rows) = (advice.gains.columns.clone(), advice.gains.rows.clone());
    report.changes = Table { heading: String::new(), columns, rows };
    report.reasons.extend(advice.notes.iter().cloned());
}

/// The text of a page, with the word for what moves the body.
fn page(model: &Model, mut report: Report) -> String {
    report.motors = has_motors(model);
    let notes = report.figures.iter_mut().flat_map(|figure| [&mut figure.label, &mut figure.note]);
    let listed = [&mut report.list.heading, &mut report.list.none].into_iter();
    let entries = report.list.entries.iter_mut().map(|entry| &mut entry.text);
    let columns = std::iter::once(&mut report.table.heading).chain(&mut report.table.columns);
    let texts = notes.chain(&mut report.reasons).chain(listed).chain(entries).chain(columns);
    texts.for_each(|text| *text = muscles_or_motors(model, text));
    contrapposto_report::write(&report)
}
