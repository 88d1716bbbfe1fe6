//! Tracks a motion: every frame from the posture of the one before.

use nalgebra::Vector3;

use super::goals::{Goals, GoalsError};
use super::starts::first_posture;
use super::tracker::{Solved, Tracker};
use crate::model::Model;
use crate::posture::{Posture, PostureError};

/// The answer of one frame of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedFrame {
    /// The posture.
    pub posture: Posture,
    /// Objective and optimality.
    pub solved: Solved,
    /// Number of markers that the frame has.
    pub seen: usize,
    /// Sum of their squared distances, without weights, m^2.
    pub total_squared_error: f64,
    /// The marker with the largest distance, by index, and the distance, m; `None` without markers.
    pub largest: Option<(usize, f64)>,
}

impl TrackedFrame {
    /// Root mean square of the distances, m; 0 without markers.
    pub fn root_mean_square(&self) -> f64 {
        if self.seen == 0 { 0.0 } else { (self.total_squared_error / self.seen as f64).sqrt() }
    }
}

/// The reason for which a motion cannot be tracked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrackingError {
    /// Goals do not fit the model.
    #[error(transparent)]
    Goals(#[from] GoalsError),
    /// The start does not fit the model.
    #[error(transparent)]
    Posture(#[from] PostureError),
}

/// Markers with weights that tell which way a body faces: fewer of them fit it turned, too. Assumed.
const ENOUGH_MARKERS: usize = 4;

/// Tracks frames, each given by the places of all markers of the goals (m, ground; `None` for a gap). A frame without a marker that has a
/// weight keeps the posture of the one before. The body is sought in other directions, too ([`first_posture`]), in the first frame with
/// markers, in the first one with four of them, and in such frames after one without a marker.
///
/// # Errors
/// [`TrackingError`] when goals or start do not fit the model.
///
/// # Panics
/// Unless every frame has one place a marker.
pub fn track<'f>(
    model: &Model,
    goals: Goals,
    start: &Posture,
    frames: impl IntoIterator<Item = &'f [Option<Vector3<f64>>]>,
) -> Result<Vec<TrackedFrame>, TrackingError> {
    let weighted: Vec<bool> = goals.markers.iter().map(|marker| marker.weight > 0.0).collect();
    let mut tracker = Tracker::new(model, goals)?;
    let mut posture = start.clone();
    let mut tracked = vec![];
    let (mut begun, mut sure) = (false, false);
    for observed in frames {
        let seen = observed.iter().flatten().count();
        let pulling = observed.iter().zip(&weighted).filter(|(place, weighted)| place.is_some() && **weighted).count();
        let solved = if pulling == 0 {
            (begun, sure) = (false, false);
            tracker.stay(model, &posture, observed)?
        } else if !begun || (!sure && pulling >= ENOUGH_MARKERS) {
            let (first, solved) = first_posture(&mut tracker, model, &posture, observed)?;
            posture = first;
            (begun, sure) = (true, pulling >= ENOUGH_MARKERS);
            solved
        } else {
            tracker.solve(model, &mut posture, observed)?
        };
        let mut total_squared_error = 0.0;
        let mut largest: Option<(usize, f64)> = None;
        for (index, error) in tracker.errors().enumerate() {
            let Some(error) = error else { continue };
            total_squared_error += error * error;
            if largest.is_none_or(|(_, most)| error > most) {
                largest = Some((index, error));
            }
        }
        tracked.push(TrackedFrame { posture: posture.clone(), solved, seen, total_squared_error, largest });
    }
    Ok(tracked)
}
