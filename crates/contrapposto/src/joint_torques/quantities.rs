//! Names the quantities that an update of joint torques computes.

/// The quantities that an update computes beyond frames and axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quantities {
    /// The centre of mass.
    pub center_of_mass: bool,
    /// External torque.
    pub external_torque: bool,
    /// External torque and its gradient.
    pub gradient: bool,
    /// Passive torque; with external torque, active torque and all torques about axes, too.
    pub passive_torque: bool,
}

impl Quantities {
    /// All of them.
    pub const ALL: Self = Self { center_of_mass: true, external_torque: true, gradient: true, passive_torque: true };
    /// External, passive and active torque, without the gradient.
    pub const TORQUES: Self = Self { center_of_mass: false, gradient: false, ..Self::ALL };

    /// The quantities of both selections together.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            center_of_mass: self.center_of_mass || other.center_of_mass,
            external_torque: self.external_torque || other.external_torque,
            gradient: self.gradient || other.gradient,
            passive_torque: self.passive_torque || other.passive_torque,
        }
    }

    pub(super) fn needs_external_torque(self) -> bool {
        self.external_torque || self.gradient
    }

    pub(super) fn about_axes(self) -> bool {
        self.passive_torque && self.needs_external_torque()
    }
}
