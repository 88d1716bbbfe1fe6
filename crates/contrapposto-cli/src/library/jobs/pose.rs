//! Solves one posture from tasks in order of priority.

use std::slice::from_ref;

use contrapposto::posture_solver::SolvedPosture;
use contrapposto_formats::{PoseScenario, PoseText};

use super::source::ScenarioSource;
use crate::args::SuggestArgs;
use crate::commands::pose::{answer, read, solve};
use crate::fail::Fail;
use crate::library::failure::{Failure, Note, with_notes};
use crate::library::frames::Frames;
use crate::output::json_text;
use crate::view::answer::Answer;
use crate::view::held::held;
use crate::view::muscle_work::{MusclesAtWork, muscles_at_work};
use crate::view::report::pose::report_of_pose;

/// A solved posture.
pub struct Posed {
    scenario: PoseScenario,
    pose: SolvedPosture,
    kept_balance: bool,
    answer: Answer,
    json: String,
    frames: Frames,
}

impl Posed {
    /// Carries out `pose` of the program.
    ///
    /// # Errors
    /// [`Failure`] as the program prints it.
    pub fn new(source: &ScenarioSource) -> Result<(Self, Vec<Note>), Failure> {
        with_notes(|| {
            let file = source.open()?;
            let name = file.name.clone();
            let mut scenario = read(file)?;
            let crate::commands::pose::Posed { pose, held, kept_balance, .. } = solve(&name, &mut scenario)?;
            let answer = answer(&scenario, &pose, &held, SuggestArgs::default());
            let muscles = muscles_at_work(&scenario.model, scenario.muscles.as_ref(), from_ref(&held.frame), |_| true)?;
            let text = PoseText::new(&scenario, &pose, (&answer.verdict, &answer.advice), vec![]);
            let text = PoseText { muscle_work: muscles.as_ref().map(MusclesAtWork::text), ..text };
            let json = json_text("pose.json", &text)?;
            let frames = Frames::of(&scenario.model, &[held.frame]);
            Ok(Self { scenario, pose, kept_balance, answer, json, frames })
        })
    }

    /// The text of `pose.json`.
    pub fn json(&self) -> &str {
        &self.json
    }

    /// The posture with its torques.
    pub fn frames(&self) -> &Frames {
        &self.frames
    }

    /// The page `report.html`.
    ///
    /// # Errors
    /// [`Failure`] where the page cannot be drawn.
    pub fn report(&self) -> Result<String, Failure> {
        let page = || -> Result<String, Fail> {
            let Self { scenario, pose, kept_balance, answer, .. } = self;
            let held = held(&scenario.model, &pose.posture, &scenario.loads, &scenario.supports)?;
            let text = PoseText::new(scenario, pose, (&answer.verdict, &answer.advice), vec![]);
            let muscles = muscles_at_work(&scenario.model, scenario.muscles.as_ref(), from_ref(&held.frame), |_| true)?;
            report_of_pose(scenario, (pose, *kept_balance), (&text, answer), (held, muscles.as_ref()))
        };
        page().map_err(Failure::from)
    }
}
