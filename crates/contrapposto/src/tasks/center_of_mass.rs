//! Error and Jacobian of the centre of mass against a place or a polygon.
//!
//! At a place: error `c - target` in ground axes, m, on the asked axes. Over a polygon: one inequality an edge,
//! `normal . c <= offset - margin`, error the excess, m.

use nalgebra::Vector3;

use super::check::{Check, TaskError, TaskPart};
use super::polygon::HalfPlane;
use super::rows::{add_along, append, chosen, equations};
use crate::joint_torques::JointTorques;
use crate::model::Model;
use hierarchical_least_squares::Level;

/// The centre of mass at a place, or over a polygon.
#[derive(Clone, Debug, PartialEq)]
pub struct CenterOfMass {
    /// Goal of the centre of mass.
    pub goal: CenterOfMassGoal,
}

/// Goal of the centre of mass: a place, or an area.
#[derive(Clone, Debug, PartialEq)]
pub enum CenterOfMassGoal {
    /// At one place.
    At {
        /// In ground, m.
        target: Vector3<f64>,
        /// Ground axes that are asked for; one at least.
        axes: [bool; 3],
    },
    /// Inside all of some half-planes.
    Inside {
        /// In ground; see [`super::half_planes`].
        polygon: Vec<HalfPlane>,
        /// Least distance from every edge, m; negative allows to leave by as much.
        margin: f64,
    },
}

impl CenterOfMass {
    pub(super) fn rows(&self) -> usize {
        match &self.goal {
            CenterOfMassGoal::At { axes, .. } => axes.iter().filter(|asked| **asked).count(),
            CenterOfMassGoal::Inside { polygon, .. } => polygon.len(),
        }
    }

    fn center(body: &JointTorques) -> Vector3<f64> {
        // A body without mass is refused by `check`.
        body.center_of_mass().position().unwrap_or_else(Vector3::zeros)
    }

    pub(super) fn residual(&self, body: &JointTorques, out: &mut Vec<f64>) {
        let center = Self::center(body);
        match &self.goal {
            CenterOfMassGoal::At { target, axes } => out.extend(chosen(*axes, center - target)),
            CenterOfMassGoal::Inside { polygon, margin } => {
                out.extend(polygon.iter().map(|edge| (edge.excess(&center) + margin).max(0.0)));
            }
        }
    }

    pub(super) fn evaluate(&self, model: &Model, body: &JointTorques, level: &mut Level) {
        let center = Self::center(body);
        let n = model.rates().len();
        match &self.goal {
            CenterOfMassGoal::At { target, axes } => {
                body.center_of_mass().jacobian(model, body.kinematics(), append(level, model, 3));
                equations(level, model, *axes, center - target);
            }
            CenterOfMassGoal::Inside { polygon, margin } => {
                // The edges' rows, then the three they are made of, which are removed again.
                let rows = append(level, model, polygon.len() + 3);
                let (edges, jacobian) = rows.split_at_mut(polygon.len() * n);
                body.center_of_mass().jacobian(model, body.kinematics(), jacobian);
                for (row, edge) in edges.chunks_exact_mut(n.max(1)).zip(polygon) {
                    add_along(row, &edge.normal, jacobian);
                }
                level.matrix.truncate(level.matrix.len() - 3 * n);
                for edge in polygon {
                    level.lower.push(f64::NEG_INFINITY);
                    level.upper.push(-(edge.excess(&center) + margin));
                }
            }
        }
    }

    pub(super) fn check(&self, check: &Check<'_>) -> Result<(), TaskError> {
        match &self.goal {
            CenterOfMassGoal::At { target, axes } => {
                check.vector(TaskPart::Target, target)?;
                check.some(TaskPart::Axis, axes.contains(&true))?;
            }
            CenterOfMassGoal::Inside { polygon, margin } => {
                check.number(TaskPart::Margin, *margin)?;
                check.some(TaskPart::Edge, !polygon.is_empty())?;
                for edge in polygon {
                    check.number(TaskPart::EdgeOffset, edge.offset)?;
                    check.unit(TaskPart::EdgeNormal, edge.normal.norm())?;
                }
            }
        }
        if check.model.mass() > 0.0 { Ok(()) } else { check.unable(check.model.name(), "has no mass") }
    }
}
