//! Which torque do ligaments and other passive tissue give?

use crate::kinematics::Kinematics;
use crate::model::Model;

/// Larger torque cannot be calculated with: squares of it must stay finite. N m, N for slides.
const LARGEST: f64 = 1e50;

/// A law of a file that gives no torque to calculate with in a posture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the passive torque of `{coordinate}` at {value:.6} (rad or m) is {torque:e} N m (or N); it must be finite and at most {LARGEST:e} in size"
)]
pub struct PassiveTorqueError {
    /// Name of the coordinate.
    pub coordinate: String,
    /// Where it stands, rad or m.
    pub value: f64,
    /// What its law says there, N m or N.
    pub torque: f64,
}

/// Passive torque of every rate, N m, in the posture that `kinematics` holds. What a coordinate that follows another one gives
/// is folded into its leader, as with external torque. Filled by [`PassiveTorque::update`].
#[derive(Clone, Debug)]
pub struct PassiveTorque {
    raw: Vec<f64>,
    torques: Vec<f64>,
}

impl PassiveTorque {
    /// Space for `model`.
    pub fn new(model: &Model) -> Self {
        Self { raw: vec![0.0; model.rates().len()], torques: vec![0.0; model.rates().len()] }
    }

    /// Computes them. Does not allocate.
    ///
    /// # Errors
    /// [`PassiveTorqueError`] where a law gives no number, as `1/q` does at 0.
    pub fn update(&mut self, model: &Model, kinematics: &Kinematics) -> Result<(), PassiveTorqueError> {
        for (torque, rate) in self.raw.iter_mut().zip(model.rates()) {
            let known = rate.coordinate.and_then(|i| Some((i, model.coordinates()[i].passive.as_ref()?)));
            *torque = 0.0;
            let Some((i, law)) = known else { continue };
            *torque = law.torque(i, kinematics.values());
            if torque.is_nan() || torque.abs() > LARGEST {
                let (coordinate, value) = (model.coordinates()[i].name.clone(), kinematics.values()[i]);
                return Err(PassiveTorqueError { coordinate, value, torque: *torque });
            }
        }
        kinematics.fold_couplings(model, &self.raw, &mut self.torques);
        Ok(())
    }

    /// By rate, N m (N for slides).
    pub fn torques(&self) -> &[f64] {
        &self.torques
    }
}
