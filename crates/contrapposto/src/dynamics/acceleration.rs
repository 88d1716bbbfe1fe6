//! Computes velocity and acceleration of every segment from the speeds and accelerations of the coordinates.
//!
//! Coordinates first: an elementary motion `u = f(q)` has `u' = f_q q'` and `u'' = f_q q'' + f_qq q'^2`; a dependent coordinate
//! `q_d = g(q_i)` has the same with `g`. Then from the root to the ends, with `r` from the parent's origin to the mobility's own and
//! `e` its axis, all in ground axes:
//!
//! ```text
//! hinge, ball   omega = omega_p + e u'     alpha = alpha_p + e u'' + omega_p x e u'    (a ball sums over its three axes)
//! slide         omega = omega_p            alpha = alpha_p
//! origin        a = a_p + alpha_p x r + omega_p x (omega_p x r)    (+ e u'' + 2 omega_p x e u' of a slide)
//! ```
//!
//! The speeds of a ball are the components of its angular velocity about its own moved axes, as its torques are.

use nalgebra::Vector3;

use crate::kinematics::Kinematics;
use crate::model::{LARGEST, Model, Motion};

/// The reason for which speeds or accelerations do not fit a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpeedError {
    /// Another number of values.
    #[error("{given} {quantity} are given; the model has {needed} rates")]
    Length {
        /// Speeds or accelerations.
        quantity: &'static str,
        /// Values given.
        given: usize,
        /// Rates of the model.
        needed: usize,
    },
    /// A value is NaN, infinite or beyond [`LARGEST`].
    #[error("{quantity} of `{rate}` is {value}; it must be finite and at most {LARGEST:e} in size (rad or m, and s)")]
    NotFinite {
        /// Speed or acceleration.
        quantity: &'static str,
        /// Name of the rate.
        rate: String,
        /// The value.
        value: f64,
    },
}

/// Velocities and accelerations of a posture in motion. Depends on posture, speeds and accelerations of the coordinates; filled by
/// [`Acceleration::update`].
#[derive(Clone, Debug)]
pub struct Acceleration {
    /// Angular velocity (rad/s) and acceleration (rad/s^2) of each mobility's moved frame, in ground axes.
    pub(super) omega: Vec<Vector3<f64>>,
    pub(super) alpha: Vec<Vector3<f64>>,
    /// Acceleration of its origin, m/s^2.
    pub(super) origin: Vec<Vector3<f64>>,
    /// Speed and acceleration of every rate, dependent ones filled in.
    rates: Vec<(f64, f64)>,
}

impl Acceleration {
    /// Space for `model`, at rest.
    pub fn new(model: &Model) -> Self {
        let zero = vec![Vector3::zeros(); model.mobilities.len()];
        Self { omega: zero.clone(), alpha: zero.clone(), origin: zero, rates: vec![(0.0, 0.0); model.rates.len()] }
    }

    /// Computes all of it in the posture that `kinematics` holds, for speeds (rad/s or m/s) and accelerations (rad/s^2 or m/s^2), one
    /// a rate; entries of dependent coordinates do not count. Does not allocate.
    ///
    /// # Errors
    /// [`SpeedError`] when they do not fit the model; nothing is changed then.
    pub fn update(
        &mut self,
        model: &Model,
        kinematics: &Kinematics,
        speeds: &[f64],
        accelerations: &[f64],
    ) -> Result<(), SpeedError> {
        check(model, "speed", speeds)?;
        check(model, "acceleration", accelerations)?;
        self.fill_rates(model, kinematics, speeds, accelerations);
        for i in 0..model.mobilities.len() {
            self.fill_mobility(model, kinematics, i);
        }
        Ok(())
    }

    /// Copies speeds and accelerations, and gives dependent coordinates theirs.
    fn fill_rates(&mut self, model: &Model, kinematics: &Kinematics, speeds: &[f64], accelerations: &[f64]) {
        for (own, given) in self.rates.iter_mut().zip(speeds.iter().zip(accelerations)) {
            *own = (*given.0, *given.1);
        }
        for (coupling, &(slope, curvature)) in model.couplings.iter().zip(&kinematics.couplings) {
            let rate = |coordinate: usize| model.coordinates[coordinate].rate;
            if let (Some(d), Some(i)) = (rate(coupling.dependent), rate(coupling.independent)) {
                let (speed, acceleration) = self.rates[i];
                self.rates[d] = (slope * speed, slope * acceleration + curvature * speed * speed);
            }
        }
    }

    /// Speed and acceleration of an elementary motion.
    fn element(&self, model: &Model, kinematics: &Kinematics, element: usize) -> (f64, f64) {
        let Some(rate) = model.elements[element] else { return (0.0, 0.0) };
        let (speed, acceleration) = self.rates[rate];
        let (slope, curvature) = kinematics.drives[element];
        (slope * speed, slope * acceleration + curvature * speed * speed)
    }

    fn fill_mobility(&mut self, model: &Model, kinematics: &Kinematics, i: usize) {
        let mobility = &model.mobilities[i];
        let (mut omega, mut alpha, mut origin) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        if let Some(p) = mobility.parent {
            let arm = kinematics.origins[i] - kinematics.origins[p];
            (omega, alpha) = (self.omega[p], self.alpha[p]);
            origin = self.origin[p] + alpha.cross(&arm) + omega.cross(&omega.cross(&arm));
        }
        // Sums over the axes of the motion itself.
        let (mut velocity, mut change) = (Vector3::zeros(), Vector3::zeros());
        for element in mobility.rate..mobility.rate + mobility.motion.rates() {
            let (speed, acceleration) = self.element(model, kinematics, element);
            velocity += speed * kinematics.axes[element];
            change += acceleration * kinematics.axes[element];
        }
        if let Motion::Slide(_) = mobility.motion {
            origin += change + 2.0 * omega.cross(&velocity);
        } else {
            alpha += change + omega.cross(&velocity);
            omega += velocity;
        }
        (self.omega[i], self.alpha[i], self.origin[i]) = (omega, alpha, origin);
    }

    /// Angular velocity (rad/s) and angular acceleration (rad/s^2) of a segment, in ground axes.
    pub fn angular(&self, model: &Model, segment: usize) -> (Vector3<f64>, Vector3<f64>) {
        model.segments[segment].mobility.map_or_else(Default::default, |m| (self.omega[m], self.alpha[m]))
    }

    /// Acceleration of a point fixed in a segment (m, its frame), in ground axes, m/s^2.
    pub fn station(&self, model: &Model, kinematics: &Kinematics, segment: usize, point: Vector3<f64>) -> Vector3<f64> {
        let Some(m) = model.segments[segment].mobility else { return Vector3::zeros() };
        let arm = kinematics.station(model, segment, point) - kinematics.origins[m];
        let omega = self.omega[m];
        self.origin[m] + self.alpha[m].cross(&arm) + omega.cross(&omega.cross(&arm))
    }

    /// Speed and acceleration of every rate, those of dependent coordinates filled in.
    pub fn rates(&self) -> &[(f64, f64)] {
        &self.rates
    }
}

/// Whether values, one a rate, fit the model.
fn check(model: &Model, quantity: &'static str, values: &[f64]) -> Result<(), SpeedError> {
    let (given, needed) = (values.len(), model.rates.len());
    if given != needed {
        return Err(SpeedError::Length { quantity, given, needed });
    }
    match values.iter().zip(&model.rates).find(|(value, _)| value.is_nan() || value.abs() > LARGEST) {
        Some((&value, rate)) => Err(SpeedError::NotFinite { quantity, rate: rate.name.clone(), value }),
        None => Ok(()),
    }
}
