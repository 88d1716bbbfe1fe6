//! The page of a run over time.

use contrapposto::hybrid::Strategy;
use contrapposto::model::Side;
use contrapposto::simulation::{FootStep, MuscleOutcome, Scenario, StepKind, Summary};
use contrapposto::verdict::{Verdict, VerdictKind};
use contrapposto_formats::Thing;
use contrapposto_report::{Entry, List, Moments, Report};

use super::{narrative, page};
use crate::fail::Fail;
use crate::view::answer::{Answer, group_of_title};
use crate::view::decision::{alike, merged};
use crate::view::excerpt::{Event, RunExcerpt};
use crate::view::frame::Frame;
use crate::view::muscle_work::{MusclesAtWork, muscles_at_work};
use crate::view::recording::Recording;
use crate::view::scene::Scene;
use crate::view::selection::{main_coordinate, shown};
use crate::view::stage::{Stage, load_in_words};
use crate::view::targets::missed_targets;
use crate::view::words::{how_long, list, plain, sentence, why};

/// The muscles of a run in the moments that its page shows. Nothing is judged while a support is put elsewhere.
pub(crate) fn muscles_of_run<'a>(
    scenario: &'a Scenario,
    recording: &Recording,
    summary: &'a Summary,
) -> Result<Option<MusclesAtWork<'a>>, Fail> {
    if scenario.muscles.is_none() {
        return Ok(None);
    }
    let excerpt = RunExcerpt::new(scenario, recording, summary);
    let steps = |time: f64| summary.foot_steps.iter().any(|step| time > step.time.0 && time < step.time.1);
    let muscles = muscles_at_work(&scenario.model, scenario.muscles.as_ref(), &excerpt.frames, |time| !steps(time))?;
    Ok(muscles.map(|muscles| muscles.tiring(summary.muscles.as_ref())))
}

