//! Reads and writes tables of motion: OpenSim's `.mot` and `.sto` and comma separated text.
//!
//! [`read_table`] makes a [`Table`] of bytes, [`postures`] makes postures of a model of it, [`write_sto`] and [`write_csv`]
//! write. A table keeps the numbers as the file holds them; degrees become radians in [`postures`] and back in the writers,
//! and nowhere else.

mod header;
mod layout;
mod postures;
mod read;
mod write;

pub use postures::{Postures, Units, postures};
pub use read::read_table;
pub(crate) use write::plain;
pub use write::{UnwritableTable, csv_cell, opensim_columns, write_csv, write_sto};

/// Largest table file, bytes.
pub const MOST_TABLE_BYTES: usize = 64 << 20;
/// Most columns of a table, time counted.
pub const MOST_COLUMNS: usize = 10_000;
/// Most numbers of a table, times counted; also most coordinates times rows of the postures that are made of one.
pub const MOST_NUMBERS: usize = 10_000_000;
/// Longest name of a table or column, bytes.
pub const MOST_NAME_BYTES: usize = 256;

/// Named columns of numbers over time, in the units of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The name that OpenSim's tables begin with; empty where there is none.
    pub name: String,
    /// The unit of angles that the file names: `inDegrees`, or the words that older files use. SIMM's own motions, which say
    /// nothing, hold degrees. `None` where nothing is said, as in CSV.
    pub in_degrees: Option<bool>,
    /// Labels, without time.
    pub columns: Vec<String>,
    /// Faults of a file that can be read nevertheless, a sentence each.
    pub warnings: Vec<String>,
    /// Times, s: one a row, never falling. Row numbers where the file has no times.
    pub times: Vec<f64>,
    /// Rows: one finite number a column.
    pub rows: Vec<Vec<f64>>,
}
