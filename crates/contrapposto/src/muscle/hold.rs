//! Holds torques by muscles that tire until the muscles cannot give them any more, or for a given time.
//!
//! Steps of time adapt to the changes of activations ([`MuscleFatigue::advance`]); a step in which a muscle becomes exhausted is short, so
//! that the time of exhaustion is known, and the steps before the failure are halved until its instant is.

use super::fatigue::{MuscleFatigue, SharingError};
use super::shared_torques::{SharedTorques, TorqueLimit};
use super::tolerances::{
    EXHAUSTION_STEP, FIRST_HOLD_STEP, INSTANT, LONGEST_HOLD_STEP, MOST_LOAD_CHANGE, STEADY_FATIGUE,
};
use crate::fatigue::Breaks;

/// The end of a hold.
#[derive(Clone, Debug, PartialEq)]
pub struct MuscleHold {
    /// Time for which the muscles held the torques, s.
    pub seconds: f64,
    /// At its end: multiple of the torques that the muscles can still give, and who limits it.
    pub limit: TorqueLimit,
    /// Whether the muscles failed then; else the given time was over.
    pub failed: bool,
}

/// Holds torques from a rested start for at most `most` seconds, and shows times (s) and muscles to `visit`: at the start, after every step, and
/// at the end. Times of exhaustion are known to 0.1 s, that of failure to 1e-7 s.
///
/// # Errors
/// [`SharingError`] for numbers that cannot be calculated with.
///
/// # Panics
/// As [`MuscleFatigue::share`].
pub fn hold(
    fatigue: &mut MuscleFatigue,
    asked: &SharedTorques<'_>,
    most: f64,
    visit: impl FnMut(f64, &MuscleFatigue),
) -> Result<MuscleHold, SharingError> {
    fatigue.begin(asked)?;
    hold_on(fatigue, asked, most, visit)
}

/// Holds torques from the present state of the muscles with breaks, the first one after `until` seconds, for at most `most` seconds of work. Returns the
/// time of the failure, s of work and breaks; `None` where the muscles hold, or are no more tired at a break than at the one before.
///
/// # Errors
/// As [`hold`].
///
/// # Panics
/// As [`hold`].
pub fn hold_with_breaks(
    fatigue: &mut MuscleFatigue,
    asked: &SharedTorques<'_>,
    (mut until, breaks): (f64, Breaks),
    most: f64,
) -> Result<Option<f64>, SharingError> {
    let (mut time, mut work) = (0.0, 0.0);
    let mut before: Vec<f64> = vec![];
    while work < most {
        let held = hold_on(fatigue, asked, until.min(most - work), |_, _| {})?;
        (time, work) = (time + held.seconds, work + held.seconds);
        if held.failed {
            return Ok(Some(time));
        }
        let tired: Vec<f64> = fatigue.states().iter().map(|state| state.fatigued).collect();
        if !before.is_empty() && tired.iter().zip(&before).all(|(now, before)| *now <= before + STEADY_FATIGUE) {
            return Ok(None);
        }
        fatigue.rest(breaks.rest);
        time += breaks.rest;
        (until, before) = (breaks.work, tired);
    }
    Ok(None)
}

/// As [`hold`], from the present state of the muscles.
///
/// # Errors
/// As [`hold`].
///
/// # Panics
/// As [`hold`].
pub fn hold_on(
    fatigue: &mut MuscleFatigue,
    asked: &SharedTorques<'_>,
    most: f64,
    mut visit: impl FnMut(f64, &MuscleFatigue),
) -> Result<MuscleHold, SharingError> {
    let mut held = fatigue.share(asked)?;
    let (mut time, mut step) = (0.0, FIRST_HOLD_STEP);
    let mut failing = !held;
    visit(time, fatigue);
    while held && time < most {
        let seconds = f64::min(step, most - time);
        let exhausted = fatigue.exhausted();
        match fatigue.advance(asked, seconds)? {
            None if seconds <= INSTANT => held = false,
            None => (step, failing) = (0.5 * seconds, true),
            Some(change) => {
                let coarse = change > MOST_LOAD_CHANGE || fatigue.exhausted() > exhausted;
                if coarse && seconds > EXHAUSTION_STEP {
                    fatigue.undo();
                    step = (0.5 * seconds).max(EXHAUSTION_STEP);
                    continue;
                }
                time = if seconds < step { most } else { time + seconds };
                visit(time, fatigue);
                if !failing && change < 0.25 * MOST_LOAD_CHANGE {
                    step = (2.0 * step).min(LONGEST_HOLD_STEP);
                }
            }
        }
    }
    let capacities: Vec<f64> = fatigue.capacities().collect();
    Ok(MuscleHold { seconds: time, limit: asked.limit(&capacities), failed: !held })
}
