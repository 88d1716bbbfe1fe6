//! Units of errors.

use crate::model::Rate;

/// Unit of the error of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A distance.
    Metre,
    /// An angle.
    Radian,
    /// A torque over the strength of the muscle group that gives it.
    ShareOfStrength,
}

impl Unit {
    /// `m`, `rad`, or `1` for shares of strength.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Radian => "rad",
            Self::ShareOfStrength => "1",
        }
    }

    /// Unit of the coordinate that a generalised speed changes.
    pub(crate) fn of(rate: &Rate) -> Self {
        if rate.rotational { Self::Radian } else { Self::Metre }
    }
}
