//! Tries the changes of a job that does not hold with reserve, several at once.

use contrapposto::simulation::{Scenario, Summary};
use contrapposto::suggestions::{Change, Suggestion, changes, suggestion, with_breaks};

use crate::view::answer::Answer;

/// Tries all changes of a job that does not hold, or holds without reserve, on `threads` threads, while `go_on` says yes, and completes the answer. The
/// findings do not depend on the number of threads.
pub(crate) fn try_changes(
    answer: &mut Answer,
    scenario: &Scenario,
    summary: &Summary,
    threads: usize,
    go_on: impl Fn() -> bool + Sync,
) {
    let verdict = &answer.verdict;
    if verdict.has_reserve() {
        answer.advice = Suggestion::sentence(&[], 0, verdict);
        return;
    }
    let mut tried: Vec<Option<Suggestion>> = vec![];
    let go_on = &go_on;
    for part in changes(scenario).chunks(threads.max(1)) {
        tried.extend(std::thread::scope(|scope| {
            let run = |change: &'_ Change| suggestion(scenario, change, go_on);
            let runs: Vec<_> = part.iter().map(|change| scope.spawn(move || run(change))).collect();
            // A change whose run ends in a panic is none that helps.
            runs.into_iter().map(|run| run.join().ok().flatten()).collect::<Vec<_>>()
        }));
    }
    let breaks = verdict.kind.is_done().then(|| with_breaks(scenario, summary, verdict)).flatten();
    let tried: Vec<Suggestion> = tried.into_iter().flatten().chain(breaks).collect();
    let number = tried.len();
    let helping = Suggestion::that_help(tried, verdict);
    answer.advice = Suggestion::sentence(&helping, number, verdict);
    answer.helping = helping;
}
