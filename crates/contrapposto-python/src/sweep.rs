//! The classes `Sweep` and `SweepFolder`, and the populations: many runs, their progress, and Ctrl-C.

use std::num::NonZero;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use contrapposto_cli::library::{self, Failure, Populated};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::{failure, guarded, internal};
use crate::job::source_of;
use crate::unlocked::{in_background, watched};

/// A plan of many runs.
#[pyclass(frozen, module = "contrapposto._native")]
pub(crate) struct Sweep {
    inner: Arc<library::Sweep>,
}

/// A folder that takes the parts of a sweep, until it is closed.
#[pyclass(frozen, module = "contrapposto._native")]
pub(crate) struct SweepFolder {
    sweep: Arc<library::Sweep>,
    folder: Mutex<Option<Arc<Mutex<library::SweepFolder>>>>,
}

/// Numbers of finished rows and of all rows, counted while a job runs.
#[derive(Default)]
struct Counts {
    done: AtomicUsize,
    all: AtomicUsize,
}

impl Counts {
    /// Tells a function of Python how many rows of how many are done, where it has been given.
    fn tell(&self, py: Python<'_>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
        let counts = (self.done.load(Ordering::Relaxed), self.all.load(Ordering::Relaxed));
        progress.map(|progress| progress.call1(py, counts)).transpose().map(drop)
    }
}

fn threads(threads: Option<usize>) -> Option<NonZero<usize>> {
    threads.and_then(NonZero::new)
}

#[pymethods]
impl Sweep {
    /// The plan of a file, or of a text.
    #[new]
    fn new(py: Python<'_>, plan: String, is_text: bool) -> PyResult<Self> {
        guarded(py, || {
            let source = source_of(plan, is_text);
            let opened = py.detach(|| library::Sweep::open(&source));
            let (inner, _) = opened.map_err(|why| failure(py, &why))?;
            Ok(Self { inner: Arc::new(inner) })
        })
    }

    /// The bodies of `population`, for a folder whose parts it takes with `resume`.
    #[staticmethod]
    fn population(py: Python<'_>, scenario: String, is_text: bool, bodies: usize, seed: u32) -> PyResult<Self> {
        guarded(py, || {
            let source = source_of(scenario, is_text);
            let opened = py.detach(|| library::Sweep::of_population(&source, bodies, seed));
            let (inner, _) = opened.map_err(|why| failure(py, &why))?;
            Ok(Self { inner: Arc::new(inner) })
        })
    }

    /// The sweep of the bytes that `state` gives.
    #[staticmethod]
    fn from_state(py: Python<'_>, state: &[u8]) -> PyResult<Self> {
        let inner = library::Sweep::from_bytes(state).map_err(|why| failure(py, &why))?;
        Ok(Self { inner: Arc::new(inner) })
    }

    /// All that the sweep is made of, as bytes.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.inner.to_bytes().map_err(|why| internal(py, &why))?))
    }

    /// Number of rows of a part.
    fn rows_of(&self, part: usize) -> usize {
        self.inner.rows_of(part)
    }

    /// The bytes of a part.
    fn part<'py>(&self, py: Python<'py>, part: usize) -> PyResult<Bound<'py, PyBytes>> {
        let sweep = Arc::clone(&self.inner);
        let bytes = in_background(py, move |stop| sweep.part(part, || !stop.load(Ordering::Relaxed)))?;
        let bytes = bytes.ok_or_else(|| failure(py, &Failure::refused(format!("the sweep has no part {part}"))))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Locks a folder for the parts.
    fn folder(&self, py: Python<'_>, out: PathBuf, resume: bool) -> PyResult<SweepFolder> {
        guarded(py, || {
            let folder = py.detach(|| self.inner.folder(&out, resume)).map_err(|why| failure(py, &why))?;
            let folder = Mutex::new(Some(Arc::new(Mutex::new(folder))));
            Ok(SweepFolder { sweep: Arc::clone(&self.inner), folder })
        })
    }
}

