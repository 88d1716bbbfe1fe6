//! Computes smoothed postures of a recorded motion with the speeds and accelerations of all coordinates.
//!
//! Every coordinate is a signal of its own ([`Smoothing`]); coordinates that follow others get their speeds from them by the chain
//! rule. The quaternion `p` of a ball, whose four components are smoothed without its sign turning from sample to sample, gives
//! the angular velocity about the moved axes and its derivative, whatever its length:
//!
//! ```text
//! omega = 2 Im(p* p') / |p|^2,    omega' = 2 Im(p* p'') / |p|^2 - 2 omega (p . p') / |p|^2
//! ```

use nalgebra::{Quaternion, Vector3};

use super::error::MotionError;
use super::sampling::{Sampling, Smoothing};
use crate::model::{CoordinateKind, Model};
use crate::posture::{Part, Posture, parts};

/// Least length of a smoothed quaternion: that of the mean of two quaternions that half a turn separates.
const LEAST_QUATERNION: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Speeds (rad/s, m/s) and accelerations (rad/s^2, m/s^2) of a posture, one a rate. Entries of dependent coordinates are 0 and do not
/// count.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rates {
    /// Speeds.
    pub speeds: Vec<f64>,
    /// Accelerations.
    pub accelerations: Vec<f64>,
}

/// A motion with its rates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moving {
    /// Times (s) and smoothed postures.
    pub motion: Vec<(f64, Posture)>,
    /// Speeds and accelerations of each.
    pub rates: Vec<Rates>,
}

/// Smoothed postures, speeds and accelerations of postures at rising times (s).
///
/// # Errors
/// [`MotionError`] names what is wrong with the motion or the filter.
pub fn differentiate(model: &Model, motion: &[(f64, Posture)], smoothing: Smoothing) -> Result<Moving, MotionError> {
    for (index, (_, posture)) in motion.iter().enumerate() {
        posture.check(model).map_err(|error| MotionError::Posture { index, error })?;
    }
    let sampling = Sampling::new(motion.iter().map(|(time, _)| *time).collect(), smoothing)?;
    let n = model.rates().len();
    let rest = Rates { speeds: vec![0.0; n], accelerations: vec![0.0; n] };
    let mut moving = Moving { motion: motion.to_vec(), rates: vec![rest; motion.len()] };
    for part in parts(model) {
        match part {
            Part::Axis { coordinate, .. } if model.is_dependent(coordinate) => {}
            Part::Axis { rate, coordinate } => {
                let values: Vec<f64> = motion.iter().map(|(_, posture)| posture.values()[coordinate]).collect();
                for (i, [value, speed, acceleration]) in sampling.derivatives(&values).into_iter().enumerate() {
                    moving.motion[i].1.values_mut()[coordinate] = value;
                    (moving.rates[i].speeds[rate], moving.rates[i].accelerations[rate]) = (speed, acceleration);
                }
            }
            Part::Ball { rate, first } => moving.turn(model, &sampling, rate, first)?,
        }
    }
    Ok(moving)
}

impl Moving {
    /// Smooths the quaternions of a ball.
    fn turn(&mut self, model: &Model, sampling: &Sampling, rate: usize, first: usize) -> Result<(), MotionError> {
        debug_assert_eq!(model.coordinates()[first].kind, CoordinateKind::Quaternion);
        let mut quaternions: Vec<[f64; 4]> = Vec::with_capacity(self.motion.len());
        for (_, posture) in &self.motion {
            let v = &posture.values()[first..first + 4];
            let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            let along = quaternions.last().map_or(1.0, |last| last.iter().zip(v).map(|(a, b)| a * b).sum());
            let scale = if along < 0.0 { -1.0 } else { 1.0 } / length;
            quaternions.push([v[0], v[1], v[2], v[3]].map(|v| scale * v));
        }
        let columns = [0, 1, 2, 3].map(|k| {
            let values: Vec<f64> = quaternions.iter().map(|quaternion| quaternion[k]).collect();
            sampling.derivatives(&values)
        });
        for (i, ((time, posture), rates)) in self.motion.iter_mut().zip(&mut self.rates).enumerate() {
            let [p, dp, ddp] = [0, 1, 2]
                .map(|d| Quaternion::new(columns[0][i][d], columns[1][i][d], columns[2][i][d], columns[3][i][d]));
            let square = p.norm_squared();
            if square < LEAST_QUATERNION * LEAST_QUATERNION {
                let coordinate = model.coordinates()[first].name.clone();
                return Err(MotionError::Turn { coordinate, time: *time });
            }
            let rotating = |by: &Quaternion<f64>| -> Vector3<f64> { 2.0 / square * (p.conjugate() * by).imag() };
            let omega = rotating(&dp);
            let alpha = rotating(&ddp) - 2.0 * p.dot(&dp) / square * omega;
            let unit = p / square.sqrt();
            posture.values_mut()[first..first + 4].copy_from_slice(&[unit.w, unit.i, unit.j, unit.k]);
            rates.speeds[rate..rate + 3].copy_from_slice(omega.as_slice());
            rates.accelerations[rate..rate + 3].copy_from_slice(alpha.as_slice());
        }
        Ok(())
    }

    /// Keeps the instants at the times (s) that `kept` accepts.
    pub fn keep(&mut self, kept: impl Fn(f64) -> bool) {
        let kept: Vec<bool> = self.motion.iter().map(|(time, _)| kept(*time)).collect();
        let mut flags = kept.iter();
        self.motion.retain(|_| flags.next().copied().unwrap_or(true));
        let mut flags = kept.iter();
        self.rates.retain(|_| flags.next().copied().unwrap_or(true));
    }
}
