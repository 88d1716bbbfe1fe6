//! Holds and computes the load of one muscle group.

use serde::{Deserialize, Serialize};

use crate::model::{Coordinate, MuscleGroup, Side};

/// A muscle group at work.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroupLoad {
    /// Coordinate of the group.
    pub coordinate: usize,
    /// The group of the coordinate, by the sign of its torque.
    pub side: Side,
    /// Active torque, N m, about the axis of the coordinate.
    pub torque: f64,
    /// `|torque|` over strength.
    pub load: f64,
}

/// Relative load of a coordinate at `angle` (rad; [`super::JointTorques::angles`]): `|active|` (N m, about its axis) over the strength of
/// the muscle group that gives it; 0 for a coordinate of unknown strength.
pub fn relative_load(coordinate: &Coordinate, angle: f64, active: f64) -> f64 {
    let strength = |groups: &[MuscleGroup; 2]| groups[Side::of(active).index()].strength.torque(angle);
    coordinate.groups.as_ref().map_or(0.0, |groups| active.abs() / strength(groups))
}
