//! Defines the goals of marker tracking, and refuses those without meaning.

use nalgebra::Vector3;

use crate::model::{CoordinateKind, LARGEST, Model};

/// A marker of the body.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerGoal {
    /// Index of the segment that carries it.
    pub segment: usize,
    /// Place in the segment's frame, m.
    pub point: Vector3<f64>,
    /// Weight of its squared distance; 0 for a marker whose error is reported only.
    pub weight: f64,
}

/// A coordinate with a wanted value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateGoal {
    /// Index of the coordinate, an angle or a distance.
    pub coordinate: usize,
    /// Wanted value, rad or m.
    pub value: f64,
    /// Weight of its squared error.
    pub weight: f64,
}

/// Goals and limits of every frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Goals {
    /// Markers, in the order of the observations.
    pub markers: Vec<MarkerGoal>,
    /// Coordinates with wanted values.
    pub coordinates: Vec<CoordinateGoal>,
    /// Coordinates that keep the value they begin with.
    pub fixed: Vec<usize>,
    /// Coordinates with hard limits, rad or m; limits of a coordinate that follows another one are not used.
    pub limits: Vec<(usize, (f64, f64))>,
}

/// The reason for which goals do not fit a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GoalsError {
    /// There is no such segment or coordinate.
    #[error("{what} number {index}; the model has {count}")]
    Index {
        /// `segment` or `coordinate`.
        what: &'static str,
        /// The index given.
        index: usize,
        /// Number of them in the model.
        count: usize,
    },
    /// The coordinate is a component of a quaternion, which has no value of its own.
    #[error("coordinate `{0}` is a component of a quaternion; a wanted value or a limit needs an angle or a distance")]
    Quaternion(String),
    /// A number is NaN, too large, or a weight negative.
    #[error("{what} is {value}; it must be {accepted}")]
    Number {
        /// The quantity.
        what: &'static str,
        /// The value.
        value: f64,
        /// The values that would be accepted.
        accepted: &'static str,
    },
}

impl Goals {
    /// Whether the goals fit `model`.
    ///
    /// # Errors
    /// [`GoalsError`] names the first number that has no meaning.
    pub fn check(&self, model: &Model) -> Result<(), GoalsError> {
        let segments = model.segments().len();
        for marker in &self.markers {
            if marker.segment >= segments {
                return Err(GoalsError::Index { what: "segment", index: marker.segment, count: segments });
            }
            for &value in marker.point.iter() {
                size("place of a marker (m)", value)?;
            }
            weight("weight of a marker", marker.weight)?;
        }
        for goal in &self.coordinates {
            scalar(model, goal.coordinate)?;
            size("wanted value of a coordinate", goal.value)?;
            weight("weight of a coordinate", goal.weight)?;
        }
        for &(coordinate, (low, high)) in &self.limits {
            scalar(model, coordinate)?;
            if low.is_nan() || high.is_nan() || low > high {
                let accepted = "at or below the upper limit";
                return Err(GoalsError::Number { what: "lower limit of a coordinate", value: low, accepted });
            }
        }
        let count = model.coordinates().len();
        match self.fixed.iter().find(|&&index| index >= count) {
            Some(&index) => Err(GoalsError::Index { what: "coordinate", index, count }),
            None => Ok(()),
        }
    }
}

fn scalar(model: &Model, index: usize) -> Result<(), GoalsError> {
    let count = model.coordinates().len();
    let coordinate = model.coordinates().get(index).ok_or(GoalsError::Index { what: "coordinate", index, count })?;
    match coordinate.kind {
        CoordinateKind::Quaternion => Err(GoalsError::Quaternion(coordinate.name.clone())),
        _ => Ok(()),
    }
}

fn size(what: &'static str, value: f64) -> Result<(), GoalsError> {
    let accepted = "finite and at most 1e9 in size";
    if value.abs() <= LARGEST { Ok(()) } else { Err(GoalsError::Number { what, value, accepted }) }
}

/// Largest weight: with distances up to [`LARGEST`] no sum overflows.
const MOST_WEIGHT: f64 = 1e12;

fn weight(what: &'static str, value: f64) -> Result<(), GoalsError> {
    let accepted = "between 0 and 1e12";
    if (0.0..=MOST_WEIGHT).contains(&value) { Ok(()) } else { Err(GoalsError::Number { what, value, accepted }) }
}
