//! Defines the goal of a relief, and remembers the goals that a muscle group has left (docs/deviations.md, D4).

use serde::{Deserialize, Serialize};

use crate::hybrid::{Decision, Outcome, Strategy};
use crate::model::Side;

/// A goal of a coordinate: the kind of posture sought, and the side of the present angle on which it lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Goal {
    pub(super) kind: Strategy,
    /// Positive: above the present angle.
    pub(super) side: Side,
}

impl Goal {
    /// The goal of a decision for a coordinate at `angle`; `None` where the coordinate stays, or is no farther from its goal than
    /// `reach` (rad), which counts as reached.
    pub(super) fn of(decision: &Decision, angle: f64, reach: f64) -> Option<Self> {
        let kind = kind(decision.outcome)?;
        let way = decision.goal? - angle;
        (way.abs() > reach).then(|| Self { kind, side: Side::of(way) })
    }
}

/// The kind of posture that an outcome leads to; `None` where it leads nowhere.
pub(super) fn kind(outcome: Outcome) -> Option<Strategy> {
    match outcome {
        Outcome::Active | Outcome::LeastTorque => Some(Strategy::Active),
        Outcome::Passive | Outcome::AtLimit => Some(Strategy::Passive),
        Outcome::Stay | Outcome::None => None,
    }
}

/// The goals that a group has left in its present recovery: by kind and side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct LeftGoals([[bool; 2]; 2]);

impl LeftGoals {
    pub(super) fn insert(&mut self, goal: Goal) {
        self.0[goal.kind as usize][goal.side.index()] = true;
    }

    pub(super) fn contains(&self, goal: Goal) -> bool {
        self.0[goal.kind as usize][goal.side.index()]
    }
}
