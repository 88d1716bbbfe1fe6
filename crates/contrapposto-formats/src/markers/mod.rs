//! Reads measured markers (`.trc`, `.c3d`), the tasks of marker tracking (OpenSim's IKTaskSet) and the measurements that scale a body (OpenSim's
//! ScaleTool).

mod c3d;
mod marker_set;
mod measurement;
mod named_file;
mod scale_setup;
mod tasks;
mod trc;

pub(crate) use c3d::LEAST_FORCE;
pub use c3d::{C3dError, ForcePlate, ForcePlates, is_c3d, read_c3d, read_force_plates};
pub use marker_set::marker_set;
pub use measurement::{Measurement, MeasurementError};
pub use named_file::NamedFile;
pub use scale_setup::{ACCEPTED_FACTORS, Order, ScaleSetup, scale_setup};
pub use tasks::{CoordinateTask, MarkerTask, TaskFileError, TaskValue, TrackingTasks, tracking_tasks};
pub use trc::{MarkerUnit, Markers, read_trc, turn_upright};

use nalgebra::Vector3;

use crate::input_error::InputError;

/// The reason for which a file of markers cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum MarkerFileError {
    /// Of a `.trc` file.
    #[error(transparent)]
    Trc(#[from] InputError),
    /// Of a `.c3d` file.
    #[error(transparent)]
    C3d(#[from] C3dError),
}

/// Reads a file of measured markers: C3D by its first bytes or the end of its name, else `.trc`. `unit`: that of the coordinates, whatever the file says.
///
/// # Errors
/// [`MarkerFileError`] says what is wrong, where, and what would be right.
pub fn read_markers(name: &str, bytes: &[u8], unit: Option<MarkerUnit>) -> Result<Markers, MarkerFileError> {
    if is_c3d(bytes) || name.to_ascii_lowercase().ends_with(".c3d") {
        Ok(read_c3d(name, bytes, unit)?)
    } else {
        Ok(read_trc(name, bytes, unit)?)
    }
}

/// A marker of a model file.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelMarker {
    /// Unique name.
    pub name: String,
    /// Index of the segment that carries it.
    pub segment: usize,
    /// Place in the segment's frame, m.
    pub point: Vector3<f64>,
}
