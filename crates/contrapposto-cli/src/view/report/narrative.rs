//! The words of a run's page: a headline, the reasons, and the few numbers that say most.

use contrapposto::simulation::{FootStep, Scenario, StepKind, StopReason, Summary};
use contrapposto::verdict::{TIRED, VerdictKind};
use contrapposto_report::{Figure, Report};

use crate::view::answer::{Answer, group_of_title};
use crate::view::axes::pelvis_list;
use crate::view::excerpt::RunExcerpt;
use crate::view::frame::Frame;
use crate::view::muscles::{hardest_of_run, tired, working};
use crate::view::selection::main_coordinate;
use crate::view::words::{how_long, percent, plain, sentence, value, why};

/// A pelvis that hangs more than this, degrees, is no level one.
const LEVEL: f64 = 4.0;
/// A share below this is said as none.
const NOTHING: f64 = 0.005;
/// A joint that moved less, degrees, stayed.
const STAYED: f64 = 0.5;

/// Fills in headline, reasons and figures.
pub(super) fn write(
    (scenario, names): (&Scenario, &[String]),
    excerpt: &RunExcerpt,
    summary: &Summary,
    answer: &Answer,
    report: &mut Report,
) {
    let (Some(first), Some(last)) = (excerpt.frames.first(), excerpt.frames.last()) else { return };
    // The joint that was relieved; without reliefs, and where a group fails, that of the title.
    let by_title = excerpt.happened == 0 || answer.verdict.kind == VerdictKind::HeldUntil;
    let of_title = group_of_title(&answer.verdict).filter(|_| by_title).map(|group| group.coordinate);
    let main = of_title.unwrap_or_else(|| main_coordinate(scenario, summary));
    let ligaments = answer.verdict.hazards.first().map_or(main, |hazard| hazard.coordinate);
    let in_hazard = !answer.verdict.hazards.is_empty();
    let angles = excerpt.frames.iter().map(|frame| frame.angles[main].to_degrees());
    let (low, high) = angles.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), a| (low.min(a), high.max(a)));
    let narrative = Narrative { scenario, names, first, last, main, swept: high - low, ligaments, in_hazard };
    let lists = pelvis_list(&scenario.model, &first.posture).zip(pelvis_list(&scenario.model, &last.posture));
    // On its feet (or hands), not seated.
    let seated = scenario.supports.iter().any(|s| Some(s.segment) == scenario.model.segment("pelvis"));
    let standing = lists.filter(|_| !scenario.supports.is_empty() && !seated && pelvis_was_relieved(scenario, summary));
    super::answer(report, &answer.verdict, &answer.advice);
    report.reasons.extend(answer.also_cut());
    // Of a job that cannot be done nothing else is said to hold.
    let tired = answer.verdict.tired.is_some_and(|tired| tired.fatigue > TIRED);
    if answer.verdict.kind.is_done() && !(tired && excerpt.happened == 0) {
        report.reasons.push(match standing {
            _ if excerpt.happened == 0 => of_rest(summary.end_time),
            Some((before, after)) if after.abs() >= LEVEL => narrative.of_list(before, after),
            Some((_, after)) => narrative.of_level(after),
            None => narrative.of_joint(),
        });
        if excerpt.happened > 0 {
            report.reasons.extend(narrative.reasons(standing.is_some()));
        }
    }
    report.reasons.extend(summary.foot_steps.iter().map(|step| narrative.of_step(step)));
    report.reasons.extend(narrative.end(excerpt, summary));
    report.figures = narrative.figures(standing, summary);
}

/// No muscle group needed relief.
fn of_rest(seconds: f64) -> String {
    format!(
        "In {} no muscle of a person of mean strength became so tired that the body moved to relieve it.",
        how_long(seconds)
    )
}

/// Whether muscles that carry the pelvis to a side needed relief.
fn pelvis_was_relieved(scenario: &Scenario, summary: &Summary) -> bool {
    let carries = |name: &str| name.starts_with("hip_adduction") || name.starts_with("pelvis_list");
    let mut records = summary.reliefs.records.iter();
    records.any(|record| carries(&scenario.model.coordinates()[record.coordinate].name))
}

struct Narrative<'a> {
    scenario: &'a Scenario,
    /// Of the supports.
    names: &'a [String],
    first: &'a Frame,
    last: &'a Frame,
    main: usize,
    /// Difference of the greatest and the least angle of `main` over the run, degrees.
    swept: f64,
    /// The coordinate whose passive torque is reported: the first in hazard, or `main`.
    ligaments: usize,
    /// That coordinate is in hazard.
    in_hazard: bool,
}

