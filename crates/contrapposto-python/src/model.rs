//! The class `Model`: a body and its torques in postures at rest.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use contrapposto::model::Sex;
use contrapposto::posture::Posture;
use contrapposto_cli::library::{
    Failure, ModelOptions, ModelSource, Note, RestTorques, TorqueRow, muscle_lines, read_motion, write_motion,
};
use contrapposto_formats::tissue::{MuscleUse, SourcedModel};
use numpy::{PyArray2, PyArray3, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{array_2, array_3, rows_of};
use crate::errors::{failure, guarded, internal, unit_of};
use crate::loads::Loading;
use crate::torques::{Body, Given};
use crate::unlocked::in_background;

/// External, passive and active torque as arrays.
type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// Times as one row, postures, and kinds and texts of notes.
type Motion<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Vec<(String, String)>);

/// An immutable body.
#[pyclass(frozen, module = "contrapposto._native")]
pub(crate) struct Model {
    pub(crate) source: ModelSource,
    pub(crate) opened: Arc<SourcedModel>,
    rows: Vec<TorqueRow>,
    notes: Vec<Note>,
    /// The same body with its muscles, by the use that was asked of them.
    bodies: Mutex<BTreeMap<String, Arc<Body>>>,
}

impl Model {
    fn new(source: ModelSource, mut opened: SourcedModel, mut notes: Vec<Note>) -> Self {
        let of_model = std::mem::take(&mut opened.notes);
        notes.extend(of_model.into_iter().map(|text| Note { kind: "note".to_owned(), text }));
        let rows = RestTorques::rows(&opened.model);
        Self { source, opened: Arc::new(opened), rows, notes, bodies: Mutex::default() }
    }

    /// The body whose muscles are used as `uses` says, a word of the program's `--muscles`; as the program does without one.
    fn body(&self, py: Python<'_>, uses: Option<&str>) -> PyResult<Arc<Body>> {
        let asked = match uses {
            None => None,
            Some("off") => Some(MuscleUse::Off),
            Some("strength") => Some(MuscleUse::Strength),
            Some("passive") => Some(MuscleUse::Passive),
            Some("both") => Some(MuscleUse::Both),
            Some(other) => {
                let message = format!("muscles is `{other}`; it must be `off`, `strength`, `passive` or `both`");
                return Err(failure(py, &Failure::refused(message)));
            }
        };
        if asked.unwrap_or_else(|| self.opened.default_muscle_use()) == MuscleUse::Off {
            return Ok(Arc::new(Body { opened: Arc::clone(&self.opened), muscles: None }));
        }
        let name = uses.unwrap_or_default().to_owned();
        let bodies = || self.bodies.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(body) = bodies().get(&name) {
            return Ok(Arc::clone(body));
        }
        let made = py.detach(|| self.source.open_with_muscles(asked)).map_err(|why| failure(py, &why))?;
        let ((opened, muscles), _) = made;
        let body = Arc::new(Body { opened: Arc::new(opened), muscles });
        bodies().insert(name, Arc::clone(&body));
        Ok(body)
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

    /// The built-in adult at a percentile of people of that sex.
    #[staticmethod]
    fn adult_at(py: Python<'_>, female: bool, percentile: f64) -> PyResult<Self> {
        let sex = if female { Sex::Female } else { Sex::Male };
        Self::made_of(py, ModelSource::adult_at(sex, percentile).map_err(|why| failure(py, &why))?)
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

    /// The same body with an overlay (TOML) laid over it.
    fn lay_over(&self, py: Python<'_>, overlay: String) -> PyResult<Self> {
        Self::made_of(py, self.source.clone().lay_over(overlay))
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
    #[pyo3(signature = (postures, loads, device, muscles, threads))]
    fn torques<'py>(
        &self,
        py: Python<'py>,
        postures: PyReadonlyArray2<'py, f64>,
        loads: Vec<Bound<'py, PyAny>>,
        device: Option<PyReadonlyArray2<'py, f64>>,
        muscles: Option<&str>,
        threads: usize,
    ) -> PyResult<Arrays<'py>> {
        guarded(py, || {
            let body = self.body(py, muscles)?;
            let given = self.given(py, &postures, &loads, device.as_ref(), threads)?;
            let (count, rates) = (postures.as_array().nrows(), self.rows.len());
            let [external, passive, active] = given.torques(py, &body, rates)?;
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
            array_3(py, (count, rates), given.gradients(py, &*self.body(py, Some("off"))?, rates)?)
        })
    }

    /// The muscles in postures, a JSON text each, as a line of `contrapposto muscles --json`.
    fn muscles(
        &self,
        py: Python<'_>,
        postures: PyReadonlyArray2<'_, f64>,
        opensim: bool,
        activation: f64,
    ) -> PyResult<Vec<String>> {
        let given = self.given(py, &postures, &[], None, 1)?;
        let rows = given.values.chunks_exact(given.width.max(1));
        let (rows, opened): (Vec<Posture>, _) =
            (rows.map(|row| Posture::new(row.to_vec())).collect(), Arc::clone(&self.opened));
        let job = move |stop: &AtomicBool| {
            muscle_lines(&opened, &rows, (opensim, activation), || !stop.load(Ordering::Relaxed))
        };
        in_background(py, job)?.map_err(|why| failure(py, &why))
    }

    /// Postures whose dependent coordinates are those that the independent ones ask for.
    fn coupled<'py>(
        &self,
        py: Python<'py>,
        postures: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let mut given = self.given(py, &postures, &[], None, 1)?;
        for row in given.values.chunks_exact_mut(given.width.max(1)) {
            for coupling in self.opened.model.couplings() {
                row[coupling.dependent] = coupling.function.value(row[coupling.independent]);
            }
        }
        array_2(py, (postures.as_array().nrows(), given.width), given.values)
    }

    /// Times and postures of a table (.mot, .sto, .csv), and notes about it.
    fn read_motion<'py>(&self, py: Python<'py>, path: PathBuf, degrees: Option<bool>) -> PyResult<Motion<'py>> {
        guarded(py, || {
            let read = py.detach(|| read_motion(&self.opened.model, &path, degrees));
            let ((times, values), notes) = read.map_err(|why| failure(py, &why))?;
            let (rows, width) = (times.len(), self.opened.model.coordinates().len());
            let notes = notes.into_iter().map(|note| (note.kind, note.text)).collect();
            Ok((array_2(py, (1, rows), times)?, array_2(py, (rows, width), values)?, notes))
        })
    }

    /// Writes times (one row) and postures as a .mot table.
    fn write_motion(
        &self,
        py: Python<'_>,
        path: PathBuf,
        times: PyReadonlyArray2<'_, f64>,
        postures: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        guarded(py, || {
            let given = self.given(py, &postures, &[], None, 1)?;
            let times = rows_of(&times).2;
            let written = py.detach(|| write_motion(&self.opened.model, &path, &times, &given.values));
            written.map_err(|why| failure(py, &why))
        })
    }
}
