//! The page of a run over time.

use contrapposto::simulation::{Scenario, Summary};
use contrapposto_formats::Thing;
use contrapposto_report::{Entry, List, Moments};

use super::narrative;
use crate::fail::Fail;
use crate::view::answer::Answer;
use crate::view::decision::decision;
use crate::view::excerpt::{Event, RunExcerpt};
use crate::view::recording::Recording;
use crate::view::scene::Scene;
use crate::view::selection::{main_coordinate, shown};
use crate::view::stage::Stage;

/// The page of a run.
pub(crate) fn report_of_run(
    (scenario, things): (&Scenario, &[Thing]),
    recording: &Recording,
    summary: &Summary,
    answer: &Answer,
) -> Result<String, Fail> {
    let excerpt = RunExcerpt::new(scenario, recording, summary);
    let shown = shown(&scenario.model);
    let start = excerpt.frames.first().map_or(scenario.start.values(), |frame| &frame.posture);
    let scene = Scene {
        held: (!scenario.has_supports_or_tasks()).then_some(scenario.loads.as_slice()),
        ..Scene::of(&scenario.title, &scenario.model, start, &excerpt.frames, Stage::of_run(scenario, things))
    };
    let times = excerpt.frames.iter().map(|frame| frame.time).collect();
    let mut report = scene.report(Moments::Times(times), main_coordinate(scenario, summary))?;
    report.levels = Some([scenario.hysteresis.critical_level, scenario.hysteresis.recovery_level]);
    report.list = List {
        heading: "Decisions".to_owned(),
        entries: entries(scenario, &excerpt, &shown),
        none: "None: no muscle group needed relief.".to_owned(),
    };
    narrative::write(scenario, &excerpt, summary, answer, &shown, &mut report);
    Ok(contrapposto_report::write(&report))
}

fn entries(scenario: &Scenario, excerpt: &RunExcerpt, shown: &[usize]) -> Vec<Entry> {
    let entry = |event: &Event| {
        let joint = shown.iter().position(|&i| i == event.coordinate)?;
        let frame = excerpt.frames.iter().position(|frame| frame.time >= event.time)?;
        Some(Entry { frame, joint, text: decision(&scenario.model, event, &excerpt.frames[frame]) })
    };
    excerpt.events.iter().filter_map(entry).collect()
}
