//! States the problem of least effort in posture and contact forces.
//!
//! `min 1/2 sum_i (tau_a,i / S_i)^2` over the free rates and the contact forces, while the root is in equilibrium, supports stay in
//! place, levels above effort are reached, and contact forces lie in their friction pyramids. The unknowns are the changes of the
//! free rates, then the three components of each contact force in body weights.

use crate::contact::ContactForces;
use crate::joint_torques::JointTorques;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::statics::Load;
use crate::tasks::PriorityLevel;
use crate::tasks::{Task, share_of_strength};

/// A problem of least effort.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EffortProblem<'b> {
    pub(crate) model: &'b Model,
    /// Placements of the supports.
    pub(crate) places: &'b PriorityLevel,
    /// Inequalities above all levels.
    pub(crate) limits: &'b PriorityLevel,
    /// Levels above effort.
    pub(crate) above: &'b [PriorityLevel],
    /// By row of the constraint levels: the error that a descent keeps, as [`Iterate::shortfall`](super::iterate::Iterate::shortfall) gives it;
    /// empty where all rows are to be met.
    pub(crate) shortfall: &'b [f64],
    /// The level of effort.
    pub(crate) effort: &'b PriorityLevel,
    pub(crate) loads: &'b [Load],
    /// Rates that move.
    pub(crate) free: &'b [usize],
    /// Corners, axes and limits of the contact forces; its forces are the start of a descent.
    pub(crate) contact: &'b ContactForces,
}

impl EffortProblem<'_> {
    /// Levels of constraints on the posture: placements of supports, limits, then the levels above effort.
    pub(crate) fn constraint_levels(&self) -> impl Iterator<Item = &PriorityLevel> {
        [self.places, self.limits].into_iter().chain(self.above)
    }

    /// Coordinates whose relative loads count as effort, in the order of the residual.
    pub(crate) fn effort_coordinates(&self) -> impl Iterator<Item = usize> {
        let coordinates = self.effort.tasks.iter().filter_map(|task| match task {
            Task::Effort(effort) => Some(&effort.coordinates),
            _ => None,
        });
        coordinates.flatten().copied()
    }

    /// Number of unknowns: free rates, then forces.
    pub(crate) fn unknowns(&self) -> usize {
        self.free.len() + self.contact.forces().len()
    }

    /// Fills `columns` with the torque of every rate about its axis at one body weight of each unknown force; `kinematics` are those of the body with balls.
    pub(crate) fn contact_columns(&self, kinematics: &Kinematics, jacobian: &mut [f64], columns: &mut Vec<f64>) {
        let n = self.model.rates().len();
        columns.clear();
        for (load, axes) in self.contact.loads().iter().zip(self.contact.axes()) {
            kinematics.point_jacobian(self.model.by_axes(), load.segment, load.point, jacobian);
            for axis in axes {
                let force = self.contact.weight() * axis;
                columns.extend(
                    (0..n).map(|k| force.x * jacobian[k] + force.y * jacobian[n + k] + force.z * jacobian[2 * n + k]),
                );
            }
        }
    }
}

/// Fills `row` with the derivative of a coordinate's relative load, now `residual`, by the contact forces.
pub(crate) fn fill_force_columns(
    model: &Model,
    body: &JointTorques,
    columns: &[f64],
    coordinate: usize,
    residual: f64,
    row: &mut [f64],
) {
    let Some(rate) = model.coordinates()[coordinate].rate else { return };
    let share = share_of_strength(model, body, coordinate, residual);
    for (entry, column) in row.iter_mut().zip(columns.chunks_exact(model.rates().len())) {
        *entry = -column[rate] * share;
    }
}
