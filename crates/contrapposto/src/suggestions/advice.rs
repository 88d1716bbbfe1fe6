//! Says which changes of a job help, and which were not tried.

use super::budget::{Budget, Trial, within};
use super::change::{Change, Job};
use super::trial::Suggestion;
use crate::verdict::{Verdict, has_motors};

/// The sentence of a job with reserve. Fatigue of muscles is judged, and hazards are; ligaments and discs besides are not.
const NOTHING: &str = "Nothing needs to change as to muscle fatigue";

/// The changes of a job that were tried.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Advice {
    /// Suggestions that help, the one that helps most first.
    pub helping: Vec<Suggestion>,
    /// Suggestions that were not tried because the budget was used up, in words.
    pub not_tried: Vec<String>,
    /// `What would help most: ...`; `None` where there is nothing to say.
    pub sentence: Option<String>,
}

impl Advice {
    /// Tries changes of a job in their order within a budget; nothing for a job that holds with reserve. `known` are suggestions that
    /// need no trial.
    pub fn new(
        verdict: &Verdict,
        job: &Job<'_>,
        changes: impl FnOnce() -> Vec<Change>,
        known: impl FnOnce() -> Option<Suggestion>,
        budget: Budget,
        trial: impl Fn(&Change) -> Trial + Sync,
    ) -> Self {
        if verdict.has_reserve() {
            return Self {
                sentence: Some(if has_motors(job.model) {
                    "Nothing needs to change.".to_owned()
                } else {
                    format!("{NOTHING}.")
                }),
                ..Self::default()
            };
        }
        let changes = changes();
        let trials = within(budget, &changes, trial);
        let not_tried: Vec<String> = changes[trials.len()..].iter().map(|change| change.in_words(job)).collect();
        let suggestion =
            |(change, trial): (&Change, &Trial)| Some(Suggestion::new(job, change, trial.verdict.as_ref()?));
        let all: Vec<Suggestion> = changes.iter().zip(&trials).filter_map(suggestion).chain(known()).collect();
        let tried: Vec<String> = all.iter().map(|one| one.change.clone()).collect();
        let helping = Suggestion::that_help(all, verdict);
        let sentence = sentence(verdict, &helping, &tried, &not_tried);
        Self { helping, not_tried, sentence }
    }
}

/// The sentence after the verdict; `None` where there is nothing to try.
fn sentence(verdict: &Verdict, helping: &[Suggestion], tried: &[String], not_tried: &[String]) -> Option<String> {
    let all = tried.join("; ");
    let stays = !helping.is_empty() && !verdict.hazards.is_empty() && helping.iter().all(|one| one.hazards > 0);
    let hazard = stays.then(|| format!("No change that was tried ends every hazard: {all}."));
    let what = match (stays, helping.iter().any(|one| one.lessens_hazards(verdict))) {
        (false, _) => "What would help",
        (true, false) => "What would let it go on longer",
        (true, true) => "What would end some of them, or let it go on longer",
    };
    let said = match helping {
        [] if tried.is_empty() => None,
        [] if tried.len() == 1 => Some(format!("The one change that was tried does not help: {all}.")),
        [] => Some(format!("None of the {} changes that were tried helps: {all}.", tried.len())),
        [best] => Some(format!("{what}: {}.", best.in_words(verdict))),
        [best, rest @ ..] => {
            let rest: Vec<String> = rest.iter().map(|one| one.in_words(verdict)).collect();
            let most = if stays { "" } else { " most" };
            Some(format!("{what}{most}: {}. Also: {}.", best.in_words(verdict), rest.join("; ")))
        }
    };
    let left = (!not_tried.is_empty())
        .then(|| format!("Not tried, to keep the computing time short: {}.", not_tried.join("; ")));
    let parts: Vec<String> = hazard.into_iter().chain(said).chain(left).collect();
    (!parts.is_empty()).then(|| parts.join(" "))
}
