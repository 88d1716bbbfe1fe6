//! Holds the state of one muscle group: its fatigue, its recovery, and the strategy that its recovery follows.

use serde::{Deserialize, Serialize};

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
    /// How often a motion for its relief was taken back.
    pub(super) rejections: u32,
    /// The kind of relief that is followed.
    kind: Option<Strategy>,
    /// Decisions for the other kind in a row.
    contrary: u32,
}

/// A recovery changes to the other kind of relief after more than so many contrary decisions in a row.
const CONTRARY_DECISIONS: u32 = 30;

impl GroupState {
    /// Counts a new decision for the strategy hysteresis. The slope that a decision extrapolates jumps where an edge of a foot
    /// begins or ends to carry weight, so a decision for the other kind of relief counts only when it is repeated.
    pub(super) fn count(&mut self, outcome: Outcome) {
        let kind = match outcome {
            Outcome::Active | Outcome::LeastTorque => Some(Strategy::Active),
            Outcome::Passive | Outcome::AtLimit => Some(Strategy::Passive),
            Outcome::Stay | Outcome::None => None,
        };
        let contrary = kind.is_some() && self.kind.is_some() && kind != self.kind;
        self.contrary = if contrary { self.contrary + 1 } else { 0 };
        if self.contrary > CONTRARY_DECISIONS {
            self.contrary = 0;
        }
        if self.contrary == 0 {
            self.kind = kind.or(self.kind);
        }
    }

    /// Whether the decision counted last is to be followed.
    pub(super) fn is_confirmed(&self) -> bool {
        self.contrary == 0
    }

    /// Keeps the first strategy that found a goal; from active it may fall back to passive once, never the other way.
    pub(super) fn accept(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Active | Outcome::LeastTorque if self.accepted.is_none() => self.accepted = Some(Strategy::Active),
            Outcome::Passive | Outcome::AtLimit => self.accepted = Some(Strategy::Passive),
            _ => {}
        }
    }

    /// The next decision is free to choose its strategy.
    pub(super) fn forget_strategy(&mut self) {
        (self.accepted, self.kind) = (None, None);
    }

    /// Begins or ends the recovery, at the relative load `load`.
    pub(super) fn set_recovering(&mut self, recovering: bool, load: f64) {
        if recovering && !self.recovering {
            self.load_at_start = load;
        } else if !recovering {
            self.forget_strategy();
            self.rejections = 0;
        }
        self.recovering = recovering;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_31st_contrary_decision_in_a_row_is_followed() {
        let mut group = GroupState::default();
        group.count(Outcome::Active);
        assert!(group.is_confirmed());
        for _ in 0..30 {
            group.count(Outcome::Passive);
            assert!(!group.is_confirmed());
        }
        group.count(Outcome::Passive);
        assert!(group.is_confirmed());
        group.count(Outcome::AtLimit);
        assert!(group.is_confirmed(), "the kind has changed");
    }

    #[test]
    fn a_decision_of_the_same_kind_ends_the_count_of_contrary_ones() {
        let mut group = GroupState::default();
        [Outcome::Active, Outcome::Passive, Outcome::Active].into_iter().for_each(|outcome| group.count(outcome));
        for _ in 0..30 {
            group.count(Outcome::Passive);
            assert!(!group.is_confirmed());
        }
    }
}
