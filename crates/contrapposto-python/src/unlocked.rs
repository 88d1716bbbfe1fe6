//! Runs jobs without the interpreter's lock, and sees Ctrl-C while they run.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::prelude::*;

use crate::errors::{internal, panicked};

/// Longest time between two looks for Ctrl-C.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// Runs a job in a thread of its own, without the lock. On Ctrl-C `KeyboardInterrupt` is raised at once, and the job learns it from the
/// flag; a job that does not look at the flag ends later, and its result is dropped.
pub(crate) fn in_background<T: Send + 'static>(
    py: Python<'_>,
    job: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
    watched(py, job, |_| Ok(()))
}

/// As [`in_background`]; between two looks `tell` is called, whose exception ends the job as Ctrl-C does.
pub(crate) fn watched<T: Send + 'static>(
    py: Python<'_>,
    job: impl FnOnce(&AtomicBool) -> T + Send + 'static,
    tell: impl Fn(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, ends) = channel();
    let flag = Arc::clone(&stop);
    let worker = std::thread::Builder::new()
        .name("contrapposto".to_owned())
        .spawn(move || {
            let result = job(&flag);
            // Nobody waits after Ctrl-C.
            let _ = sender.send(result);
        })
        .map_err(|error| internal(py, &format!("no thread can be started: {error}")))?;
    // The receiver is not shared between threads: it moves into the waiting and back.
    let mut ends = Some(ends);
    loop {
        let Some(receiver) = ends.take() else { return Err(internal(py, "the job was forgotten")) };
        let (answer, receiver) = py.detach(move || (receiver.recv_timeout(BETWEEN_LOOKS), receiver));
        match answer {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => ends = Some(receiver),
            Err(RecvTimeoutError::Disconnected) => {
                let panic = py.detach(move || worker.join()).err();
                return Err(panic.map_or_else(|| internal(py, "the job gave no result"), |panic| panicked(py, &*panic)));
            }
        }
        if let Err(interrupt) = py.check_signals().and_then(|()| tell(py)) {
            stop.store(true, Ordering::Relaxed);
            return Err(interrupt);
        }
    }
}
