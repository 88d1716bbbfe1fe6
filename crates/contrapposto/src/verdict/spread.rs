//! Computes how much the time until a muscle group fails differs between published laws of fatigue and between people.
//!
//! Every law is applied to the same loads: the group's own, the three-compartment controller with the parameters of its joint, and the
//! endurance curves of Frey-Law & Avin 2010 of its joint and in general. A person whose strength is one standard deviation above or
//! below the mean (two of three people lie between them) carries the load over `1 + cv` or `1 - cv`. The posture is that of the mean
//! person throughout.

use crate::fatigue::{FatigueLaw, FatigueState, LoadCycle, LoadHistory, Repeated, Repetition};
use crate::model::MuscleGroup;
use crate::model::data::library;

/// Bisections of the piece in which a group fails: to a part in a million.
const HALVINGS: usize = 20;

/// Least and greatest time (s) at which a group fails under the loads of `history`, with fatigue `start` (0..=1) at first;
/// the last load lasts for ever.
pub fn spread(group: &MuscleGroup, history: &LoadHistory, start: f64) -> (f64, f64) {
    over_laws_and_people(group, |law, strength| failure(law, history, strength, start))
}

/// As [`spread`], of a group that is rested at first and repeats a cycle: times from the start of the job.
pub fn spread_of_repeats(group: &MuscleGroup, cycle: &LoadCycle, repetition: Repetition) -> (f64, f64) {
    over_laws_and_people(group, |law, strength| Repeated::new(law, cycle, strength, repetition).time_of(0.0, 1.0))
}

/// Least and greatest time over laws and people, given the time by a law and a strength over the mean.
fn over_laws_and_people(group: &MuscleGroup, time: impl Fn(&FatigueLaw, f64) -> f64) -> (f64, f64) {
    let (laws, variation) = laws_and_variation(group);
    let strengths = [1.0 - variation, 1.0, 1.0 + variation];
    let times = laws.iter().flat_map(|law| strengths.map(|strength| time(law, strength)));
    times.fold((f64::INFINITY, 0.0), |(least, greatest), time| (time.min(least), time.max(greatest)))
}

/// Published laws of a group and its own, and the standard deviation of its strength between people over the mean.
pub(crate) fn laws_and_variation(group: &MuscleGroup) -> (Vec<FatigueLaw>, f64) {
    let library = library();
    let variation = library.strength_variation(&group.name).map_or(0.0, |(coefficient, _)| coefficient);
    let mut laws = library.published_laws(&group.name);
    laws.push(group.fatigue.clone());
    (laws, variation)
}

/// Time at which a group of `strength` times the mean fails, s; infinite if never.
pub(crate) fn failure(law: &FatigueLaw, history: &LoadHistory, strength: f64, start: f64) -> f64 {
    let pieces: Vec<(f64, f64)> = history.pieces().iter().map(|(from, load)| (*from, load / strength)).collect();
    let Some(&(_, first)) = pieces.first() else { return f64::INFINITY };
    let mut state = law.start(start, first);
    for (i, &(from, load)) in pieces.iter().enumerate() {
        if load > 1.0 {
            return from;
        }
        let Some(&(next, _)) = pieces.get(i + 1) else {
            return from + law.time_left(state.level(load), load);
        };
        let after = law.advance(state, load, next - from);
        if after.level(load) >= 1.0 {
            return from + time_of_failure(law, state, load, next - from);
        }
        state = after;
    }
    f64::INFINITY
}

/// Time after which a group in `state` fails under one load within `seconds`.
fn time_of_failure(law: &FatigueLaw, state: FatigueState, load: f64, seconds: f64) -> f64 {
    let (mut held, mut failed) = (0.0, seconds);
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(held, failed);
        if law.advance(state, load, middle).level(load) >= 1.0 { failed = middle } else { held = middle }
    }
    failed
}
