//! Turns the columns of a table into postures of a model.

use std::collections::HashMap;
use std::f64::consts::TAU;

use contrapposto::model::{CoordinateKind, LARGEST, Model};
use contrapposto::posture::Posture;

use super::layout::Layout;
use super::write::plain;
use super::{MOST_NUMBERS, Table};
use crate::input_error::{InputError, nearest, suggestion};

/// Farthest a quaternion may be from unit length.
const QUATERNION_TOLERANCE: f64 = 1e-3;

/// The unit of angles whose column does not name one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// As the file says; radians beyond a full turn are refused, and so is a file that says nothing.
    #[default]
    FromFile,
    /// Degrees, whatever the file says (`--degrees`).
    Degrees,
    /// Radians, whatever the file says and however large they are (`--radians`).
    Radians,
}

/// The postures of a model that a table holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Postures {
    /// Time (s) and posture of every row.
    pub postures: Vec<(f64, Posture)>,
    /// Coordinates without a column, which stand at their default. Those that follow another coordinate are not counted.
    pub missing: Vec<String>,
    /// Columns that are no coordinate of the model. Speeds, and torques and fatigue of our own runs, are not counted.
    pub unknown: Vec<String>,
}

/// Postures of `model`, one a row. `name` and `bytes` are the file of the table, for errors; empty ones will do.
///
/// A column is a coordinate if its label is
/// - the coordinate's name, in the file's unit;
/// - an OpenSim state path that ends in `/NAME/value`, in the file's unit (`/speed` is passed over);
/// - `NAME.angle_deg`, `NAME.position_m` or `NAME.value` as [`super::write_csv`] and our runs write it, or `NAME_deg` or
///   `NAME_m` as scenarios do.
///
/// Only angles are ever converted. Values may leave the coordinate's range, but not [`LARGEST`]. A quaternion needs all four
/// columns and unit length within 1e-3, and is normalised. Values of coordinates that follow another one are kept as they
/// are; kinematics computes them anew.
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right: no column is a coordinate; two are the same one; the
/// unit is unknown, or contradicted by an angle beyond 2 pi rad; a quaternion is none; a value is too large.
pub fn postures(table: &Table, name: &str, bytes: &[u8], model: &Model, units: Units) -> Result<Postures, InputError> {
    let layout = Layout::new(name, std::str::from_utf8(bytes).unwrap_or_default());
    let job = Job { table, layout, model, degrees: degrees(table, units), units };
    job.check_shape()?;
    let (columns, unknown) = job.columns()?;
    let coordinates = model.coordinates();
    let mut filled = vec![false; coordinates.len()];
    columns.iter().for_each(|column| filled[column.coordinate] = true);
    let balls = job.balls(&filled)?;
    let absent = |i: &usize| !filled[*i] && !model.is_dependent(*i);
    let missing = (0..filled.len()).filter(absent).map(|i| coordinates[i].name.clone()).collect();
    let mut made = Vec::with_capacity(table.rows.len());
    for (row, time) in table.times.iter().enumerate() {
        let mut posture = model.default_posture();
        for column in &columns {
            posture.values_mut()[column.coordinate] = job.value(row, column)?;
        }
        for &first in &balls {
            job.normalise(row, first, &columns, posture.values_mut())?;
        }
        made.push((*time, posture));
    }
    Ok(Postures { postures: made, missing, unknown })
}

fn degrees(table: &Table, units: Units) -> Option<bool> {
    match units {
        Units::FromFile => table.in_degrees,
        Units::Degrees => Some(true),
        Units::Radians => Some(false),
    }
}

/// The unit of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
    /// The file's, for angles.
    File,
    Degrees,
    /// Metres, or components of a quaternion.
    AsIs,
}

/// A column of the table that is a coordinate of the model.
struct Column<'a> {
    label: &'a str,
    index: usize,
    coordinate: usize,
    unit: Unit,
}

enum Meaning {
    Coordinate(usize, Unit),
    PassedOver,
    Unknown,
}

struct Job<'a> {
    table: &'a Table,
    layout: Layout<'a>,
    model: &'a Model,
    degrees: Option<bool>,
    units: Units,
}

