//! Writes the summary of a run as `summary.json`.

use std::collections::BTreeMap;

use contrapposto::contact::{Slip, Support};
use contrapposto::hybrid::Case;
use contrapposto::model::{Coordinate, CoordinateKind, Side};
use contrapposto::simulation::{Contact, CoordinateSummary, FootStep, Scenario, Standing, StopReason, Summary};
use contrapposto::suggestions::Advice;
use contrapposto::verdict::Verdict;
use serde::Serialize;

use crate::tissue::FatigueParametersText;
use crate::{AdviceText, MuscleWorkText, VerdictText};

/// The whole file.
#[derive(Clone, Debug, Serialize)]
pub struct SummaryText {
    /// Title of the scenario.
    pub title: String,
    /// Name of the body.
    pub model: String,
    /// The answer.
    pub verdict: VerdictText,
    /// Changes of the job that were tried.
    #[serde(flatten)]
    pub advice: AdviceText,
    /// `duration`, `settled`, `interrupted`, `fell` or `slid`.
    pub stopped: &'static str,
    /// The event that threw the body off balance, if one did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fell: Option<FallText>,
    /// The run was interrupted: all entries go up to `end_s` only.
    pub partial: bool,
    /// Time of the last sample, s.
    pub end_s: f64,
    /// Number of samples.
    pub samples: u64,
    /// Balance of a body with supports or tasks at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standing: Option<StandingText>,
    /// A search for an easier posture ended at its budget of solver steps, so that there may be an easier one.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub search_cut: bool,
    /// Supports that were put elsewhere, to relieve a muscle group.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<StepText>,
    /// The muscle group that first could no longer hold its load; `null`: none gave up.
    pub failed_first: Option<FailureText>,
    /// Number of reliefs; `decisions.csv` lists the first ten thousand.
    pub reliefs: u64,
    /// The order of coordinates in tables.
    pub coordinate_order: Vec<String>,
    /// The course of each.
    pub coordinates: BTreeMap<String, CoordinateText>,
    /// The muscles of a body whose strength they give.
    #[serde(flatten)]
    pub muscle_work: Option<MuscleWorkText>,
    /// Files beside this one.
    pub files: Vec<String>,
}

/// The end of a body that nothing holds any more.
#[derive(Clone, Debug, Serialize)]
pub struct FallText {
    /// Time of the fall, s.
    pub at_s: f64,
    /// The force that supports do not give, N.
    pub missing_n: f64,
    /// The moment that they do not give, N m.
    pub missing_nm: f64,
    /// A sentence.
    pub why: String,
}

/// A muscle group that gave up.
#[derive(Clone, Debug, Serialize)]
pub struct FailureText {
    /// Coordinate of the group.
    pub coordinate: String,
    /// Movement of the group.
    pub group: Option<String>,
    /// Time of the failure, s.
    pub at_s: f64,
}

/// Effort, centre of mass, supports and tasks of a body.
#[derive(Clone, Debug, Serialize)]
pub struct StandingText {
    /// `sum (active torque / strength)^2` in the first sample.
    pub effort_at_start: f64,
    /// In the last one.
    pub effort: f64,
    /// Centre of mass, ground, m.
    pub center_of_mass_m: [f64; 3],
    /// The supports, in the order of the scenario.
    pub supports: Vec<SupportText>,
    /// The tasks of each priority, in the order of the scenario.
    pub tasks: Vec<String>,
    /// Length of the error of each of `tasks`, in its units.
    pub task_errors: Vec<f64>,
    /// Distance of the supports from their places.
    pub slip: SlipText,
    /// The greatest slip of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub greatest_slip: Option<GreatestSlipText>,
}

/// Distance of the supports from their places: errors of all supports together.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct SlipText {
    /// Distance, m.
    pub distance_m: f64,
    /// Angle, degrees.
    pub angle_deg: f64,
}

impl From<Slip> for SlipText {
    fn from(slip: Slip) -> Self {
        Self { distance_m: slip.distance, angle_deg: slip.angle.to_degrees() }
    }
}

