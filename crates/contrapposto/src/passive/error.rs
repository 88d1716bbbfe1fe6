//! Errors of passive laws.

/// A parameter of a passive law; prints as its name with its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PassiveParameter {
    /// Angle where the upper spring begins.
    UpperLimit,
    /// Angle where the lower spring begins.
    LowerLimit,
    /// Stiffness of the upper spring.
    UpperStiffness,
    /// Stiffness of the lower spring.
    LowerStiffness,
    /// Width over which a spring sets in.
    Transition,
    /// Torque of an exponential term.
    Torque,
    /// Rate of an exponential term.
    Rate,
    /// Angle of an exponential term.
    Angle,
    /// Stiffness of the linear term.
    Stiffness,
    /// Angle where the linear term is zero.
    NeutralAngle,
    /// The constant term.
    Constant,
    /// Number of exponential terms.
    Terms,
    /// Width of the zone of a linear term near a limit.
    ReshapeZone,
    /// Stiffness of a linear term near a limit.
    ReshapeStiffness,
    /// A limit of the range.
    RangeLimit,
    /// The upper limit of the range.
    UpperRangeLimit,
    /// Joint of a coupled term.
    Joint,
    /// The form of a law.
    Law,
}

impl PassiveParameter {
    /// Name and unit of the parameter; the unit of a number that counts is empty.
    pub fn name_and_unit(self) -> (&'static str, &'static str) {
        match self {
            Self::UpperLimit => ("upper limit", "rad"),
            Self::LowerLimit => ("lower limit", "rad"),
            Self::UpperStiffness => ("upper stiffness", "N m/rad"),
            Self::LowerStiffness => ("lower stiffness", "N m/rad"),
            Self::Transition => ("transition", "rad"),
            Self::Torque => ("torque", "N m"),
            Self::Rate => ("rate", "1/rad"),
            Self::Angle => ("angle", "rad"),
            Self::Stiffness => ("stiffness", "N m/rad"),
            Self::NeutralAngle => ("neutral angle", "rad"),
            Self::Constant => ("constant", "N m"),
            Self::Terms => ("number of exponential terms", ""),
            Self::ReshapeZone => ("reshape zone", "rad"),
            Self::ReshapeStiffness => ("reshape stiffness", "N m/rad"),
            Self::RangeLimit => ("limit of the range", "rad"),
            Self::UpperRangeLimit => ("upper limit of the range", "rad"),
            Self::Joint => ("joint", ""),
            Self::Law => ("law", ""),
        }
    }
}

impl std::fmt::Display for PassiveParameter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.name_and_unit() {
            (name, "") => f.write_str(name),
            (name, unit) => write!(f, "{name} ({unit})"),
        }
    }
}

/// The reason for which a curve was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PassiveError {
    /// A parameter has no meaning.
    #[error("{parameter} is {value}; it must be {accepted}")]
    Parameter {
        /// The parameter.
        parameter: PassiveParameter,
        /// The value given.
        value: f64,
        /// The accepted values.
        accepted: &'static str,
    },
    /// The torque rises with the angle somewhere in the range.
    #[error("passive torque rises at {:.4} deg (slope {slope:+.4} N m/rad); it must fall or stay level over the whole range", angle.to_degrees())]
    Rises {
        /// Angle where it does, rad.
        angle: f64,
        /// Slope there, N m/rad.
        slope: f64,
    },
    /// Torque, slope or energy at a limit of the range is not a number, or beyond 1e150.
    #[error("passive torque is {torque} N m at {:.4} deg; torque, slope and energy must stay within 1e150 over the whole range", angle.to_degrees())]
    NotFinite {
        /// Angle, rad.
        angle: f64,
        /// Torque there.
        torque: f64,
    },
    /// The table's angles are not in order, or too few, or do not cover the range.
    #[error("row {row} of the table: {problem}")]
    Table {
        /// Row, counted from 1.
        row: usize,
        /// The fault.
        problem: &'static str,
    },
}
