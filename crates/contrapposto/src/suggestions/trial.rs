//! Tries changes of a job, and says what they give.

use super::budget::Trial;
use super::change::Change;
use super::job::Job;
use crate::equilibria::{Search, SearchError, equilibria};
use crate::model::Model;
use crate::posture_solver::Options;
use crate::simulation::{Run, Scenario, ScenarioError, StopReason};
use crate::verdict::{Verdict, VerdictKind, how_long};

/// A time counts as longer from this factor on.
const LONGER: f64 = 1.05;

/// A change that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// The change in words.
    pub change: String,
    /// The kind of verdict with it.
    pub kind: VerdictKind,
    /// The time that was asked for, s; `None` where none was.
    pub asked: Option<f64>,
    /// Time for which the job can be done with the change, s: until a group fails; of a job that holds, with the posture of its end held on. `None`
    /// where no muscle sets a limit, or where it cannot be done.
    pub seconds: Option<f64>,
    /// Least time until any group fails, s, as [`Verdict::least`].
    pub least: Option<f64>,
    /// Number of coordinates that ligaments carry in hazard at the end.
    pub hazards: usize,
    /// These postures in words, `low back bent forward by 52°`; `None` of breaks, in which they are those of the job.
    pub hazard: Option<String>,
    /// Number of hands that hold half of the strength of their grip or more.
    pub hands: usize,
    /// Load of the hardest worked group.
    pub load: Option<f64>,
    /// The change is less load, or less load and another change.
    pub lighter: bool,
    /// Two changes at once.
    pub both: bool,
}

/// Runs a scenario with a change in one thread until a group needs more than its strength or fails, or a target is missed, or to its end, and judges
/// it. No verdict: the changed scenario is not in order, or `go_on` said no.
pub fn try_run(scenario: &Scenario, change: &Change, go_on: impl Fn() -> bool) -> Trial {
    let mut changed = change.apply(scenario);
    changed.run.threads = 1;
    let mut run = match Run::new(&changed) {
        Ok(run) => run,
        Err(ScenarioError::CannotStand(missing)) => {
            return Trial { verdict: Some(Verdict::of_fall(&changed.model, missing, &changed.loads)), steps: 0 };
        }
        Err(_) => return Trial::default(),
    };
    let verdict = judged(&changed, &mut run, go_on).unwrap_or_default();
    Trial { verdict, steps: run.solver_steps() }
}

/// The verdict on a run, as soon as it is known; `None` where `go_on` said no.
fn judged(scenario: &Scenario, run: &mut Run<'_>, go_on: impl Fn() -> bool) -> Result<Option<Verdict>, ScenarioError> {
    let mut is_first = true;
    while let Some(sample) = run.next_sample()? {
        let fails = !sample.stepping
            && (sample.exhausted.iter().flatten().any(|exhausted| *exhausted)
                || sample.load.iter().any(|load| *load > 1.0));
        if fails || std::mem::take(&mut is_first) {
            let mut summary = run.summary();
            // It is left on purpose, with its answer known.
            summary.reason = StopReason::Duration;
            let verdict = Verdict::of_run(scenario, &summary);
            // A target that is missed at first counts as missed however the run goes on.
            if fails || verdict.kind == VerdictKind::NotReached {
                return Ok(Some(verdict));
            }
        }
        if !go_on() {
            return Ok(None);
        }
    }
    Ok(Some(Verdict::of_run(scenario, &run.summary())))
}

/// Searches the posture of least effort with a change, and judges it.
pub fn try_search(search: &Search<'_>, options: Options, change: &Change) -> Trial {
    let job = Job::from(search);
    let (start, mut goals, mut loads) = (change.start(&job), search.goals.to_vec(), search.loads.to_vec());
    change.apply_to_goals(&job, &mut goals);
    change.apply_to_loads(&mut loads);
    let search = Search { start: &start, goals: &goals, loads: &loads, ..search.clone() };
    match equilibria(&search, options) {
        Ok(found) => Trial { verdict: Verdict::of_equilibria(&search, &found), steps: found.steps },
        Err(SearchError::CannotStand(missing)) => {
            Trial { verdict: Some(Verdict::of_fall(search.model, missing, search.loads)), steps: 0 }
        }
        Err(SearchError::Relax(_)) => Trial::default(),
    }
}

/// Times of a job for comparison: that of the mean person, and the least for two of three people, s; infinite without a limit.
fn times(seconds: Option<f64>, least: Option<f64>) -> (f64, f64) {
    (seconds.unwrap_or(f64::INFINITY), least.unwrap_or(f64::INFINITY))
}

/// The postures of all coordinates in hazard, in words.
pub(super) fn hazards_in_words(model: &Model, verdict: &Verdict) -> String {
    let all: Vec<String> = verdict.hazards.iter().map(|hazard| hazard.posture_in_words(model)).collect();
    all.join(", ")
}

