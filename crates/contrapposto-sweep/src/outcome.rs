//! Carries out one row: the run of a scenario, and what counts of its answer.

use contrapposto::model::Model;
use contrapposto::simulation::{Fall, Run, Scenario, ScenarioError};
use contrapposto::verdict::{Verdict, Who};
use contrapposto_formats::read_run;

/// Kind of a row whose scenario is refused, or whose run ends with an error.
pub(crate) const REFUSED: &str = "refused";

/// The answer of one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Kind of the verdict; `refused` where the reader refuses the scenario with these values, or the run ends with an error.
    pub kind: &'static str,
    /// Time for which the job can be done, min; `None` where muscles set no limit, and where the job cannot be done.
    pub minutes: Option<f64>,
    /// The muscle group that is too weak or fails first; where none does, the one with the greatest load.
    pub who: Option<String>,
    /// The muscle group with the greatest load.
    pub hardest: Option<String>,
    /// Active torque of that group over its strength.
    pub load: Option<f64>,
    /// Sum of (active torque / strength)^2 at the end.
    pub effort: Option<f64>,
    /// Simulated time, s.
    pub seconds: Option<f64>,
    /// Whether a search for an easier posture was cut short at its budget.
    pub search_cut: Option<bool>,
    /// The reason for which it is refused.
    pub note: Option<String>,
}

impl Outcome {
    /// Of the scenario `text`, while `go_on` says yes; `None` where it says no. `name` is its name for messages.
    pub fn of(name: &str, text: &str, go_on: impl Fn() -> bool) -> Option<Self> {
        let scenario = match read_run(name, text.as_bytes(), None) {
            Ok(run) => run.scenario,
            Err(error) => return Some(Self { kind: REFUSED, note: Some(error.to_string()), ..Self::default() }),
        };
        let mut run = match Run::new(&scenario) {
            Ok(run) => run,
            Err(error) => return Some(Self::without_run(&scenario.model, error)),
        };
        let mut loads = vec![];
        loop {
            if !go_on() {
                return None;
            }
            match run.next_sample() {
                Ok(Some(sample)) => {
                    loads.clear();
                    loads.extend_from_slice(sample.load);
                }
                Ok(None) => break,
                Err(error) => return Some(Self::without_run(&scenario.model, error)),
            }
        }
        let summary = run.summary();
        let effort = summary.standing.as_ref().map_or_else(|| loads.iter().map(|load| load * load).sum(), |s| s.effort);
        let verdict = Verdict::of_run(&scenario, &summary);
        let (effort, seconds, search_cut) = (Some(effort), Some(summary.end_time), Some(summary.search_cut));
        Some(Self { effort, seconds, search_cut, ..Self::answered(&scenario, &verdict) })
    }

    /// Of a run that ended with an error: a body that its supports do not hold cannot stand, whether before the first sample or in it.
    fn without_run(model: &Model, error: ScenarioError) -> Self {
        match error {
            ScenarioError::CannotStand(missing) | ScenarioError::Falls(Fall { missing, .. }) => {
                Self { kind: Verdict::of_fall(model, missing, &[]).kind.word(), ..Self::default() }
            }
            error => Self { kind: REFUSED, note: Some(error.to_string()), ..Self::default() },
        }
    }

    fn answered(scenario: &Scenario, verdict: &Verdict) -> Self {
        let name = |who: Who| who.name(&scenario.model);
        Self {
            kind: verdict.kind.word(),
            minutes: verdict.seconds.filter(|seconds| seconds.is_finite()).map(|seconds| seconds / 60.0),
            who: verdict.who.map(name),
            hardest: verdict.hardest.map(name),
            load: verdict.hardest.map(|who| who.load),
            ..Self::default()
        }
    }
}
