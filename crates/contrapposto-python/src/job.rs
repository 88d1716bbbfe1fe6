//! The class `Job`: a scenario carried out, and its results.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use contrapposto_cli::library::{Failure, Frames, Note, Posed, Relaxed, ScenarioSource, Simulated};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::array_2;
use crate::errors::{failure, guarded};
use crate::unlocked::in_background;

/// The result of a job of each kind.
enum Done {
    Pose(Box<Posed>),
    Relax(Box<Relaxed>),
    Run(Box<Simulated>),
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

    /// Names of coordinates, and arrays: times as one row, then one row a moment of postures, external, passive and active torque,
    /// load and fatigue.
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        let frames = match &self.done {
            Done::Pose(posed) => posed.frames(),
            Done::Relax(relaxed) => relaxed.frames(),
            Done::Run(run) => run.frames(),
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
            });
            page.map_err(|why| failure(py, &why))
        })
    }
}
