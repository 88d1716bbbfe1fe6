//! The terminal table of a solved pose.

use contrapposto::posture_solver::{Reason, SolvedPosture};
use contrapposto::tasks::Task;
use contrapposto::verdict::{Verdict, VerdictKind};
use contrapposto_formats::{PoseLevelText, PoseScenario, PoseText};

use super::plain_table;
use crate::view::words::metres;

/// `remaining: look_at head 3.100 deg; posture 80.500 mm, 2.000 deg`.
pub(crate) fn subtitle(text: &PoseText) -> String {
    let missing: Vec<String> = tasks(text)
        .filter(|entries| !reached(entries))
        .map(|entries| format!("{} {}", entries[0].task, all_remaining(entries)))
        .collect();
    if missing.is_empty() { "all tasks are reached".to_owned() } else { format!("remaining: {}", missing.join("; ")) }
}

/// The entries of each task: one, or one for each of its units.
pub(crate) fn tasks(text: &PoseText) -> impl Iterator<Item = &[PoseLevelText]> {
    text.levels.chunk_by(|a, b| a.priority == b.priority && a.task == b.task && a.unit != b.unit)
}

pub(crate) fn reached(entries: &[PoseLevelText]) -> bool {
    entries.iter().all(|entry| entry.reached)
}

/// Whether the task is reached, or why not.
pub(crate) fn mark(entries: &[PoseLevelText]) -> &'static str {
    if reached(entries) { "reached" } else { "limited by higher priorities" }
}

pub(crate) fn all_remaining(entries: &[PoseLevelText]) -> String {
    entries.iter().map(remaining).collect::<Vec<_>>().join(", ")
}

/// `0.412 mm`, in units that people read.
fn remaining(level: &PoseLevelText) -> String {
    if let Some(text) = metres(level.residual).filter(|_| level.unit == "m") {
        return text;
    }
    let (value, unit) = match level.unit {
        "m" => (1e3 * level.residual, " mm"),
        "rad" => (level.residual.to_degrees(), " deg"),
        // Effort is one number everywhere: the sum of squared relative loads.
        _ => (level.residual.powi(2), ", sum of squared relative loads"),
    };
    // An error below the tolerance is written without its digits.
    if !level.reached && value < 5e-4 { format!("{value:.0e}{unit}") } else { format!("{value:.3}{unit}") }
}

/// The hint at a task of balance, where no task asks for it and the body would fall.
fn unbalanced(scenario: &PoseScenario, verdict: &Verdict) -> String {
    let asks = |task: &Task| matches!(task, Task::CenterOfMass(_));
    let asked = scenario.goals.iter().flat_map(|goal| &goal.tasks).any(asks);
    if verdict.kind != VerdictKind::CannotStand || asked {
        return String::new();
    }
    "No posture that the supports hold was found near it; a task of kind `center_of_mass` asks for balance over a place of its own.\n"
        .to_owned()
}

/// The end of the steps toward a posture in balance.
pub(crate) const IN_BALANCE: &str = "in balance; its effort still fell when the steps toward balance ended";

/// The table of tasks, below the first lines and the title.
pub(crate) fn report(
    scenario: &PoseScenario,
    (pose, kept_balance): (&SolvedPosture, bool),
    text: &PoseText,
    verdict: &Verdict,
) -> String {
    let mut table = plain_table();
    table.set_header(["priority", "task", "remaining error", ""]);
    for entries in tasks(text) {
        table.add_row([
            entries[0].priority.to_string(),
            entries[0].task.clone(),
            all_remaining(entries),
            mark(entries).to_owned(),
        ]);
    }
    let reason = match pose.reason {
        Reason::Reached => "all tasks are reached",
        Reason::Converged => "converged: the remaining errors are the smallest that tasks of higher priority allow",
        Reason::StepLimit if kept_balance => IN_BALANCE,
        Reason::StepLimit => "the step limit was reached before the posture converged",
    };
    let steps = if pose.steps == 1 { "1 step".to_owned() } else { format!("{} steps", pose.steps) };
    format!("{}{table}\n{reason} ({steps})\n", unbalanced(scenario, verdict))
}
