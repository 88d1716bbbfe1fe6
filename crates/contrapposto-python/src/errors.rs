//! Turns refusals, failures and panics into the exceptions of `contrapposto.errors`.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use contrapposto::joint_torques::JointTorquesError;
use contrapposto::model::{CoordinateKind, Model};
use contrapposto::posture::PostureError;
use contrapposto::statics::LoadError;
use contrapposto_cli::library::Failure;
use pyo3::prelude::*;
use pyo3::types::PyType;

/// An exception of that class of `contrapposto.errors`.
fn exception<'py>(py: Python<'py>, class: &str, message: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("contrapposto.errors")?.getattr(class)?.cast_into::<PyType>()?.call1((message,))
}

/// Completes an exception; an error on the way is the exception then.
fn raised(value: PyResult<Bound<'_, PyAny>>) -> PyErr {
    value.map_or_else(|error| error, PyErr::from_value)
}

/// An `InternalError`.
pub(crate) fn internal(py: Python<'_>, message: &str) -> PyErr {
    raised(exception(py, "InternalError", message))
}

/// An `InputError` or a `JobError`, with its place in a file.
pub(crate) fn failure(py: Python<'_>, failure: &Failure) -> PyErr {
    let class = if failure.refused { "InputError" } else { "JobError" };
    let filled = || {
        let value = exception(py, class, &failure.message)?;
        if let Some(place) = &failure.place {
            value.setattr("file", &place.file)?;
            value.setattr("line", place.line)?;
            value.setattr("column", place.column)?;
        }
        value.setattr("help", failure.help.as_deref())?;
        Ok(value)
    };
    raised(filled())
}

/// An `InputError` about row `row` of an array of postures.
pub(crate) fn refused_row(py: Python<'_>, model: &Model, row: usize, error: &JointTorquesError) -> PyErr {
    let filled = || {
        let value = exception(py, "InputError", &format!("row {row}: {error}"))?;
        value.setattr("row", row)?;
        match error {
            JointTorquesError::Posture(PostureError::NotFinite { coordinate, value: number }) => {
                value.setattr("coordinate", coordinate)?;
                value.setattr("value", number)?;
                value.setattr("unit", unit(model, coordinate))?;
                value.setattr("limit", "finite and at most 1e9 in size")?;
            }
            JointTorquesError::Posture(PostureError::Quaternion { coordinate, length }) => {
                value.setattr("coordinate", coordinate)?;
                value.setattr("value", length)?;
                value.setattr("unit", "1")?;
                value.setattr("limit", "a length that is not zero")?;
            }
            JointTorquesError::Load(LoadError::Number { value: number, accepted, .. }) => {
                value.setattr("value", number)?;
                value.setattr("limit", accepted)?;
            }
            _ => {}
        }
        Ok(value)
    };
    raised(filled())
}

/// Unit of a coordinate's values.
fn unit(model: &Model, coordinate: &str) -> Option<&'static str> {
    let kind = model.coordinates().get(model.coordinate(coordinate)?)?.kind;
    Some(unit_of(kind))
}

/// `rad`, `m`, or `1` for components of a quaternion.
pub(crate) fn unit_of(kind: CoordinateKind) -> &'static str {
    match kind {
        CoordinateKind::Rotation => "rad",
        CoordinateKind::Translation => "m",
        CoordinateKind::Quaternion => "1",
    }
}

/// Runs a job; a panic in it is an `InternalError`.
pub(crate) fn guarded<T>(py: Python<'_>, job: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(job)).unwrap_or_else(|panic| Err(panicked(py, &*panic)))
}

/// The `InternalError` of a panic.
pub(crate) fn panicked(py: Python<'_>, panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    internal(py, &format!("contrapposto has a defect: {}", text.unwrap_or("a panic without a text")))
}

/// Panics, so that a test sees the exception.
#[pyfunction]
#[pyo3(name = "_panic_for_tests")]
pub(crate) fn panic_for_tests(py: Python<'_>) -> PyResult<()> {
    guarded(py, || panic!("asked for by a test"))
}