impl<'a> Job<'a> {
    /// Tables made by hand may be ragged.
    fn check_shape(&self) -> Result<(), InputError> {
        let Table { columns, times, rows, .. } = self.table;
        if times.len() != rows.len() || rows.iter().any(|row| row.len() != columns.len()) {
            let help = "as many times as rows, as many numbers in every row as columns".to_owned();
            return Err(self.layout.error(None, "the table is ragged".to_owned(), "", help));
        }
        if rows.len().saturating_mul(self.model.coordinates().len()) > MOST_NUMBERS {
            let (rows, coordinates) = (rows.len(), self.model.coordinates().len());
            let message = format!("{rows} postures of {coordinates} coordinates are too many");
            let help = format!("at most {MOST_NUMBERS} values; cut the motion");
            return Err(self.layout.error(None, message, "", help));
        }
        Ok(())
    }

    /// The columns that are coordinates, and the labels that nobody knows.
    fn columns(&self) -> Result<(Vec<Column<'a>>, Vec<String>), InputError> {
        let names = self.names();
        let mut taken: HashMap<usize, &str> = HashMap::new();
        let (mut columns, mut unknown) = (vec![], vec![]);
        for (index, label) in self.table.columns.iter().enumerate() {
            let (coordinate, unit) = match self.meaning(label, &names) {
                Meaning::Coordinate(coordinate, unit) => (coordinate, unit),
                Meaning::PassedOver => continue,
                Meaning::Unknown => {
                    unknown.push(label.clone());
                    continue;
                }
            };
            let Some(about) = self.model.coordinates().get(coordinate) else { continue };
            if let Some(other) = taken.insert(coordinate, label) {
                let message = format!("columns `{other}` and `{label}` are the same coordinate, `{}`", about.name);
                let part = self.layout.find(label, None);
                return Err(self.layout.error(part, message, "here", "keep one of them".to_owned()));
            }
            if unit == Unit::File && about.kind == CoordinateKind::Rotation && self.degrees.is_none() {
                let message = format!("nothing says whether the angles of `{label}` are degrees or radians");
                let help = "`--degrees` or `--radians` says it, or `inDegrees=yes` or `no` in the header of a .sto or \
                            .mot file, or column names: NAME_deg";
                return Err(self.layout.error(self.layout.find(label, None), message, "here", help.to_owned()));
            }
            columns.push(Column { label, index, coordinate, unit });
        }
        if columns.is_empty() { Err(self.nothing_known()) } else { Ok((columns, unknown)) }
    }

    /// Coordinates by name; names that cannot stand in a table by the name that the writers put there instead.
    fn names(&self) -> HashMap<String, usize> {
        let coordinates = || self.model.coordinates().iter().enumerate();
        let mut names: HashMap<String, usize> = coordinates().map(|(i, c)| (c.name.clone(), i)).collect();
        for (i, coordinate) in coordinates() {
            for csv in [false, true] {
                names.entry(plain(&coordinate.name, csv)).or_insert(i);
            }
        }
        names
    }

    fn meaning(&self, label: &str, names: &HashMap<String, usize>) -> Meaning {
        use CoordinateKind::{Quaternion, Rotation, Translation};
        let known = |name: &str| names.get(name).map(|i| (*i, self.model.coordinates()[*i].kind));
        if let Some((i, _)) = known(label) {
            return Meaning::Coordinate(i, Unit::File);
        }
        match label.rsplit_once('/') {
            Some((_, "speed")) => return Meaning::PassedOver,
            Some((path, "value")) => {
                let found = known(path.rsplit_once('/').map_or(path, |(_, name)| name));
                return found.map_or(Meaning::Unknown, |(i, _)| Meaning::Coordinate(i, Unit::File));
            }
            _ => {}
        }
        let found = label.rsplit_once('.').and_then(|(name, what)| Some((known(name)?, what)));
        if let Some(((i, kind), what)) = found {
            return match (what, kind) {
                ("angle_deg", Rotation) => Meaning::Coordinate(i, Unit::Degrees),
                ("position_m", Translation) | ("value", Quaternion) => Meaning::Coordinate(i, Unit::AsIs),
                ("fatigue_positive" | "fatigue_negative" | "case" | "goal_deg" | "goal_m", _) => Meaning::PassedOver,
                _ if ["external_", "passive_", "active_"].iter().any(|w| what.starts_with(w)) => Meaning::PassedOver,
                _ => Meaning::Unknown,
            };
        }
        let with = |end: &str, kind| {
            label.strip_suffix(end).and_then(known).filter(|found| found.1 == kind).map(|found| found.0)
        };
        let degrees = with("_deg", Rotation).map(|i| Meaning::Coordinate(i, Unit::Degrees));
        let metres = || with("_m", Translation).map(|i| Meaning::Coordinate(i, Unit::AsIs));
        degrees.or_else(metres).unwrap_or(Meaning::Unknown)
    }

