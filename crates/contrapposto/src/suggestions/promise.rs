//! Orders changes by their promise: the verdict on a posture near the present one, found by few solver steps.

use super::change::Change;
use super::job::Job;
use crate::assessment::{AssessSettings, assess};
use crate::contact::{Place, Support};
use crate::equilibria::{Aim, Search};
use crate::posture::Posture;
use crate::posture_solver::{Engine, Options};
use crate::simulation::{Scenario, Summary};
use crate::tasks::{PriorityLevel, Task};
use crate::verdict::{HandLoad, HeldPosture, Missed, Verdict};

/// Most solver steps to the posture of a change.
const GLANCE_STEPS: usize = 60;
/// Largest change of a joint in one of them, rad.
const GLANCE_STEP: f64 = 0.1;

/// The changes of a scenario that was run, the one of most promise first.
pub fn by_promise(scenario: &Scenario, summary: &Summary, changes: Vec<Change>) -> Vec<Change> {
    let values = summary.coordinates.iter().map(|coordinate| coordinate.final_value).collect();
    let end = Scenario { start: Posture::new(values), ..scenario.clone() };
    let goals: Vec<PriorityLevel> = end.tasks.iter().map(|task| task.goal.clone()).collect();
    let locked: Vec<usize> = end.locked_rates().collect();
    let supports: Vec<Support> = summary.in_use.iter().map(|&number| end.supports[number].clone()).collect();
    by_promise_of_search(
        &Search {
            model: &end.model,
            start: &end.start,
            supports: &supports,
            goals: &goals,
            limits: &end.limits_with(&summary.in_use),
            loads: &end.loads,
            locked: &locked,
            most_work: usize::MAX,
            scattered: crate::equilibria::SCATTERED_STARTS,
            aim: Aim::Ways,
            threads: 1,
        },
        changes,
    )
}

/// The changes of a search, whose start is the posture that was found, the one of most promise first.
pub fn by_promise_of_search(search: &Search<'_>, changes: Vec<Change>) -> Vec<Change> {
    let mut promises: Vec<(Change, Option<Verdict>)> =
        changes.into_iter().map(|change| (change.clone(), glance(search, &change))).collect();
    // The sort is stable: equals stay in their fixed order.
    promises.sort_by(|(_, a), (_, b)| match (a, b) {
        (Some(a), Some(b)) => compared(a, b),
        _ => b.is_some().cmp(&a.is_some()),
    });
    promises.into_iter().map(|(change, _)| change).collect()
}

/// The better kind first, then the longer time, then fewer hazards and hands with much weight, the nearer target and the smaller load.
fn compared(a: &Verdict, b: &Verdict) -> std::cmp::Ordering {
    let time = |verdict: &Verdict| verdict.seconds.unwrap_or(f64::INFINITY);
    let miss = |verdict: &Verdict| verdict.missed.first().map_or(0.0, |missed| missed.distance);
    let load = |verdict: &Verdict| verdict.hardest.map_or(0.0, |group| group.load);
    b.kind
        .is_done()
        .cmp(&a.kind.is_done())
        .then(time(b).total_cmp(&time(a)))
        .then(a.risks().cmp(&b.risks()))
        .then(miss(a).total_cmp(&miss(b)))
        .then(load(a).total_cmp(&load(b)))
}

/// The verdict on a posture with the change near the start of the search; `None` where nothing can be computed.
fn glance(search: &Search<'_>, change: &Change) -> Option<Verdict> {
    let job = Job::from(search);
    let (start, mut goals, mut loads) = (change.start(&job), search.goals.to_vec(), search.loads.to_vec());
    change.apply_to_goals(&job, &mut goals);
    change.apply_to_loads(&mut loads);
    let (mut posture, mut missed, mut supports) = (start, vec![], search.supports.to_vec());
    if !search.supports.is_empty() || !goals.is_empty() {
        let options =
            Options { max_step: GLANCE_STEP, max_steps: GLANCE_STEPS, local_minima: 0, ..Options::least_effort() };
        let model = search.model;
        let mut levels = goals.clone();
        if let Change::Hand(hand) = change {
            levels.splice(0..0, hand.rest(0).lies(&hand.support).map(PriorityLevel::from));
        }
        let above = levels.len() - goals.len();
        let mut engine = Engine::with_supports(model, &posture, supports.clone(), levels, &loads, options).ok()?;
        search.locked.iter().for_each(|&rate| engine.lock(rate));
        search.limits.iter().try_for_each(|task: &Task| engine.limit(task.clone())).ok()?;
        let solved = engine.solve(&posture).ok()?;
        let errors = solved.levels.iter().skip(above).map(|level| level.length);
        missed = Missed::of_levels(model, &solved.posture, goals.iter().zip(errors));
        posture = solved.posture;
        if let Change::Hand(hand) = change {
            supports.push(Support { place: Place::Fixed, ..hand.support.clone() });
        }
    }
    let settings = AssessSettings { supports, ..AssessSettings::default() };
    let held = [(0.0, posture)];
    let found = assess(search.model, &held, |_, _, all| all.extend_from_slice(&loads), &settings, |_| {}).ok()?;
    let hands = HandLoad::all(search.model, &loads);
    Some(Verdict::of_posture(search.model, &HeldPosture { missed, hands, ..HeldPosture::from(&found) }))
}
