//! Finds the different postures of least effort on supports.

use contrapposto::equilibria::{Equilibria, SearchError};
use contrapposto::verdict::Verdict;
use contrapposto_formats::RelaxScenario;

use super::source::ScenarioSource;
use crate::args::SuggestArgs;
use crate::commands::relax::{advice_without, answer, find, frames_and_muscles, read};
use crate::fail::Fail;
use crate::library::failure::{Failure, Note, with_notes};
use crate::library::frames::Frames;
use crate::output::json_text;
use crate::view::answer::{Answer, text_without_posture};
use crate::view::report::equilibria::report_of_equilibria;
use crate::view::text::relax::RelaxText;

/// The postures of least effort; none of a body that cannot stand.
pub struct Relaxed {
    scenario: RelaxScenario,
    found: Option<(Equilibria, Answer)>,
    json: String,
    frames: Frames,
}

impl Relaxed {
    /// Carries out `relax` of the program.
    ///
    /// # Errors
    /// [`Failure`] as the program prints it.
    pub fn new(source: &ScenarioSource) -> Result<(Self, Vec<Note>), Failure> {
        with_notes(|| {
            let file = source.open()?;
            let name = file.name.clone();
            let mut scenario = read(file)?;
            match find(&mut scenario) {
                Ok(found) => Self::of(scenario, found),
                Err(SearchError::CannotStand(missing)) => {
                    let verdict = Verdict::of_fall(&scenario.model, missing, &scenario.loads);
                    let advice = advice_without(&scenario, &verdict, SuggestArgs::default());
                    let answer = (&verdict, &advice);
                    let json = text_without_posture("relax.json", &scenario.title, &scenario.model, answer)?;
                    let frames = Frames::of(&scenario.model, &[]);
                    Ok(Self { scenario, found: None, json, frames })
                }
                Err(SearchError::Relax(error)) => Err(Fail::Refused(format!("{name}: {error}"))),
                Err(error) => Err(Fail::Job(format!("{name}: {error}"))),
            }
        })
    }

    fn of(scenario: RelaxScenario, found: Equilibria) -> Result<Self, Fail> {
        let answer = answer(&scenario, &found, SuggestArgs::default());
        let (frames, muscles) = frames_and_muscles(&scenario, &found)?;
        let text = RelaxText::new(&scenario, (&found, muscles.as_ref()), &answer, vec![]);
        let json = json_text("relax.json", &text)?;
        let frames = Frames::of(&scenario.model, &frames);
        Ok(Self { scenario, found: Some((found, answer)), json, frames })
    }

    /// The text of `relax.json`.
    pub fn json(&self) -> &str {
        &self.json
    }

    /// The postures with their torques, the one of least effort first.
    pub fn frames(&self) -> &Frames {
        &self.frames
    }

    /// The page `report.html`.
    ///
    /// # Errors
    /// [`Failure`] where the page cannot be drawn, or the body cannot stand.
    pub fn report(&self) -> Result<String, Failure> {
        match &self.found {
            Some((found, answer)) => {
                let (frames, muscles) = frames_and_muscles(&self.scenario, found)?;
                Ok(report_of_equilibria(&self.scenario, found, (&frames, muscles.as_ref()), answer)?)
            }
            None => Err(Failure::failed("the body cannot stand: there is no posture to show")),
        }
    }
}
