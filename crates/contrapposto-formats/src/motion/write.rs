//! Writes motion as text that OpenSim and spreadsheets read.

use std::collections::HashSet;
use std::fmt::Write;

use contrapposto::model::{CoordinateKind, Model};

use super::MOST_NAME_BYTES;
use super::read::is_time;

/// The reason for which a motion was not written: a file that [`super::read_table`] would refuse helps nobody.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnwritableTable {
    /// Nothing to write.
    #[error("a table needs a column and a row")]
    Empty,
    /// The rows do not fit the times or the columns.
    #[error("row {row} does not fit: {found} numbers where {needed} are needed")]
    Ragged {
        /// The first row that does not fit, counted from 0; the number of rows if the times are more or fewer.
        row: usize,
        /// Numbers it has (or times).
        found: usize,
        /// Numbers it needs (or rows).
        needed: usize,
    },
    /// NaN or infinite, perhaps only in degrees.
    #[error("row {row}, column `{column}`: {value} is not finite")]
    NotFinite {
        /// The row, counted from 0.
        row: usize,
        /// Label.
        column: String,
        /// The value as it would stand in the file.
        value: f64,
    },
    /// Times fall.
    #[error("time falls at row {row}")]
    Time {
        /// The row, counted from 0.
        row: usize,
    },
    /// A label twice, too long, or `time`.
    #[error("the column name `{0}` stands twice, is `time` or has more than {MOST_NAME_BYTES} bytes")]
    Name(String),
}

/// Name and kind of every coordinate, as [`write_sto`] takes them. A rotation by a curve of its coordinate is none for OpenSim, which reads and writes
/// its values in radians; here it stands as a length, which is written as it is.
pub fn opensim_columns(model: &Model) -> Vec<(&str, CoordinateKind)> {
    let kind = |i: usize, kind| if model.turns_by_curves(i) { CoordinateKind::Translation } else { kind };
    model.coordinates().iter().enumerate().map(|(i, c)| (c.name.as_str(), kind(i, c.kind))).collect()
}

/// A `.sto` or `.mot` table as OpenSim reads it: name, `version=1`, `nRows`, `nColumns`, `inDegrees`, `endheader`, labels and
/// rows separated by tabs, `time` first.
///
/// Values are in rad, m and components of quaternions, whatever is written: with `in_degrees` angles are converted, and the
/// header says so. Numbers are written in the shortest form that reads back the same bits. So what [`super::read_table`]
/// reads are exactly the numbers written; [`super::postures`] gives back the same bits without `in_degrees`, and with it
/// angles within a relative 4.5e-16 (two roundings each way), everything else the same bits.
///
/// Control characters and blanks in labels become `_`: OpenSim's `Storage` cuts labels at blanks. The name keeps its blanks.
///
/// # Errors
/// [`UnwritableTable`] if the table could not be read back.
pub fn write_sto<R: AsRef<[f64]>>(
    name: &str,
    columns: &[(&str, CoordinateKind)],
    in_degrees: bool,
    times: &[f64],
    rows: &[R],
) -> Result<String, UnwritableTable> {
    let labels: Vec<(String, bool)> = columns
        .iter()
        .map(|(name, kind)| (plain(name, false), in_degrees && *kind == CoordinateKind::Rotation))
        .collect();
    let mut text = format!(
        "{}\nversion=1\nnRows={}\nnColumns={}\ninDegrees={}\nendheader\n",
        title(name),
        rows.len(),
        labels.len() + 1,
        if in_degrees { "yes" } else { "no" }
    );
    body(&mut text, '\t', &labels, times, rows)?;
    Ok(text)
}

/// A comma separated table with columns `NAME.angle_deg`, `NAME.position_m` and, for quaternions, `NAME.value`: those of our
/// runs. Values are in rad and m; angles are written in degrees, always, with what that means for bits (see [`write_sto`]).
///
/// Commas, quotes and control characters in names become `_`.
///
/// # Errors
/// [`UnwritableTable`] if the table could not be read back.
pub fn write_csv<R: AsRef<[f64]>>(
    columns: &[(&str, CoordinateKind)],
    times: &[f64],
    rows: &[R],
) -> Result<String, UnwritableTable> {
    let label = |(name, kind): &(&str, CoordinateKind)| {
        let name = plain(name, true);
        match kind {
            CoordinateKind::Rotation => (format!("{name}.angle_deg"), true),
            CoordinateKind::Translation => (format!("{name}.position_m"), false),
            CoordinateKind::Quaternion => (format!("{name}.value"), false),
        }
    };
    let labels: Vec<(String, bool)> = columns.iter().map(label).collect();
    let mut text = String::new();
    body(&mut text, ',', &labels, times, rows)?;
    Ok(text)
}

