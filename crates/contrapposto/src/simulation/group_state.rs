//! Holds the state of one muscle group: its fatigue, its recovery, and how its relief is sought.

use serde::{Deserialize, Serialize};

use super::goal::LeftGoals;
use super::sample::Attempt;
use crate::fatigue::FatigueState;
use crate::hybrid::{Outcome, Strategy};

/// One muscle group over time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct GroupState {
    pub(super) fatigue: Option<FatigueState>,
    pub(super) recovering: bool,
    /// Relative load when its present recovery began.
    pub(super) load_at_start: f64,
    /// The strategy its present recovery ended up with (docs/deviations.md, D4).
    pub(super) accepted: Option<Strategy>,
    /// The attempt at relief, how often a motion of that attempt was taken back, and decisions in a row without progress.
    pub(super) attempt: Attempt,
    pub(super) rejections: u32,
    pub(super) stalled: u32,
    /// Goals that are not taken up again in the present recovery.
    pub(super) left: LeftGoals,
}

impl GroupState {
    /// Keeps the first strategy that found a goal; from active it may fall back to passive once, never the other way.
    pub(super) fn accept(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Active | Outcome::LeastTorque if self.accepted.is_none() => self.accepted = Some(Strategy::Active),
            Outcome::Passive | Outcome::AtLimit => self.accepted = Some(Strategy::Passive),
            _ => {}
        }
    }

    /// The next decision is free to choose its strategy and its goal.
    pub(super) fn restart(&mut self) {
        let Self { fatigue, recovering, load_at_start, .. } = *self;
        *self = Self { fatigue, recovering, load_at_start, ..Self::default() };
    }

    /// Begins the next attempt.
    pub(super) fn begin(&mut self, attempt: Attempt) {
        (self.attempt, self.rejections, self.stalled) = (attempt, 0, 0);
    }

    /// Begins or ends the recovery, at the relative load `load`.
    pub(super) fn set_recovering(&mut self, recovering: bool, load: f64) {
        if recovering && !self.recovering {
            self.load_at_start = load;
        } else if !recovering {
            self.restart();
        }
        self.recovering = recovering;
    }
}