/// The greatest slip of a run.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct GreatestSlipText {
    /// Size of the slip.
    #[serde(flatten)]
    pub slip: SlipText,
    /// Time of the slip, s.
    pub at_s: f64,
}

/// A support that was put elsewhere, put down to rest or taken up again.
#[derive(Clone, Debug, Serialize)]
pub struct StepText {
    /// Segment.
    pub segment: String,
    /// `elsewhere`, `put_down` or `taken_off`.
    pub kind: &'static str,
    /// The coordinate whose tired group asked for relief; absent of a hand that was taken up because it kept the body from a task.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relieves: Option<String>,
    /// Time at which the body began to shift its weight, s.
    pub begin_s: f64,
    /// Time at which the body had taken the new posture, s.
    pub end_s: f64,
    /// Middle of the patch before, ground, m.
    pub from_m: [f64; 3],
    /// Middle of the patch after, ground, m.
    pub to_m: [f64; 3],
    /// Effort before.
    pub effort_before: f64,
    /// Effort after.
    pub effort_after: f64,
}

/// The load of a support.
#[derive(Clone, Debug, Serialize)]
pub struct SupportText {
    /// Segment.
    pub segment: String,
    /// Force on the body, ground, N.
    pub force_n: [f64; 3],
    /// Normal part of the contact force as a share of body weight.
    pub share: f64,
    /// Point at which the contact force acts, ground, m.
    pub center_of_pressure_m: Option<[f64; 3]>,
}

/// One coordinate.
#[derive(Clone, Debug, Serialize)]
pub struct CoordinateText {
    /// Whether it could move.
    pub free: bool,
    /// Cases in the order they came, repetitions left out; the first two hundred.
    pub cases: Vec<&'static str>,
    /// Number of changes of the case.
    pub case_changes: u64,
    /// Decisions of each case.
    pub iterations: BTreeMap<&'static str, u64>,
    /// Last value, deg (m for slides).
    pub final_deg: f64,
    /// Last torques, N m.
    pub final_external_nm: f64,
    /// See above.
    pub final_passive_nm: f64,
    /// See above.
    pub final_active_nm: f64,
    /// Greatest |active torque| over strength while no support was put elsewhere.
    pub peak_relative_load: f64,
    /// The positive group.
    pub positive: GroupText,
    /// The negative group.
    pub negative: GroupText,
    /// Outcome of the last decision.
    pub last_outcome: Option<&'static str>,
}

/// One muscle group.
#[derive(Clone, Debug, Serialize)]
pub struct GroupText {
    /// Movement of the group.
    pub name: Option<String>,
    /// The parameters of its fatigue law.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fatigue: Option<FatigueParametersText>,
    /// Greatest fatigue while no support was put elsewhere, 0 to 1.
    pub peak_fatigue: f64,
    /// Time at which the group could no longer hold its load, s.
    pub exhausted_s: Option<f64>,
}

impl SummaryText {
    /// From a finished run, the verdict on it and the changes that were tried. `files`: names of the files written beside it.
    pub fn new(scenario: &Scenario, summary: &Summary, verdict: &Verdict, advice: &Advice, files: Vec<String>) -> Self {
        let model = &scenario.model;
        let names = model.coordinates().iter().map(|c| c.name.clone());
        let coordinates = model.coordinates().iter().zip(&summary.coordinates).zip(&scenario.free);
        let coordinates = coordinates.map(|((c, s), free)| (c.name.clone(), CoordinateText::new(c, s, *free)));
        let failed = model.coordinates().iter().zip(&summary.coordinates).flat_map(|(c, s)| {
            let failure = |side: Side| {
                let group = c.groups.as_ref().map(|groups| groups[side.index()].name.clone());
                Some(FailureText { coordinate: c.name.clone(), group, at_s: s.exhausted_at[side.index()]? })
            };
            Side::BOTH.into_iter().filter_map(failure)
        });
        Self {
            title: scenario.title.clone(),
            model: model.name().to_owned(),
            verdict: VerdictText::new(model, verdict),
            advice: advice.into(),
            failed_first: failed.min_by(|a, b| a.at_s.total_cmp(&b.at_s)),
            stopped: summary.reason.word(),
            fell: summary.fall.map(|fall| FallText {
                at_s: fall.time,
                missing_n: fall.missing.force,
                missing_nm: fall.missing.moment,
                why: fall.to_string(),
            }),
            partial: summary.reason == StopReason::Interrupted,
            end_s: summary.end_time,
            samples: summary.samples,
            standing: summary.standing.as_ref().map(|standing| StandingText::new(scenario, summary, standing)),
            search_cut: summary.search_cut,
            steps: summary.foot_steps.iter().map(|step| StepText::new(scenario, step)).collect(),
            reliefs: summary.reliefs.count,
            coordinate_order: names.collect(),
            coordinates: coordinates.collect(),
            muscle_work: None,
            files,
        }
    }
}

