//! `assess.json`, and the terminal table of a recorded motion.

use std::fmt::Write;

use contrapposto::assessment::{AngleInDoubt, Assessment, GroupAssessment, Peak, PeakKind, Proposal, RepeatedGroup};
use contrapposto::fatigue::Repetition;
use contrapposto::hybrid::Strategy;
use contrapposto::model::CoordinateKind;
use contrapposto_formats::tissue::SourcedModel;
use contrapposto_formats::{AdviceText, MuscleWorkText, VerdictText};
use serde::Serialize;

use super::cycles::CyclesText;
use super::group::GroupName;
use super::plain_table;
use super::sources::StrengthAtText;
use crate::view::answer::Answer;
use crate::view::cycles::CycleCurves;
use crate::view::words::{A_DAY, MOST_ROWS, how_long, moment_in_words, percent};

/// Most groups whose relief is listed.
const RELIEVED: usize = 3;

/// The whole file.
#[derive(Serialize)]
pub(crate) struct AssessText {
    model: String,
    motion: String,
    /// The answer.
    verdict: VerdictText,
    /// Changes of the job that were tried.
    #[serde(flatten)]
    advice: AdviceText,
    frames: usize,
    start_s: f64,
    end_s: f64,
    /// Times of a motion that is repeated; left out of another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    repeats: Option<RepeatsText>,
    /// Curves over the cycles of the motion; left out of a motion without cycles.
    #[serde(skip_serializing_if = "Option::is_none")]
    cycles: Option<CyclesText>,
    /// The reason why a motion that moves has no cycles.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_cycles: Option<String>,
    /// Error of the angles within which groups that work against passive torque are judged.
    angle_error_deg: f64,
    /// Every group of known strength, the worst first.
    groups: Vec<AssessedGroupText>,
    /// The muscles of a body whose strength they give.
    #[serde(flatten)]
    pub(crate) muscle_work: Option<MuscleWorkText>,
    /// Largest residual of the root, which neither loads nor supports give.
    residual_force_n: PeakText,
    residual_moment_nm: PeakText,
    /// Frames in which the supports cannot hold the body.
    unheld_frames: usize,
    /// Inertia counts in all torques.
    dynamics: bool,
    acceleration_m_s2: PeakText,
    /// Share of the frames in which the centre of mass accelerates by more than 1 m/s2.
    fast_share: f64,
    warnings: Vec<String>,
    files: Vec<String>,
}

#[derive(Serialize)]
struct RepeatsText {
    asked_minutes: f64,
    /// Length of the motion.
    cycle_s: f64,
    /// Time from one start to the next.
    every_s: f64,
    /// Number of whole cycles in the asked time.
    cycles: u64,
    /// Work before each break; `null`: no breaks.
    work_minutes: Option<f64>,
    break_minutes: Option<f64>,
}

/// A group over the repeats.
#[derive(Serialize)]
struct RepeatedText {
    /// Share of a cycle, with its pause, in which the group works.
    duty_cycle: f64,
    mean_load: f64,
    /// Greatest fatigue in the last cycle.
    fatigue: f64,
    /// Time after which the group asks for relief; `null`: never, however long the motion is repeated.
    relief_after_s: Option<f64>,
    /// Time after which the group fails; `null` likewise.
    fails_after_s: Option<f64>,
}

#[derive(Serialize)]
struct PeakText {
    value: f64,
    at_s: f64,
}

#[derive(Serialize)]
struct AssessedGroupText {
    #[serde(flatten)]
    name: GroupName,
    /// Active torque over strength.
    peak_load: PeakText,
    /// The strength that this is a share of.
    strength_at_peak: Option<StrengthAtText>,
    external_at_peak_nm: f64,
    passive_at_peak_nm: f64,
    active_at_peak_nm: f64,
    /// The part of the external torque that inertia gives; left out of postures at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    inertia_at_peak_nm: Option<f64>,
    peak_fatigue: PeakText,
    fatigue_at_end: f64,
    /// `null`: it holds.
    exhausted_at_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    repeated: Option<RepeatedText>,
    /// The instant in which the error of the recorded angle counts most.
    #[serde(skip_serializing_if = "Option::is_none")]
    angle_in_doubt: Option<AngleInDoubtText>,
    proposals: Vec<ProposalText>,
}

#[derive(Serialize)]
struct AngleInDoubtText {
    at_s: f64,
    angle_deg: f64,
    recorded_load: f64,
    judged_load: f64,
    recorded_active_nm: f64,
    judged_active_nm: f64,
}

#[derive(Serialize)]
struct ProposalText {
    /// `load` or `fatigue`: at which peak.
    at: &'static str,
    time_s: f64,
    strategy: &'static str,
    case: &'static str,
    outcome: &'static str,
    angle_deg: f64,
    goal_deg: Option<f64>,
    active_nm: f64,
    active_at_goal_nm: Option<f64>,
    sentence: String,
}

