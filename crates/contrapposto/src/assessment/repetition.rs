//! Follows the fatigue of all groups through a job that repeats the motion.

use super::error::AssessError;
use super::result::{Assessment, RepeatedGroup};
use super::settings::AssessSettings;
use crate::fatigue::{Repeated, Repetition};
use crate::model::Model;
use crate::posture::Posture;

impl Assessment {
    /// Takes in what becomes of every group when the motion is repeated.
    pub(super) fn repeat(
        &mut self,
        model: &Model,
        motion: &[(f64, Posture)],
        settings: &AssessSettings,
    ) -> Result<(), AssessError> {
        let Some(repetition) = settings.repetition else { return Ok(()) };
        let (start, end) = motion.first().zip(motion.last()).map_or((0.0, 0.0), |(first, last)| (first.0, last.0));
        check(repetition, end - start)?;
        for group in &mut self.groups {
            let Some(groups) = &model.coordinates()[group.coordinate].groups else { continue };
            let repeated = Repeated::new(&groups[group.side.index()].fatigue, &group.cycle, 1.0, repetition);
            let (duty, mean_load) = group.cycle.duty(repetition.every);
            let [relief_at, fails_at] = [settings.critical_level, 1.0].map(|level| repeated.time_of(0.0, level));
            let fails = fails_at < repetition.seconds;
            let (end, greatest) = if fails { (1.0, 1.0) } else { repeated.at_end(0.0) };
            group.exhausted_at = fails.then_some(start + fails_at);
            group.fatigue = end;
            group.repeated = Some(RepeatedGroup { duty, mean_load, fatigue: greatest, relief_at, fails_at });
        }
        Ok(())
    }
}

/// Whether a cycle of so many seconds can be repeated so.
fn check(repetition: Repetition, cycle: f64) -> Result<(), AssessError> {
    let Repetition { seconds, every, breaks } = repetition;
    let room = breaks.map_or(seconds, |breaks| breaks.work.min(seconds));
    let fits = cycle > 0.0 && cycle <= every && every <= room;
    let in_order = breaks.is_none_or(|breaks| breaks.work.is_finite() && breaks.rest.is_finite() && breaks.rest >= 0.0);
    if fits && seconds.is_finite() && in_order {
        return Ok(());
    }
    Err(AssessError::Repetition { cycle, every, room })
}
