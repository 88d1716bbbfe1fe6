//! Computes the torque of ligaments and other passive tissue of all coordinates.

use crate::kinematics::Kinematics;
use crate::model::Model;

/// Larger torque cannot be calculated with: squares of it must stay finite. N m, N for slides.
const PASSIVE_TORQUE_LIMIT: f64 = 1e50;

/// A law of a file that gives no torque to calculate with in a posture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the passive torque of `{coordinate}` at {value:.6} (rad or m) is {torque:e} N m (or N); it must be finite and at most {PASSIVE_TORQUE_LIMIT:e} in size"
)]
pub struct PassiveTorqueError {
    /// Name of the coordinate.
    pub coordinate: String,
    /// Where it stands, rad or m.
    pub value: f64,
    /// Torque by its law, N m or N.
    pub torque: f64,
}

/// Passive torque of every rate, N m, in the posture that `kinematics` holds. Torques of a dependent coordinate are folded into its
/// independent one, as with external torque. Filled by [`PassiveTorque::update`].
#[derive(Clone, Debug)]
pub struct PassiveTorque {
    /// By coordinate; empty for none.
    ranges: Vec<Option<(f64, f64)>>,
    /// Values of all coordinates, those with a range clamped into it.
    values: Vec<f64>,
    raw: Vec<f64>,
    torques: Vec<f64>,
}

impl PassiveTorque {
    /// Space for `model`.
    pub fn new(model: &Model) -> Self {
        Self::within(model, &[])
    }

    /// Space for `model`. Outside of its range (rad, one entry a coordinate) the torque of a coordinate stays what it is at the
    /// nearer end: laws that were measured inside a range say nothing outside of it.
    pub fn within(model: &Model, ranges: &[Option<(f64, f64)>]) -> Self {
        let n = model.rates().len();
        let values = vec![0.0; model.coordinates().len()];
        Self { ranges: ranges.to_vec(), values, raw: vec![0.0; n], torques: vec![0.0; n] }
    }

    /// Computes them. Does not allocate.
    ///
    /// # Errors
    /// [`PassiveTorqueError`] where a law gives no number, as `1/q` does at 0.
    pub fn update(&mut self, model: &Model, kinematics: &Kinematics) -> Result<(), PassiveTorqueError> {
        self.values.copy_from_slice(kinematics.values());
        for (value, range) in self.values.iter_mut().zip(&self.ranges) {
            *value = range.map_or(*value, |(min, max)| value.max(min).min(max));
        }
        for (torque, rate) in self.raw.iter_mut().zip(model.rates()) {
            let known = rate.coordinate.and_then(|i| Some((i, model.coordinates()[i].passive.as_ref()?)));
            *torque = 0.0;
            let Some((i, law)) = known else { continue };
            *torque = law.torque(i, &self.values);
            if torque.is_nan() || torque.abs() > PASSIVE_TORQUE_LIMIT {
                let (coordinate, value) = (model.coordinates()[i].name.clone(), self.values[i]);
                return Err(PassiveTorqueError { coordinate, value, torque: *torque });
            }
        }
        kinematics.fold_couplings(model, &self.raw, &mut self.torques);
        Ok(())
    }

    /// The values of all coordinates, inside their ranges, at which the laws were evaluated, rad or m.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// By rate, N m (N for slides).
    pub fn torques(&self) -> &[f64] {
        &self.torques
    }

    /// As [`PassiveTorque::torques`], but as if no coordinate depended on another one.
    pub fn uncoupled_torques(&self) -> &[f64] {
        &self.raw
    }
}
