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
    /// The time that was asked for, s.
    pub asked: f64,
    /// How long the job can be done with it, s: until a group fails; of a job that holds, with the posture of its end held on. `None`
    /// where no muscle sets a limit, or where it cannot be done.
    pub seconds: Option<f64>,
    /// Least of that time for two of three people, s.
    pub least: Option<f64>,
    /// Number of coordinates that ligaments carry in hazard at the end.
    pub hazards: usize,
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
        asked: scenario.run.end(),
        seconds: verdict.seconds,
        least: verdict.range.map(|(least, _)| least),
        hazards: verdict.hazards.len(),
        load: verdict.hardest.map(|group| group.load),
    })
}

/// Times of a job for comparison: that of the mean person, and the least for two of three people, s; infinite without a limit.
fn times(seconds: Option<f64>, least: Option<f64>) -> (f64, f64) {
    (seconds.unwrap_or(f64::INFINITY), least.unwrap_or(f64::INFINITY))
}

impl Suggestion {
    /// The suggestions that help, the one that helps most first: a better kind of verdict, or the same with fewer hazards or for longer; where no muscle
    /// limits the mean person before or after, longer for weaker ones.
    pub fn that_help(mut all: Vec<Self>, verdict: &Verdict) -> Vec<Self> {
        let (before, least_before) = times(verdict.seconds, verdict.range.map(|(least, _)| least));
        let longer = |one: &Self| {
            let (after, least_after) = times(one.seconds, one.least);
            after > LONGER * before || (after.is_infinite() && least_after > LONGER * least_before)
        };
        let safer = |one: &Self| one.hazards < verdict.hazards.len();
        let equally_safe = |one: &Self| one.hazards == verdict.hazards.len();
        let better = |one: &Self| safer(one) || equally_safe(one) && longer(one);
        let helps =
            |one: &Self| one.kind.is_done() && (one.kind > verdict.kind || one.kind == verdict.kind && better(one));
        all.retain(helps);
        all.sort_by(|a, b| {
            let ((time_a, least_a), (time_b, least_b)) = (times(a.seconds, a.least), times(b.seconds, b.least));
            let load = a.load.unwrap_or(0.0).total_cmp(&b.load.unwrap_or(0.0));
            b.kind
                .cmp(&a.kind)
                .then(a.hazards.cmp(&b.hazards))
                .then(time_b.total_cmp(&time_a))
                .then(least_b.total_cmp(&least_a))
                .then(load)
        });
        all
    }

    /// `with the target of right hand 10 cm lower it holds through the run (5.0 min), about 11.2 min in all`,
    /// `with 20 % less load it can be held 11 s of the 30 s asked`.
    pub fn in_words(&self) -> String {
        let (change, asked) = (&self.change, how_long(self.asked));
        let hazard = if self.hazards > 0 { ", with ligaments in hazard" } else { "" };
        let time = match (self.kind, self.seconds) {
            (VerdictKind::Holds, Some(time)) => {
                format!("with {change} it holds through the run ({asked}), about {} in all", how_long(time))
            }
            (VerdictKind::Holds, None) => format!("with {change} it holds through the run ({asked}) without a limit"),
            (_, time) => format!("with {change} it can be held {} of the {asked} asked", how_long(time.unwrap_or(0.0))),
        };
        time + hazard
    }

    /// The sentence after the verdict; `None` where nothing was tried.
    pub fn sentence(helping: &[Self], tried: usize, verdict: &Verdict) -> Option<String> {
        match helping {
            _ if verdict.has_reserve() => Some("Nothing needs to change.".to_owned()),
            _ if tried == 0 => None,
            [] if tried == 1 => Some("The one change that was tried does not help.".to_owned()),
            [] => Some(format!("None of the {tried} changes that were tried helps.")),
            [best] => Some(format!("What would help: {}.", best.in_words())),
            [best, rest @ ..] => {
                let rest: Vec<String> = rest.iter().map(Self::in_words).collect();
                Some(format!("What would help most: {}. Also: {}.", best.in_words(), rest.join("; ")))
            }
        }
    }
}
