//! Which torque do ligaments and other passive tissue give?

use crate::kinematics::Kinematics;
use crate::model::Model;

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
    pub fn update(&mut self, model: &Model, kinematics: &Kinematics) {
        for (torque, rate) in self.raw.iter_mut().zip(model.rates()) {
            let known = rate.coordinate.and_then(|i| Some((i, model.coordinates()[i].passive.as_ref()?)));
            *torque = known.map_or(0.0, |(i, law)| law.torque(i, kinematics.values()));
        }
        kinematics.fold_couplings(model, &self.raw, &mut self.torques);
    }

    /// By rate, N m (N for slides).
    pub fn torques(&self) -> &[f64] {
        &self.torques
    }
}
