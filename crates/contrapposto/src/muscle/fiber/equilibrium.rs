//! Finds the fibre length at which the forces of fibres and tendon are equal.
//!
//! The imbalance is negative at the shortest length, or the fibres stay there, and not negative where the tendon is slack: Newton's
//! method between these bounds, with bisection where it would leave them. The first length is that of a slightly stretched tendon, as in
//! OpenSim, so that of several equilibria the same one is found.

use super::curves::Curves;
use crate::muscle::tolerances::{EQUILIBRIUM, EQUILIBRIUM_STEPS, FIRST_STRETCH};

/// Fibres of constant width in series with a tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fibers {
    /// Width of the fibres' parallelogram, m.
    pub(super) width: f64,
    /// Shortest length of the fibres, m.
    pub(super) least_length: f64,
    /// m.
    pub(super) optimal_length: f64,
    /// Of the tendon, m.
    pub(super) slack_length: f64,
    /// The tendon does not stretch.
    pub(super) rigid: bool,
    /// N.
    pub(super) max_isometric_force: f64,
}

/// A muscle in equilibrium at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FiberState {
    /// m.
    pub fiber_length: f64,
    /// Cosine of the angle between fibres and tendon.
    pub cos_pennation: f64,
    /// Force of the tendon, N.
    pub tendon_force: f64,
    /// Active force of the fibres along the tendon, N.
    pub active_force: f64,
    /// Passive force of the fibres along the tendon, N.
    pub passive_force: f64,
    /// Derivative of `passive_force` by the path's length, in equilibrium, N/m.
    pub passive_stiffness: f64,
    /// Fibre force along the tendon less tendon force, over the greatest isometric force: zero but for rounding. Not so where a file's passive
    /// curve is negative and larger than the active force: no tendon can hold such fibres, which stay at the length of a slack one.
    pub imbalance: f64,
    /// The fibres are at their shortest length and carry nothing.
    pub shortest: bool,
}

/// Forces of fibres of one length, over the greatest isometric force.
struct Forces {
    cos: f64,
    active: f64,
    passive: f64,
    tendon: f64,
    /// Derivative of the imbalance by fibre length, per m.
    slope: f64,
    /// Derivative of the imbalance by the path's length, per m.
    path_slope: f64,
    /// Derivative of the passive force along the tendon by fibre length, per m.
    passive_slope: f64,
}

impl Forces {
    fn imbalance(&self) -> f64 {
        (self.active + self.passive) * self.cos - self.tendon
    }
}

impl Fibers {
    /// The equilibrium of fibres and tendon at a path length, m, and an activation.
    pub(super) fn solve(&self, curves: &impl Curves, path_length: f64, activation: f64) -> FiberState {
        let forces = |length: f64| self.evaluate(curves, path_length, activation, length);
        let extent = path_length - self.slack_length;
        // Fibre length at which the tendon has its slack length.
        let slack = self.length_of_extent(extent);
        let least = self.least_length;
        if self.rigid {
            let mut forces = forces(slack);
            forces.tendon = ((forces.active + forces.passive) * forces.cos).max(0.0);
            return self.state(slack, &forces, slack <= least);
        }
        let at_least = forces(least);
        if slack <= least || at_least.imbalance() >= 0.0 {
            return self.state(least, &at_least, true);
        }
        let (mut low, mut high) = (least, slack);
        let mut length = self.length_of_extent(extent - FIRST_STRETCH * self.slack_length);
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
        self.state(length, &now, false)
    }

    /// The forces of fibres of a length, m.
    pub(super) fn at(&self, curves: &impl Curves, path_length: f64, activation: f64, length: f64) -> FiberState {
        self.state(length, &self.evaluate(curves, path_length, activation, length), false)
    }

    fn evaluate(&self, curves: &impl Curves, path_length: f64, activation: f64, length: f64) -> Forces {
        let cos = self.cos_pennation(length);
        let relative = length / self.optimal_length;
        let (active, active_slope) = curves.active(relative);
        let (passive, passive_slope) = curves.passive(relative);
        let (tendon, tendon_slope) = match self.slack_length {
            slack if slack > 0.0 => curves.tendon((path_length - length * cos) / slack),
            _ => (0.0, 0.0),
        };
        let fibers = activation * active + passive;
        let fibers_slope = (activation * active_slope + passive_slope) / self.optimal_length;
        let cos_slope = self.width * self.width / (length * length * length * cos);
        let slope = fibers_slope * cos + fibers * cos_slope + tendon_slope / (self.slack_length * cos);
        let path_slope = if self.slack_length > 0.0 { -tendon_slope / self.slack_length } else { 0.0 };
        let passive_slope = passive_slope / self.optimal_length * cos + passive * cos_slope;
        Forces { cos, active: activation * active, passive, tendon, slope, path_slope, passive_slope }
    }

    fn state(&self, length: f64, forces: &Forces, shortest: bool) -> FiberState {
        let most = self.max_isometric_force;
        let carried = if shortest { 0.0 } else { most * forces.cos };
        // The length of fibres at a rigid tendon changes with the path's by the cosine of their angle.
        let stretched = if self.rigid { forces.cos } else { -forces.path_slope / forces.slope };
        FiberState {
            fiber_length: length,
            cos_pennation: forces.cos,
            // The curve of a tendon may go below zero where it is slack.
            tendon_force: match (shortest, self.rigid) {
                (true, true) => 0.0,
                (true, false) => most * forces.tendon.max(0.0),
                (false, _) => most * forces.tendon,
            },
            active_force: carried * forces.active,
            passive_force: carried * forces.passive,
            passive_stiffness: if shortest { 0.0 } else { most * forces.passive_slope * stretched },
            imbalance: if shortest { 0.0 } else { forces.imbalance() },
            shortest,
        }
    }

    /// Length of fibres whose extent along the tendon is given, m; the shortest where it is too small.
    fn length_of_extent(&self, extent: f64) -> f64 {
        let length = libm::hypot(self.width, extent);
        if extent > 0.0 { length.max(self.least_length) } else { self.least_length }
    }

    /// Cosine of the pennation of fibres of a length.
    fn cos_pennation(&self, length: f64) -> f64 {
        if self.width == 0.0 {
            return 1.0;
        }
        let sin = self.width / length;
        ((1.0 - sin) * (1.0 + sin)).max(0.0).sqrt()
    }
}
