//! The class `Engine`: a posture that follows moving targets, step by step.

use std::sync::{Mutex, PoisonError};

use contrapposto_cli::library::{Controller, Failure, Note};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{array_2, rows_of};
use crate::errors::{failure, guarded};
use crate::job::source_of;

/// The tasks of a scenario, ready to step.
#[pyclass(frozen, module = "contrapposto._native")]
pub(crate) struct Engine {
    controller: Mutex<Controller>,
    notes: Vec<Note>,
}

/// A task and its target in each posture, or in all of them.
type Targets<'py> = Vec<(String, PyReadonlyArray2<'py, f64>)>;

/// Postures, and the errors of the levels beside them.
type Solved<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// A task, and the rows, columns and numbers of its target.
type Rows<'a> = (&'a str, (usize, usize, Vec<f64>));

impl Engine {
    /// Moves the targets of row `row`, then the posture; gives the errors of the levels.
    fn advance_one(
        &self,
        row: usize,
        targets: &[Rows<'_>],
        posture: &mut [f64],
        solve: bool,
    ) -> Result<Vec<f64>, Failure> {
        let mut controller = self.controller.lock().unwrap_or_else(PoisonError::into_inner);
        for (task, (count, columns, numbers)) in targets {
            let at = if *count == 1 { 0 } else { row };
            controller.set_target(task, &numbers[at * columns..(at + 1) * columns])?;
        }
        if solve { controller.solve(posture) } else { controller.step(posture) }
    }
}

#[pymethods]
impl Engine {
    /// The tasks of a scenario: a text, or the path of a file.
    #[new]
    #[pyo3(signature = (scenario, is_text, max_step=None))]
    fn new(py: Python<'_>, scenario: String, is_text: bool, max_step: Option<f64>) -> PyResult<Self> {
        guarded(py, || {
            let source = source_of(scenario, is_text);
            let made = py.detach(|| Controller::new(&source, max_step));
            let (controller, notes) = made.map_err(|why| failure(py, &why))?;
            Ok(Self { controller: Mutex::new(controller), notes })
        })
    }

    #[getter]
    fn names(&self) -> Vec<String> {
        self.controller.lock().unwrap_or_else(PoisonError::into_inner).names().to_vec()
    }

    #[getter]
    fn tasks(&self) -> Vec<String> {
        self.controller.lock().unwrap_or_else(PoisonError::into_inner).tasks().map(str::to_owned).collect()
    }

    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let start = self.controller.lock().unwrap_or_else(PoisonError::into_inner).start().to_vec();
        array_2(py, (1, start.len()), start)
    }

    /// Kinds and texts of the notes of the reader.
    #[getter]
    fn notes(&self) -> Vec<(&str, &str)> {
        self.notes.iter().map(|note| (note.kind.as_str(), note.text.as_str())).collect()
    }

    /// Moves targets, then every posture by one step, or until it is solved. One row a posture; between rows Ctrl-C is seen.
    fn advance<'py>(
        &self,
        py: Python<'py>,
        postures: PyReadonlyArray2<'py, f64>,
        targets: Targets<'py>,
        solve: bool,
    ) -> PyResult<Solved<'py>> {
        guarded(py, || {
            let (rows, width, mut values) = rows_of(&postures);
            let targets: Vec<Rows<'_>> = targets.iter().map(|(task, rows)| (task.as_str(), rows_of(rows))).collect();
            let mut errors = vec![];
            for row in 0..rows {
                let posture = &mut values[row * width..(row + 1) * width];
                let found = py.detach(|| self.advance_one(row, &targets, posture, solve));
                errors.extend(found.map_err(|why| failure(py, &why))?);
                py.check_signals()?;
            }
            let levels = errors.len().checked_div(rows).unwrap_or(0);
            Ok((array_2(py, (rows, width), values)?, array_2(py, (rows, levels), errors)?))
        })
    }
}