    fn nothing_known(&self) -> InputError {
        let names = self.model.coordinates().iter().map(|c| c.name.as_str());
        // The distance of two words costs their product: a few short labels tell enough.
        let labels = || self.table.columns.iter().map(String::as_str).filter(|label| label.len() <= 64).take(20);
        let near = labels().find_map(|label| Some((label, nearest(label, names.clone())?)));
        let help = match near {
            Some((label, name)) => Some(format!("did you mean `{name}` with `{label}`?")),
            None => suggestion("", names),
        };
        let part = self.table.columns.first().and_then(|label| self.layout.find(label, None));
        let message = format!("no column is a coordinate of the model `{}`", self.model.name());
        self.layout.error(part, message, "the first of the columns", help)
    }

    /// First components of the quaternions that have columns.
    fn balls(&self, filled: &[bool]) -> Result<Vec<usize>, InputError> {
        let coordinates = self.model.coordinates();
        let mut balls = vec![];
        let mut i = 0;
        while i < coordinates.len() {
            if coordinates[i].kind != CoordinateKind::Quaternion {
                i += 1;
                continue;
            }
            let four = i..(i + 4).min(coordinates.len());
            if filled[four.clone()].iter().any(|f| *f) {
                if let Some(absent) = four.clone().find(|i| !filled[*i]) {
                    let message = format!("the quaternion of `{}` has no column for it", coordinates[absent].name);
                    let help = "a quaternion needs its four columns".to_owned();
                    return Err(self.layout.error(None, message, "", help));
                }
                balls.push(i);
            }
            i = four.end;
        }
        Ok(balls)
    }

    fn value(&self, row: usize, column: &Column) -> Result<f64, InputError> {
        let Column { label, unit, .. } = *column;
        let about = &self.model.coordinates()[column.coordinate];
        let given = self.table.rows[row][column.index];
        let rotation = about.kind == CoordinateKind::Rotation;
        // OpenSim's files have such angles in radians, whatever the header says.
        let as_is = self.units == Units::FromFile && self.model.turns_by_curves(column.coordinate);
        let degrees =
            rotation && (unit == Unit::Degrees || (unit == Unit::File && self.degrees == Some(true) && !as_is));
        let value = if degrees { given.to_radians() } else { given };
        if value.is_nan() || value.abs() > LARGEST {
            let help = format!("at most {LARGEST:e} rad or m");
            return Err(self.cell_error(row, label, &format!("holds {given:?}: too large"), help));
        }
        if rotation && !degrees && self.units == Units::FromFile && value.abs() > TAU {
            let problem = format!(
                "holds {given:?}, more than a full turn in radians; the file probably holds degrees although its header \
                 says inDegrees=no"
            );
            let help = "`--degrees` reads it as degrees; `--radians` insists on radians".to_owned();
            return Err(self.cell_error(row, label, &problem, help));
        }
        Ok(value)
    }

    fn normalise(&self, row: usize, first: usize, columns: &[Column], values: &mut [f64]) -> Result<(), InputError> {
        let end = (first + 4).min(values.len());
        let four = &mut values[first..end];
        let square = four.iter().map(|v| v * v).sum::<f64>();
        let length = square.sqrt();
        if length.is_nan() || (length - 1.0).abs() > QUATERNION_TOLERANCE {
            let name = &self.model.coordinates()[first].name;
            let label =
                columns.iter().find(|column| column.coordinate == first).map_or(name.as_str(), |column| column.label);
            let problem = format!("begins a quaternion of length {length}");
            let help = format!("its four components must have length 1 within {QUATERNION_TOLERANCE}");
            return Err(self.cell_error(row, label, &problem, help));
        }
        // What is as good as unit length keeps its bits.
        if (square - 1.0).abs() > 4.0 * f64::EPSILON {
            four.iter_mut().for_each(|v| *v /= length);
        }
        Ok(())
    }

    fn cell_error(&self, row: usize, label: &str, problem: &str, help: String) -> InputError {
        let part = self.layout.find(label, Some(row));
        let place = match part.and_then(|part| self.layout.line_number(part)) {
            Some(line) => format!("line {line}"),
            None => format!("row {}", row + 1),
        };
        self.layout.error(part, format!("{place}: column `{label}` {problem}"), "here", help)
    }
}
