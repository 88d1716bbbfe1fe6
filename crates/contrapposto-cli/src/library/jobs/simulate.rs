//! Carries out a scenario over time.

use contrapposto::simulation::{Fall, Run, ScenarioError, Summary};
use contrapposto::suggestions::Advice;
use contrapposto::verdict::Verdict;
use contrapposto_formats::RunScenario;
use contrapposto_formats::tissue::fatigue_notes;

use super::source::ScenarioSource;
use crate::args::SuggestArgs;
use crate::commands::simulate::{read, summary_json};
use crate::commands::trials::{advice_of_run, advice_without_posture};
use crate::fail::Fail;
use crate::library::failure::{Failure, Note, with_notes};
use crate::library::frames::Frames;
use crate::output::print_note;
use crate::view::answer::{Answer, text_without_posture};
use crate::view::frame::Frame;
use crate::view::recording::Recording;
use crate::view::report::run::{muscles_of_run, report_of_run};

/// A run; without samples of a body that cannot stand.
pub struct Simulated {
    run: RunScenario,
    course: Option<(Recording, Summary, Answer)>,
    json: String,
    frames: Frames,
}

impl Simulated {
    /// Carries out `simulate` of the program, while `go_on` says yes; `suggest`: changes of a job that does not hold are tried.
    ///
    /// # Errors
    /// [`Failure`] as the program prints it.
    pub fn new(
        source: &ScenarioSource,
        suggest: bool,
        go_on: impl Fn() -> bool + Sync,
    ) -> Result<(Self, Vec<Note>), Failure> {
        with_notes(|| {
            let run = read(source.open()?)?;
            run.notes.iter().for_each(|note| print_note("note", note));
            fatigue_notes(&run.scenario.model).iter().for_each(|note| print_note("note", note));
            Self::of(run, suggest, go_on)
        })
    }

    fn of(run: RunScenario, suggest: bool, go_on: impl Fn() -> bool + Sync) -> Result<Self, Fail> {
        let scenario = &run.scenario;
        let trials = SuggestArgs { no_suggest: !suggest, ..SuggestArgs::default() };
        let failed = |error: ScenarioError| Fail::job("simulation", error);
        let mut under_way = match Run::new(scenario) {
            Ok(under_way) => under_way,
            Err(ScenarioError::CannotStand(missing) | ScenarioError::Falls(Fall { missing, .. })) => {
                let verdict = Verdict::of_fall(&scenario.model, missing, &scenario.loads);
                let advice = advice_without_posture(&verdict, scenario, trials, &go_on);
                let answer = (&verdict, &advice);
                let json = text_without_posture("summary.json", &scenario.title, &scenario.model, answer)?;
                let frames = Frames::of(&scenario.model, &[]);
                return Ok(Self { run, course: None, json, frames });
            }
            Err(error) => return Err(failed(error)),
        };
        let (mut recording, mut number) = (Recording::new(scenario), 0);
        while go_on() {
            let Some(sample) = under_way.next_sample().map_err(failed)? else { break };
            recording.record(number, &sample);
            number += 1;
        }
        let summary = under_way.summary();
        let mut answer = Answer::of_run(scenario, &summary);
        if suggest && go_on() {
            let job = (&summary, under_way.solver_steps());
            let advice = advice_of_run(&answer.verdict, scenario, job, trials, &go_on);
            answer.advice = if go_on() { advice } else { Advice::broken_off() };
        }
        let muscles = muscles_of_run(scenario, &recording, &summary)?;
        let json = summary_json(scenario, (&summary, muscles.as_ref()), &answer, vec![])?;
        let frames: Vec<Frame> = recording.rows().map(|row| Frame::of_row(&scenario.model, row)).collect();
        let frames = Frames::of(&scenario.model, &frames);
        Ok(Self { course: Some((recording, summary, answer)), json, frames, run })
    }

    /// The text of `summary.json`.
    pub fn json(&self) -> &str {
        &self.json
    }

    /// The samples; of a long run every second, third, ... one.
    pub fn frames(&self) -> &Frames {
        &self.frames
    }

    /// The page `report.html`.
    ///
    /// # Errors
    /// [`Failure`] where the page cannot be drawn, or the body cannot stand.
    pub fn report(&self) -> Result<String, Failure> {
        let RunScenario { scenario, things, .. } = &self.run;
        match &self.course {
            Some((recording, summary, answer)) => {
                let muscles = muscles_of_run(scenario, recording, summary)?;
                Ok(report_of_run((scenario, things.as_slice()), (recording, muscles.as_ref()), summary, answer)?)
            }
            None => Err(Failure::failed("the body cannot stand: there is no run to show")),
        }
    }
}