/// The page of a run, with the muscles of [`muscles_of_run`].
pub(crate) fn report_of_run(
    (scenario, things): (&Scenario, &[Thing]),
    (recording, muscles): (&Recording, Option<&MusclesAtWork<'_>>),
    summary: &Summary,
    answer: &Answer,
) -> Result<String, Fail> {
    let excerpt = RunExcerpt::new(scenario, recording, summary);
    let shown = shown(&scenario.model);
    let start = excerpt.frames.first().map_or(scenario.start.values(), |frame| &frame.posture);
    let scene = Scene {
        held: (!scenario.has_supports_or_tasks()).then_some(scenario.loads.as_slice()),
        muscles,
        ..Scene::of(&scenario.title, &scenario.model, start, &excerpt.frames, Stage::of_run(scenario, things))
    };
    let times = excerpt.frames.iter().map(|frame| frame.time).collect();
    let main =
        group_of_title(&answer.verdict).map_or_else(|| main_coordinate(scenario, summary), |group| group.coordinate);
    let mut report = scene.report(Moments::Times(times), main)?;
    summary.muscles.iter().for_each(|muscles| tell_time_left(&mut report, &shown, muscles, &excerpt.frames));
    report.targets = missed_targets(scenario, &excerpt.frames)?;
    report.open = excerpt.nearest(moment(&answer.verdict, summary));
    report.levels = Some([scenario.hysteresis.critical_level, scenario.hysteresis.recovery_level]);
    report.list = List {
        heading: "Decisions, changes and steps".to_owned(),
        entries: entries(scenario, summary, &excerpt, &shown),
        none: "None: no muscle group needed relief.".to_owned(),
    };
    narrative::write((scenario, &scene.names_of_supports()), &excerpt, summary, answer, &mut report);
    Ok(page(&scenario.model, report))
}

/// Gives groups whose muscles tire one by one the time that these leave them.
fn tell_time_left(report: &mut Report, shown: &[usize], muscles: &MuscleOutcome, frames: &[Frame]) {
    for (joint, &coordinate) in report.joints.iter_mut().zip(shown).filter(|(_, i)| muscles.coordinates.contains(i)) {
        for (group, side) in joint.groups.iter_mut().flatten().zip(Side::BOTH) {
            for (left, frame) in group.left.iter_mut().zip(frames) {
                let own = left.is_finite().then_some(*left);
                *left = muscles.seconds_left((coordinate, side), frame.time, own).unwrap_or(f64::INFINITY);
            }
        }
    }
}

/// The time that the verdict is about, s: of a job that holds the end, from which its minutes are counted, and not the hardest moment, which
/// may be one of a motion between two postures.
fn moment(verdict: &Verdict, summary: &Summary) -> f64 {
    match verdict.kind {
        VerdictKind::CannotBeDone => summary.hardest.map_or(summary.end_time, |(_, time)| time),
        VerdictKind::HeldUntil => verdict.seconds.unwrap_or(summary.end_time),
        VerdictKind::Holds | VerdictKind::CannotStand | VerdictKind::NotReached => summary.end_time,
    }
}

/// Decisions, those that repeat listed once; changes of the scenario; and steps of feet. In the order of time.
fn entries(scenario: &Scenario, summary: &Summary, excerpt: &RunExcerpt, shown: &[usize]) -> Vec<Entry> {
    let frame_at = |time: f64| excerpt.frames.iter().position(|frame| frame.time >= time);
    let mut kinds: Vec<Vec<(&Event, &Frame)>> = vec![];
    for event in &excerpt.events {
        let Some(frame) = frame_at(event.time).map(|i| &excerpt.frames[i]) else { continue };
        match kinds.iter_mut().find(|kind| alike(kind[0].0, event)) {
            Some(kind) => kind.push((event, frame)),
            None => kinds.push(vec![(event, frame)]),
        }
    }
    let decided = kinds.iter().filter_map(|kind| {
        let joint = shown.iter().position(|&i| i == kind[0].0.coordinate)?;
        Some((kind[0].0.time, Some(joint), merged(&scenario.model, kind)?))
    });
    let changed = scenario
        .events
        .iter()
        .flat_map(|event| changes(scenario, event).into_iter().map(|text| (event.time, None, text)));
    let stepped = summary.foot_steps.iter().map(|step| {
        let joint = shown.iter().position(|&i| step.relieves.is_some_and(|(coordinate, _)| i == coordinate));
        (step.time.0, joint, step_in_words(scenario, step))
    });
    let mut entries: Vec<(f64, Option<usize>, String)> = decided.chain(changed).chain(stepped).collect();
    entries.sort_by(|a, b| a.0.total_cmp(&b.0));
    let entry = |(time, joint, text): (f64, Option<usize>, String)| {
        Some(Entry { frame: frame_at(time)?, time: Some(time), joint, text })
    };
    entries.into_iter().filter_map(entry).collect()
}

/// The changes by an event of the scenario, a sentence each.
fn changes(scenario: &Scenario, event: &contrapposto::simulation::Event) -> Vec<String> {
    let mut texts = vec![];
    if let Some(loads) = &event.loads {
        let loads: Vec<String> = loads.iter().map(|load| load_in_words(&scenario.model, load)).collect();
        let loads = if loads.is_empty() { "none".to_owned() } else { list(&loads) };
        texts.push(format!("Loads from now on: {loads}."));
    }
    if let Some(strategies) = &event.strategies {
        let named = |strategy: Strategy| match strategy {
            Strategy::Active => "active",
            Strategy::Passive => "passive",
        };
        let same = strategies.iter().all(|strategy| strategies.first() == Some(strategy));
        texts.push(match strategies.first().filter(|_| same) {
            Some(&strategy) => format!("Strategy from now on: {}.", named(strategy)),
            None => "Strategy from now on: active for some joints, passive for others.".to_owned(),
        });
    }
    if !event.tasks.is_empty() {
        texts.push("The target of a task changes.".to_owned());
    }
    texts
}

/// A support that is put elsewhere.
fn step_in_words(scenario: &Scenario, step: &FootStep) -> String {
    let support = plain(&scenario.model.segments()[scenario.supports[step.support].segment].name);
    let ([from_x, _, from_z], [x, _, z]) = step.place;
    let (why, end) = (why(&scenario.model, step), how_long(step.time.1));
    let change = match step.kind {
        StepKind::Elsewhere => {
            let far = 100.0 * libm::hypot(x - from_x, z - from_z);
            format!("Step: {support} is put {far:.0} cm away, {why}; it is there at {end}")
        }
        StepKind::PutDown => format!("{} is put down to rest, {why}; it lies at {end}", sentence(&support)),
        StepKind::TakenOff => format!("{} is taken up again, {why}, until {end}", sentence(&support)),
    };
    format!("{change}. Nobody is judged while it is in the air.")
}
