//! Decides when the relief of a muscle group begins and when it ends.
//!
//! Rodriguez & Boulic 2007, section 3: the constraint switches on at a critical level and off at a lower one, which forces
//! a least duration of recovery. The paper gives no numbers.

/// The two thresholds, `recovery_level < critical_level`, both in 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hysteresis {
    /// Fatigue at which a group asks for relief.
    pub critical_level: f64,
    /// Fatigue at or below which it no longer does.
    pub recovery_level: f64,
}

impl Hysteresis {
    /// Whether the group recovers now, given whether it recovered before and its fatigue.
    pub fn recovering(self, was_recovering: bool, fatigue: f64) -> bool {
        if was_recovering { fatigue > self.recovery_level } else { fatigue >= self.critical_level }
    }
}