impl Suggestion {
    /// A change that leads to a verdict.
    pub fn new(job: &Job<'_>, change: &Change, verdict: &Verdict) -> Self {
        Self {
            change: change.in_words(job),
            kind: verdict.kind,
            asked: job.asked,
            seconds: verdict.seconds,
            least: verdict.least,
            hazards: verdict.hazards.len(),
            hazard: Some(hazards_in_words(job.model, verdict)),
            hands: verdict.hands.len(),
            load: verdict.hardest.map(|group| group.load),
            lighter: change.is_lighter(),
            both: matches!(change, Change::Both(_)),
        }
    }

    /// Whether people with that least time, s, reach the asked one; where none is asked nobody does.
    pub(super) fn reaches(&self, least: f64) -> bool {
        self.asked.is_some_and(|asked| least >= asked)
    }

    /// Whether weaker people reach the asked time.
    pub(super) fn suffices(&self) -> bool {
        self.kind == VerdictKind::Holds && self.reaches(times(self.seconds, self.least).1)
    }

    /// Number of hazards and of hands with much weight.
    fn risks(&self) -> usize {
        self.hazards + self.hands
    }

    /// Whether people of mean strength, and weaker ones, hold the job for less time than without the change, as times are shown; of a job that can
    /// be done.
    pub(super) fn shortens(&self, before: &Verdict) -> [bool; 2] {
        if !before.kind.is_done() {
            return [false; 2];
        }
        let (mean, weaker) = times(self.seconds, self.least);
        let (mean_before, weaker_before) = times(before.seconds, before.least);
        let shorter = |after: f64, before: f64| after < before && how_long(after) != how_long(before);
        [shorter(mean, mean_before), shorter(weaker, weaker_before)]
    }

    /// Whether the change answers what is open: of a job that only weaker people do not hold, their time is longer; of another one that of people of
    /// mean strength, or, where no muscle limits these, that of weaker people.
    fn is_longer(&self, before: &Verdict) -> bool {
        let (after, least_after) = times(self.seconds, self.least);
        let (mean_before, least_before) = times(before.seconds, before.least);
        let of_weaker = least_after > LONGER * least_before;
        let weaker_lack = before.kind == VerdictKind::Holds && self.asked.is_some() && !self.reaches(least_before);
        if weaker_lack { of_weaker } else { after > LONGER * mean_before || after.is_infinite() && of_weaker }
    }

    /// The suggestions that help, the one that helps most first: a better kind of verdict, or the same with fewer hazards and
    /// hands with much weight or for longer. A change with which weaker people no longer reach the asked time does not help, nor does one with which
    /// people of mean strength hold out for less time, unless it is safer or weaker people reach the asked time with it, nor does
    /// less load with which somebody holds out for less time: the search has ended in another posture. Of those that are equally safe the
    /// ones come first with which weaker people reach the asked time. Two changes at once help where they help more than each single one.
    pub fn that_help(mut all: Vec<Self>, verdict: &Verdict) -> Vec<Self> {
        let (_, least_before) = times(verdict.seconds, verdict.least);
        let keeps = |one: &Self| !one.reaches(least_before) || one.reaches(times(one.seconds, one.least).1);
        let safer = |one: &Self| one.risks() < verdict.risks();
        let equally_safe = |one: &Self| one.risks() == verdict.risks();
        let better = |one: &Self| safer(one) || equally_safe(one) && one.is_longer(verdict);
        let another_posture = |one: &Self| one.lighter && one.shortens(verdict).contains(&true);
        let at_a_cost = |one: &Self| one.shortens(verdict)[0] && !safer(one) && !one.suffices();
        let helps = |one: &Self| {
            one.kind.is_done()
                && (one.kind > verdict.kind || one.kind == verdict.kind && better(one) && keeps(one))
                && !another_posture(one)
                && !at_a_cost(one)
        };
        all.retain(helps);
        all.sort_by(|a, b| {
            let ((time_a, least_a), (time_b, least_b)) = (times(a.seconds, a.least), times(b.seconds, b.least));
            let load = a.load.unwrap_or(0.0).total_cmp(&b.load.unwrap_or(0.0));
            b.kind
                .cmp(&a.kind)
                .then(a.risks().cmp(&b.risks()))
                .then(b.reaches(least_b).cmp(&a.reaches(least_a)))
                .then(time_b.total_cmp(&time_a))
                .then(least_b.total_cmp(&least_a))
                .then(load)
        });
        let (mut place, single) = (0, all.iter().position(|one| !one.both).unwrap_or(all.len()));
        all.retain(|one| {
            place += 1;
            !one.both || place <= single
        });
        all
    }

    /// Whether fewer joints than before, but some, are carried by ligaments in hazard.
    pub(super) fn lessens_hazards(&self, before: &Verdict) -> bool {
        (1..before.hazards.len()).contains(&self.hazards)
    }
}
