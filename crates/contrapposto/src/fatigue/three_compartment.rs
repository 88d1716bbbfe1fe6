//! Computes how the active, resting and fatigued shares of a muscle group change under load.
//!
//! Three-compartment controller with rest recovery, 3CC-r (Xia & Frey-Law 2008; Frey-Law, Looft & Heitsman 2012; Looft et
//! al. 2018), all rates in 1/s:
//! `MA' = C - F MA`, `MR' = -C + Rr MF`, `MF' = F MA - Rr MF`, with the controller
//! `C = L (TL - MA)` below the target if enough rests, `L MR` if not, `L (TL - MA)` above; `Rr = r R` at rest, `R` else.
//! Older codes use `r R` whenever `MA >= TL`, which speeds recovery up during a constant hold; we do not.

use super::REST_LOAD;
use super::linear_step::{LinearStep, Shares};
use serde::{Deserialize, Serialize};

/// Rate of development and relaxation `LD = LR`, 1/s (the published value for both).
const DRIVE: f64 = 10.0;

/// Longest integration step, s: half of the controller's time constant.
const STEP: f64 = 0.05;

/// Steps after which the controller has caught up with a constant load of any size to the last bits: nearly 5 s,
/// 49 of its time constants.
const SETTLING: u64 = 100;

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
    pub(crate) fn of(active: f64, fatigued: f64) -> Self {
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
        let (steps, h) = steps(seconds);
        let mut shares = (start.active, start.fatigued);
        for step in 0..steps {
            if step == SETTLING
                && let Some(end) = self.held(shares, load, (steps - step, h))
            {
                shares = end;
                break;
            }
            shares = runge_kutta(shares, h, |active, fatigued| {
                let (missing, resting) = (load - active, 1.0 - active - fatigued);
                self.rates(active, fatigued, load, if missing > 0.0 { missing.min(resting) } else { missing })
            });
        }
        Compartments::of(shares.0, shares.1)
    }

    /// The shares after so many further steps of `h` s, once the controller has caught up with the load: with a constant `MA` the share `MF` goes one
    /// way, so that a group which can carry the load before and after can carry it all the time, and the steps are one affine
    /// map to a power. `None` of a group that cannot.
    fn held(&self, (active, fatigued): Shares, load: f64, (times, h): (u64, f64)) -> Option<Shares> {
        let can = |fatigued: f64| fatigued <= 1.0 - load;
        let end = || {
            let rates = |active: f64, fatigued: f64| self.rates(active, fatigued, load, load - active);
            LinearStep::of(|a, b| runge_kutta((a, b), h, rates)).repeated(times).apply((active, fatigued))
        };
        can(fatigued).then(end).filter(|(_, fatigued)| can(*fatigued))
    }

    /// The same as a step, of a group that does not fail: enough of it rests, so that the controller drives `L (TL - MA)`.
    pub(super) fn linear_step(&self, load: f64, seconds: f64) -> LinearStep {
        let load = load.clamp(0.0, 1.0);
        let (steps, h) = steps(seconds);
        let rates = |active: f64, fatigued: f64| self.rates(active, fatigued, load, load - active);
        LinearStep::of(|active, fatigued| runge_kutta((active, fatigued), h, rates)).repeated(steps)
    }

    /// `(MA', MF')` with a controller that drives `L` times `driven`; `MR` follows from the sum.
    fn rates(&self, active: f64, fatigued: f64, load: f64, driven: f64) -> (f64, f64) {
        let recovery = if load <= REST_LOAD { self.rest_multiplier * self.recovery_rate } else { self.recovery_rate };
        (DRIVE * driven - self.fatigue_rate * active, self.fatigue_rate * active - recovery * fatigued)
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
        let recovered = -libm::expm1(-self.recovery_rate * seconds.max(0.0));
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
        (libm::log1p(-share * level.max(0.0)) - libm::log1p(-share)) / self.recovery_rate
    }
}

/// Number and length (s) of the steps of an integration.
fn steps(seconds: f64) -> (u64, f64) {
    let seconds = seconds.clamp(0.0, LONGEST_TIME);
    let steps = (seconds / STEP).ceil().max(1.0);
    (steps as u64, seconds / steps)
}

/// A step of `h` s of the classical Runge-Kutta method of fourth order, with the rates of two shares.
fn runge_kutta((a, b): (f64, f64), h: f64, rates: impl Fn(f64, f64) -> (f64, f64)) -> (f64, f64) {
    let k1 = rates(a, b);
    let k2 = rates(a + 0.5 * h * k1.0, b + 0.5 * h * k1.1);
    let k3 = rates(a + 0.5 * h * k2.0, b + 0.5 * h * k2.1);
    let k4 = rates(a + h * k3.0, b + h * k3.1);
    let sum = |k1: f64, k2: f64, k3: f64, k4: f64| h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
    (a + sum(k1.0, k2.0, k3.0, k4.0), b + sum(k1.1, k2.1, k3.1, k4.1))
}