impl Narrative<'_> {
    /// The pelvis hangs to a side; in a run, if it did not at the start.
    fn of_list(&self, before: f64, after: f64) -> String {
        let side = if after > 0.0 { "right" } else { "left" };
        let word = if after.abs() - before.abs() >= LEVEL { "Slouched: the" } else { "The" };
        format!("{word} pelvis ends {:.0}° lower on the {side}, and {}.", after.abs(), self.weight())
    }

    fn of_level(&self, list: f64) -> String {
        format!("No slouch: the pelvis ends level (within {:.0}°), and {}.", list.abs().ceil().max(1.0), self.weight())
    }

    fn weight(&self) -> String {
        match self.heaviest() {
            Some((name, share)) => format!("{} of the weight is on the {name}", percent(share)),
            None => "no support carries weight".to_owned(),
        }
    }

    fn of_joint(&self) -> String {
        let name = sentence(&plain(&self.scenario.model.coordinates()[self.main].name));
        let [from, to] =
            [self.first, self.last].map(|frame| value(&self.scenario.model, self.main, frame.angles[self.main]));
        let [before, after] = [self.first, self.last].map(|frame| frame.active(self.main).abs());
        let who = self.muscles();
        if self.moved().abs() < STAYED {
            let verb = if self.swept < STAYED { "stayed at" } else { "ended where it began, at" };
            return format!("{name} {verb} {to}: {who} hold {after:.1} N m.");
        }
        let (now, then) = (format!("{after:.1}"), format!("{before:.1}"));
        if now == then {
            return format!("{name} moved from {from} to {to}: {who} hold {now} N m as before.");
        }
        let verb = if after > before { "more" } else { "less" };
        format!("{name} moved from {from} to {to}: {who} hold {verb}, {now} N m instead of {then}.")
    }

    /// `the muscles of right hip extension`: the group that works at the end, by the name that rows have for it.
    fn muscles(&self) -> String {
        let group = working(&self.scenario.model, self.main, self.last);
        group.map_or_else(|| "its muscles".to_owned(), |group| format!("the muscles of {group}"))
    }

    fn moved(&self) -> f64 {
        (self.last.angles[self.main] - self.first.angles[self.main]).to_degrees()
    }

    /// The support that carries most at the end, and its share.
    fn heaviest(&self) -> Option<(String, f64)> {
        let (i, share) = self.last.shares().into_iter().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((self.names.get(i)?.clone(), share))
    }

    fn reasons(&self, standing: bool) -> Vec<String> {
        let Self { scenario, first, last, main, .. } = *self;
        let name = plain(&scenario.model.coordinates()[main].name);
        let mut reasons = vec![];
        let critical = scenario.hysteresis.critical_level;
        if let Some((group, fatigue)) = tired(&scenario.model, main, first).filter(|(_, fatigue)| *fatigue >= critical)
        {
            reasons.push(format!(
                "Reason: the muscles of {group} were tired from the start ({}) and needed relief.",
                percent(fatigue)
            ));
        }
        if standing && self.moved().abs() >= STAYED {
            let [from, to] = [first, last].map(|frame| value(&scenario.model, main, frame.angles[main]));
            let [before, after] = [first, last].map(|frame| frame.active(main).abs());
            reasons.push(format!(
                "{} moved from {from} to {to}; {} hold {after:.1} N m, at the start {before:.1}.",
                sentence(&name),
                self.muscles()
            ));
        }
        reasons.extend(self.of_ligaments());
        reasons
    }

    /// The share of the external torque that passive tissue carries; `None` where it carries nothing.
    fn of_ligaments(&self) -> Option<String> {
        let Self { scenario, first, last, ligaments: i, .. } = *self;
        let name = plain(&scenario.model.coordinates()[i].name);
        let whole = last.external[i].abs();
        let share = last.carried(i)?;
        if last.against_muscles(i) {
            let [ligaments, muscles] = [last.passive[i], last.active(i)].map(f64::abs);
            return Some(format!(
                "Ligaments of {name} pull with {ligaments:.1} N m, more than the external torque of {whole:.1} N m; muscles hold the \
                 difference of {muscles:.1} N m against them."
            ));
        }
        let before = first.carried(i).unwrap_or_default();
        if share < NOTHING && before < NOTHING {
            return None;
        }
        let part = match share {
            0.0..NOTHING => "none".to_owned(),
            NOTHING..0.5 => format!("only {}", percent(share)),
            _ => percent(share),
        };
        let before = percent(before);
        Some(format!(
            "Ligaments carry {part} of the external torque of {whole:.1} N m at {name}, at the start {before}."
        ))
    }

    /// A support that was put elsewhere.
    fn of_step(&self, step: &FootStep) -> String {
        let model = &self.scenario.model;
        let support = plain(&model.segments()[self.scenario.supports[step.support].segment].name);
        let ([from_x, _, from_z], [x, _, z]) = step.place;
        let what = match step.kind {
            StepKind::Elsewhere => {
                format!("put elsewhere, {:.0} cm away,", 100.0 * libm::hypot(x - from_x, z - from_z))
            }
            StepKind::PutDown => "put down to rest".to_owned(),
            StepKind::TakenOff => "taken up again".to_owned(),
        };
        format!(
            "At {} {support} was {what} {}: effort {:.4} before, {:.4} after.",
            how_long(step.time.0),
            why(model, step),
            step.effort.0,
            step.effort.1
        )
    }

    /// The reason for which the run ended, if not at its time; and the decisions that the page leaves out.
    fn end(&self, excerpt: &RunExcerpt, summary: &Summary) -> Option<String> {
        let how = match summary.reason {
            StopReason::Settled => "the posture no longer changed",
            StopReason::Duration => "its full duration",
            StopReason::Interrupted => "it was interrupted",
            StopReason::Fell => "the supports could no longer hold the body",
            StopReason::Slid => "the supports slid",
        };
        let why = summary.fall.map_or(String::new(), |fall| format!(" {}.", sentence(&fall.to_string())));
        let listed = excerpt.events.len() as u64;
        let more = match excerpt.happened - listed {
            0 => String::new(),
            more => format!(" Of {} decisions the first {listed} are listed; {more} more follow.", excerpt.happened),
        };
        let whole = summary.reason == StopReason::Duration && more.is_empty();
        (!whole).then(|| format!("The run ended after {}: {how}.{why}{more}", how_long(summary.end_time)))
    }

    fn figures(&self, standing: Option<(f64, f64)>, summary: &Summary) -> Vec<Figure> {
        let Self { scenario, names, first, last, main, ligaments, .. } = *self;
        let figure = |label: &str, value: String, note: String| Figure { label: label.to_owned(), value, note };
        let mut figures = vec![];
        if let Some((before, after)) = standing {
            let side = |list: f64| if list > 0.0 { "right" } else { "left" };
            let down = if after.abs() < 0.05 { "level".to_owned() } else { format!("to the {}", side(after)) };
            let note = format!("{down}; {:.1}° at the start", before.abs());
            figures.push(figure("Pelvis drops", format!("{:.1}°", after.abs()), note));
        }
        for (name, (before, after)) in names.iter().zip(first.shares().into_iter().zip(last.shares())).take(4) {
            figures.push(figure(
                &format!("Weight on {name}"),
                percent(after),
                format!("{} at the start", percent(before)),
            ));
        }
        if scenario.supports.is_empty() {
            let [from, to] = [first, last].map(|frame| value(&scenario.model, main, frame.angles[main]));
            figures.push(figure(
                &sentence(&plain(&scenario.model.coordinates()[main].name)),
                to,
                format!("{from} at the start"),
            ));
            let [before, after] = [first, last].map(|frame| frame.active(main).abs());
            figures.push(figure(
                "Its active torque",
                format!("{after:.1} N m"),
                format!("{before:.1} N m at the start"),
            ));
        }
        let carried = last.carried(ligaments).filter(|share| *share >= NOTHING && !last.against_muscles(ligaments));
        if let Some(share) = carried {
            let name = plain(&scenario.model.coordinates()[ligaments].name);
            let judged = if self.in_hazard { "" } else { "; for how long they may is not judged" };
            figures.push(figure(
                "Ligaments carry",
                percent(share),
                format!("of the external torque at {name}{judged}"),
            ));
        }
        let [before, after] = [first, last].map(Frame::effort);
        let change =
            if before > 0.0 { format!("{:+.0} %", 100.0 * (after / before - 1.0)) } else { format!("{after:.3}") };
        let change =
            if change == "-0 %" || change == "+0 %" { "unchanged".to_owned() } else { change.replace('-', "\u{2212}") };
        figures.push(figure(
            "Effort of all muscles",
            change,
            format!("sum of squared relative loads, {before:.4} to {after:.4}"),
        ));
        if let Some((name, load, time)) = hardest_of_run(&scenario.model, summary) {
            figures.push(figure("Highest load", percent(load), format!("{name}, at {}", how_long(time))));
        }
        figures
    }
}
