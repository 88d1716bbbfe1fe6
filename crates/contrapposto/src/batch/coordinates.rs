//! Converts values of coordinates into those of motions, and torques of motions into those of rates, block by block.
//!
//! Functions that drive motions or couple coordinates are evaluated posture by posture; torques are folded by the chain rule as in
//! [`crate::statics`].

use super::lanes::{LANES, Lanes};
use super::sin_cos::LARGEST_ANGLE;
use crate::math::Function;
use crate::model::{Drive, Model};

/// Square of the length below which a quaternion is looked at again: rounding must not hide one that is too short.
const SHORT_QUATERNION: f64 = 2e-12;

/// Values and slopes of functions. Filled by [`Driven::update`].
#[derive(Clone, Debug)]
pub(super) struct Driven {
    /// Values of all coordinates, if some depend on others.
    pub(super) values: Vec<Lanes>,
    /// By elementary rate: the slope of its motion by its coordinate.
    slopes: Vec<Lanes>,
    /// By coupling: its slope.
    couplings: Vec<Lanes>,
}

impl Driven {
    pub(super) fn new(model: &Model) -> Self {
        let coupled = if model.couplings.is_empty() { 0 } else { model.coordinates.len() };
        Self {
            values: vec![Lanes::ZERO; coupled],
            slopes: vec![Lanes::ONE; model.elements.len()],
            couplings: vec![Lanes::ZERO; model.couplings.len()],
        }
    }

    /// Computes dependent coordinates of a block, and writes the values of the functions that drive motions to `driven`.
    pub(super) fn update(&mut self, model: &Model, given: &[Lanes], driven: &mut [Lanes]) {
        if !self.values.is_empty() {
            self.values.copy_from_slice(given);
        }
        for (coupling, slope) in model.couplings.iter().zip(&mut self.couplings) {
            let (value, of_value) = evaluate(&coupling.function, self.values[coupling.independent]);
            (self.values[coupling.dependent], *slope) = (value, of_value);
        }
        let mut driven = driven.iter_mut();
        for mobility in &model.mobilities {
            let Drive::Function(function, c) = &mobility.drive else { continue };
            let values = if self.values.is_empty() { given } else { &self.values };
            let (value, slope) = evaluate(function, values[*c]);
            self.slopes[mobility.rate] = slope;
            if let Some(driven) = driven.next() {
                *driven = value;
            }
        }
    }

    /// Torques of elementary motions become torques of rates.
    pub(super) fn fold(&self, model: &Model, elements: &[Lanes], rates: &mut [Lanes]) {
        rates.fill(Lanes::ZERO);
        for ((rate, torque), slope) in model.elements.iter().zip(elements).zip(&self.slopes) {
            if let Some(rate) = *rate {
                rates[rate] += *slope * *torque;
            }
        }
        for (coupling, slope) in model.couplings.iter().zip(&self.couplings).rev() {
            let rate = |coordinate: usize| model.coordinates[coordinate].rate;
            if let (Some(d), Some(i)) = (rate(coupling.dependent), rate(coupling.independent)) {
                let dependent = std::mem::replace(&mut rates[d], Lanes::ZERO);
                rates[i] += *slope * dependent;
            }
        }
    }
}

/// Value and slope of a function in every lane.
fn evaluate(function: &Function, at: Lanes) -> (Lanes, Lanes) {
    let (mut values, mut slopes) = ([0.0; LANES], [0.0; LANES]);
    for ((x, value), slope) in at.0.iter().zip(&mut values).zip(&mut slopes) {
        [*value, *slope, _] = function.value_slope_curvature(*x);
    }
    (Lanes(values), Lanes(slopes))
}

/// Whether all values are numbers that [`LARGEST_ANGLE`] allows, in every lane.
pub(super) fn are_small(values: &[Lanes]) -> bool {
    values.iter().fold(true, |small, lanes| small & lanes.every(|x| x.abs() <= LARGEST_ANGLE))
}

/// Whether no quaternion is too short, or almost, in any lane.
pub(super) fn are_rotations(model: &Model, values: &[Lanes]) -> bool {
    model.balls.iter().all(|&first| {
        let squares = values[first..first + 4].iter().fold(Lanes::ZERO, |sum, v| sum + *v * *v);
        squares.every(|square| square >= SHORT_QUATERNION)
    })
}
