//! Reads loads from Python: texts as the program takes them, and weights, forces and couples with numbers.

use contrapposto::model::Model;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto_cli::library::Failure;
use contrapposto_formats::loads::{force, no_segment, weight};
use nalgebra::Vector3;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::arrays::rows_of;
use crate::errors::failure;

/// A load of `contrapposto.loads` as the package hands it over: kind, segment, one row of numbers for all postures or one for each,
/// point (m; the centre of mass where it is none), and whether the axes are those of the segment.
type Given<'py> = (String, String, PyReadonlyArray2<'py, f64>, Option<[f64; 3]>, bool);

/// A load on all postures, or one of its own on each.
pub(crate) struct Loading {
    first: Load,
    /// Numbers of the forces, row after row.
    rows: Vec<Vector3<f64>>,
}

impl Loading {
    /// From a text of the program, or from numbers.
    pub(crate) fn read(model: &Model, given: &Bound<'_, PyAny>, postures: usize) -> PyResult<Self> {
        let py = given.py();
        let refuse = |message: String| failure(py, &Failure::refused(message));
        if let Ok(text) = given.extract::<String>() {
            let read = if text.contains("kg") { weight(model, &text) } else { force(model, &text) };
            let first = read.map_err(|error| refuse(format!("load \"{text}\": {error}")))?;
            return Ok(Self { first, rows: vec![] });
        }
        let (kind, name, numbers, point, in_segment): Given<'_> = given.extract()?;
        let segment = model.segment(&name).ok_or_else(|| refuse(no_segment(model, &name)))?;
        let point = point.map_or(model.segments()[segment].center_of_mass, Vector3::from);
        let (rows, columns, numbers) = rows_of(&numbers);
        if rows != 1 && rows != postures {
            return Err(refuse(format!(
                "the {kind} on `{name}` has {rows} rows; it must have 1, or {postures}, one a posture"
            )));
        }
        let fixed_in = if in_segment { FixedIn::Segment } else { FixedIn::World };
        let of_row = move |row: &[f64]| match kind.as_str() {
            "weight" => Vector3::new(row[0], 0.0, 0.0),
            _ => Vector3::new(row[0], row[1], row[2]),
        };
        let kind = match (numbers.len() == rows * columns, columns) {
            (true, 1) => LoadKind::Weight(0.0),
            (true, 3) => LoadKind::Force(Vector3::zeros(), fixed_in),
            _ => {
                return Err(refuse(format!("a load on `{name}` has {columns} numbers a row; a mass has 1, a force 3")));
            }
        };
        let rows: Vec<Vector3<f64>> = numbers.chunks_exact(columns).map(of_row).collect();
        let loading = Self { first: Load { segment, point, kind }, rows };
        for row in 0..loading.rows.len() {
            loading.at(row).check(model).map_err(|error| refuse(format!("`{name}`, row {row}: {error}")))?;
        }
        Ok(loading)
    }

    /// The load on a posture.
    pub(crate) fn at(&self, posture: usize) -> Load {
        let Some(&row) = self.rows.get(if self.rows.len() == 1 { 0 } else { posture }) else { return self.first };
        let kind = match self.first.kind {
            LoadKind::Weight(_) => LoadKind::Weight(row.x),
            LoadKind::Force(_, fixed_in) => LoadKind::Force(row, fixed_in),
            LoadKind::Couple(_, fixed_in) => LoadKind::Couple(row, fixed_in),
        };
        Load { kind, ..self.first }
    }
}
