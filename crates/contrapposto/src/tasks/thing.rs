//! Defines things that stand in ground: half-spaces such as the floor or a wall, and blocks such as the top of a table.

use nalgebra::{Isometry3, Vector3};

use super::check::{Check, TaskError, TaskPart};
use crate::model::LARGEST;

/// A thing that no part of the body passes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thing {
    /// All points with `normal . x <= offset`, m, in ground.
    HalfSpace {
        /// Unit normal, out of the thing.
        normal: Vector3<f64>,
        /// Coordinate of the surface along the normal, m.
        offset: f64,
    },
    /// A block with flat faces.
    Block {
        /// Middle and axes of the block in ground.
        placement: Isometry3<f64>,
        /// Half its lengths along its axes, m.
        half: Vector3<f64>,
    },
}

impl Thing {
    /// The half-space below a height, m, of ground axis y.
    pub fn floor(height: f64) -> Self {
        Self::HalfSpace { normal: Vector3::y(), offset: height }
    }

    /// Whether a point of ground is inside the thing.
    pub(crate) fn holds(&self, point: Vector3<f64>) -> bool {
        match self {
            Self::HalfSpace { normal, offset } => normal.dot(&point) <= *offset,
            Self::Block { placement, half } => {
                let inside = placement.inverse_transform_point(&point.into());
                (0..3).all(|axis| inside[axis].abs() <= half[axis])
            }
        }
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        match self {
            Self::HalfSpace { normal, offset } => {
                check.unit(TaskPart::SurfaceNormal, normal.norm())?;
                check.number(TaskPart::SurfaceOffset, *offset)
            }
            Self::Block { placement, half } => {
                check.vector(TaskPart::BlockMiddle, &placement.translation.vector)?;
                let fits = |length: &f64| (0.0..=LARGEST).contains(length);
                match half.iter().find(|length| !fits(length)) {
                    Some(length) => check.refuse(TaskPart::BlockLength, *length, "between 0 and 1e9"),
                    None => Ok(()),
                }
            }
        }
    }
}