impl CoordinateText {
    fn new(c: &Coordinate, s: &CoordinateSummary, free: bool) -> Self {
        let [external, passive, active] = s.final_torques;
        let group = |side: Side| GroupText {
            name: c.groups.as_ref().map(|groups| groups[side.index()].name.clone()),
            fatigue: c.groups.as_ref().map(|groups| FatigueParametersText::new(&groups[side.index()])),
            peak_fatigue: s.peak_fatigue[side.index()],
            exhausted_s: s.exhausted_at[side.index()],
        };
        Self {
            free,
            cases: s.cases.iter().map(|case| case.number()).collect(),
            case_changes: s.case_changes,
            iterations: iterations(&s.iterations),
            final_deg: if c.kind == CoordinateKind::Rotation { s.final_value.to_degrees() } else { s.final_value },
            final_external_nm: external,
            final_passive_nm: passive,
            final_active_nm: active,
            peak_relative_load: s.peak_load,
            positive: group(Side::Positive),
            negative: group(Side::Negative),
            last_outcome: s.last_decision.map(|decision| decision.outcome.word()),
        }
    }
}

impl StepText {
    fn new(scenario: &Scenario, step: &FootStep) -> Self {
        let model = &scenario.model;
        Self {
            segment: model.segments()[scenario.supports[step.support].segment].name.clone(),
            kind: step.kind.word(),
            relieves: step.relieves.map(|(coordinate, _)| model.coordinates()[coordinate].name.clone()),
            begin_s: step.time.0,
            end_s: step.time.1,
            from_m: step.place.0,
            to_m: step.place.1,
            effort_before: step.effort.0,
            effort_after: step.effort.1,
        }
    }
}

impl StandingText {
    fn new(scenario: &Scenario, summary: &Summary, standing: &Standing) -> Self {
        let segments = scenario.model.segments();
        let support = |(support, contact): (&Support, &Contact)| SupportText {
            segment: segments[support.segment].name.clone(),
            force_n: contact.force.into(),
            share: contact.share,
            center_of_pressure_m: contact.center_of_pressure.map(Into::into),
        };
        Self {
            effort_at_start: summary.effort_at_start.unwrap_or(standing.effort),
            effort: standing.effort,
            center_of_mass_m: standing.center_of_mass.into(),
            supports: scenario.supports.iter().zip(&standing.contacts).map(support).collect(),
            tasks: scenario.tasks.iter().map(|task| task.label(&scenario.model)).collect(),
            task_errors: standing.errors.clone(),
            slip: standing.slip.into(),
            greatest_slip: summary.slip.map(|(slip, at_s)| GreatestSlipText { slip: slip.into(), at_s }),
        }
    }
}

/// Counts by case number, those that occurred.
pub fn iterations(counts: &[u64; 10]) -> BTreeMap<&'static str, u64> {
    Case::ALL.iter().zip(counts).filter(|(_, n)| **n > 0).map(|(case, n)| (case.number(), *n)).collect()
}
