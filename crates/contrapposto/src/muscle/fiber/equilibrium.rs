//! Finds the fibre length at which the forces of fibres and tendon are equal.
//!
//! The imbalance is negative at the shortest length, or the fibres stay there, and not negative where the tendon is slack: Newton's
//! method between these bounds, with bisection where it would leave them. The first length is that of a slightly stretched tendon, as in
//! OpenSim, so that of several equilibria the same one is found.

use super::{Curves, FiberState, Muscle};
use crate::muscle::tolerances::{EQUILIBRIUM, EQUILIBRIUM_STEPS, FIRST_STRETCH};

/// Forces of fibres of one length, over the greatest isometric force.
struct Forces {
    cos: f64,
    active: f64,
    passive: f64,
    tendon: f64,
    /// Derivative of the imbalance by fibre length, per m.
    slope: f64,
}

impl Forces {
    fn imbalance(&self) -> f64 {
        (self.active + self.passive) * self.cos - self.tendon
    }
}

/// The equilibrium at a path length, m.
pub(super) fn solve(muscle: &Muscle, curves: &impl Curves, path_length: f64, activation: f64) -> FiberState {
    let spec = muscle.spec();
    let forces = |length: f64| evaluate(muscle, curves, path_length, activation, length);
    let extent = path_length - spec.tendon_slack_length;
    let slack = muscle.length_of_extent(extent);
    let least = muscle.least_length;
    if spec.rigid_tendon || spec.tendon_slack_length == 0.0 {
        let mut forces = forces(slack);
        forces.tendon = ((forces.active + forces.passive) * forces.cos).max(0.0);
        return state(muscle, slack, &forces, slack <= least);
    }
    let at_least = forces(least);
    if slack <= least || at_least.imbalance() >= 0.0 {
        return state(muscle, least, &at_least, true);
    }
    let (mut low, mut high) = (least, slack);
    let mut length = muscle.length_of_extent(extent - FIRST_STRETCH * spec.tendon_slack_length);
    let mut now = forces(length);
    for _ in 0..EQUILIBRIUM_STEPS {
        let imbalance = now.imbalance();
        if imbalance.abs() <= EQUILIBRIUM {
            break;
        }
        if imbalance > 0.0 {
            high = length
        } else {
            low = length
        }
        let newton = length - imbalance / now.slope;
        if (newton - length).abs() <= f64::EPSILON * length {
            break;
        }
        length = if newton > low && newton < high { newton } else { f64::midpoint(low, high) };
        now = forces(length);
    }
    state(muscle, length, &now, false)
}

fn evaluate(muscle: &Muscle, curves: &impl Curves, path_length: f64, activation: f64, length: f64) -> Forces {
    let spec = muscle.spec();
    let cos = muscle.cos_pennation(length);
    let relative = length / spec.optimal_fiber_length;
    let (active, active_slope) = curves.active(relative);
    let (passive, passive_slope) = curves.passive(relative);
    let (tendon, tendon_slope) = match spec.tendon_slack_length {
        slack if slack > 0.0 => curves.tendon((path_length - length * cos) / slack),
        _ => (0.0, 0.0),
    };
    let fibers = activation * active + passive;
    let fibers_slope = (activation * active_slope + passive_slope) / spec.optimal_fiber_length;
    let cos_slope = muscle.width * muscle.width / (length * length * length * cos);
    let slope = fibers_slope * cos + fibers * cos_slope + tendon_slope / (spec.tendon_slack_length * cos);
    Forces { cos, active: activation * active, passive, tendon, slope }
}

fn state(muscle: &Muscle, length: f64, forces: &Forces, shortest: bool) -> FiberState {
    let most = muscle.spec().max_isometric_force;
    let carried = if shortest { 0.0 } else { most * forces.cos };
    let rigid = muscle.spec().rigid_tendon || muscle.spec().tendon_slack_length == 0.0;
    FiberState {
        fiber_length: length,
        cos_pennation: forces.cos,
        tendon_force: if shortest && rigid { 0.0 } else { most * forces.tendon },
        active_force: carried * forces.active,
        passive_force: carried * forces.passive,
        imbalance: if shortest { 0.0 } else { forces.imbalance() },
        shortest,
    }
}
