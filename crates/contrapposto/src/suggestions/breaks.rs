//! Computes how long a job can be done with breaks.

use super::trial::Suggestion;
use crate::fatigue::FatigueLaw;
use crate::model::Side;
use crate::simulation::{Scenario, Summary};
use crate::verdict::{Verdict, VerdictKind};

/// A break comes after so much work, s.
pub const BREAK_EVERY: f64 = 600.0;
/// A break lasts so long, s.
pub const BREAK: f64 = 60.0;
/// Piece of work under one load, s.
const WORK_PIECE: f64 = 1.0;
/// Fatigue that grows by less from break to break under the last loads of a run has reached its steady state.
const STEADY: f64 = 1e-6;
/// A time from here on, s, counts as no limit: a day.
const LONGEST: f64 = 86_400.0;

/// The job of a run with a break of a minute after every ten minutes of work: in a break no group has a load; between breaks each has
/// that of the run, and after the run that of its end. `verdict` is that of the run. Time counts work and breaks. `None` where the run is too short for a break.
pub fn with_breaks(scenario: &Scenario, summary: &Summary, verdict: &Verdict) -> Option<Suggestion> {
    let asked = scenario.run.end();
    if asked <= BREAK_EVERY {
        return None;
    }
    let longest = LONGEST.max(asked);
    let mut first = longest;
    for (i, coordinate) in scenario.model.coordinates().iter().enumerate() {
        let Some(groups) = &coordinate.groups else { continue };
        for side in Side::BOTH {
            let start = scenario.start_fatigue[i][side.index()];
            let course = &summary.coordinates[i];
            if course.loads[side.index()].pieces().iter().all(|(_, load)| *load <= 0.0) {
                continue;
            }
            let load_at = |work: f64| match work < summary.end_time {
                true => course.loads[side.index()].at(work),
                false => course.final_groups[side.index()].load,
            };
            first = first.min(failure(&groups[side.index()].fatigue, load_at, start, (summary.end_time, first)));
        }
    }
    let held = first >= asked;
    Some(Suggestion {
        change: "a break of a minute every ten minutes".to_owned(),
        kind: if held { VerdictKind::Holds } else { VerdictKind::HeldUntil },
        asked,
        seconds: (first < longest).then_some(first),
        least: None,
        hazards: verdict.hazards.len(),
        load: summary.hardest.map(|(group, _)| group.load),
    })
}

/// When a group fails, s of work and breaks; infinite if not until `longest`. Loads stay the same after `end` s of work.
fn failure(law: &FatigueLaw, load_at: impl Fn(f64) -> f64, start: f64, (end, longest): (f64, f64)) -> f64 {
    let (mut state, mut time, mut work) = (law.start(start, load_at(0.0)), 0.0, 0.0);
    let (mut until_break, mut before_break) = (BREAK_EVERY, f64::NEG_INFINITY);
    while time < longest {
        if until_break <= 0.0 {
            let level = state.level(load_at(work));
            if work > end && level <= before_break + STEADY {
                return f64::INFINITY;
            }
            state = law.advance(state, 0.0, BREAK);
            time += BREAK;
            (until_break, before_break) = (BREAK_EVERY, level);
            continue;
        }
        let load = load_at(work);
        state = law.advance(state, load, WORK_PIECE);
        (time, work, until_break) = (time + WORK_PIECE, work + WORK_PIECE, until_break - WORK_PIECE);
        if load > 0.0 && state.level(load) >= 1.0 {
            return time;
        }
    }
    f64::INFINITY
}
