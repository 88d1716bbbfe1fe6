//! Reads measured markers (`.trc`), the tasks of marker tracking (OpenSim's IKTaskSet) and the measurements that scale a body (OpenSim's
//! ScaleTool).

mod marker_set;
mod measurement;
mod scale_setup;
mod tasks;
mod trc;

pub use marker_set::marker_set;
pub use measurement::{Measurement, MeasurementError};
pub use scale_setup::{ACCEPTED_FACTORS, Order, ScaleSetup, scale_setup};
pub use tasks::{CoordinateTask, MarkerTask, TaskFileError, TaskValue, TrackingTasks, tracking_tasks};
pub use trc::{MarkerUnit, Markers, read_trc};

use nalgebra::Vector3;

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
