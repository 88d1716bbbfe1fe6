//! Holds moments of a body as rows of numbers.

use contrapposto::model::Model;

use crate::view::frame::Frame;

/// Moments, and what the body does in them: one row a moment, one column a coordinate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frames {
    /// Names of the coordinates.
    pub names: Vec<String>,
    /// s.
    pub times: Vec<f64>,
    /// Values of the coordinates: rad, m, components of quaternions.
    pub postures: Vec<f64>,
    /// External torque, N m; of three-axis joints about the axes that stand for their coordinates, as all below.
    pub external: Vec<f64>,
    /// Passive torque, N m.
    pub passive: Vec<f64>,
    /// Active torque, N m.
    pub active: Vec<f64>,
    /// Active torque over the strength of its group.
    pub load: Vec<f64>,
    /// Fatigue of the positive and the negative group; empty where time has no part.
    pub fatigue: Vec<f64>,
}

impl Frames {
    pub(super) fn of(model: &Model, frames: &[Frame]) -> Self {
        let names: Vec<String> = model.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
        let mut all = Self::default();
        for frame in frames {
            all.times.push(frame.time);
            all.postures.extend_from_slice(&frame.posture);
            all.external.extend_from_slice(&frame.external);
            all.passive.extend_from_slice(&frame.passive);
            // Adding 0 turns -0, the active torque of no torques, into 0.
            all.active.extend((0..names.len()).map(|i| frame.active(i) + 0.0));
            all.load.extend_from_slice(&frame.load);
            all.fatigue.extend(frame.fatigue.iter().flatten().flatten());
        }
        Self { names, ..all }
    }
}
