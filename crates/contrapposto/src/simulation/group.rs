//! What is remembered of one muscle group?

use serde::{Deserialize, Serialize};

use crate::fatigue::FatigueState;
use crate::hybrid::{Outcome, Strategy};

/// One muscle group over time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct GroupState {
    pub(super) fatigue: Option<FatigueState>,
    pub(super) recovering: bool,
    /// Relative load when its present recovery began.
    pub(super) load_at_trip: f64,
    /// The strategy its present recovery ended up with (docs/deviations.md, D4).
    pub(super) accepted: Option<Strategy>,
    /// How often its relief was taken back.
    pub(super) taken_back: u32,
    /// Which kind of relief leads it now, and how many decisions in a row asked for the other.
    pub(super) led: Option<Strategy>,
    pub(super) contrary: u32,
}

/// So many decisions in a row turn a relief round.
const REPEATED: u32 = 30;

impl GroupState {
    /// Is a decision to be followed that asks for another kind of relief than this recovery began with? The slope that it
    /// extrapolates jumps where a foot's edge begins or ends to carry, so only if it is repeated.
    pub(super) fn believes(&mut self, outcome: Outcome) -> bool {
        let kind = match outcome {
            Outcome::Active => Some(Strategy::Active),
            Outcome::Passive | Outcome::AtLimit => Some(Strategy::Passive),
            Outcome::Stay | Outcome::None => None,
        };
        let contrary = kind.is_some() && self.led.is_some() && kind != self.led;
        self.contrary = if contrary { self.contrary + 1 } else { 0 };
        let follow = self.contrary == 0 || self.contrary > REPEATED;
        if follow {
            (self.contrary, self.led) = (0, kind.or(self.led));
        }
        follow
    }

    /// Keeps the first strategy that led somewhere; from active it may fall back to passive once, never the other way.
    pub(super) fn accept(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Active if self.accepted.is_none() => self.accepted = Some(Strategy::Active),
            Outcome::Passive | Outcome::AtLimit => self.accepted = Some(Strategy::Passive),
            _ => {}
        }
    }
}
