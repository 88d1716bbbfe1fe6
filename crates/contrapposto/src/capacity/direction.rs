//! Finds the greatest force in one direction, the contact forces beside it, and what limits it.
//!
//! The share of a limit is the relative change of the force per relative change of that limit (an elasticity), from the multipliers `y` of
//! the equations `A x = b`: `S |y| / s` for a strength, the sum of `c max(-y . A_m, 0) / s` over the muscles that work for a group, `-y . (dA/dp) x p / s` for a coefficient of friction, and for the size of all patches about
//! their middles, which stands for balance.

use nalgebra::Vector3;

use super::Capacity;
use super::program::Program;
use super::tolerances::{LEAST_SHARE, NO_LIMIT, WIDEST_GAP};
use crate::math::Optimum;
use crate::model::Side;

/// A thing that limits a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limiter {
    /// The strength of a muscle group.
    Strength {
        /// Coordinate of the group.
        coordinate: usize,
        /// The group of the coordinate, by the sign of its torque.
        side: Side,
    },
    /// Balance: the body would tip over an edge of its supports, or leave them.
    Balance,
    /// Friction: a support would slip.
    Friction,
}

/// A limit of a force, with its share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The limit.
    pub by: Limiter,
    /// Relative change of the force per relative change of a strength, of the friction of all supports, or of the size of all
    /// patches.
    pub share: f64,
}

/// The greatest force in a direction.
#[derive(Clone, Debug, PartialEq)]
pub struct GreatestForce {
    /// The direction in which the body pushes, ground axes, of unit length.
    pub direction: Vector3<f64>,
    /// The force, N; infinite where nothing limits it.
    pub force: f64,
    /// Every force `f` (N, ground axes) that the body can exert at the point has `normal . f <= force`; `normal . direction = 1`. Zero where
    /// nothing limits the force.
    pub normal: Vector3<f64>,
    /// Limits, the one with the largest share first. [`Limiter::Balance`] alone where more of nothing else would help.
    pub limits: Vec<Limit>,
    /// Contact forces on the body beside that force, by corner in the order of the supports, ground axes, N.
    pub contact: Vec<Vector3<f64>>,
    /// Distance of dual and primal value, as a share of the force (of 1 N, if that is more): zero but for rounding.
    pub gap: f64,
}

impl Capacity {
    /// The greatest force along `direction` (ground axes, any length).
    pub fn in_direction(&mut self, direction: &Vector3<f64>) -> GreatestForce {
        let direction = direction.normalize();
        let column = self.program.column(&direction);
        let optimum = self.program.maximise(&column).filter(|found| self.program.gap(found) <= WIDEST_GAP);
        let optimum = optimum.unwrap_or_else(|| {
            self.program.linear.clone_from(&self.at_rest.linear);
            self.program.maximise(&column).unwrap_or_default()
        });
        self.program.greatest_force(direction, &optimum)
    }
}

impl Program {
    fn maximise(&mut self, column: &[f64]) -> Option<Optimum> {
        self.linear.maximise_with_column(&self.cost, self.cost.len() - 1, column)
    }

    fn gap(&self, found: &Optimum) -> f64 {
        found.gap.abs() / found.value.max(self.weight.recip())
    }

    fn greatest_force(&self, direction: Vector3<f64>, found: &Optimum) -> GreatestForce {
        let force = found.value * self.weight;
        let mut contact = vec![Vector3::zeros(); self.axes.len()];
        for (edge, &unknown) in self.edges.iter().zip(found.unknowns.get(self.pulls..).unwrap_or_default()) {
            let axes = edge.parts.iter().zip(&self.axes[edge.corner]);
            contact[edge.corner] +=
                self.weight * edge.force(unknown) * axes.map(|(part, axis)| *part * axis).sum::<Vector3<f64>>();
        }
        let unlimited = force >= NO_LIMIT * (1.0 - LEAST_SHARE);
        GreatestForce {
            direction,
            force: if unlimited { f64::INFINITY } else { force },
            normal: if unlimited { Vector3::zeros() } else { self.normal(&found.multipliers) },
            limits: if unlimited { vec![] } else { self.limits(found) },
            contact,
            gap: self.gap(found),
        }
    }

    /// The limits with their shares.
    fn limits(&self, found: &Optimum) -> Vec<Limit> {
        let y = &found.multipliers;
        let size = found.value.max(f64::MIN_POSITIVE);
        let mut limits: Vec<Limit> = vec![];
        for (row, y) in self.rows.iter().zip(y) {
            let Some(joint) = row.joint else { continue };
            // A larger right side is a smaller lower bound: the negative group would give more.
            let side = if *y > 0.0 { Side::Negative } else { Side::Positive };
            let share = joint.strength[side.index()] * row.scale * y.abs() / size;
            limits.push(Limit { by: Limiter::Strength { coordinate: joint.coordinate, side }, share });
        }
        for muscle in &self.muscles {
            let Some((coordinate, side)) = muscle.works_for else { continue };
            let gain: f64 = muscle.column.iter().zip(y).map(|(entry, y)| -y * entry).sum();
            let (by, share) = (Limiter::Strength { coordinate, side }, gain.max(0.0) * muscle.capacity / size);
            match limits.iter_mut().find(|limit| limit.by == by) {
                Some(limit) => limit.share += share,
                None => limits.push(Limit { by, share }),
            }
        }
        let (mut friction, mut patch) = (0.0, 0.0);
        for (edge, &unknown) in self.edges.iter().zip(found.unknowns.get(self.pulls..).unwrap_or_default()) {
            let against = |other: &[f64]| -> f64 {
                edge.column.iter().zip(other).zip(y).map(|((own, other), y)| y * (own - other)).sum()
            };
            let force = edge.force(unknown) / size;
            friction -= if edge.limited { against(&edge.without_friction) * force } else { 0.0 };
            patch -= against(&edge.at_middle) * force;
        }
        limits.push(Limit { by: Limiter::Balance, share: patch });
        limits.push(Limit { by: Limiter::Friction, share: friction });
        limits.retain(|limit| limit.share > LEAST_SHARE);
        limits.sort_by(|a, b| b.share.total_cmp(&a.share));
        if limits.is_empty() {
            limits.push(Limit { by: Limiter::Balance, share: 0.0 });
        }
        limits
    }
}
