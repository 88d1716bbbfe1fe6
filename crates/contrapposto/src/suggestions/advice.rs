//! Says which changes of a job help, and which were not tried.

use super::budget::{Budget, Trial, within};
use super::change::{Change, SHELF};
use super::gain::Gains;
use super::job::Job;
use super::largest::LargestLoad;
use super::trial::Suggestion;
use crate::tasks::Unit;
use crate::verdict::{A_DAY, Line, Verdict, VerdictKind, asked_in_words, has_motors};

/// The sentence of a job with reserve.
const NOTHING: &str = "Nothing needs to change";
/// The name of the column of the job where no change stands below it.
const AS_IT_IS: &str = "The job";
/// People whose strength is one standard deviation below the mean.
const WEAKER_PEOPLE: &str = "weaker people";
/// Most pairs of changes that are tried. Assumed.
const MOST_PAIRS: usize = 2;

/// The changes of a job that were tried.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Advice {
    /// Suggestions that help, the one that helps most first.
    pub helping: Vec<Suggestion>,
    /// Suggestions that were not tried because the budget was used up, in words.
    pub not_tried: Vec<String>,
    /// The suggestions that help beside the job as it is; the job alone where there are none, without rows where it cannot be done.
    pub gains: Gains,
    /// The largest loads of the job, where they were searched for.
    pub largest: Option<LargestLoad>,
    /// Sentences about changes that do not help, or were not tried.
    pub notes: Vec<String>,
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
            return Self::of_reserve(verdict, job);
        }
        if let Some(why) = out_of_reach(verdict) {
            return Self { notes: vec![why.to_owned()], ..Self::default() };
        }
        let mut changes = changes();
        let suggestion =
            |(change, trial): (&Change, &Trial)| Some(Suggestion::new(job, change, trial.verdict.as_ref()?));
        let mut trials = within(budget, &changes, &trial);
        let not_tried = changes.split_off(trials.len());
        let mut all: Vec<Suggestion> = changes.iter().zip(&trials).filter_map(suggestion).chain(known()).collect();
        let single = Suggestion::that_help(all.clone(), verdict);
        let tried: Vec<String> = all.iter().map(|one| one.change.clone()).collect();
        let lacking = lacking(verdict, &single);
        let mut two_tried = false;
        if (lacking.is_some() || single.is_empty()) && not_tried.is_empty() {
            let two = pairs(job, &single, &changes);
            let steps = budget.steps.saturating_sub(trials.iter().map(|trial| trial.steps).sum());
            trials = within(Budget { steps, ..budget }, &two, &trial);
            two_tried = !trials.is_empty();
            all.extend(two.iter().zip(&trials).filter_map(suggestion));
        }
        let not_tried: Vec<String> = not_tried.iter().map(|change| change.in_words(job)).collect();
        let helping = Suggestion::that_help(all, verdict);
        let gains = match helping.is_empty() {
            true if !verdict.kind.is_done() || verdict.hardest.is_none() => Gains::default(),
            true => Gains::new(job.model, AS_IT_IS, verdict, &[]),
            false => Gains::new(job.model, heading(verdict, &helping), verdict, &helping),
        };
        let too_little =
            lacking.filter(|_| !has_motors(job.model)).map(|people| too_little(people, &helping, two_tried));
        let notes = too_little.into_iter().chain(notes(verdict, &helping, &tried, &not_tried)).collect();
        Self { helping, not_tried, gains, largest: None, notes }
    }

    /// Of a job whose changes were not tried to their end: what was found until then may not be what helps most.
    pub fn broken_off() -> Self {
        let note = "Changes of the job were not tried to their end, as the program was interrupted.";
        Self { notes: vec![note.to_owned()], ..Self::default() }
    }

    /// Of a job that holds with reserve: the sentence that nothing needs to change, beside the time that the job lasts.
    fn of_reserve(verdict: &Verdict, job: &Job<'_>) -> Self {
        if verdict.hardest.is_none() {
            return Self::default();
        }
        let judged = verdict.lines.iter().any(|line| line.name == Line::HAZARD);
        let about = match (has_motors(job.model), judged) {
            (true, _) => "",
            (false, true) => " for muscles and ligaments",
            (false, false) => " for muscles",
        };
        // Where no time is asked, weaker people may tire, and nobody knows whether that is too early.
        let who = match (verdict.asked, verdict.least) {
            (None, Some(least)) if least < A_DAY => " of people of mean strength",
            _ => "",
        };
        let comma = if about.is_empty() { "" } else { "," };
        let time = verdict.asked.map(|asked| format!(" in the {} asked{comma}", asked_in_words(asked)));
        let note = format!("{NOTHING}{}{about}{who}.", time.unwrap_or_default());
        Self { gains: Gains::new(job.model, AS_IT_IS, verdict, &[]), notes: vec![note], ..Self::default() }
    }
}

