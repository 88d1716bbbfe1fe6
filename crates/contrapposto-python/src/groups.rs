//! Strength and fatigue of the muscle groups of a model, and decisions of single joints.

use contrapposto::fatigue::FatigueLaw;
use contrapposto::model::{MuscleGroup, Side};
use contrapposto::simulation::Tables;
use contrapposto_cli::library::Failure;
use contrapposto_formats::minimize_line;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::errors::{failure, guarded};
use crate::model::Model;

/// The muscle group of one sense of a coordinate.
fn group<'a>(py: Python<'_>, model: &'a Model, coordinate: &str, positive: bool) -> PyResult<&'a MuscleGroup> {
    let side = if positive { Side::Positive } else { Side::Negative };
    let refuse = |message: String| failure(py, &Failure::refused(message));
    let found = model.opened.model.coordinate(coordinate);
    let index = found.ok_or_else(|| refuse(format!("the model has no coordinate `{coordinate}`")))?;
    let groups = model.opened.model.coordinates()[index].groups.as_ref();
    let none = || refuse(format!("no strength of `{coordinate}` is known, so it has no muscle groups"));
    Ok(&groups.ok_or_else(none)?[side.index()])
}

/// A function of each number of an array.
fn each<'py>(
    py: Python<'py>,
    numbers: &PyReadonlyArray1<'py, f64>,
    of: impl FnMut(f64) -> f64,
) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_vec(py, numbers.as_array().iter().copied().map(of).collect())
}

/// Name of a muscle group, and of its law of fatigue.
#[pyfunction]
pub(crate) fn group_names(
    py: Python<'_>,
    model: &Model,
    coordinate: &str,
    positive: bool,
) -> PyResult<(String, String)> {
    let group = group(py, model, coordinate, positive)?;
    Ok((group.name.clone(), group.fatigue.name().to_owned()))
}

/// Greatest torque (N m) of a muscle group at angles (rad).
#[pyfunction]
pub(crate) fn strength<'py>(
    py: Python<'py>,
    model: &Model,
    coordinate: &str,
    positive: bool,
    angles: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    guarded(py, || {
        let group = group(py, model, coordinate, positive)?;
        Ok(each(py, &angles, |angle| group.strength.torque(angle)))
    })
}

/// Time (s) for which a rested muscle group holds relative loads; infinite where for ever.
#[pyfunction]
pub(crate) fn endurance_time<'py>(
    py: Python<'py>,
    model: &Model,
    coordinate: &str,
    positive: bool,
    loads: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    guarded(py, || {
        let group = group(py, model, coordinate, positive)?;
        Ok(each(py, &loads, |load| group.fatigue.endurance_time(load)))
    })
}

/// Fatigue of a muscle group after each of the relative loads, which last `seconds` one after the other, from the fatigue `start`.
#[pyfunction]
pub(crate) fn fatigue<'py>(
    py: Python<'py>,
    model: &Model,
    coordinate: &str,
    positive: bool,
    course: (PyReadonlyArray1<'py, f64>, f64, f64),
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    guarded(py, || {
        let (loads, seconds, start) = &course;
        let law: &FatigueLaw = &group(py, model, coordinate, positive)?.fatigue;
        let first = loads.as_array().first().copied().unwrap_or(0.0);
        let mut state = law.start(*start, first);
        Ok(each(py, loads, |load| {
            state = law.advance(state, load, *seconds);
            state.level(load)
        }))
    })
}

/// Decides one joint: a JSON problem in, a JSON decision out, as a line of `contrapposto minimize`.
#[pyfunction]
pub(crate) fn minimize(py: Python<'_>, problem: &str, literal: bool) -> PyResult<String> {
    guarded(py, || {
        let tables = if literal { Tables::Literal } else { Tables::Total };
        let refuse = |message: String| failure(py, &Failure::refused(message));
        let decision = minimize_line(problem, tables).map_err(refuse)?;
        serde_json::to_string(&decision).map_err(|error| refuse(error.to_string()))
    })
}
