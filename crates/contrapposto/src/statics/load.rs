//! Defines the loads that act on the body besides its own weight.

use nalgebra::Vector3;

use crate::model::{LARGEST, Model};

/// Axes that a force or couple keeps when the body moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FixedIn {
    /// Ground axes: a held weight, a rope to a far point.
    World,
    /// The segment's axes: a thruster, a tool's reaction.
    Segment,
}

/// Kinds of load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadKind {
    /// A mass in kg, pulled by the model's gravity; may be zero.
    Weight(f64),
    /// A force in N.
    Force(Vector3<f64>, FixedIn),
    /// A pure couple in N m; its point does not matter.
    Couple(Vector3<f64>, FixedIn),
}

/// A load on a point of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Index of the segment.
    pub segment: usize,
    /// Point at which the load acts, in the segment's frame, m.
    pub point: Vector3<f64>,
    /// Force, couple or weight.
    pub kind: LoadKind,
}

/// A number of a load; prints as its name with its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadQuantity {
    /// Point of the segment on which the load pulls.
    Point,
    /// Force of a load.
    Force,
    /// Couple of a load.
    Couple,
    /// Mass of a weight.
    Mass,
}

impl std::fmt::Display for LoadQuantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Point => "point (m)",
            Self::Force => "force (N)",
            Self::Couple => "couple (N m)",
            Self::Mass => "mass (kg)",
        })
    }
}

/// The reason for which a load was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// There is no such segment.
    #[error("load on segment number {segment}; the model has {count} segments")]
    Segment {
        /// The index given.
        segment: usize,
        /// Number of segments.
        count: usize,
    },
    /// A number is NaN, infinite or beyond [`LARGEST`], or a mass negative.
    #[error("{quantity} of a load is {value}; it must be {accepted}")]
    Number {
        /// The quantity.
        quantity: LoadQuantity,
        /// The value.
        value: f64,
        /// The values that would be accepted.
        accepted: &'static str,
    },
}

impl Load {
    /// A weight at a segment's centre of mass. A segment that is not there is refused by [`Load::check`].
    pub fn weight(model: &Model, segment: usize, mass: f64) -> Self {
        let point = model.segments().get(segment).map_or(Vector3::zeros(), |s| s.center_of_mass);
        Self { segment, point, kind: LoadKind::Weight(mass) }
    }

    /// Whether the load fits `model`.
    ///
    /// # Errors
    /// [`LoadError`] for a segment that is not there, or a number without meaning.
    pub fn check(&self, model: &Model) -> Result<(), LoadError> {
        let count = model.segments().len();
        if self.segment >= count {
            return Err(LoadError::Segment { segment: self.segment, count });
        }
        let within = |quantity, v: &Vector3<f64>| {
            // Without a branch for each number; NaN is within nothing.
            if (v.x.abs() <= LARGEST) & (v.y.abs() <= LARGEST) & (v.z.abs() <= LARGEST) {
                return Ok(());
            }
            let value = v.iter().copied().find(|x| x.is_nan() || x.abs() > LARGEST).unwrap_or(f64::NAN);
            Err(LoadError::Number { quantity, value, accepted: "finite and at most 1e9 in size" })
        };
        within(LoadQuantity::Point, &self.point)?;
        match &self.kind {
            LoadKind::Force(force, _) => within(LoadQuantity::Force, force),
            LoadKind::Couple(couple, _) => within(LoadQuantity::Couple, couple),
            &LoadKind::Weight(mass) if (0.0..=LARGEST).contains(&mass) => Ok(()),
            &LoadKind::Weight(value) => {
                Err(LoadError::Number { quantity: LoadQuantity::Mass, value, accepted: "between 0 and 1e9" })
            }
        }
    }
}