impl SweepFolder {
    fn opened(&self, py: Python<'_>) -> PyResult<Arc<Mutex<library::SweepFolder>>> {
        let folder = self.folder.lock().unwrap_or_else(PoisonError::into_inner).clone();
        folder.ok_or_else(|| internal(py, "the folder of the sweep is closed"))
    }
}

#[pymethods]
impl SweepFolder {
    /// Numbers of the parts that the folder lacked when it was opened.
    #[getter]
    fn missing(&self, py: Python<'_>) -> PyResult<Vec<usize>> {
        Ok(self.opened(py)?.lock().unwrap_or_else(PoisonError::into_inner).missing().to_vec())
    }

    /// Writes a part, whole or not at all.
    fn write(&self, py: Python<'_>, part: usize, bytes: &[u8]) -> PyResult<()> {
        let folder = self.opened(py)?;
        let written = py.detach(|| folder.lock().unwrap_or_else(PoisonError::into_inner).write(part, bytes));
        written.map_err(|why| failure(py, &why))
    }

    /// Computes the missing parts in threads; `progress` is called with the finished rows and all rows.
    fn fill(&self, py: Python<'_>, thread_count: Option<usize>, progress: Option<Py<PyAny>>) -> PyResult<()> {
        let (sweep, folder, counts) = (Arc::clone(&self.sweep), self.opened(py)?, Arc::new(Counts::default()));
        let counted = Arc::clone(&counts);
        let job = move |stop: &AtomicBool| {
            let folder = folder.lock().unwrap_or_else(PoisonError::into_inner);
            let begin = |rows| counted.all.store(rows, Ordering::Relaxed);
            let done = || {
                counted.done.fetch_add(1, Ordering::Relaxed);
            };
            folder.fill(&sweep, threads(thread_count), &|| !stop.load(Ordering::Relaxed), (&begin, &done))
        };
        watched(py, job, |py| counts.tell(py, progress.as_ref()))?.map_err(|why| failure(py, &why))?;
        counts.tell(py, progress.as_ref())
    }

    /// Writes `sweep.json`, and removes parts of other plans.
    fn finish(&self, py: Python<'_>) -> PyResult<()> {
        let folder = self.opened(py)?;
        let finished = py.detach(|| folder.lock().unwrap_or_else(PoisonError::into_inner).finish(&self.sweep));
        finished.map_err(|why| failure(py, &why))
    }

    /// Unlocks the folder.
    fn close(&self) {
        self.folder.lock().unwrap_or_else(PoisonError::into_inner).take();
    }
}

/// Answers for a population of women and men: the texts of population.json, population.csv and population.html.
#[pyfunction]
#[pyo3(signature = (scenario, is_text, bodies, seed, out, resume, thread_count, progress))]
#[expect(clippy::too_many_arguments, reason = "the keywords of one function of Python")]
pub(crate) fn population(
    py: Python<'_>,
    scenario: String,
    is_text: bool,
    bodies: usize,
    seed: u32,
    out: Option<PathBuf>,
    resume: bool,
    thread_count: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, String, String)> {
    let (source, counts) = (source_of(scenario, is_text), Arc::new(Counts::default()));
    let counted = Arc::clone(&counts);
    let job = move |stop: &AtomicBool| {
        let begin = |rows| counted.all.store(rows, Ordering::Relaxed);
        let done = || {
            counted.done.fetch_add(1, Ordering::Relaxed);
        };
        let place = (out.as_deref(), resume, threads(thread_count));
        let (found, _) =
            Populated::new(&source, (bodies, seed), place, &|| !stop.load(Ordering::Relaxed), (&begin, &done))?;
        Ok((found.json().to_owned(), found.table().to_owned(), found.report()))
    };
    let found: Result<_, Failure> = watched(py, job, |py| counts.tell(py, progress.as_ref()))?;
    let texts = found.map_err(|why| failure(py, &why))?;
    counts.tell(py, progress.as_ref())?;
    Ok(texts)
}
