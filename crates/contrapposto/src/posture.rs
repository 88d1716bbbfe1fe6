//! Where does every coordinate stand?

use crate::model::{LARGEST, Model};

/// The values of all coordinates of a model, in its order: rad, m, or quaternion components.
#[derive(Clone, Debug, PartialEq)]
pub struct Posture {
    values: Vec<f64>,
}

/// Why a posture does not fit a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PostureError {
    /// Another number of values.
    #[error("posture has {given} values; the model has {needed} coordinates")]
    Length {
        /// Values given.
        given: usize,
        /// Coordinates of the model.
        needed: usize,
    },
    /// A value is NaN, infinite or beyond [`LARGEST`].
    #[error("coordinate `{coordinate}` is {value}; it must be finite and at most {LARGEST:e} in size")]
    NotFinite {
        /// Name of the coordinate.
        coordinate: String,
        /// The value.
        value: f64,
    },
    /// A quaternion is too short to be a rotation.
    #[error("the quaternion that starts with `{coordinate}` has length {length}; it must not be zero")]
    Quaternion {
        /// Name of its first component.
        coordinate: String,
        /// Its length.
        length: f64,
    },
}

impl Model {
    /// Every coordinate at its default.
    pub fn default_posture(&self) -> Posture {
        Posture::new(self.coordinates.iter().map(|c| c.default).collect())
    }
}

impl Posture {
    /// From values in the model's order.
    pub fn new(values: Vec<f64>) -> Self {
        Self { values }
    }

    /// The values in the model's order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The values in the model's order, to change.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Does it fit `model`?
    ///
    /// # Errors
    /// [`PostureError`] names the first coordinate that does not.
    pub fn check(&self, model: &Model) -> Result<(), PostureError> {
        let (given, needed) = (self.values.len(), model.coordinates().len());
        if given != needed {
            return Err(PostureError::Length { given, needed });
        }
        for (value, coordinate) in self.values.iter().zip(model.coordinates()) {
            if value.is_nan() || value.abs() > LARGEST {
                return Err(PostureError::NotFinite { coordinate: coordinate.name.clone(), value: *value });
            }
        }
        for &first in &model.balls {
            let length = self.values[first..first + 4].iter().map(|v| v * v).sum::<f64>().sqrt();
            if length < 1e-6 {
                return Err(PostureError::Quaternion { coordinate: model.coordinates[first].name.clone(), length });
            }
        }
        Ok(())
    }
}
