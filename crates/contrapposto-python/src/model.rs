//! The class `Model`: a body and its torques in postures at rest.

use std::path::PathBuf;
use std::sync::Arc;

use contrapposto::model::Sex;
use contrapposto_cli::library::{Failure, ModelOptions, ModelSource, Note, RestTorques, TorqueRow};
use contrapposto_formats::tissue::SourcedModel;
use numpy::{PyArray2, PyArray3, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{array_2, array_3, rows_of};
use crate::errors::{failure, guarded, internal, unit_of};
use crate::loads::Loading;
use crate::torques::Given;

/// External, passive and active torque as arrays.
type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// An immutable body.
#[pyclass(frozen, module = "contrapposto._native")]
pub(crate) struct Model {
    source: ModelSource,
    pub(crate) opened: Arc<SourcedModel>,
    rows: Vec<TorqueRow>,
    notes: Vec<Note>,
}

impl Model {
    fn new(source: ModelSource, mut opened: SourcedModel, mut notes: Vec<Note>) -> Self {
        let of_model = std::mem::take(&mut opened.notes);
        notes.extend(of_model.into_iter().map(|text| Note { kind: "note".to_owned(), text }));
        let rows = RestTorques::rows(&opened.model);
        Self { source, opened: Arc::new(opened), rows, notes }
    }

    fn made_of(py: Python<'_>, source: ModelSource) -> PyResult<Self> {
        guarded(py, || {
            let (opened, notes) = source.open().map_err(|why| failure(py, &why))?;
            Ok(Self::new(source, opened, notes))
        })
    }

    /// Postures and loads, copied and checked.
    fn given(
        &self,
        py: Python<'_>,
        postures: &PyReadonlyArray2<'_, f64>,
        loads: &[Bound<'_, PyAny>],
        device: Option<&PyReadonlyArray2<'_, f64>>,
        threads: usize,
    ) -> PyResult<Given> {
        let (count, width, values) = rows_of(postures);
        let refuse = |message: String| Err(failure(py, &Failure::refused(message)));
        let needed = self.opened.model.coordinates().len();
        if width != needed {
            return refuse(format!("postures have {width} values; the model has {needed} coordinates"));
        }
        let device = match device.map(rows_of) {
            None => vec![],
            Some((rows, columns, device)) if (rows, columns) == (count, self.rows.len()) => device,
            Some((1, columns, device)) if columns == self.rows.len() => device.repeat(count),
            Some((rows, columns, _)) => {
                let needed = self.rows.len();
                return refuse(format!(
                    "external has shape ({rows}, {columns}); it must be ({count}, {needed}) or (1, {needed})"
                ));
            }
        };
        if let Some(bad) = device.iter().position(|value| !value.is_finite()) {
            let (row, name) = (bad / self.rows.len().max(1), &self.rows[bad % self.rows.len().max(1)].name);
            return refuse(format!("external of `{name}` in row {row} is {}; it must be finite", device[bad]));
        }
        let loads = loads.iter().map(|load| Loading::read(&self.opened.model, load, count));
        Ok(Given { values, width, loads: loads.collect::<PyResult<_>>()?, device, threads })
    }
}

#[pymethods]
impl Model {
    /// The built-in adult, stature in m and mass in kg.
    #[staticmethod]
    #[pyo3(signature = (female, stature=None, mass=None))]
    fn adult(py: Python<'_>, female: bool, stature: Option<f64>, mass: Option<f64>) -> PyResult<Self> {
        let sex = if female { Sex::Female } else { Sex::Male };
        Self::made_of(py, ModelSource::adult(sex, stature, mass))
    }

    /// Reads a model file: OpenSim, URDF or MJCF.
    #[staticmethod]
    #[pyo3(signature = (path, overlay=None, root=None, fill=None, no_strength=false, person=None))]
    fn from_file(
        py: Python<'_>,
        path: PathBuf,
        overlay: Option<PathBuf>,
        root: Option<String>,
        fill: Option<bool>,
        no_strength: bool,
        person: Option<String>,
    ) -> PyResult<Self> {
        let options = ModelOptions { overlay, root, fill, no_strength, person };
        let read = || {
            let (source, opened, notes) =
                py.detach(|| ModelSource::read(&path, &options)).map_err(|why| failure(py, &why))?;
            Ok(Self::new(source, opened, notes))
        };
        guarded(py, read)
    }

    /// The model of the bytes that `state` gives.
    #[staticmethod]
    fn from_state(py: Python<'_>, state: &[u8]) -> PyResult<Self> {
        let refuse = |why: String| failure(py, &Failure::refused(format!("these bytes are no pickled model: {why}")));
        Self::made_of(py, ModelSource::from_bytes(state).map_err(refuse)?)
    }

    /// All that the model is made of, as bytes.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.source.to_bytes().map_err(|why| internal(py, &why))?))
    }

    #[getter]
    fn name(&self) -> &str {
        self.opened.model.name()
    }

    /// Mass, kg.
    #[getter]
    fn mass(&self) -> f64 {
        self.opened.model.mass()
    }

    #[getter]
    fn coordinate_names(&self) -> Vec<&str> {
        self.opened.model.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect()
    }

    /// `rad`, `m`, or `1` for components of quaternions.
    #[getter]
    fn coordinate_units(&self) -> Vec<&'static str> {
        self.opened.model.coordinates().iter().map(|coordinate| unit_of(coordinate.kind)).collect()
    }

    /// Least and greatest value of each coordinate.
    #[getter]
    fn ranges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let coordinates = self.opened.model.coordinates();
        let limits = coordinates.iter().flat_map(|coordinate| [coordinate.range.0, coordinate.range.1]).collect();
        array_2(py, (coordinates.len(), 2), limits)
    }

    #[getter]
    fn default_posture<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values = self.opened.model.default_posture().values().to_vec();
        array_2(py, (1, values.len()), values)
    }

    #[getter]
    fn segment_names(&self) -> Vec<&str> {
        self.opened.model.segments().iter().map(|segment| segment.name.as_str()).collect()
    }

    #[getter]
    fn torque_names(&self) -> Vec<&str> {
        self.rows.iter().map(|row| row.name.as_str()).collect()
    }

    /// `N m` or `N`.
    #[getter]
    fn torque_units(&self) -> Vec<&'static str> {
        self.rows.iter().map(|row| if row.turns { "N m" } else { "N" }).collect()
    }

    /// Kinds and texts of the notes about the model.
    #[getter]
    fn notes(&self) -> Vec<(&str, &str)> {
        self.notes.iter().map(|note| (note.kind.as_str(), note.text.as_str())).collect()
    }

    /// External, passive and active torque of postures.
    #[pyo3(signature = (postures, loads, device, threads))]
    fn torques<'py>(
        &self,
        py: Python<'py>,
        postures: PyReadonlyArray2<'py, f64>,
        loads: Vec<Bound<'py, PyAny>>,
        device: Option<PyReadonlyArray2<'py, f64>>,
        threads: usize,
    ) -> PyResult<Arrays<'py>> {
        guarded(py, || {
            let given = self.given(py, &postures, &loads, device.as_ref(), threads)?;
            let (count, rates) = (postures.as_array().nrows(), self.rows.len());
            let [external, passive, active] = given.torques(py, &self.opened, rates)?;
            let array = |values| array_2(py, (count, rates), values);
            Ok((array(external)?, array(passive)?, array(active)?))
        })
    }

    /// Gradient of external torque of postures.
    #[pyo3(signature = (postures, loads, threads))]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        postures: PyReadonlyArray2<'py, f64>,
        loads: Vec<Bound<'py, PyAny>>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        guarded(py, || {
            let given = self.given(py, &postures, &loads, None, threads)?;
            let (count, rates) = (postures.as_array().nrows(), self.rows.len());
            array_3(py, (count, rates), given.gradients(py, &self.opened, rates)?)
        })
    }
}
