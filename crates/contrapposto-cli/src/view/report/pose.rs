//! The page of a solved pose.

use contrapposto::contact::root_rates;
use contrapposto::posture_solver::{Reason, SolvedPosture};
use contrapposto_formats::{PoseLevelText, PoseScenario, PoseText};
use contrapposto_report::{Moments, Table};

use super::figure::{carriers, figure, figures_of};
use crate::fail::Fail;
use crate::view::axes::turn;
use crate::view::figures::figures_of_postures;
use crate::view::held::{Held, held};
use crate::view::pose_picture::targets;
use crate::view::scene::Scene;
use crate::view::text::pose::{reached, tasks};
use crate::view::words::{list, percent, plain};

/// The page of a solved pose.
pub(crate) fn report_of_pose(scenario: &PoseScenario, pose: &SolvedPosture, text: &PoseText) -> Result<String, Fail> {
    let model = &scenario.model;
    let Held { frame, holds } = held(model, &pose.posture, &scenario.loads, &scenario.supports)?;
    let frames = [frame];
    let supported = scenario.goals.iter().any(|goal| goal.hard);
    let scene = Scene {
        held: (!supported).then_some(scenario.loads.as_slice()),
        ..Scene::of(&scenario.title, model, scenario.start.values(), &frames, &scenario.supports)
    };
    let [frame] = &frames;
    let worst = (0..frame.load.len()).max_by(|&a, &b| frame.load[a].total_cmp(&frame.load[b]));
    let mut report = scene.report(Moments::Postures(vec!["the posture".to_owned()]), worst.unwrap_or(0))?;
    let turn = turn(model);
    report.targets = targets(scenario, pose)?.into_iter().map(|target| turn.point(target)).collect();
    let all: Vec<_> = tasks(text).collect();
    let done = all.iter().filter(|entries| reached(entries)).count();
    // What is asked of the rest of the body is left by as much as everything above it needs.
    let rest = |task: &str| task.starts_with("posture") || task.starts_with("effort");
    let missing = all.iter().filter(|entries| !reached(entries) && !rest(&entries[0].task));
    let missing: Vec<String> =
        missing.map(|entries| format!("{} by {}", plain_task(&entries[0].task), left(entries))).collect();
    report.headline = match (missing.is_empty(), done == all.len()) {
        (true, true) => "Everything is reached.".to_owned(),
        (true, false) => "All is reached; the rest of the body is as near to what is asked as that allows.".to_owned(),
        _ => format!("Not everything is reached: {}.", list(&missing)),
    };
    report.reasons = match pose.reason {
        Reason::Reached => vec![],
        Reason::Converged if missing.is_empty() => vec![],
        Reason::Converged => vec!["What is left is as near as the tasks above it allow.".to_owned()],
        Reason::StepLimit => vec!["The largest number of steps was made, and the body still moves.".to_owned()],
    };
    if !text.supports_hold {
        report.reasons.push("The supports do not stay where they are.".to_owned());
    }
    let free = !root_rates(model).is_empty();
    report.reasons.extend(if !holds {
        Some("Supports that only push cannot hold the body in this posture: it would fall; torques are those of a body that is held at its root besides.".to_owned())
    } else {
        let nothing = scenario.supports.is_empty() && free;
        nothing.then(|| "Where supports touch is not known, so torques are those of a body that is held at its root.".to_owned())
    });
    report.figures.push(figure("Tasks reached", format!("{done} of {}", all.len()), "supports among them"));
    figures_of(model, frame, &carriers(&scene), &mut report);
    let row = |entries: &&[PoseLevelText]| {
        let mark = if reached(entries) { "reached" } else { "as near as those above allow" };
        vec![entries[0].priority.to_string(), plain_task(&entries[0].task), left(entries), mark.to_owned()]
    };
    report.table = Table {
        heading: "What is left of the tasks, the most important first".to_owned(),
        columns: ["Priority", "Task", "What is left", ""].map(str::to_owned).to_vec(),
        rows: all.iter().map(row).collect(),
    };
    Ok(contrapposto_report::write(&report))
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
fn left(entries: &[PoseLevelText]) -> String {
    let text = |level: &PoseLevelText| match level.unit {
        "m" => format!("{:.1} mm", 1e3 * level.residual),
        "rad" => format!("{:.1}°", level.residual.to_degrees()),
        _ => format!("{} of strength", percent(level.residual)),
    };
    if reached(entries) { "nothing".to_owned() } else { entries.iter().map(text).collect::<Vec<_>>().join(", ") }
}
