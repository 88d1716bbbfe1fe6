//! Tries changes of a job on all cores of the machine, within a budget of solver steps.

use contrapposto::equilibria::Search;
use contrapposto::posture_solver::Options;
use contrapposto::simulation::{Scenario, Summary};
use contrapposto::suggestions::{
    Advice, Budget, Job, LargestLoad, Worked, by_promise, by_promise_of_search, changes, try_run, try_search,
    with_breaks,
};
use contrapposto::verdict::Verdict;

use crate::args::SuggestArgs;
use crate::output::print_note;

/// Number of cores of the machine, as far as it is known.
pub(super) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

impl SuggestArgs {
    /// The budget of a job that took `steps` solver steps; `None` where nothing is to be tried.
    pub(super) fn budget(self, steps: usize) -> Option<Budget> {
        let budget = Budget::of_job(steps, cores());
        (!self.no_suggest).then_some(Budget { steps: self.suggest_steps.unwrap_or(budget.steps), ..budget })
    }
}

/// The changes of a scenario whose run has this summary and took so many solver steps.
pub(crate) fn advice_of_run(
    verdict: &Verdict,
    scenario: &Scenario,
    (summary, steps): (&Summary, usize),
    suggest: SuggestArgs,
    go_on: impl Fn() -> bool + Sync,
) -> Advice {
    let Some(budget) = suggest.budget(steps) else { return Advice::default() };
    let job = Job::from(scenario);
    let groups = Worked::in_run(scenario, summary);
    let worked = (groups.as_slice(), summary.muscles.as_ref());
    let breaks = || with_breaks(worked, scenario.run.end(), (0.0, summary.end_time), verdict);
    Advice::new(
        verdict,
        &job,
        || by_promise(scenario, summary, changes(&job, &verdict.hazards)),
        || verdict.kind.is_done().then(breaks).flatten(),
        budget,
        |change| try_run(scenario, change, &go_on),
    )
}

/// The changes of a scenario whose body cannot stand at the start.
pub(crate) fn advice_without_posture(
    verdict: &Verdict,
    scenario: &Scenario,
    suggest: SuggestArgs,
    go_on: impl Fn() -> bool + Sync,
) -> Advice {
    let Some(budget) = suggest.budget(0) else { return Advice::default() };
    let job = Job::from(scenario);
    let trial = |change: &_| try_run(scenario, change, &go_on);
    Advice::new(verdict, &job, || changes(&job, &verdict.hazards), || None, budget, trial)
}

/// The largest loads of a scenario, where they are `asked` for, its body has some, and `go_on` lets the search end.
pub(crate) fn largest_load(
    scenario: &Scenario,
    (asked, steps): (bool, usize),
    suggest: SuggestArgs,
    go_on: impl Fn() -> bool + Sync,
) -> Option<LargestLoad> {
    if !asked {
        return None;
    }
    let budget = SuggestArgs { no_suggest: false, ..suggest }.budget(steps)?;
    let found = LargestLoad::find(&Job::from(scenario), budget, |change| try_run(scenario, change, &go_on));
    if found.is_none() {
        let why = if scenario.loads.is_empty() { "the job has no load" } else { "none held within the solver steps" };
        print_note("note", &format!("there is no largest load: {why}"));
    }
    found.filter(|_| go_on())
}

/// The changes of a search for postures of least effort, whose best posture is `search.start`, and which took so many solver steps.
/// `given` is the search as it was.
pub(super) fn advice_of_search(
    verdict: &Verdict,
    (given, search): (&Search<'_>, &Search<'_>),
    (options, steps): (Options, usize),
    suggest: SuggestArgs,
) -> Advice {
    let Some(budget) = suggest.budget(steps) else { return Advice::default() };
    let job = Job::from(given);
    let order = || by_promise_of_search(search, changes(&job, &verdict.hazards));
    Advice::new(verdict, &job, order, || None, budget, |change| try_search(given, options, change))
}
