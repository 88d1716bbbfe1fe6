//! What do tasks need to know of a posture? Everything that depends on it, computed once for all of them.

use crate::kinematics::{CenterOfMass, Kinematics};
use crate::model::Model;
use crate::posture::{Posture, PostureError};
use crate::statics::{ExternalTorque, Gradient, Load, LoadError, PassiveTorqueError};

/// What must be computed beyond frames and axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// The centre of mass.
    pub center_of_mass: bool,
    /// External torque and its gradient.
    pub torque: bool,
}

impl Needs {
    /// What either needs.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self { center_of_mass: self.center_of_mass || other.center_of_mass, torque: self.torque || other.torque }
    }
}

/// Why a posture or a load was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BodyError {
    /// The posture does not fit the model.
    #[error(transparent)]
    Posture(#[from] PostureError),
    /// A load does not fit the model.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A passive law gives no torque in the posture.
    #[error(transparent)]
    Passive(#[from] PassiveTorqueError),
}

/// A model in a posture. Depends on posture and loads; filled by [`Body::update`].
#[derive(Clone, Debug)]
pub struct Body {
    posture: Posture,
    kinematics: Kinematics,
    center_of_mass: CenterOfMass,
    external_torque: ExternalTorque,
    gradient: Gradient,
    /// What the last update computed.
    known: Needs,
}

impl Body {
    /// Space for `model`, at its default posture; knows frames and axes only.
    pub fn new(model: &Model) -> Self {
        Self {
            posture: model.default_posture(),
            kinematics: Kinematics::new(model),
            center_of_mass: CenterOfMass::new(model),
            external_torque: ExternalTorque::new(model),
            gradient: Gradient::new(model),
            known: Needs::default(),
        }
    }

    /// Brings everything that is needed to `posture`. Does not allocate.
    ///
    /// # Errors
    /// [`BodyError`] when posture or loads do not fit the model. After a refused posture nothing has changed; after a refused
    /// load only frames and axes are known.
    pub fn update(&mut self, model: &Model, posture: &Posture, loads: &[Load], needs: Needs) -> Result<(), BodyError> {
        self.kinematics.update(model, posture)?;
        self.posture.values_mut().copy_from_slice(posture.values());
        self.known = Needs::default();
        if needs.torque {
            self.external_torque.update(model, &self.kinematics, loads)?;
            self.external_torque.gradient(model, &self.kinematics, &mut self.gradient);
        } else if needs.center_of_mass {
            self.center_of_mass.update(model, &self.kinematics);
        }
        self.known = needs;
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

    /// The centre of mass.
    ///
    /// # Panics
    /// When the last update was not told that it is needed.
    pub fn center_of_mass(&self) -> &CenterOfMass {
        assert!(self.known.center_of_mass || self.known.torque, "the last update left the centre of mass out");
        // Torques come with the same sums.
        if self.known.torque { self.external_torque.center_of_mass() } else { &self.center_of_mass }
    }

    /// External torque, N m.
    ///
    /// # Panics
    /// When the last update was not told that it is needed.
    pub fn external_torque(&self) -> &ExternalTorque {
        assert!(self.known.torque, "the last update left the external torque out");
        &self.external_torque
    }

    /// Gradient of the external torque, N m/rad.
    ///
    /// # Panics
    /// When the last update was not told that it is needed.
    pub fn gradient(&self) -> &Gradient {
        assert!(self.known.torque, "the last update left the external torque out");
        &self.gradient
    }
}
