//! Which forces on the body pull as the errors of a task do?
//!
//! With weights `w_i` on the errors `r_i` of a task, forces whose generalised forces are `sum w_i grad r_i`. How these change
//! with the posture, the gradient of external torque (Eqs. 7, 8), is then `sum w_i r_i''`.

use nalgebra::Vector3;

use super::{CenterOfMassGoal, Task};
use crate::model::Model;
use crate::statics::{FixedIn, Load, LoadKind};

impl Task {
    /// Adds the loads whose generalised forces are `sum weights_i grad r_i` of its rows. Tasks whose errors are angles between
    /// lines or efforts are left out: their second derivatives are not known here.
    pub(crate) fn pull(&self, model: &Model, weights: &[f64], loads: &mut Vec<Load>) {
        let world = |segment, point, force| Load { segment, point, kind: LoadKind::Force(force, FixedIn::World) };
        let couple = |segment, v| Load { segment, point: Vector3::zeros(), kind: LoadKind::Couple(v, FixedIn::World) };
        let vector = |v: &[f64]| Vector3::new(v[0], v[1], v[2]);
        match self {
            Self::Point(task) => loads.push(world(task.segment, task.point, spread(task.axes, weights))),
            Self::Orientation(task) => loads.push(couple(task.segment, vector(weights))),
            Self::Placement(task) => {
                loads.push(world(task.segment, task.point, vector(weights)));
                loads.push(couple(task.segment, vector(&weights[3..])));
            }
            Self::CenterOfMass(task) => {
                let force = match &task.goal {
                    CenterOfMassGoal::At { axes, .. } => spread(*axes, weights),
                    CenterOfMassGoal::Inside { polygon, .. } => {
                        polygon.iter().zip(weights).map(|(edge, w)| edge.normal * *w).sum()
                    }
                };
                let mass = model.mass();
                for (i, segment) in model.segments().iter().enumerate().filter(|(_, segment)| segment.mass > 0.0) {
                    loads.push(world(i, segment.center_of_mass, force * (segment.mass / mass)));
                }
            }
            Self::LookAt(_) | Self::Distance(_) | Self::Posture(_) | Self::Effort(_) => {}
        }
    }
}

/// The entries of the asked axes back in their places.
fn spread(axes: [bool; 3], weights: &[f64]) -> Vector3<f64> {
    let mut weights = weights.iter();
    Vector3::from_fn(|k, _| if axes[k] { weights.next().copied().unwrap_or(0.0) } else { 0.0 })
}
