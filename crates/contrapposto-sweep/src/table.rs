//! Reads the text of a part back: the answer of every row.

use std::collections::BTreeMap;
use std::ops::Range;

use contrapposto::verdict::VerdictKind;

use super::outcome::{Outcome, REFUSED};

/// A row of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Number of the row.
    pub row: usize,
    /// The cells before the answer: the number of the row and the parameters, as they are written.
    pub cells: Vec<String>,
    /// The answer.
    pub outcome: Outcome,
}

/// The rows of a part; `None` where the text is no part, is cut off, or has other rows.
pub fn read_part(text: &str, rows: Range<usize>) -> Option<Vec<Answer>> {
    let mut lines = text.strip_suffix('\n')?.split('\n');
    let header = cells(lines.next()?);
    let columns: BTreeMap<&str, usize> = header.iter().enumerate().map(|(i, name)| (name.as_str(), i)).collect();
    let first = *columns.get("kind")?;
    let whole = |line: &str| Some(cells(line)).filter(|cells| cells.len() == header.len());
    let answers: Vec<Answer> = lines.map(|line| answer(&columns, first, whole(line)?)).collect::<Option<_>>()?;
    answers.iter().map(|answer| answer.row).eq(rows).then_some(answers)
}

fn answer(columns: &BTreeMap<&str, usize>, first: usize, mut cells: Vec<String>) -> Option<Answer> {
    let text = |name: &str| {
        let cell = cells.get(*columns.get(name)?)?;
        (!cell.is_empty()).then(|| cell.clone())
    };
    // An empty cell is no number; another text than a number makes the row unreadable.
    let number =
        |name: &str| text(name).map(|text| text.parse::<f64>().ok()).map_or(Some(None), |number| number.map(Some));
    let word = text("kind")?;
    let kind = VerdictKind::ALL.into_iter().map(VerdictKind::word).chain([REFUSED]).find(|kind| *kind == word)?;
    let outcome = Outcome {
        kind,
        minutes: number("minutes")?,
        who: text("who"),
        hardest: text("hardest"),
        load: number("load")?,
        effort: number("effort")?,
        seconds: number("seconds")?,
        search_cut: text("search_cut").map(|cut| cut == "true"),
        note: text("note"),
    };
    let row = cells.first()?.parse().ok()?;
    cells.truncate(first);
    Some(Answer { row, cells, outcome })
}

/// The cells of a line: separated by commas; one in quotes may hold commas, and two quotes for one.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        let twice = quoted && letter == '"' && letters.next_if_eq(&'"').is_some();
        match (letter, cells.last_mut()) {
            ('"', _) if !twice => quoted = !quoted,
            (',', _) if !quoted => cells.push(String::new()),
            (letter, Some(cell)) => cell.push(letter),
            (_, None) => {}
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::cells;
    use contrapposto_formats::motion::csv_cell;

    #[test]
    fn cells_come_back_as_they_were_written() {
        for written in [vec!["a", "b"], vec!["", "", ""], vec!["a, \"b\", c", "1"], vec!["\"", ",", "\"\"", ",\","]] {
            let line = written.iter().map(|cell| csv_cell(cell)).collect::<Vec<_>>().join(",");
            assert_eq!(cells(&line), written, "{line}");
        }
    }
}
