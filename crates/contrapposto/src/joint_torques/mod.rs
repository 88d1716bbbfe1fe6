//! Computes the torques at the joints of a body at rest: external, passive, contact and active torque, relative load and effort.
//!
//! At every rate the torques add up to zero (Rodriguez & Boulic 2007, Eq. 1):
//!
//! ```text
//! tau_a + tau_p + tau_e = 0                active, passive and external torque, N m
//! l_i = |tau_a,i| / S_i(q_i)               relative load, S the strength of the muscle group that gives tau_a
//! effort = sum_i l_i^2
//! ```
//!
//! Muscles of a three-axis joint ([`crate::model::ThreeAxisJoint`]) are judged by the components of its moment along the axes that
//! stand for its coordinates, which no choice of angles can hide: there `tau_e`, `tau_p`, `tau_a` and `S` are those about the axes,
//! and `q` is the angle about the axis. All other coordinates have one axis, their own.
//!
//! External torque is that of gravity, of the loads and of the contact forces of supports. The contact forces of a body on supports
//! ([`ContactForces`]) depend on the active torque that the joints would need without them; [`JointTorques::update_with_contact`]
//! computes that torque, then the forces, then all torques with the forces among the loads. Torques of a dependent coordinate are
//! folded into its independent one. Least-squares solvers minimise `effort / 2`; that half is called objective there.

mod about_axes;
mod group_load;
mod hazard;
mod hip_tract;
mod joint_reaction;
mod moving;
mod muscle_laws;
mod muscle_share;
mod muscle_tables;
mod muscle_work;
mod muscles;
mod quantities;

pub use about_axes::AboutAxes;
pub use group_load::{GroupLoad, relative_load};
pub use hazard::{Hazard, carried};
pub(crate) use hazard::{judged_parts, posture_in_words};
pub use hip_tract::{HipTract, hip_tract};
pub use joint_reaction::{Compression, JointReaction, JointReactions, PathForces};
pub use muscle_laws::{MOST_LEVELLED, TorqueRise};
pub(crate) use muscle_share::works_for;
pub use muscle_share::{MuscleShare, MuscleShareError};
pub use muscle_tables::RESTING_ACTIVATION;
pub use muscle_work::{MissingTorque, MuscleWork, MuscleWorkError};
pub use muscles::{JointMuscles, JointMusclesError, LEAST_MUSCLE_STRENGTH};
pub use quantities::Quantities;

use crate::contact::ContactForces;
use crate::dynamics::Inertia;
use crate::kinematics::{CenterOfMass, Kinematics};
use crate::model::Model;
use crate::posture::{Posture, PostureError};
use crate::statics::{ExternalTorque, Gradient, Load, LoadError, PassiveTorque, PassiveTorqueError, PathTensionError};

/// Active torque (Eq. 1), N m: what muscles give for external and passive torque to be in equilibrium.
#[inline]
pub fn active_torque(external: f64, passive: f64) -> f64 {
    -(passive + external)
}

/// Effort: the sum of squares of relative loads, or of errors of effort tasks, which are relative loads with a sign.
pub fn effort(loads: &[f64]) -> f64 {
    loads.iter().fold(0.0, |sum, load| sum + load * load)
}

