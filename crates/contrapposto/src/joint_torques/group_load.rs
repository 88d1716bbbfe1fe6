//! Holds the load of one muscle group.

use serde::{Deserialize, Serialize};

use crate::model::Side;

/// A muscle group at work.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroupLoad {
    /// Its coordinate.
    pub coordinate: usize,
    /// Which of the two groups of the coordinate.
    pub side: Side,
    /// Active torque, N m, about the axis of the coordinate.
    pub torque: f64,
    /// `|torque|` over strength.
    pub load: f64,
}
