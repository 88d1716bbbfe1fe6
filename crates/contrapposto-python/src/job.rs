//! The class `Job`: a scenario or a motion carried out, and its results.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use contrapposto_cli::library::{
    Assessed, Failure, Frames, MotionSource, Note, Posed, Relaxed, ScenarioSource, Simulated,
};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{array_2, rows_of};
use crate::errors::{failure, guarded};
use crate::model::Model;
use crate::unlocked::in_background;

/// The result of a job of each kind.
enum Done {
    Pose(Box<Posed>),
    Relax(Box<Relaxed>),
    Run(Box<Simulated>),
    Assessment(Box<Assessed>),
}

/// A job that was carried out.
#[pyclass(frozen, module = "contrapposto._native")]
pub(crate) struct Job {
    done: Done,
    notes: Vec<Note>,
}

/// Names of coordinates, times, and arrays with one row a moment: postures, external, passive and active torque, load, fatigue.
type Columns<'py> = (Vec<String>, Vec<Bound<'py, PyArray2<f64>>>);

/// A scenario: its text, or the path of its file.
pub(crate) fn source_of(scenario: String, is_text: bool) -> ScenarioSource {
    if is_text { ScenarioSource::Text(scenario) } else { ScenarioSource::File(PathBuf::from(scenario)) }
}

/// Carries out a job; `stop` ends a run before its time.
fn carried_out(kind: &str, source: &ScenarioSource, suggest: bool, stop: &AtomicBool) -> Result<Job, Failure> {
    let (done, notes) = match kind {
        "pose" => Posed::new(source).map(|(done, notes)| (Done::Pose(Box::new(done)), notes))?,
        "relax" => Relaxed::new(source).map(|(done, notes)| (Done::Relax(Box::new(done)), notes))?,
        _ => {
            let go_on = || !stop.load(Ordering::Relaxed);
            Simulated::new(source, suggest, go_on).map(|(done, notes)| (Done::Run(Box::new(done)), notes))?
        }
    };
    Ok(Job { done, notes })
}

#[pymethods]
impl Job {
    /// Carries out `pose`, `relax` or `simulate` of a scenario: a text, or the path of a file.
    #[staticmethod]
    fn run(py: Python<'_>, kind: String, scenario: String, is_text: bool, suggest: bool) -> PyResult<Self> {
        let source = source_of(scenario, is_text);
        let job = move |stop: &AtomicBool| carried_out(&kind, &source, suggest, stop);
        in_background(py, job)?.map_err(|why| failure(py, &why))
    }

    /// Assesses a motion of a model: the path of a file, or times as one row and postures. `words` are the program's options.
    #[staticmethod]
    fn assess(
        py: Python<'_>,
        model: &Model,
        path: Option<PathBuf>,
        rows: Option<(PyReadonlyArray2<'_, f64>, PyReadonlyArray2<'_, f64>)>,
        words: Vec<String>,
    ) -> PyResult<Self> {
        let source = model.source.clone();
        let motion = match (path, rows) {
            (Some(path), _) => MotionSource::File(path),
            (None, Some((times, postures))) => MotionSource::Rows(rows_of(&times).2, rows_of(&postures).2),
            (None, None) => MotionSource::Rows(vec![], vec![]),
        };
        let assessed = in_background(py, move |_| Assessed::new(source, motion, words))?;
        let (assessed, notes) = assessed.map_err(|why| failure(py, &why))?;
        Ok(Self { done: Done::Assessment(Box::new(assessed)), notes })
    }

    /// Names of coordinates, and arrays: times as one row, then one row a moment of postures, external, passive and active torque,
    /// load and fatigue.
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        let frames = match &self.done {
            Done::Pose(posed) => posed.frames(),
            Done::Relax(relaxed) => relaxed.frames(),
            Done::Run(run) => run.frames(),
            Done::Assessment(assessed) => assessed.frames(),
        };
        let Frames { names, times, postures, external, passive, active, load, fatigue } = frames.clone();
        let (rows, width) = (times.len(), names.len());
        let shape = if fatigue.is_empty() { (0, 2 * width) } else { (rows, 2 * width) };
        let mut arrays = vec![array_2(py, (1, rows), times)?];
        for column in [postures, external, passive, active, load] {
            arrays.push(array_2(py, (rows, width), column)?);
        }
        arrays.push(array_2(py, shape, fatigue)?);
        Ok((names, arrays))
    }

    /// The text of the program's JSON file.
    #[getter]
    fn json(&self) -> &str {
        match &self.done {
            Done::Pose(posed) => posed.json(),
            Done::Relax(relaxed) => relaxed.json(),
            Done::Run(run) => run.json(),
            Done::Assessment(assessed) => assessed.json(),
        }
    }

    /// Kinds and texts of the notes of the reader.
    #[getter]
    fn notes(&self) -> Vec<(&str, &str)> {
        self.notes.iter().map(|note| (note.kind.as_str(), note.text.as_str())).collect()
    }

    /// The page of the program.
    fn report(&self, py: Python<'_>) -> PyResult<String> {
        guarded(py, || {
            let page = py.detach(|| match &self.done {
                Done::Pose(posed) => posed.report(),
                Done::Relax(relaxed) => relaxed.report(),
                Done::Run(run) => run.report(),
                Done::Assessment(assessed) => assessed.report(),
            });
            page.map_err(|why| failure(py, &why))
        })
    }
}
