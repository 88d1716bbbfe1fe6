//! Holds the values of all coordinates.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::model::{LARGEST, Model};

/// The values of all coordinates of a model, in its order: rad, m, or quaternion components.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Posture {
    values: Vec<f64>,
}

/// The reason for which a posture does not fit a model.
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
        /// Length of the quaternion.
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

    /// Whether the posture fits `model`.
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

    /// Moves by a step of rates (rad, m): angles and distances add, a ball's quaternion `q` becomes `q exp(step)`, of length 1,
    /// and dependent coordinates are set from their independent ones; their own step does nothing. Does not allocate.
    ///
    /// # Panics
    /// When posture or step has another length than the model needs.
    pub fn displace(&mut self, model: &Model, step: &[f64]) {
        self.expect(model, step);
        for part in parts(model) {
            match part {
                Part::Axis { rate, coordinate } => self.values[coordinate] += step[rate],
                Part::Ball { rate, first } => {
                    let turn = UnitQuaternion::from_scaled_axis(Vector3::from_column_slice(&step[rate..rate + 3]));
                    let moved = self.quaternion(first) * turn;
                    // Once more, so that rounding does not grow over many steps.
                    let moved = UnitQuaternion::new_normalize(moved.into_inner());
                    self.values[first..first + 4].copy_from_slice(&[moved.w, moved.i, moved.j, moved.k]);
                }
            }
        }
        for coupling in model.couplings() {
            self.values[coupling.dependent] = coupling.function.value(self.values[coupling.independent]);
        }
    }

    /// The step of rates (rad, m) that displaces this posture to `to`: balls the shorter way, 0 for coordinates that follow
    /// others. Does not allocate.
    ///
    /// # Panics
    /// When a posture or `step` has another length than the model needs.
    pub fn difference(&self, model: &Model, to: &Self, step: &mut [f64]) {
        self.expect(model, step);
        to.expect(model, step);
        for part in parts(model) {
            match part {
                Part::Axis { rate, coordinate } => step[rate] = to.values[coordinate] - self.values[coordinate],
                Part::Ball { rate, first } => {
                    step[rate..rate + 3].copy_from_slice(self.turn_to(first, to).as_slice());
                }
            }
        }
        for coupling in model.couplings() {
            if let Some(rate) = model.coordinates[coupling.dependent].rate {
                step[rate] = 0.0;
            }
        }
    }

    fn expect(&self, model: &Model, step: &[f64]) {
        assert_eq!(self.values.len(), model.coordinates.len(), "the posture belongs to another model");
        assert_eq!(step.len(), model.rates.len(), "a step has one entry a rate");
    }

    /// The turn of a ball, in its own axes, that leads to `to`; `first` is its first coordinate.
    pub(crate) fn turn_to(&self, first: usize, to: &Self) -> Vector3<f64> {
        (self.quaternion(first).inverse() * to.quaternion(first)).scaled_axis()
    }

    fn quaternion(&self, first: usize) -> UnitQuaternion<f64> {
        let v = &self.values[first..first + 4];
        UnitQuaternion::new_normalize(Quaternion::new(v[0], v[1], v[2], v[3]))
    }
}

/// The values that one rate, or the three of a ball, change.
pub(crate) enum Part {
    Axis { rate: usize, coordinate: usize },
    Ball { rate: usize, first: usize },
}

/// All rates with the coordinates they change; balls stand in the same order among both.
pub(crate) fn parts(model: &Model) -> impl Iterator<Item = Part> {
    let (mut rate, mut balls) = (0, model.balls.iter());
    std::iter::from_fn(move || {
        let at = rate;
        Some(match model.rates.get(at)?.coordinate {
            Some(coordinate) => {
                rate += 1;
                Part::Axis { rate: at, coordinate }
            }
            None => {
                rate += 3;
                Part::Ball { rate: at, first: *balls.next()? }
            }
        })
    })
}
