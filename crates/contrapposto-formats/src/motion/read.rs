//! Reads bytes as a [`Table`], or gives an error with line and column.

use std::collections::HashSet;

use super::layout::Layout;
use super::{MOST_COLUMNS, MOST_NAME_BYTES, MOST_NUMBERS, MOST_TABLE_BYTES, Table, header};
use crate::input_error::{InputError, utf8};
use crate::xml::shorten;

/// Reads a table: OpenSim's `.sto` and `.mot` if there is a line `endheader`, comma separated text otherwise. `name` is the
/// file's name for messages.
///
/// OpenSim's form: a name line, `key=value` lines and comments, `endheader`, labels of which the first is `time`, rows;
/// cells are separated by tabs or spaces. SIMM's older form (`datacolumns`, `datarows`) as well.
///
/// CSV: labels, then rows. Without a first column `time` the rows are numbered 0, 1, 2 and so on. Columns `NAME.case` and
/// `NAME.goal_deg` or `.goal_m` of our own runs are left out: their cells may be empty.
///
/// Every number must be finite, every row complete, every label unique, and times must not fall. A wrong `nRows` or
/// `nColumns` is a warning of the table: OpenSim reads such files. Empty lines and blanks at line ends do not matter. At most [`MOST_TABLE_BYTES`],
/// [`MOST_COLUMNS`], [`MOST_NUMBERS`] and [`MOST_NAME_BYTES`].
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_table(name: &str, bytes: &[u8]) -> Result<Table, InputError> {
    if bytes.len() > MOST_TABLE_BYTES {
        let message = format!("the file has {} bytes", bytes.len());
        return Err(Layout::new(name, "").error(
            None,
            message,
            "",
            format!("at most {} MiB are read", MOST_TABLE_BYTES >> 20),
        ));
    }
    let layout = Layout::new(name, utf8(name, bytes)?);
    let is_storage = |name: &str| name.ends_with(".sto") || name.ends_with(".mot");
    if !layout.storage && is_storage(&name.to_ascii_lowercase()) {
        let help = "OpenSim's tables begin with a name, `nRows=`, `nColumns=`, `inDegrees=` and a line `endheader`; \
                    comma separated text should be named .csv";
        return Err(layout.error(None, "there is no line `endheader`".to_owned(), "", help.to_owned()));
    }
    let header = header::read(&layout)?;
    let mut lines = layout.body();
    let Some(line) = lines.next() else {
        let help = "a line of column names must follow, then rows of numbers".to_owned();
        return Err(layout.error(None, "the file holds no table".to_owned(), "", help));
    };
    let columns = columns(&layout, line)?;
    let width = columns.len();
    let (mut times, mut rows) = (vec![], vec![]);
    for line in lines {
        if (rows.len() + 1).saturating_mul(width) > MOST_NUMBERS {
            let message = format!("the table has more than {MOST_NUMBERS} numbers");
            return Err(layout.error(Some(&line[..0]), message, "here", "keep fewer rows or columns".to_owned()));
        }
        let (time, row) = row(&layout, line, &columns)?;
        let time = time.unwrap_or((rows.len() as f64, line));
        if times.last().is_some_and(|last| time.0 < *last) {
            let message = format!("time falls from {:?} to {:?}", times[times.len() - 1], time.0);
            return Err(layout.error(Some(time.1), message, "here", "rows must be in the order of time".to_owned()));
        }
        times.push(time.0);
        rows.push(row);
    }
    let warnings = [(header.rows, rows.len(), "rows"), (header.columns, width, "columns")];
    let warnings =
        warnings.into_iter().filter_map(|(promised, found, what)| broken(&layout, promised?, found, what)).collect();
    if rows.is_empty() {
        let message = "the table has column names but no rows".to_owned();
        return Err(layout.error(Some(line), message, "nothing follows", "rows of numbers must follow".to_owned()));
    }
    let names = columns.iter().filter(|(role, _)| *role == Role::Value).map(|(_, label)| (*label).to_owned());
    let (name, in_degrees) = (header.name.to_owned(), header.in_degrees);
    Ok(Table { name, in_degrees, columns: names.collect(), warnings, times, rows })
}

/// A warning about a number of rows or columns (`what`) that the header promises at a place, if the table has another one.
fn broken(layout: &Layout<'_>, (promised, place): (usize, &str), found: usize, what: &str) -> Option<String> {
    let line = layout.line_number(place).map_or_else(String::new, |line| format!(" (line {line})"));
    let name = layout.name();
    let text = format!(
        "{name}: the header says {promised} {what}{line}, but there are {found}, which are read; was the file cut off?"
    );
    (promised != found).then_some(text)
}

/// The role of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Time,
    Value,
    LeftOut,
}

