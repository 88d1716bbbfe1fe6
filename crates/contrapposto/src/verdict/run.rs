//! Judges a run over time.

use super::holding::GroupAtEnd;
use super::spread::spread;
use super::{Failure, Findings, HandLoad, LEAST_HAZARD, Missed, PassedHazard, Verdict, Who};
use crate::joint_torques::Hazard;
use crate::model::Side;
use crate::posture::Posture;
use crate::simulation::{CoordinateSummary, Scenario, StopReason, Summary};
use crate::statics::Load;

impl Verdict {
    /// Of a run, whether it went to its end or not.
    pub fn of_run(scenario: &Scenario, summary: &Summary) -> Self {
        let levels = scenario.tasks.iter().map(|task| &task.goal).zip(summary.errors.iter().copied());
        let end = Posture::new(summary.coordinates.iter().map(|coordinate| coordinate.final_value).collect());
        let hazards = at_end(scenario, summary);
        let interrupted = summary.reason == StopReason::Interrupted;
        let mut findings = Findings {
            asked: Some(summary.end_time),
            hardest: summary.hardest.map(|(group, time)| (group, Some(time))),
            missing: summary.fall.map(|fall| (fall.missing, Some(fall.time))),
            slip: summary.slip.map(|(slip, time)| (slip, Some(time))),
            slides: summary.sliding_since.zip(summary.standing.as_ref()).map(|(since, last)| (last.slip, Some(since))),
            missed: Missed::of_levels(&scenario.model, &end, levels),
            fails: fails(scenario, summary),
            passed: passed(scenario, summary, &hazards),
            hazards,
            in_hazard: in_hazard(scenario, summary),
            hands: hands(scenario),
            loads: summary.fall.map_or_else(Vec::new, |fall| loads_at(scenario, fall.time).to_vec()),
            interrupted: interrupted.then_some(summary.end_time),
            ..Findings::default()
        };
        if findings.kind().is_done() {
            findings.take_end(&groups_at_end(scenario, summary), (0.0, summary.end_time));
        }
        findings.verdict(&scenario.model)
    }
}

/// Coordinates in hazard at the end of a run.
fn at_end(scenario: &Scenario, summary: &Summary) -> Vec<Hazard> {
    let of = |value: fn(&CoordinateSummary) -> f64| -> Vec<f64> { summary.coordinates.iter().map(value).collect() };
    let (external, passive) = (of(|end| end.final_torques[0]), of(|end| end.final_torques[1]));
    Hazard::of_posture(&scenario.model, &of(|end| end.final_value), &external, &passive)
}

/// The heaviest weights that hands hold at any time of a run.
fn hands(scenario: &Scenario) -> Vec<HandLoad> {
    let later = scenario.events.iter().filter_map(|event| event.loads.as_deref());
    let all = std::iter::once(scenario.loads.as_slice()).chain(later);
    let mut hands: Vec<HandLoad> = vec![];
    for hand in all.flat_map(|loads| HandLoad::all(&scenario.model, loads)) {
        match hands.iter_mut().find(|other| other.segment == hand.segment) {
            Some(other) => other.weight = other.weight.max(hand.weight),
            None => hands.push(hand),
        }
    }
    hands.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    hands
}

/// The loads at a time of a run.
fn loads_at(scenario: &Scenario, time: f64) -> &[Load] {
    let mut changed =
        scenario.events.iter().filter(|event| event.time <= time).filter_map(|event| event.loads.as_deref());
    changed.next_back().unwrap_or(&scenario.loads)
}

/// Coordinates that were in hazard, with the time in all, s.
fn in_hazard(scenario: &Scenario, summary: &Summary) -> Vec<(usize, f64)> {
    let seconds = |(i, course): (usize, &CoordinateSummary)| Some((i, course.hazardous?.seconds(scenario.run.step)));
    summary.coordinates.iter().enumerate().filter_map(seconds).collect()
}

/// Hazards of a run that are none of those `at_end`.
fn passed(scenario: &Scenario, summary: &Summary, at_end: &[Hazard]) -> Vec<PassedHazard> {
    let hazard = |(i, course): (usize, &CoordinateSummary)| {
        let coordinate = &scenario.model.coordinates()[i];
        let worst = course.hazardous?;
        let [external, passive] = worst.torques;
        let is_over = at_end.iter().all(|hazard| hazard.coordinate != i);
        let row = Hazard::at(coordinate, worst.angle, external, passive)?;
        let seconds = worst.seconds(scenario.run.step);
        let hazard = Hazard { coordinate: i, angle: worst.angle, external, passive, row };
        (is_over && seconds >= LEAST_HAZARD).then_some(PassedHazard { hazard, time: worst.time, seconds })
    };
    summary.coordinates.iter().enumerate().filter_map(hazard).collect()
}

/// All groups of known strength at the end of a run.
fn groups_at_end<'a>(scenario: &'a Scenario, summary: &'a Summary) -> Vec<GroupAtEnd<'a>> {
    let mut all = vec![];
    for (coordinate, course) in summary.coordinates.iter().enumerate() {
        let Some(groups) = &scenario.model.coordinates()[coordinate].groups else { continue };
        all.extend(Side::BOTH.map(|side| {
            let end = course.final_groups[side.index()];
            GroupAtEnd {
                who: Who { coordinate, side, load: end.load },
                muscles: &groups[side.index()],
                history: &course.loads[side.index()],
                start: scenario.start_fatigue[coordinate][side.index()],
                fatigue: end.fatigue,
                seconds_left: end.seconds_left,
                of_people: summary.muscles.as_ref().and_then(|muscles| muscles.spread_of((coordinate, side))),
            }
        }));
    }
    all
}

/// The group that fails first in a run.
fn fails(scenario: &Scenario, summary: &Summary) -> Option<Failure> {
    let failures = summary.coordinates.iter().enumerate().flat_map(|(coordinate, course)| {
        Side::BOTH.into_iter().filter_map(move |side| Some((coordinate, side, course.exhausted_at[side.index()]?)))
    });
    // Muscles that cannot give all torques fail at several groups at once; one of these limits them.
    let beside = |i, side| summary.muscles.as_ref().is_some_and(|muscles| muscles.fails_beside((i, side)));
    let (coordinate, side, time) =
        failures.filter(|(i, side, _)| !beside(*i, *side)).min_by(|a, b| a.2.total_cmp(&b.2))?;
    let group = &scenario.model.coordinates()[coordinate].groups.as_ref()?[side.index()];
    let history = &summary.coordinates[coordinate].loads[side.index()];
    let start = scenario.start_fatigue[coordinate][side.index()];
    let of_people = summary.muscles.as_ref().and_then(|muscles| muscles.spread_of((coordinate, side)));
    let (least, greatest) = of_people.unwrap_or_else(|| spread(group, history, start));
    let who = Who { coordinate, side, load: history.at(time) };
    Some(Failure { who, time, range: (least.min(time), greatest.max(time)) })
}
