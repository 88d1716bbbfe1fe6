//! Computes how long a job can be done with breaks.

use super::trial::Suggestion;
use crate::fatigue::FatigueLaw;
use crate::model::Side;
use crate::simulation::{Scenario, Summary};
use crate::verdict::VerdictKind;

/// A break comes after so much work, s.
pub const BREAK_EVERY: f64 = 600.0;
/// A break lasts so long, s.
pub const BREAK: f64 = 60.0;
/// Piece of work under one load, s.
const WORK_PIECE: f64 = 1.0;

/// The job of a run with a break of a minute after every ten minutes of work: in a break no group has a load; between breaks each has
/// that of the run. Time counts work and breaks. `None` where the run is too short for a break.
pub fn with_breaks(scenario: &Scenario, summary: &Summary) -> Option<Suggestion> {
    let asked = scenario.run.end();
    if asked <= BREAK_EVERY {
        return None;
    }
    let mut first = f64::INFINITY;
    for (i, coordinate) in scenario.model.coordinates().iter().enumerate() {
        let Some(groups) = &coordinate.groups else { continue };
        for side in Side::BOTH {
            let start = scenario.start_fatigue[i][side.index()];
            let loads = &summary.coordinates[i].loads[side.index()];
            let load_at = |work: f64| loads.at(work.min(summary.end_time));
            first = first.min(failure(&groups[side.index()].fatigue, load_at, start, asked));
        }
    }
    let held = first.is_infinite();
    Some(Suggestion {
        change: "a break of a minute every ten minutes".to_owned(),
        kind: if held { VerdictKind::Holds } else { VerdictKind::HeldUntil },
        seconds: Some(if held { asked } else { first }),
        load: summary.hardest.map(|(group, _)| group.load),
    })
}

/// When a group fails, s of work and breaks; infinite if not until `asked`.
fn failure(law: &FatigueLaw, load_at: impl Fn(f64) -> f64, start: f64, asked: f64) -> f64 {
    let (mut state, mut time, mut work) = (law.start(start, load_at(0.0)), 0.0, 0.0);
    let mut until_break = BREAK_EVERY;
    while time < asked {
        if until_break <= 0.0 {
            state = law.advance(state, 0.0, BREAK);
            time += BREAK;
            until_break = BREAK_EVERY;
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