/// The reason for which no change of a job is tried that misses its most important target by more than any change moves it.
fn out_of_reach(verdict: &Verdict) -> Option<&'static str> {
    let missed = verdict.missed.iter().find(|missed| missed.decides && verdict.kind == VerdictKind::NotReached)?;
    let far = missed.unit == Some(Unit::Metre) && missed.distance > SHELF;
    match (missed.contradicts, far) {
        (true, _) => Some("No change was tried: no place of the body meets both targets."),
        (false, true) => {
            Some("No change was tried: the target is farther away than any of them would move it (30 cm at most).")
        }
        (false, false) => None,
    }
}

/// Whether every change that helps leaves a joint in hazard.
fn hazard_stays(verdict: &Verdict, helping: &[Suggestion]) -> bool {
    !helping.is_empty() && !verdict.hazards.is_empty() && helping.iter().all(|one| one.hazards > 0)
}

/// The name of the column of changes that help.
fn heading(verdict: &Verdict, helping: &[Suggestion]) -> &'static str {
    match (hazard_stays(verdict, helping), helping.iter().any(|one| one.lessens_hazards(verdict))) {
        (false, _) => "What would help",
        (true, false) => "What would let it go on longer",
        (true, true) => "What would end some hazards, or let it go on longer",
    }
}

/// The sentences about changes that do not help, or were not tried.
fn notes(verdict: &Verdict, helping: &[Suggestion], tried: &[String], not_tried: &[String]) -> Vec<String> {
    let all = tried.join("; ");
    let others = tried.iter().filter(|change| helping.iter().all(|one| one.change != **change)).cloned();
    let others: Vec<String> = others.collect();
    let others = if others.is_empty() { String::new() } else { format!(" Tried without help: {}.", others.join("; ")) };
    let of_all = match (helping, tried.len()) {
        ([], 0) => None,
        ([], 1) => Some(format!("The one change that was tried does not help: {all}.")),
        ([], count) => Some(format!("None of the {count} changes that were tried helps: {all}.")),
        _ if hazard_stays(verdict, helping) => Some(format!("No change that was tried ends every hazard.{others}")),
        _ => None,
    };
    let left =
        (!not_tried.is_empty()).then(|| format!("Not calculated, to keep the answer quick: {}.", not_tried.join("; ")));
    of_all.into_iter().chain(left).collect()
}

/// The people whom no change that helps lets go on for the asked time: those of mean strength, or only weaker ones.
fn lacking(verdict: &Verdict, helping: &[Suggestion]) -> Option<&'static str> {
    let asked = helping.first()?.asked?;
    let enough = |one: &Suggestion| one.kind == VerdictKind::Holds;
    let for_weaker = |one: &Suggestion| one.least.is_none_or(|least| one.reaches(least));
    let people = if helping.iter().any(enough) { WEAKER_PEOPLE } else { "people of mean strength" };
    let lacks = !helping.iter().any(for_weaker) && verdict.least.is_none_or(|least| least < asked);
    lacks.then_some(people)
}

/// Says that no single change suffices for these people, and whether two at once do, where these were tried.
fn too_little(people: &str, helping: &[Suggestion], two_tried: bool) -> String {
    let enough =
        |one: &&Suggestion| if people == WEAKER_PEOPLE { one.suffices() } else { one.kind == VerdictKind::Holds };
    match (two_tried, helping.iter().filter(|one| one.both).any(|one| enough(&one))) {
        (false, _) => format!("No single change that was tried suffices for {people}."),
        (true, true) => format!("No single change that was tried suffices for {people}; two at once do."),
        (true, false) => {
            format!("No change that was tried suffices for {people}, alone or in the pairs that were tried.")
        }
    }
}

/// The changes that help most, and after them those of most promise, two at a time, as far as they go together: those that are tried where
/// no single one suffices.
fn pairs(job: &Job<'_>, helping: &[Suggestion], changes: &[Change]) -> Vec<Change> {
    let change = |one: &Suggestion| changes.iter().find(|change| change.in_words(job) == one.change);
    let mut best: Vec<&Change> = helping.iter().filter_map(change).collect();
    let others: Vec<&Change> = changes.iter().filter(|change| !best.contains(change)).collect();
    best.extend(others);
    let later = |(k, first): (usize, _)| best[k + 1..].iter().map(move |second| (first, second));
    let two = best.iter().enumerate().flat_map(later).filter_map(|(first, second): (&&Change, _)| first.with(second));
    two.take(MOST_PAIRS).collect()
}
