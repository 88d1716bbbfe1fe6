//! Computes the torques of a body in motion: inverse dynamics, the inertia of the motion added as torques.

use super::{JointTorques, JointTorquesError, Quantities};
use crate::dynamics::Inertia;
use crate::model::Model;
use crate::statics::Load;

impl JointTorques {
    /// As [`JointTorques::apply`] with the loads of inertia behind `loads`, in the posture and with the held weights of the last
    /// [`Inertia::update`]. Where gradient and torques about the axes of three-axis joints are not asked for, the torques of inertia are added to
    /// those of the other loads, which takes one pass over the body less; slopes of the external torque then have no part of inertia.
    ///
    /// # Errors
    /// As [`JointTorques::update`].
    pub fn apply_moving(
        &mut self,
        model: &Model,
        loads: &[Load],
        inertia: &Inertia,
        quantities: Quantities,
    ) -> Result<(), JointTorquesError> {
        let as_loads = quantities.gradient || self.axes.is_some();
        self.begin(model, loads, quantities)?;
        if as_loads {
            inertia.add_loads(model, &self.kinematics, &mut self.loads);
            return self.finish(model, quantities, None);
        }
        self.finish(model, quantities, Some(inertia))?;
        // Whoever asks for the loads, joint reactions for one, sees them all.
        inertia.add_loads(model, &self.kinematics, &mut self.loads);
        Ok(())
    }
}