fn columns<'a>(layout: &Layout<'a>, line: &'a str) -> Result<Vec<(Role, &'a str)>, InputError> {
    let mut columns = vec![];
    let mut seen = HashSet::new();
    for label in layout.labels(line) {
        let at = columns.len();
        let complain = |message: String, help: &str| Err(layout.error(Some(label), message, "here", help.to_owned()));
        let is_time = is_time(label);
        if at == MOST_COLUMNS {
            return complain(format!("the table has more than {MOST_COLUMNS} columns"), "keep fewer columns");
        }
        if label.len() > MOST_NAME_BYTES {
            let message = format!("a column's name has {} bytes; at most {MOST_NAME_BYTES} are read", label.len());
            return complain(message, "are the columns separated by commas, or, after `endheader`, by tabs?");
        }
        if label.is_empty() {
            return complain(format!("column {} has no name", at + 1), "every column needs a name");
        }
        if label.contains(|c: char| c.is_control() || (!layout.storage && c == '"')) {
            let shown = label.escape_debug();
            let help = "names hold no quotes and no control characters; commas separate them";
            return complain(format!("the column name `{shown}` cannot be read"), help);
        }
        if !layout.storage && label.parse::<f64>().is_ok() {
            let message = format!("`{label}` stands where a column name should be");
            return complain(message, "the first line must name the columns");
        }
        if layout.storage && at == 0 && !is_time {
            return complain(format!("the first column is `{label}`"), "it must be `time`");
        }
        if at == 0 && !is_time && is_like_time(label) {
            let help = "name it `time`, with values in s; a coordinate of this name may stand in any other column";
            return complain(format!("the first column, `{label}`, is like a time and would not be read as one"), help);
        }
        if is_time && at > 0 {
            return complain(format!("`{label}` is column {}", at + 1), "time stands once, in the first column");
        }
        if !seen.insert(label) {
            return complain(format!("two columns are named `{label}`"), "names must be unique");
        }
        let of_run = [".case", ".goal_deg", ".goal_m"].iter().any(|end| label.ends_with(end));
        let role = match (is_time, of_run && !layout.storage) {
            (true, _) => Role::Time,
            (_, true) => Role::LeftOut,
            _ => Role::Value,
        };
        columns.push((role, label));
    }
    if columns.iter().all(|(role, _)| *role != Role::Value) {
        let help = "a column of values is needed".to_owned();
        return Err(layout.error(Some(line), "the table has no values".to_owned(), "only these columns", help));
    }
    if !layout.storage && columns.len() == 1 && line.contains([';', '\t']) {
        let help = "separate cells with commas and write decimals with a point; \
                    OpenSim's tables have a line `endheader` above the labels";
        return Err(layout.error(Some(line), "there is one column only".to_owned(), "no comma here", help.to_owned()));
    }
    Ok(columns)
}

/// Names of the column of time, s; capitals and spaces do not count.
const TIME: [&str; 4] = ["time", "time_s", "time(s)", "time[s]"];
/// Other names that stand for times or instants.
const LIKE_TIME: [&str; 6] = ["t", "t_s", "s", "sec", "second", "seconds"];

fn lower(label: &str) -> String {
    label.replace(' ', "").to_lowercase()
}

/// Whether a column of this name is that of time.
pub(super) fn is_time(label: &str) -> bool {
    TIME.contains(&lower(label).as_str())
}

fn is_like_time(label: &str) -> bool {
    let label = lower(label);
    label.starts_with("time") || LIKE_TIME.contains(&label.as_str())
}

type Time<'a> = Option<(f64, &'a str)>;

fn row<'a>(layout: &Layout<'a>, line: &'a str, columns: &[(Role, &str)]) -> Result<(Time<'a>, Vec<f64>), InputError> {
    let mut time = None;
    let mut row = Vec::with_capacity(columns.len());
    let mut found = 0;
    for cell in layout.cells(line) {
        let Some((role, label)) = columns.get(found) else {
            let message = format!("the row has more than the {} cells that the labels name", columns.len());
            return Err(layout.error(Some(cell), message, "one too many", "decimals need a point".to_owned()));
        };
        found += 1;
        match role {
            Role::LeftOut => {}
            Role::Time => time = Some((number(layout, cell, label)?, cell)),
            Role::Value => row.push(number(layout, cell, label)?),
        }
    }
    if found < columns.len() {
        let message = format!("the row has {found} cells; the labels name {}", columns.len());
        let label = format!("ends before column `{}`", columns[found].1);
        return Err(layout.error(Some(&line[line.len()..]), message, label, "was the file cut off?".to_owned()));
    }
    Ok((time, row))
}

fn number(layout: &Layout<'_>, cell: &str, label: &str) -> Result<f64, InputError> {
    let complain = |problem: &str, help: &str| {
        let message = format!("column `{label}`: `{}` is {problem}", shorten(cell));
        layout.error(Some(cell), message, problem, help.to_owned())
    };
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => {
            Err(complain("not finite", "every cell must hold a finite number: leave the row out, or fill the gap"))
        }
        Err(_) => Err(complain("not a number", "every cell must hold a finite number, like 12.5 or 1e-3")),
    }
}
