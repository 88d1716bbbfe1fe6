//! Turns the answers of rows into columns and back, and into lines of text.

use contrapposto::verdict::VerdictKind;
use contrapposto_formats::motion::csv_cell;
use contrapposto_formats::{Distribution, Value};

use super::outcome::{Outcome, REFUSED};
use super::part_file::Column;

/// Columns of a part after `row` and the parameters, with their meaning.
pub const COLUMNS: [(&str, &str); 9] = [
    (
        "kind",
        "verdict: cannot_be_done, cannot_stand, not_reached, held_until or holds; refused: no scenario with these values, or an error in the run",
    ),
    ("minutes", "min; how long the job can be done; empty: muscles set no limit, or it cannot be done"),
    ("who", "muscle group that is too weak or fails first; where none does, the one with the greatest load"),
    ("hardest", "muscle group with the greatest load"),
    ("load", "1; active torque of `hardest` over its strength"),
    ("effort", "1; sum of (active torque / strength)^2 at the end"),
    ("seconds", "s; simulated time"),
    ("search_cut", "true where a search for an easier posture was cut short: there may be one"),
    ("note", "why the row is refused"),
];

/// A row of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Number of the row.
    pub row: usize,
    /// The answer.
    pub outcome: Outcome,
}

/// The columns of answers, in the order of [`COLUMNS`].
pub(crate) fn columns(answers: &[Answer]) -> [Column; COLUMNS.len()] {
    let number = |of: fn(&Outcome) -> Option<f64>| Column::Number(answers.iter().map(|a| of(&a.outcome)).collect());
    let text = |of: fn(&Outcome) -> Option<&str>| {
        Column::Text(answers.iter().map(|answer| of(&answer.outcome).map(str::to_owned)).collect())
    };
    [
        text(|outcome| Some(outcome.kind)),
        number(|outcome| outcome.minutes),
        text(|outcome| outcome.who.as_deref()),
        text(|outcome| outcome.hardest.as_deref()),
        number(|outcome| outcome.load),
        number(|outcome| outcome.effort),
        number(|outcome| outcome.seconds),
        Column::Truth(answers.iter().map(|answer| answer.outcome.search_cut).collect()),
        text(|outcome| outcome.note.as_deref()),
    ]
}

/// The answer of the row `i` of these columns; `None` where one is of another kind, or the verdict has no known word.
pub(crate) fn outcome(columns: &[Column], i: usize) -> Option<Outcome> {
    let number = |column: &Column| if let Column::Number(values) = column { values.get(i).copied() } else { None };
    let text = |column: &Column| if let Column::Text(values) = column { values.get(i).cloned() } else { None };
    let [kind, minutes, who, hardest, load, effort, seconds, Column::Truth(cut), note] = columns else { return None };
    let word = text(kind)??;
    Some(Outcome {
        kind: VerdictKind::ALL.into_iter().map(VerdictKind::word).chain([REFUSED]).find(|kind| *kind == word)?,
        minutes: number(minutes)?,
        who: text(who)?,
        hardest: text(hardest)?,
        load: number(load)?,
        effort: number(effort)?,
        seconds: number(seconds)?,
        search_cut: cut.get(i).copied()?,
        note: text(note)?,
    })
}

/// The column of a parameter: numbers or truths where its distributions have nothing else, otherwise texts.
pub(crate) fn parameter<'a>(
    distributions: impl Iterator<Item = &'a Distribution>,
    values: impl Iterator<Item = Value>,
) -> Column {
    let kinds: Vec<Value> = distributions.flat_map(kinds).collect();
    if kinds.iter().all(|value| matches!(value, Value::Number(_))) {
        Column::Number(values.map(|value| if let Value::Number(x) = value { Some(x) } else { None }).collect())
    } else if kinds.iter().all(|value| matches!(value, Value::Bool(_))) {
        Column::Truth(values.map(|value| if let Value::Bool(truth) = value { Some(truth) } else { None }).collect())
    } else {
        let text = |value| if let Value::Text(text) = value { text } else { value.to_string() };
        Column::Text(values.map(|value| Some(text(value))).collect())
    }
}

/// Values of each kind that a distribution has.
fn kinds(distribution: &Distribution) -> Vec<Value> {
    if let Distribution::List(list) = distribution { list.clone() } else { vec![Value::Number(0.0)] }
}

/// A row as text; every number has all the digits that are needed to read the same value again.
pub(crate) fn line(row: usize, values: &[Value], outcome: &Outcome) -> String {
    let number = |number: Option<f64>| number.map_or(String::new(), |number| number.to_string());
    let text = |text: &Option<String>| text.as_deref().map_or(String::new(), csv_cell);
    let value = |value: &Value| if let Value::Text(text) = value { csv_cell(text) } else { value.to_string() };
    let answer = [
        outcome.kind.to_owned(),
        number(outcome.minutes),
        text(&outcome.who),
        text(&outcome.hardest),
        number(outcome.load),
        number(outcome.effort),
        number(outcome.seconds),
        outcome.search_cut.map_or_else(String::new, |cut| cut.to_string()),
        text(&outcome.note),
    ];
    let cells = std::iter::once(row.to_string()).chain(values.iter().map(value)).chain(answer);
    cells.collect::<Vec<_>>().join(",") + "\n"
}
