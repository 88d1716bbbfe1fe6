//! States the problem of least effort: posture and contact forces that minimise `sum_i (tau_a,i / S_i)^2` under constraints.

use crate::contact::ContactForces;
use crate::model::Model;
use crate::statics::Load;
use crate::tasks::PriorityLevel;
use crate::tasks::body::Body;
use crate::tasks::{Task, share_of_strength};

/// What is asked of posture and contact forces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EffortProblem<'b> {
    pub(crate) model: &'b Model,
    /// Where supports are to stay.
    pub(crate) places: &'b PriorityLevel,
    /// Goals above effort.
    pub(crate) above: &'b [PriorityLevel],
    /// The level of effort.
    pub(crate) effort: &'b PriorityLevel,
    pub(crate) loads: &'b [Load],
    /// Rates that move.
    pub(crate) free: &'b [usize],
    /// Where the supports push; its forces are where a descent begins.
    pub(crate) contact: &'b ContactForces,
}

impl EffortProblem<'_> {
    /// What must hold, besides the root's equilibrium and friction: places of supports, and goals above effort.
    pub(crate) fn goals(&self) -> impl Iterator<Item = &PriorityLevel> {
        std::iter::once(self.places).chain(self.above)
    }

    /// Coordinates whose effort counts, in the order of the errors.
    pub(crate) fn efforts(&self) -> impl Iterator<Item = usize> {
        let coordinates = self.effort.tasks.iter().filter_map(|task| match task {
            Task::Effort(effort) => Some(&effort.coordinates),
            _ => None,
        });
        coordinates.flatten().copied()
    }

    /// Number of unknowns: rates that move, then forces.
    pub(crate) fn unknowns(&self) -> usize {
        self.free.len() + self.contact.forces().len()
    }
}

/// Torque of every rate at one body weight of each unknown force.
pub(crate) fn contact_columns(ask: &EffortProblem<'_>, body: &Body, jacobian: &mut [f64], columns: &mut Vec<f64>) {
    let n = ask.model.rates().len();
    columns.clear();
    for (load, axes) in ask.contact.loads().iter().zip(ask.contact.axes()) {
        body.kinematics().point_jacobian(ask.model, load.segment, load.point, jacobian);
        for axis in axes {
            let force = ask.contact.weight() * axis;
            columns.extend(
                (0..n).map(|k| force.x * jacobian[k] + force.y * jacobian[n + k] + force.z * jacobian[2 * n + k]),
            );
        }
    }
}

/// What contact forces do to the effort of a coordinate, now `error`.
pub(crate) fn fill_force_columns(
    model: &Model,
    body: &Body,
    columns: &[f64],
    coordinate: usize,
    error: f64,
    row: &mut [f64],
) {
    let Some(rate) = model.coordinates()[coordinate].rate else { return };
    let share = share_of_strength(model, body, coordinate, error);
    for (entry, column) in row.iter_mut().zip(columns.chunks_exact(model.rates().len())) {
        *entry = -column[rate] * share;
    }
}
