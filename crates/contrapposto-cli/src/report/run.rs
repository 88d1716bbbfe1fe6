//! The page of a run over time.

use contrapposto::simulation::{Scenario, Summary};
use contrapposto_report::{Entry, List, Moments};

use super::film::{Event, Film};
use super::{Scene, shown, story, words};
use crate::fail::Fail;
use crate::simulate::Recording;

/// The page of a run.
pub(crate) fn report_of_run(scenario: &Scenario, recording: &Recording, summary: &Summary) -> Result<String, Fail> {
    let film = Film::new(scenario, recording, summary);
    let shown = shown(&scenario.model);
    let start = film.frames.first().map_or(scenario.start.values(), |frame| &frame.posture);
    let scene = Scene {
        held: (!scenario.is_whole()).then_some(scenario.loads.as_slice()),
        ..Scene::of(&scenario.title, &scenario.model, start, &film.frames, &scenario.supports)
    };
    let times = film.frames.iter().map(|frame| frame.time).collect();
    let mut report = scene.report(Moments::Times(times), main_coordinate(scenario, summary))?;
    report.levels = Some([scenario.hysteresis.critical_level, scenario.hysteresis.recovery_level]);
    report.list = List {
        heading: "What was decided".to_owned(),
        entries: entries(scenario, &film, &shown),
        none: "Nothing: no muscle group asked for relief.".to_owned(),
    };
    story::tell(scenario, &film, summary, &shown, &mut report);
    Ok(contrapposto_report::write(&report))
}

/// The coordinate that the story is about: the one most often relieved, of equals a free one, of equals the hardest worked.
pub(crate) fn main_coordinate(scenario: &Scenario, summary: &Summary) -> usize {
    let weight = |i: usize| {
        let coordinate = &summary.coordinates[i];
        (coordinate.iterations.iter().sum::<u64>(), scenario.free[i], coordinate.peak_load)
    };
    let more = |a: &usize, b: &usize| {
        let (a, b) = (weight(*a), weight(*b));
        (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
    };
    // The first of equals.
    shown(&scenario.model).into_iter().rev().max_by(more).unwrap_or(0)
}

fn entries(scenario: &Scenario, film: &Film, shown: &[usize]) -> Vec<Entry> {
    let entry = |event: &Event| {
        let joint = shown.iter().position(|&i| i == event.coordinate)?;
        let frame = film.frames.iter().position(|frame| frame.time >= event.time)?;
        Some(Entry { frame, joint, text: words::decision(&scenario.model, event, &film.frames[frame]) })
    };
    film.events.iter().filter_map(entry).collect()
}
