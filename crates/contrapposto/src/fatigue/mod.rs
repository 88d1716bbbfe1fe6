//! Computes the fatigue of a muscle group, and decides when the group must rest.
//!
//! Two laws, one scale: fatigue is 0 rested and 1 when the present load can no longer be held, so thresholds mean the same
//! for both. A motor has no law: it holds every load up to its strength for ever, and none above. Load is relative: |active
//! torque| over strength at the present angle. This module knows nothing of posture.

use serde::{Deserialize, Serialize};

mod cycle;
mod endurance;
mod hysteresis;
mod interval;
mod linear_step;
mod load_history;
mod repeated;
mod three_compartment;

pub use cycle::LoadCycle;
pub use endurance::{Endurance, EnduranceCurve, EnduranceForm};
pub use hysteresis::Hysteresis;
pub use interval::Interval;
use linear_step::{LinearStep, Shares};
pub use load_history::LoadHistory;
pub use repeated::{Breaks, Repeated, Repetition};
pub use three_compartment::{Compartments, ThreeCompartment};

/// Relative load at or below which a group counts as resting (3CC-r: Looft et al. 2018; the same for the integral).
pub const REST_LOAD: f64 = 0.01;

/// Law by which a muscle group tires and recovers.
#[derive(Clone, Debug, PartialEq)]
pub enum FatigueLaw {
    /// Three-compartment controller with rest recovery (3CC-r).
    ThreeCompartment(ThreeCompartment),
    /// Integral of time over endurance time.
    Endurance(Endurance),
    /// None: a motor. It is exhausted while its load is above its strength, and rested otherwise.
    Tireless,
}

/// Fatigue of a group at a time. Depends on the history of its load; filled by [`FatigueLaw::advance`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum FatigueState {
    /// State of 3CC-r.
    Compartments(Compartments),
    /// State of the integral, 0..=1.
    Share(f64),
}

impl FatigueLaw {
    /// Name of the parameters or of the endurance curve.
    pub fn name(&self) -> &str {
        match self {
            Self::ThreeCompartment(law) => &law.name,
            Self::Endurance(law) => &law.curve.name,
            Self::Tireless => "none (does not tire)",
        }
    }

    /// A group with fatigue `level` (0..=1) under relative load `load`.
    pub fn start(&self, level: f64, load: f64) -> FatigueState {
        match self {
            Self::ThreeCompartment(_) => FatigueState::Compartments(Compartments::with_fatigue(level, load)),
            Self::Endurance(_) => FatigueState::Share(level.clamp(0.0, 1.0)),
            Self::Tireless => FatigueState::Share(overload(load)),
        }
    }

    /// The state after `seconds` under relative load `load` (>= 0).
    pub fn advance(&self, state: FatigueState, load: f64, seconds: f64) -> FatigueState {
        match (self, state) {
            (Self::ThreeCompartment(law), FatigueState::Compartments(c)) => {
                FatigueState::Compartments(law.advance(c, load, seconds))
            }
            (Self::Endurance(law), FatigueState::Share(share)) => {
                FatigueState::Share(law.advance(share, load, seconds))
            }
            (Self::Tireless, _) => self.start(0.0, load),
            // A state of the other law can only come from a caller's mix-up: it starts rested.
            (law, _) => law.advance(law.start(0.0, load), load, seconds),
        }
    }

    /// Time a rested group can hold a constant relative load, s; infinite if for ever.
    pub fn endurance_time(&self, load: f64) -> f64 {
        match self {
            Self::ThreeCompartment(law) => law.endurance_time(load),
            Self::Endurance(law) => law.curve.time(load),
            Self::Tireless if load > 1.0 => 0.0,
            Self::Tireless => f64::INFINITY,
        }
    }

    /// Greatest relative load (0..=1) that a rested group can hold for `seconds`: the inverse of [`FatigueLaw::endurance_time`].
    pub fn load_held_for(&self, seconds: f64) -> f64 {
        match self {
            Self::ThreeCompartment(law) => law.load_held_for(seconds),
            Self::Endurance(law) => law.curve.load_held_for(seconds),
            Self::Tireless => 1.0,
        }
    }

    /// Time a group with fatigue `level` (0..=1) can still hold a constant relative load, s; infinite if for ever.
    pub fn time_left(&self, level: f64, load: f64) -> f64 {
        match self {
            Self::ThreeCompartment(law) => law.time_left(level, load),
            Self::Endurance(law) if level < 1.0 => (1.0 - level.max(0.0)) * law.curve.time(load),
            Self::Endurance(_) => 0.0,
            Self::Tireless => self.endurance_time(load),
        }
    }

    /// Whether a group under constant relative load `load` rests to the fatigue `level` (0..=1) in the end, with its fatigue judged at
    /// relative load `judged`.
    pub fn rests(&self, level: f64, load: f64, judged: f64) -> bool {
        match self {
            Self::ThreeCompartment(law) => law.steady_fatigue(load) <= level * (1.0 - judged.clamp(0.0, 1.0)),
            Self::Endurance(_) => load <= REST_LOAD,
            Self::Tireless => judged <= 1.0,
        }
    }
}

impl FatigueLaw {
    /// The change within `seconds` under relative load `load` (>= 0), of a group that does not fail.
    fn linear_step(&self, load: f64, seconds: f64) -> LinearStep {
        match self {
            Self::ThreeCompartment(law) => law.linear_step(load, seconds),
            Self::Endurance(law) => law.linear_step(load, seconds),
            Self::Tireless => LinearStep::of_share(0.0, overload(load)),
        }
    }

    /// The value of `MF`, or of the share, at which fatigue is `level` under relative load `load`.
    fn threshold(&self, level: f64, load: f64) -> f64 {
        match self {
            Self::ThreeCompartment(_) => level * (1.0 - load),
            Self::Endurance(_) | Self::Tireless => level,
        }
    }

    fn shares(&self, state: FatigueState) -> Shares {
        match state {
            FatigueState::Compartments(c) => (c.active, c.fatigued),
            FatigueState::Share(share) => (0.0, share),
        }
    }

    fn state_of(&self, (active, fatigued): Shares) -> FatigueState {
        match self {
            Self::ThreeCompartment(_) => FatigueState::Compartments(Compartments::of(active, fatigued)),
            Self::Endurance(_) | Self::Tireless => FatigueState::Share(fatigued.clamp(0.0, 1.0)),
        }
    }
}

/// Fatigue of a group that does not tire: 1 above its strength, 0 up to it.
fn overload(load: f64) -> f64 {
    if load > 1.0 { 1.0 } else { 0.0 }
}

impl FatigueState {
    /// Fatigue under relative load `load`: 0 rested, 1 when the load can no longer be held.
    pub fn level(self, load: f64) -> f64 {
        match self {
            Self::Compartments(c) => c.level(load),
            Self::Share(share) => share,
        }
    }

    /// Torque still available as a share of strength, under relative load `load`: 1 rested, the load itself at exhaustion.
    pub fn capacity(self, load: f64) -> f64 {
        match self {
            Self::Compartments(c) => 1.0 - c.fatigued,
            Self::Share(share) => 1.0 - share * (1.0 - load.clamp(0.0, 1.0)),
        }
    }
}