/// Labels and rows; a label's flag says that its column is converted to degrees.
fn body<R: AsRef<[f64]>>(
    text: &mut String,
    separator: char,
    labels: &[(String, bool)],
    times: &[f64],
    rows: &[R],
) -> Result<(), UnwritableTable> {
    if labels.is_empty() || rows.is_empty() {
        return Err(UnwritableTable::Empty);
    }
    if times.len() != rows.len() {
        return Err(UnwritableTable::Ragged { row: rows.len(), found: times.len(), needed: rows.len() });
    }
    text.push_str("time");
    let mut seen = HashSet::new();
    for (label, _) in labels {
        let fits = label.len() <= MOST_NAME_BYTES && !is_time(label);
        if !fits || !seen.insert(label.as_str()) {
            return Err(UnwritableTable::Name(label.clone()));
        }
        text.push(separator);
        text.push_str(label);
    }
    text.push('\n');
    for (row, (values, time)) in rows.iter().zip(times).enumerate() {
        let values = values.as_ref();
        if values.len() != labels.len() {
            return Err(UnwritableTable::Ragged { row, found: values.len(), needed: labels.len() });
        }
        if !time.is_finite() {
            return Err(UnwritableTable::NotFinite { row, column: "time".to_owned(), value: *time });
        }
        if row > 0 && *time < times[row - 1] {
            return Err(UnwritableTable::Time { row });
        }
        let _ = write!(text, "{time:?}");
        for (value, (label, to_degrees)) in values.iter().zip(labels) {
            let value = if *to_degrees { value.to_degrees() } else { *value };
            if !value.is_finite() {
                return Err(UnwritableTable::NotFinite { row, column: label.clone(), value });
            }
            let _ = write!(text, "{separator}{value:?}");
        }
        text.push('\n');
    }
    Ok(())
}

/// A name as it can stand in a table: without control characters; without blanks, at which OpenSim's `Storage` cuts labels,
/// or, for CSV, without commas, quotes and blanks around it, and nothing that a spreadsheet would run.
pub(crate) fn plain(name: &str, csv: bool) -> String {
    let bad = |c: char| c.is_control() || if csv { c == ',' || c == '"' } else { c == ' ' };
    let mut plain: String = name.chars().map(|c| if bad(c) { '_' } else { c }).collect();
    if plain.starts_with(' ') || csv && is_formula(&plain) {
        plain.replace_range(..1, "_");
    }
    if plain.is_empty() || plain.ends_with(' ') {
        plain.pop();
        plain.push('_');
    }
    plain
}

/// A text as a cell of a CSV file: one line, quoted where it has to be, and nothing that a spreadsheet would run.
pub fn csv_cell(text: &str) -> String {
    let mut plain: String = text.chars().map(|c| if c.is_control() { '_' } else { c }).collect();
    if is_formula(&plain) {
        plain.replace_range(..1, "_");
    }
    if plain.contains([',', '"']) { format!("\"{}\"", plain.replace('"', "\"\"")) } else { plain }
}

/// Whether a spreadsheet takes a cell for a formula.
fn is_formula(cell: &str) -> bool {
    cell.starts_with(['=', '+', '-', '@', '\t'])
}

/// A first line that no reader takes for anything but a name.
fn title(name: &str) -> String {
    let mut plain: String = name.chars().map(|c| if c.is_control() || c == '=' { '_' } else { c }).collect();
    plain.truncate(plain.floor_char_boundary(MOST_NAME_BYTES));
    let title = plain.trim_matches(' ');
    let first = title.split(' ').next().unwrap_or_default();
    let rows = ["nRows", "nr", "datarows", "nColumns", "nc", "datacolumns"];
    let others = ["", "name", "version", "inDegrees", "Angles", "DataType", "units", "header", "endheader"];
    if rows.contains(&first) || others.contains(&first) { "motion".to_owned() } else { title.to_owned() }
}
