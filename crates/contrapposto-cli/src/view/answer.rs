//! Says a verdict: first line, the changes that help, JSON file of a job without a posture, and exit code.

use contrapposto::contact::Missing;
use contrapposto::model::Model;
use contrapposto::simulation::{Scenario, Summary};
use contrapposto::statics::Load;
use contrapposto::suggestions::{Advice, LargestLoad};
use contrapposto::verdict::{Verdict, VerdictKind, Who, muscles_or_motors};
use contrapposto_formats::{AdviceText, VerdictText};
use serde::Serialize;

use crate::fail::Fail;
use crate::output::{ResultSet, json_text, print};
use crate::view::text::plain_table;

/// The file of a job for which there is no posture.
#[derive(Serialize)]
struct AnswerText<'a> {
    title: &'a str,
    model: &'a str,
    verdict: VerdictText,
    #[serde(flatten)]
    advice: AdviceText,
}

/// The answer to a job: verdict, and the changes that were tried.
pub(crate) struct Answer {
    pub(crate) verdict: Verdict,
    pub(crate) advice: Advice,
    /// [`Summary::search_cut`].
    search_cut: bool,
}

impl Answer {
    /// Without a run.
    pub(crate) fn new(verdict: Verdict, advice: Advice) -> Self {
        Self { verdict, advice, search_cut: false }
    }

    /// The verdict alone.
    pub(crate) fn of_run(scenario: &Scenario, summary: &Summary) -> Self {
        let (verdict, search_cut) = (Verdict::of_run(scenario, summary), summary.search_cut);
        Self { verdict, advice: Advice::default(), search_cut }
    }

    /// The lines that everything begins with.
    pub(crate) fn first_lines(&self) -> String {
        let notes: Vec<String> = self.also_cut().into_iter().chain(self.advice.notes.iter().cloned()).collect();
        let notes: String = notes.iter().map(|line| format!("{line}\n")).collect();
        self.verdict.in_words() + &self.largest_load() + &gains(&self.advice) + &notes
    }

    /// The line about the largest load, where it was searched for.
    fn largest_load(&self) -> String {
        let largest = self.advice.largest.as_ref();
        largest.map_or_else(String::new, |largest| format!("{}: {}.\n", LargestLoad::NAME, largest.in_words()))
    }

    /// The first lines of a body's job, its title, and the tables below them, with the word for what moves the body: muscles or motors. The
    /// title is the user's own text, and stays as it is.
    pub(crate) fn in_words(&self, model: &Model, title: &str, tables: &str) -> String {
        let title = if title.is_empty() { String::new() } else { format!("{title}\n") };
        muscles_or_motors(model, &self.first_lines()) + &title + &muscles_or_motors(model, tables)
    }

    /// A search that ended at its budget is no proof that the body has no easier posture.
    pub(crate) fn also_cut(&self) -> Option<String> {
        let text = "The search for an easier posture was cut short: there may be an easier one.";
        self.search_cut.then(|| text.to_owned())
    }
}

/// The group whose load the sentence states; where it states none, the group that it names.
pub(crate) fn group_of_title(verdict: &Verdict) -> Option<Who> {
    verdict.hardest.filter(|_| verdict.kind == VerdictKind::Holds).or(verdict.who)
}

/// The table of the changes that help.
fn gains(advice: &Advice) -> String {
    if advice.gains.rows.is_empty() {
        return String::new();
    }
    let mut table = plain_table();
    table.set_header(&advice.gains.columns);
    advice.gains.rows.iter().for_each(|row| {
        table.add_row(row);
    });
    format!("{table}\n")
}

/// Exit code 1 for a job that cannot be done.
pub(crate) fn answered(verdict: &Verdict) -> Result<(), Fail> {
    if verdict.kind.is_done() { Ok(()) } else { Err(Fail::Answered) }
}

/// The text of the JSON file `name` of a body that no posture near the start keeps in balance.
pub(crate) fn text_without_posture(
    name: &str,
    title: &str,
    model: &Model,
    (verdict, advice): (&Verdict, &Advice),
) -> Result<String, Fail> {
    let verdict = VerdictText::new(model, verdict);
    json_text(name, &AnswerText { title, model: model.name(), verdict, advice: advice.into() })
}

/// Answers for a body that no posture near the start keeps in balance: prints the verdict, and writes it to the file `name`.
pub(crate) fn without_posture(
    name: &str,
    title: &str,
    (model, loads): (&Model, &[Load]),
    (missing, advice): (Missing, impl FnOnce(&Verdict) -> Advice),
    folder: Option<&ResultSet>,
    json: bool,
) -> Result<(), Fail> {
    let verdict = Verdict::of_fall(model, missing, loads);
    let advice = advice(&verdict);
    let text = text_without_posture(name, title, model, (&verdict, &advice))?;
    folder.map(|folder| folder.write(&[(name, text.as_bytes())])).transpose()?;
    print(&if json { text } else { Answer::new(verdict, advice).first_lines() })?;
    Err(Fail::Answered)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use contrapposto::simulation::{Summary, run};
    use contrapposto_formats::read_scenario;

    use super::Answer;

    #[test]
    fn a_search_that_ended_at_its_budget_is_said_in_the_first_lines() {
        let text = "format = 1\n[coordinates]\nfree = [\"elbow_flex_r\"]\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 1\n";
        let scenario = read_scenario("arm.toml", text.as_bytes(), None).unwrap();
        let mut summary = run(&scenario, |_| {}).unwrap();
        let says =
            |summary: &Summary| Answer::of_run(&scenario, summary).first_lines().contains("there may be an easier one");
        assert!(!says(&summary));
        summary.search_cut = true;
        assert!(says(&summary));
    }
}