impl From<Peak> for PeakText {
    fn from(peak: Peak) -> Self {
        Self { value: peak.value, at_s: peak.time }
    }
}

impl AssessText {
    pub(crate) fn new(
        opened: &SourcedModel,
        motion: &str,
        times: &[f64],
        (angle_error, found, cycles): (f64, &Assessment, Option<&Result<CycleCurves, String>>),
        answer: &Answer,
        warnings: Vec<String>,
        files: Vec<String>,
    ) -> Self {
        let model = &opened.model;
        Self {
            model: model.name().to_owned(),
            motion: motion.to_owned(),
            verdict: VerdictText::new(model, &answer.verdict),
            advice: (&answer.advice).into(),
            frames: times.len(),
            start_s: times.first().copied().unwrap_or_default(),
            end_s: times.last().copied().unwrap_or_default(),
            repeats: found.repetition.map(|repetition| RepeatsText::new(repetition, times)),
            cycles: cycles.and_then(|cycles| Some(CyclesText::new(model, cycles.as_ref().ok()?))),
            no_cycles: cycles.and_then(|cycles| cycles.as_ref().err().cloned()),
            angle_error_deg: angle_error.to_degrees(),
            groups: found.groups.iter().map(|group| AssessedGroupText::new(opened, group, found.dynamics)).collect(),
            muscle_work: None,
            residual_force_n: found.residual_force.into(),
            residual_moment_nm: found.residual_moment.into(),
            unheld_frames: found.unheld,
            dynamics: found.dynamics,
            acceleration_m_s2: found.acceleration.into(),
            fast_share: found.fast_share,
            warnings,
            files,
        }
    }
}

impl AssessedGroupText {
    fn new(opened: &SourcedModel, found: &GroupAssessment, dynamics: bool) -> Self {
        let model = &opened.model;
        Self {
            name: GroupName::new(model, found.coordinate, found.side),
            peak_load: found.peak_load.into(),
            strength_at_peak: StrengthAtText::new(opened, found),
            external_at_peak_nm: found.at_peak.external,
            passive_at_peak_nm: found.at_peak.passive,
            active_at_peak_nm: found.peak_torque,
            inertia_at_peak_nm: dynamics.then_some(found.at_peak.inertia),
            peak_fatigue: found.peak_fatigue.into(),
            fatigue_at_end: found.fatigue,
            exhausted_at_s: found.exhausted_at,
            repeated: found.repeated.map(RepeatedText::from),
            angle_in_doubt: found.in_doubt.as_ref().map(AngleInDoubtText::new),
            // Relief of a slide is no angle.
            proposals: match model.coordinates()[found.coordinate].kind {
                CoordinateKind::Rotation => found.proposals.iter().map(ProposalText::new).collect(),
                _ => vec![],
            },
        }
    }
}

impl RepeatsText {
    fn new(Repetition { seconds, every, breaks }: Repetition, times: &[f64]) -> Self {
        Self {
            asked_minutes: seconds / 60.0,
            cycle_s: times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first),
            every_s: every,
            cycles: Repetition { seconds, every, breaks }.cycles(),
            work_minutes: breaks.map(|breaks| breaks.work / 60.0),
            break_minutes: breaks.map(|breaks| breaks.rest / 60.0),
        }
    }
}

impl From<RepeatedGroup> for RepeatedText {
    fn from(RepeatedGroup { duty, mean_load, fatigue, relief_at, fails_at }: RepeatedGroup) -> Self {
        let finite = |time: f64| time.is_finite().then_some(time);
        let [relief_after_s, fails_after_s] = [relief_at, fails_at].map(finite);
        Self { duty_cycle: duty, mean_load, fatigue, relief_after_s, fails_after_s }
    }
}

impl AngleInDoubtText {
    fn new(doubt: &AngleInDoubt) -> Self {
        Self {
            at_s: doubt.time,
            angle_deg: doubt.angle.to_degrees(),
            recorded_load: doubt.recorded_load,
            judged_load: doubt.judged_load,
            recorded_active_nm: doubt.recorded_torque,
            judged_active_nm: doubt.judged_torque,
        }
    }
}

impl ProposalText {
    fn new(proposal: &Proposal) -> Self {
        let decision = &proposal.decision;
        Self {
            at: match proposal.at {
                PeakKind::Load => "load",
                PeakKind::Fatigue => "fatigue",
            },
            time_s: proposal.time,
            strategy: match proposal.strategy {
                Strategy::Active => "active",
                Strategy::Passive => "passive",
            },
            case: decision.case.number(),
            outcome: decision.outcome.word(),
            angle_deg: proposal.angle.to_degrees(),
            goal_deg: decision.goal.map(f64::to_degrees),
            active_nm: decision.active_torque,
            active_at_goal_nm: decision.active_torque_at_goal,
            sentence: proposal.sentence.clone(),
        }
    }
}

