//! Writes a solved posture as `pose.json`.

use std::collections::BTreeMap;

use contrapposto::kinematics::Kinematics;
use contrapposto::posture_solver::{LevelError, Reason, RowError, SolvedPosture};
use contrapposto::suggestions::Advice;
use contrapposto::verdict::Verdict;
use serde::Serialize;

use crate::scenario::PoseScenario;
use crate::{AdviceText, MuscleWorkText, VerdictText};

/// The whole file.
#[derive(Clone, Debug, Serialize)]
pub struct PoseText {
    /// Title of the scenario.
    pub title: String,
    /// Name of the body.
    pub model: String,
    /// The answer.
    pub verdict: VerdictText,
    /// Changes of the job that were tried.
    #[serde(flatten)]
    pub advice: AdviceText,
    /// `reached`: every level is; `closest`: nothing moves any more, and every level is as near as the levels above allow;
    /// `steps`: the largest number of steps was made.
    pub reason: &'static str,
    /// Steps made.
    pub steps: usize,
    /// Whether all supports are where they were at the start.
    pub supports_hold: bool,
    /// The order of coordinates in tables.
    pub coordinate_order: Vec<String>,
    /// Values of the coordinates: rad, m, components of quaternions.
    pub coordinates: BTreeMap<String, f64>,
    /// Centre of mass in ground, m; `null` for a body without mass.
    pub center_of_mass_m: Option<[f64; 3]>,
    /// The remaining error of every task, in order of priority; a task of two units (placement, posture) has an entry for each.
    pub levels: Vec<PoseLevelText>,
    /// The muscles of a body whose strength they give.
    #[serde(flatten)]
    pub muscle_work: Option<MuscleWorkText>,
    /// Files beside this one.
    pub files: Vec<String>,
}

/// The remaining error of a task in one unit.
#[derive(Clone, Debug, Serialize)]
pub struct PoseLevelText {
    /// 1 is the most important; tasks of the same priority share it.
    pub priority: usize,
    /// Kind and segment: `point hand_r`, `support calcn_l`.
    pub task: String,
    /// Length of its error, in `unit`.
    pub residual: f64,
    /// `m`, `rad`, or `1` for shares of strength.
    pub unit: &'static str,
    /// Whether that counts as nothing.
    pub reached: bool,
}

impl PoseText {
    /// From a solved pose, the verdict on it and the changes that were tried. `files`: names of the files written beside it.
    pub fn new(
        scenario: &PoseScenario,
        pose: &SolvedPosture,
        (verdict, advice): (&Verdict, &Advice),
        files: Vec<String>,
    ) -> Self {
        let model = &scenario.model;
        let mut levels = vec![];
        for (k, (goal, reached)) in scenario.goals.iter().zip(&pose.levels).enumerate() {
            let mut errors = reached.rows.as_slice();
            for (task, label) in goal.tasks.iter().zip(&scenario.labels[k]) {
                let (own, rest) = errors.split_at(task.rows().min(errors.len()));
                errors = rest;
                levels.extend(lengths(own).into_iter().map(|(unit, residual)| PoseLevelText {
                    priority: k + 1,
                    task: label.clone(),
                    residual,
                    unit,
                    reached: residual <= scenario.options.level_tolerance,
                }));
            }
        }
        let hold = |(goal, reached): (&contrapposto::tasks::PriorityLevel, &LevelError)| {
            !goal.hard || reached.length <= scenario.options.level_tolerance
        };
        let mut kinematics = Kinematics::new(model);
        let center = kinematics.update(model, &pose.posture).ok().and_then(|()| kinematics.center_of_mass(model));
        let names = || model.coordinates().iter().map(|c| c.name.clone());
        Self {
            title: scenario.title.clone(),
            model: model.name().to_owned(),
            verdict: VerdictText::new(model, verdict),
            advice: advice.into(),
            reason: match pose.reason {
                Reason::Reached => "reached",
                Reason::Converged => "closest",
                Reason::StepLimit => "steps",
            },
            steps: pose.steps,
            supports_hold: scenario.goals.iter().zip(&pose.levels).all(hold),
            coordinate_order: names().collect(),
            coordinates: names().zip(pose.posture.values().iter().copied()).collect(),
            center_of_mass_m: center.map(Into::into),
            levels,
            muscle_work: None,
            files,
        }
    }
}

/// Length of the error in every unit of the task, in the order in which they come.
fn lengths(errors: &[RowError]) -> Vec<(&'static str, f64)> {
    let mut sums: Vec<(&'static str, f64)> = vec![];
    for RowError { value: error, unit } in errors {
        let unit = unit.symbol();
        match sums.iter_mut().find(|(known, _)| *known == unit) {
            Some((_, sum)) => *sum += error * error,
            None => sums.push((unit, error * error)),
        }
    }
    sums.into_iter().map(|(unit, sum)| (unit, sum.sqrt())).collect()
}
