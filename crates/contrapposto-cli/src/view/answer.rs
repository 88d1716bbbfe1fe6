//! Says a verdict: first line, the changes that help, JSON file of a job without a posture, and exit code.

use contrapposto::contact::Missing;
use contrapposto::model::Model;
use contrapposto::simulation::{Scenario, Summary};
use contrapposto::statics::Load;
use contrapposto::suggestions::Advice;
use contrapposto::verdict::{Verdict, VerdictKind, Who, how_long, muscles_or_motors, slip_in_words};
use contrapposto_formats::{AdviceText, VerdictText};
use serde::Serialize;

use crate::fail::Fail;
use crate::output::{ResultSet, json_text, print};

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
        let more: String =
            self.also_cut().iter().chain(&self.advice.sentence).map(|line| format!("{line}\n")).collect();
        first_lines(&self.verdict) + &more
    }

    /// The first lines of a body's job, its title, and the tables below them, with the word for what moves the body: muscles or motors. The
    /// title is the user's own text, and stays as it is.
    pub(crate) fn in_words(&self, model: &Model, title: &str, tables: &str) -> String {
        let title = if title.is_empty() { String::new() } else { format!("{title}\n") };
        muscles_or_motors(model, &self.first_lines()) + &title + &muscles_or_motors(model, tables)
    }

    /// A search that ended at its budget is no proof that the body has no easier posture.
    pub(crate) fn also_cut(&self) -> Option<String> {
        let text = "The search for an easier posture was cut short to save computing time: there may be an easier one.";
        self.search_cut.then(|| text.to_owned())
    }
}

/// The group whose load the sentence states; where it states none, the group that it names.
pub(crate) fn group_of_title(verdict: &Verdict) -> Option<Who> {
    verdict.hardest.filter(|_| verdict.kind == VerdictKind::Holds).or(verdict.who)
}

/// The sentence, and below it the findings of studies about its hazards, and the targets of lower priority that are missed.
pub(crate) fn first_lines(verdict: &Verdict) -> String {
    let mut findings: Vec<&str> = vec![];
    let passed = verdict.passed.iter().map(|passed| &passed.hazard);
    for finding in verdict.hazards.iter().chain(passed).map(|hazard| hazard.row.finding.as_str()) {
        if !findings.contains(&finding) {
            findings.push(finding);
        }
    }
    let hazards: String = findings.iter().map(|finding| format!("Hazard: {finding}.\n")).collect();
    let more: String = also_missed(verdict).into_iter().chain(also_slid(verdict)).map(|line| line + "\n").collect();
    format!("{}\n{hazards}{more}", verdict.sentence)
}

/// `Missed besides, of lower priority: look at head by 3.4°.`
pub(crate) fn also_missed(verdict: &Verdict) -> Option<String> {
    // The sentence names the first that decides.
    let named = verdict.missed.iter().position(|missed| missed.decides);
    let lower = verdict.missed.iter().enumerate().filter(|(i, _)| Some(*i) != named).map(|(_, missed)| missed);
    let list: Vec<String> = lower.map(|missed| format!("{} by {}", missed.task, missed.by())).collect();
    (!list.is_empty()).then(|| format!("Missed besides, of lower priority: {}.", list.join(", ")))
}

/// `The supports slid by 0.2 cm and 0.3° (the greatest slip, at 12 s).`, of a job that is done all the same.
pub(crate) fn also_slid(verdict: &Verdict) -> Option<String> {
    let (slip, time) = verdict.slip.filter(|_| verdict.kind != VerdictKind::CannotStand)?;
    let when = time.map_or(String::new(), |time| format!(" (the greatest slip, at {})", how_long(time)));
    Some(format!("The supports slid by {}{when}.", slip_in_words(slip)))
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
