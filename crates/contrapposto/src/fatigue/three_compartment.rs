//! Computes how the active, resting and fatigued shares of a muscle group change under load.
//!
//! Three-compartment controller with rest recovery, 3CC-r (Xia & Frey-Law 2008; Frey-Law, Looft & Heitsman 2012; Looft et
//! al. 2018), all rates in 1/s:
//! `MA' = C - F MA`, `MR' = -C + Rr MF`, `MF' = F MA - Rr MF`, with the controller
//! `C = L (TL - MA)` below the target if enough rests, `L MR` if not, `L (TL - MA)` above; `Rr = r R` at rest, `R` else.
//! Older codes use `r R` whenever `MA >= TL`, which speeds recovery up during a constant hold; we do not.

use super::REST_LOAD;
use serde::{Deserialize, Serialize};

/// Rate of development and relaxation `LD = LR`, 1/s (the published value for both).
const DRIVE: f64 = 10.0;

/// Longest integration step, s: half of the controller's time constant.
const STEP: f64 = 0.05;

/// Longest time under one load, s: more than a day, after which every group stands at its steady state.
const LONGEST_TIME: f64 = 1e5;

/// Rates of one muscle group.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreeCompartment {
    /// Name of the parameters, for output: `knee`, `knee_extensor, male`.
    pub name: String,
    /// Fatigue rate `F`, 1/s.
    pub fatigue_rate: f64,
    /// Recovery rate `R`, 1/s.
    pub recovery_rate: f64,
    /// Multiplier `r` of the recovery rate at rest.
    pub rest_multiplier: f64,
}

/// Shares of the group; they add up to one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compartments {
    /// `MA`, carrying load.
    pub active: f64,
    /// `MR`, able to.
    pub resting: f64,
    /// `MF`, not able to.
    pub fatigued: f64,
}

impl Compartments {
    /// Fatigue `level` (0..=1) under relative load `load`: `MF = level (1 - TL)`, the load already carried as far as it can be.
    pub fn with_fatigue(level: f64, load: f64) -> Self {
        let load = load.clamp(0.0, 1.0);
        Self::of(load, level.clamp(0.0, 1.0) * (1.0 - load))
    }

    /// The rest of one rests; rounding and the last step of the integration leave no share outside 0..=1.
    fn of(active: f64, fatigued: f64) -> Self {
        let fatigued = fatigued.clamp(0.0, 1.0);
        let active = active.clamp(0.0, 1.0 - fatigued);
        Self { active, resting: (1.0 - active - fatigued).max(0.0), fatigued }
    }

    /// `MF / (1 - TL)`, at most 1: the load fails when `MA + MR < TL`.
    pub fn level(self, load: f64) -> f64 {
        let spare = 1.0 - load;
        if spare <= self.fatigued { 1.0 } else { (self.fatigued / spare).clamp(0.0, 1.0) }
    }
}

impl ThreeCompartment {
    /// The shares after `seconds` under relative load `load`. Runge-Kutta of fourth order, steps of 0.05 s at most: whatever
    /// the load does, the fatigued share is off by less than 1e-6, the active one by less than 1e-3, and that only while the
    /// controller catches up with a jump of the load. More than 1e5 s count as that.
    pub fn advance(&self, start: Compartments, load: f64, seconds: f64) -> Compartments {
        let load = load.clamp(0.0, 1.0);
        let seconds = seconds.clamp(0.0, LONGEST_TIME);
        let steps = (seconds / STEP).ceil().max(1.0);
        let h = seconds / steps;
        let (mut active, mut fatigued) = (start.active, start.fatigued);
        for _ in 0..steps as u64 {
            let k1 = self.rates(active, fatigued, load);
            let k2 = self.rates(active + 0.5 * h * k1.0, fatigued + 0.5 * h * k1.1, load);
            let k3 = self.rates(active + 0.5 * h * k2.0, fatigued + 0.5 * h * k2.1, load);
            let k4 = self.rates(active + h * k3.0, fatigued + h * k3.1, load);
            active += h / 6.0 * (k1.0 + 2.0 * (k2.0 + k3.0) + k4.0);
            fatigued += h / 6.0 * (k1.1 + 2.0 * (k2.1 + k3.1) + k4.1);
        }
        Compartments::of(active, fatigued)
    }

    /// `(MA', MF')`; `MR` follows from the sum.
    fn rates(&self, active: f64, fatigued: f64, load: f64) -> (f64, f64) {
        let resting = 1.0 - active - fatigued;
        let missing = load - active;
        let drive = if missing > 0.0 { DRIVE * missing.min(resting) } else { DRIVE * missing };
        let recovery = if load <= REST_LOAD { self.rest_multiplier * self.recovery_rate } else { self.recovery_rate };
        (drive - self.fatigue_rate * active, self.fatigue_rate * active - recovery * fatigued)
    }

    /// The share `MF` under constant relative load `load` in the end: `MF' = 0` with `MA = TL`, or all of the group where the load
    /// fails before.
    pub(crate) fn steady_fatigue(&self, load: f64) -> f64 {
        let load = load.clamp(0.0, 1.0);
        let recovery = if load <= REST_LOAD { self.rest_multiplier * self.recovery_rate } else { self.recovery_rate };
        (self.fatigue_rate * load / recovery).min(1.0)
    }

    /// Time a rested group holds a constant load, s, the controller's ramp ignored:
    /// `T = -ln(1 - R (1 - TL) / (F TL)) / R`, infinite if `TL <= R / (F + R)` (data sheet B3, our algebra).
    pub fn endurance_time(&self, load: f64) -> f64 {
        self.time_left(0.0, load)
    }

    /// The load of which that time is `seconds`: `TL = R / (R + F (1 - exp(-R T)))`.
    pub(crate) fn load_held_for(&self, seconds: f64) -> f64 {
        let recovered = -(-self.recovery_rate * seconds.max(0.0)).exp_m1();
        if recovered == 0.0 {
            return 1.0 / (1.0 + self.fatigue_rate * seconds.max(0.0));
        }
        self.recovery_rate / (self.recovery_rate + self.fatigue_rate * recovered)
    }

    /// The same for a group with fatigue `level`, which `MF' = F TL - R MF` carries from `level (1 - TL)` to `1 - TL`.
    pub(crate) fn time_left(&self, level: f64, load: f64) -> f64 {
        if load >= 1.0 || level >= 1.0 {
            return 0.0;
        }
        let share = self.recovery_rate * (1.0 - load) / (self.fatigue_rate * load);
        if load <= 0.0 || share >= 1.0 {
            return f64::INFINITY;
        }
        ((-share * level.max(0.0)).ln_1p() - (-share).ln_1p()) / self.recovery_rate
    }
}
