//! The page of a solved pose.

use contrapposto::contact::root_rates;
use contrapposto::posture_solver::{Reason, SolvedPosture};
use contrapposto_formats::{PoseLevelText, PoseScenario, PoseText};
use contrapposto_report::{Moments, Table};

use super::figure::{carriers, figure, figures_of};
use super::page;
use crate::fail::Fail;
use crate::view::answer::Answer;
use crate::view::figures::figures_of_postures;
use crate::view::held::{Held, held};
use crate::view::muscle_work::MusclesAtWork;
use crate::view::scene::Scene;
use crate::view::stage::Stage;
use crate::view::targets::targets;
use crate::view::text::pose::{IN_BALANCE, mark, reached, tasks as tasks_of};
use crate::view::words::{list, metres, plain};

/// The page of a solved pose.
pub(crate) fn report_of_pose(
    scenario: &PoseScenario,
    (pose, kept_balance): (&SolvedPosture, bool),
    (text, answer): (&PoseText, &Answer),
    (held, muscles): (Held, Option<&MusclesAtWork<'_>>),
) -> Result<String, Fail> {
    let model = &scenario.model;
    let Held { frame, missing: unheld, .. } = held;
    let frames = [frame];
    let stage = Stage::still(&scenario.supports, &scenario.things, &scenario.loads);
    let supported = scenario.goals.iter().any(|goal| goal.hard);
    let scene = Scene {
        held: (!supported).then_some(scenario.loads.as_slice()),
        muscles,
        ..Scene::of(&scenario.title, model, scenario.start.values(), &frames, stage)
    };
    let [frame] = &frames;
    let worst = (0..frame.load.len()).max_by(|&a, &b| frame.load[a].total_cmp(&frame.load[b]));
    let mut report = scene.report(Moments::Postures(vec!["the posture".to_owned()]), worst.unwrap_or(0))?;
    let tasks = || scenario.goals.iter().filter(|goal| !goal.hard).flat_map(|goal| &goal.tasks).collect();
    report.targets = targets(model, &frames, |_| tasks())?;
    let all: Vec<_> = tasks_of(text).collect();
    let done = all.iter().filter(|entries| reached(entries)).count();
    // Posture and effort tasks take what tasks of higher priority leave.
    let rest = |task: &str| task.starts_with("posture") || task.starts_with("effort");
    let missing = all.iter().filter(|entries| !reached(entries) && !rest(&entries[0].task));
    let missing: Vec<String> =
        missing.map(|entries| format!("{} by {}", plain_task(&entries[0].task), remaining(entries))).collect();
    super::answer(&mut report, &answer.verdict, &answer.advice);
    report.reasons.extend(reasons((pose.reason, kept_balance), &missing, done == all.len()));
    let nothing = scenario.supports.is_empty() && !root_rates(model).is_empty();
    if unheld.is_some() || nothing {
        report.reasons.push("The torques shown are those of a body whose root is held, as if by hand.".to_owned());
    }
    report.figures.push(figure("Tasks reached", format!("{done} of {}", all.len()), "supports among them"));
    figures_of(model, frame, &carriers(&scene), &mut report);
    let row = |entries: &&[PoseLevelText]| {
        let mark = mark(entries).to_owned();
        vec![entries[0].priority.to_string(), plain_task(&entries[0].task), remaining(entries), mark]
    };
    report.table = Table {
        heading: "Remaining errors of the tasks, highest priority first".to_owned(),
        columns: ["Priority", "Task", "Remaining error", "Result"].map(str::to_owned).to_vec(),
        rows: all.iter().map(row).collect(),
    };
    Ok(page(model, report))
}

/// Whether the tasks are reached, and why not. `missing`: the targets that are missed; `all`: nothing at all is left.
fn reasons((reason, kept_balance): (Reason, bool), missing: &[String], all: bool) -> Vec<String> {
    let targets = match (missing.is_empty(), all) {
        (true, true) => "All tasks are reached.".to_owned(),
        (true, false) => {
            "All targets are reached; posture and effort tasks come as near to their goals as these allow.".to_owned()
        }
        _ => format!("Not all tasks are reached: {}.", list(missing)),
    };
    let why = match reason {
        Reason::Converged if !missing.is_empty() => {
            Some("The remaining errors are the smallest that tasks of higher priority allow.".to_owned())
        }
        Reason::StepLimit if kept_balance => Some(format!("The posture is {IN_BALANCE}.")),
        Reason::StepLimit => Some("The step limit was reached before the posture converged.".to_owned()),
        Reason::Reached | Reason::Converged => None,
    };
    std::iter::once(targets).chain(why).collect()
}

/// `--figures` of a solved pose.
pub(crate) fn figures_of_pose(scenario: &PoseScenario, pose: &SolvedPosture) -> Result<Vec<(String, Vec<u8>)>, Fail> {
    let held = held(&scenario.model, &pose.posture, &scenario.loads, &scenario.supports)?;
    figures_of_postures(&scenario.title, &scenario.model, &[held.frame], &["the posture".to_owned()])
}

/// `look_at head` is `look at head`, `point hand_r` is `point right hand`.
fn plain_task(task: &str) -> String {
    let words: Vec<String> =
        task.split(' ').map(|word| if word == "look_at" { "look at".to_owned() } else { plain(word) }).collect();
    words.join(" ")
}

/// `12.3 mm, 4.5°`; `nothing` where it is reached.
fn remaining(entries: &[PoseLevelText]) -> String {
    let text = |level: &PoseLevelText| match level.unit {
        "m" => metres(level.residual).unwrap_or_else(|| format!("{:.1} mm", 1e3 * level.residual)),
        "rad" => format!("{:.1}°", level.residual.to_degrees()),
        _ => format!("{:.3}, sum of squared relative loads", level.residual.powi(2)),
    };
    if reached(entries) { "nothing".to_owned() } else { entries.iter().map(text).collect::<Vec<_>>().join(", ") }
}