/// The note about times of a motion that does not begin at 0.
pub(crate) fn times_from(start: f64) -> Option<String> {
    (start.abs() > 0.0).then(|| {
        format!(
            "Times are those of the file, which begins at {}; the first sentence counts from there.",
            moment_in_words(start)
        )
    })
}

/// The worst groups, their relief, and the group that fails first.
pub(crate) fn report(text: &AssessText) -> String {
    let working: Vec<&AssessedGroupText> = text.groups.iter().filter(|group| group.peak_load.value > 0.0).collect();
    let mut out = format!("{}\n", table(&working));
    if let Some(note) = times_from(text.start_s).filter(|_| text.repeats.is_none()) {
        let _ = writeln!(out, "{note}");
    }
    if working.len() > MOST_ROWS {
        let _ = writeln!(out, "and {} groups with lower loads, which --json lists", working.len() - MOST_ROWS);
    }
    if let Some(cycles) = &text.cycles {
        let _ = writeln!(out, "{}; --out DIR draws them, --json lists them", cycles.sentence());
    }
    if let Some(why) = &text.no_cycles {
        let _ = writeln!(out, "{why}");
    }
    out.push_str("\nrelief, if that joint alone moved:\n");
    for group in working.iter().take(RELIEVED) {
        if group.proposals.is_empty() {
            let _ = writeln!(out, "{}: no falling passive curve of this joint is known", group.name);
        }
        let mut previous: Vec<String> = vec![];
        for peak in group.proposals.chunk_by(|a, b| a.at == b.at) {
            let sentences = sentences(peak);
            if sentences != previous {
                let ProposalText { at, time_s, angle_deg, .. } = peak[0];
                let _ =
                    writeln!(out, "{}, greatest {at} at {}, {angle_deg:.1} deg:", group.name, moment_in_words(time_s));
                for sentence in &sentences {
                    let _ = writeln!(out, "  {sentence}");
                }
                previous = sentences;
            }
        }
    }
    if text.repeats.is_none() {
        out.push_str(&fails_first(text, &working));
    }
    out
}

/// The line of the group that fails first.
fn fails_first(text: &AssessText, working: &[&AssessedGroupText]) -> String {
    match working.first().and_then(|group| Some((group, group.exhausted_at_s?))) {
        Some((group, time)) => format!("\nfails first: {} at {}\n", group.name, how_long(time)),
        None => {
            format!("\nno group fails from {} to {}\n", moment_in_words(text.start_s), moment_in_words(text.end_s))
        }
    }
}

/// The groups that fail first, or work hardest; where the motion is repeated with duty cycle and relief.
fn table(working: &[&AssessedGroupText]) -> comfy_table::Table {
    let mut table = plain_table();
    let repeats = working.iter().any(|group| group.repeated.is_some());
    let of_repeats = if repeats { &["duty cycle", "asks for relief"][..] } else { &[] };
    let columns = ["muscle group", "peak load", "at", "of a strength of", "fatigue at the end"];
    table.set_header(columns.into_iter().chain(of_repeats.iter().copied()).chain(["fails"]));
    for group in working.iter().take(MOST_ROWS) {
        let mut row = vec![
            group.name.to_string(),
            percent(group.peak_load.value),
            moment_in_words(group.peak_load.at_s),
            group.strength_at_peak.as_ref().map(StrengthAtText::words).unwrap_or_default(),
            format!("{:.2}", group.fatigue_at_end),
        ];
        if let Some(RepeatedText { duty_cycle, fails_after_s, relief_after_s, .. }) = &group.repeated {
            row.extend([percent(*duty_cycle), after(*relief_after_s), after(*fails_after_s)]);
        } else {
            row.push(group.exhausted_at_s.map_or_else(|| "holds".to_owned(), |time| format!("at {}", how_long(time))));
        }
        table.add_row(row);
    }
    table
}

/// `after 24 min`, `never`: in a job that is repeated.
pub(crate) fn after(time: Option<f64>) -> String {
    match time {
        Some(time) if time < A_DAY => format!("after {}", how_long(time)),
        _ => "never".to_owned(),
    }
}

/// The sentences of the strategies at a peak; one where they agree.
fn sentences(peak: &[ProposalText]) -> Vec<String> {
    let agree = peak.iter().all(|proposal| proposal.goal_deg == peak[0].goal_deg);
    let all = peak.iter().map(|proposal| proposal.sentence.clone());
    if agree {
        all.take(1).map(|text| text.replace("active strategy", "either strategy")).collect()
    } else {
        all.collect()
    }
}