/// The reason for which a posture or a load was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JointTorquesError {
    /// The posture does not fit the model.
    #[error(transparent)]
    Posture(#[from] PostureError),
    /// A load does not fit the model.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A passive law gives no torque in the posture.
    #[error(transparent)]
    Passive(#[from] PassiveTorqueError),
    /// Muscles have no torque, or no gradient of it.
    #[error(transparent)]
    Muscles(#[from] PathTensionError),
}

/// Kinematics and torques of a posture. Depends on posture, loads and contact forces; filled by [`JointTorques::update`] or
/// [`JointTorques::update_with_contact`].
#[derive(Clone, Debug)]
pub struct JointTorques {
    posture: Posture,
    kinematics: Kinematics,
    center_of_mass: CenterOfMass,
    external: ExternalTorque,
    gradient: Gradient,
    passive: PassiveTorque,
    /// External torque about axes, for a body with three-axis joints.
    axes: Option<AboutAxes>,
    muscles: Option<Box<JointMuscles>>,
    /// By rate, about axes, N m.
    active: Vec<f64>,
    /// The loads given, then the contact forces, or those of inertia.
    loads: Vec<Load>,
    /// The quantities of the last update.
    computed: Quantities,
}

impl JointTorques {
    /// Space for `model`, at its default posture; holds frames and axes only.
    pub fn new(model: &Model) -> Self {
        Self::with_passive_torque(model, PassiveTorque::new(model))
    }

    /// As [`JointTorques::new`], with passive torque evaluated inside ranges: see [`PassiveTorque::within`].
    pub fn with_passive_ranges(model: &Model, ranges: &[Option<(f64, f64)>]) -> Self {
        Self::with_passive_torque(model, PassiveTorque::within(model, ranges))
    }

    fn with_passive_torque(model: &Model, passive: PassiveTorque) -> Self {
        Self {
            posture: model.default_posture(),
            kinematics: Kinematics::new(model),
            center_of_mass: CenterOfMass::new(model),
            external: ExternalTorque::new(model),
            gradient: Gradient::new(model),
            passive,
            axes: (!model.three_axis_joints().is_empty()).then(|| AboutAxes::new(model)),
            muscles: None,
            active: vec![0.0; model.rates().len()],
            loads: vec![],
            computed: Quantities::default(),
        }
    }

    /// The same with muscles, whose passive torque is added to that of the model's laws.
    #[must_use]
    pub fn with_muscles(self, muscles: Option<JointMuscles>) -> Self {
        Self { muscles: muscles.map(Box::new), ..self }
    }

    /// The muscles in the posture of the last update.
    pub fn muscles(&self) -> Option<&JointMuscles> {
        self.muscles.as_deref()
    }

    /// Computes `quantities` in `posture`: [`JointTorques::place`], then [`JointTorques::apply`].
    ///
    /// # Errors
    /// [`JointTorquesError`] when posture or loads do not fit the model, or a passive law gives no torque. After a refused posture
    /// nothing has changed; after a refused load or torque only frames and axes are known.
    pub fn update(
        &mut self,
        model: &Model,
        posture: &Posture,
        loads: &[Load],
        quantities: Quantities,
    ) -> Result<(), JointTorquesError> {
        self.place(model, posture)?;
        self.apply(model, loads, quantities)
    }

    /// As [`JointTorques::update`], for a body on supports: see [`JointTorques::apply_with_contact`].
    ///
    /// # Errors
    /// As [`JointTorques::update`].
    pub fn update_with_contact(
        &mut self,
        model: &Model,
        posture: &Posture,
        loads: &[Load],
        contact: &mut ContactForces,
        quantities: Quantities,
    ) -> Result<(), JointTorquesError> {
        self.place(model, posture)?;
        self.apply_with_contact(model, loads, contact, quantities)
    }

    /// Brings frames and axes to `posture`; torques are unknown until the next [`JointTorques::apply`]. Does not allocate.
    ///
    /// # Errors
    /// [`PostureError`] when the posture does not fit the model; nothing has changed then.
    pub fn place(&mut self, model: &Model, posture: &Posture) -> Result<(), PostureError> {
        self.kinematics.update(model, posture)?;
        self.posture.values_mut().copy_from_slice(posture.values());
        self.computed = Quantities::default();
        if let Some(muscles) = &mut self.muscles {
            muscles.update(model, posture, &self.kinematics)?;
        }
        Ok(())
    }

    /// Computes `quantities` for `loads` in the posture that the body was placed in. Does not allocate once it has had as many loads.
    ///
    /// # Errors
    /// As [`JointTorques::update`].
    pub fn apply(&mut self, model: &Model, loads: &[Load], quantities: Quantities) -> Result<(), JointTorquesError> {
        self.begin(model, loads, quantities)?;
        self.finish(model, quantities, None)
    }

    /// Takes the loads, and computes passive torque.
    fn begin(&mut self, model: &Model, loads: &[Load], quantities: Quantities) -> Result<(), JointTorquesError> {
        self.loads.clear();
        self.loads.extend_from_slice(loads);
        self.computed = Quantities::default();
        if quantities.passive_torque {
            self.passive.update(model, &self.kinematics)?;
            if let Some(muscles) = &self.muscles {
                let [of_coordinates, about_axes] = muscles.passive_torques();
                self.passive.add(of_coordinates, about_axes);
            }
        }
        Ok(())
    }

    /// As [`JointTorques::apply`], with the contact forces among the loads that keep the root in equilibrium at least effort; they
    /// are written to `contact`. External and passive torque are computed in any case.
    ///
    /// # Errors
    /// As [`JointTorques::update`].
    pub fn apply_with_contact(
        &mut self,
        model: &Model,
        loads: &[Load],
        contact: &mut ContactForces,
        quantities: Quantities,
    ) -> Result<(), JointTorquesError> {
        self.apply(model, loads, Quantities::TORQUES)?;
        contact.update(model, self.kinematics_by_axes(), self.passive.angles(), &self.active);
        self.loads.extend_from_slice(contact.loads());
        self.finish(model, Quantities::TORQUES.with(quantities), None)
    }

    /// Computes the external torque of `self.loads` and of `inertia`, and the quantities that depend on it.
    fn finish(
        &mut self,
        model: &Model,
        quantities: Quantities,
        inertia: Option<&Inertia>,
    ) -> Result<(), JointTorquesError> {
        if quantities.needs_external_torque() {
            match inertia {
                Some(inertia) => inertia.external_torque(model, &self.kinematics, &self.loads, &mut self.external)?,
                None => self.external.update(model, &self.kinematics, &self.loads)?,
            }
        } else if quantities.center_of_mass {
            self.center_of_mass.update(model, &self.kinematics);
        }
        if quantities.gradient {
            self.external.gradient(model, &self.kinematics, &mut self.gradient);
        }
        if quantities.about_axes() {
            if let Some(axes) = &mut self.axes {
                axes.update(model, &self.posture, &self.loads, quantities.gradient)?;
            }
            let external = self.axes.as_ref().map_or(self.external.torques(), |axes| axes.external().torques());
            let torques = external.iter().zip(self.passive.about_axes());
            for (active, (external, passive)) in self.active.iter_mut().zip(torques) {
                *active = active_torque(*external, *passive);
            }
        }
        self.computed = quantities;
        Ok(())
    }

    /// The posture of the last update.
    pub fn posture(&self) -> &Posture {
        &self.posture
    }

    /// Frames and axes.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// The loads of the last update, then its contact forces, or the loads of inertia.
    pub fn loads(&self) -> &[Load] {
        &self.loads
    }

    /// The centre of mass.
    ///
    /// # Panics
    /// When the last update did not compute it.
    pub fn center_of_mass(&self) -> &CenterOfMass {
        let with_torque = self.computed.needs_external_torque();
        assert!(self.computed.center_of_mass || with_torque, "the last update left the centre of mass out");
        // External torque comes with the same sums.
        if with_torque { self.external.center_of_mass() } else { &self.center_of_mass }
    }

    /// External torque, contact forces included, N m.
    ///
    /// # Panics
    /// When the last update did not compute it.
    pub fn external_torque(&self) -> &ExternalTorque {
        assert!(self.computed.needs_external_torque(), "the last update left the external torque out");
        &self.external
    }

    /// Gradient of the external torque, N m/rad.
    ///
    /// # Panics
    /// When the last update did not compute it.
    pub fn gradient(&self) -> &Gradient {
        assert!(self.computed.gradient, "the last update left the gradient of external torque out");
        &self.gradient
    }

    /// Passive torque, N m.
    ///
    /// # Panics
    /// When the last update did not compute it.
    pub fn passive_torque(&self) -> &PassiveTorque {
        assert!(self.computed.passive_torque, "the last update left the passive torque out");
        &self.passive
    }

    /// The angles of all coordinates, rad or m: those of a three-axis joint about its axes.
    ///
    /// # Panics
    /// When the last update did not compute passive torque, which is a function of them.
    pub fn angles(&self) -> &[f64] {
        self.passive_torque().angles()
    }

    /// External torque of every rate, contact forces included, N m: of the coordinates of a three-axis joint about the axes that
    /// stand for them.
    ///
    /// # Panics
    /// When the last update did not compute it.
    pub fn external_about_axes(&self) -> &[f64] {
        assert!(self.computed.about_axes(), "the last update left external or passive torque out");
        let of_coordinates = self.external_torque().torques();
        self.axes.as_ref().map_or(of_coordinates, |axes| axes.external().torques())
    }

    /// Derivatives of the external torque, N m/rad, by rotations about the axes of three-axis joints and by the rates of all other coordinates.
    ///
    /// # Panics
    /// When the last update did not compute it.
    pub fn gradient_about_axes(&self) -> &Gradient {
        assert!(self.computed.about_axes(), "the last update left external or passive torque out");
        let of_coordinates = self.gradient();
        self.axes.as_ref().map_or(of_coordinates, AboutAxes::gradient)
    }

    /// External and passive torque of a rate about its axis, N m.
    ///
    /// # Panics
    /// When the last update did not compute both.
    pub(crate) fn external_and_passive(&self, rate: usize) -> (f64, f64) {
        (self.external_about_axes()[rate], self.passive_torque().about_axes()[rate])
    }

    /// Active torque of every rate about its axis (Eq. 1), N m (N for slides).
    ///
    /// # Panics
    /// When the last update did not compute external and passive torque, and those about axes.
    pub fn active_torque(&self) -> &[f64] {
        assert!(self.computed.about_axes(), "the last update left external or passive torque out");
        &self.active
    }

    /// Frames of the body with a ball for each three-axis joint ([`Model::by_axes`]), to which the derivatives about axes belong.
    ///
    /// # Panics
    /// When the last update did not compute torques about axes.
    pub fn kinematics_by_axes(&self) -> &Kinematics {
        self.axes.as_ref().map_or(&self.kinematics, AboutAxes::kinematics)
    }

    /// Slope of the external torque of a rate about its axis when that joint alone turns about it, N m/rad.
    ///
    /// # Panics
    /// As [`JointTorques::external_about_axes`].
    pub(crate) fn own_slope_about_axis(&self, model: &Model, rate: usize) -> f64 {
        let external = self.axes.as_ref().map_or_else(|| self.external_torque(), AboutAxes::external);
        external.own_slope(self.kinematics_by_axes(), model.by_axes(), rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn active_torque_of_external_3_and_passive_minus_1_is_minus_2() {
        assert_eq!(active_torque(3.0, -1.0), -2.0);
    }

    #[test]
    fn effort_of_loads_a_half_and_two_is_four_and_a_quarter() {
        assert_eq!(effort(&[0.5, -2.0]), 4.25);
        assert_eq!(effort(&[]).to_bits(), 0.0f64.to_bits());
    }
}
