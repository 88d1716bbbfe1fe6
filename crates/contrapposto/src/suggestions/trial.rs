//! Runs a changed scenario until a muscle group fails.

use super::change::Change;
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
    /// How long the job can be done with it, s: until a group fails, or through the asked time.
    pub seconds: Option<f64>,
    /// Load of the hardest worked group.
    pub load: Option<f64>,
}

/// Runs a scenario until a group needs more than its strength or fails, or to its end, and judges it. `None`: `go_on` said no.
///
/// # Errors
/// [`ScenarioError`], but for a body that cannot stand, which is a verdict.
fn trial(scenario: &Scenario, go_on: impl Fn() -> bool) -> Result<Option<Verdict>, ScenarioError> {
    let mut run = match Run::new(scenario) {
        Ok(run) => run,
        Err(ScenarioError::CannotStand(missing)) => return Ok(Some(Verdict::of_fall(&scenario.model, missing))),
        Err(error) => return Err(error),
    };
    let mut fails = false;
    while let Some(sample) = run.next_sample()? {
        fails = !sample.stepping
            && (sample.exhausted.iter().flatten().any(|exhausted| *exhausted)
                || sample.load.iter().any(|load| *load > 1.0));
        if fails {
            break;
        }
        if !go_on() {
            return Ok(None);
        }
    }
    let mut summary = run.summary();
    if fails {
        // It was left on purpose, with its answer known.
        summary.reason = StopReason::Duration;
    }
    Ok(Some(Verdict::of_run(scenario, &summary)))
}

/// Tries a change; `None` where the changed scenario is not in order, or `go_on` said no.
pub fn suggestion(scenario: &Scenario, change: &Change, go_on: impl Fn() -> bool) -> Option<Suggestion> {
    let verdict = trial(&change.apply(scenario), go_on).ok()??;
    Some(Suggestion {
        change: change.in_words(scenario),
        kind: verdict.kind,
        seconds: verdict.seconds,
        load: verdict.who.map(|group| group.load),
    })
}

impl Suggestion {
    /// The suggestions that help, the one that helps most first: a better kind of verdict, or the same for longer.
    pub fn that_help(mut all: Vec<Self>, verdict: &Verdict) -> Vec<Self> {
        let least = verdict.seconds.unwrap_or(0.0) * LONGER;
        let helps = |one: &Self| {
            let longer = one.seconds.unwrap_or(f64::INFINITY) > least;
            one.kind.is_done() && (one.kind > verdict.kind || (one.kind == verdict.kind && longer))
        };
        all.retain(helps);
        let load = |one: &Self| one.load.unwrap_or(0.0);
        let time = |one: &Self| one.seconds.unwrap_or(f64::INFINITY);
        all.sort_by(|a, b| b.kind.cmp(&a.kind).then(time(b).total_cmp(&time(a))).then(load(a).total_cmp(&load(b))));
        all
    }

    /// `with the target of right hand 10 cm lower it holds through the run (60 min)`.
    pub fn in_words(&self) -> String {
        let time = self.seconds.map_or_else(String::new, how_long);
        match self.kind {
            VerdictKind::Holds if time.is_empty() => {
                format!("with {} it holds without a limit by muscles", self.change)
            }
            VerdictKind::Holds => format!("with {} it holds through the run ({time})", self.change),
            _ => format!("with {} it can be held {time}", self.change),
        }
    }

    /// The sentence after the verdict; `None` where nothing needs to change.
    pub fn sentence(helping: &[Self], tried: usize, verdict: &Verdict) -> Option<String> {
        match helping {
            _ if tried == 0 || verdict.kind == VerdictKind::Holds => None,
            [] => Some(format!("None of the {tried} changes that were tried helps.")),
            [best] => Some(format!("What would help: {}.", best.in_words())),
            [best, rest @ ..] => {
                let rest: Vec<String> = rest.iter().map(Self::in_words).collect();
                Some(format!("What would help most: {}. Also: {}.", best.in_words(), rest.join("; ")))
            }
        }
    }
}
