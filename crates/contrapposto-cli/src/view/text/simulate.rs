//! The terminal table of a run.

use contrapposto::contact::Support;
use contrapposto::hybrid::Case;
use contrapposto::model::CoordinateKind;
use contrapposto::simulation::{CoordinateSummary, Scenario, Standing, StepKind, StopReason, Summary, TaskSettings};
use contrapposto::tasks::Task;
use contrapposto::verdict::error_in_words;

use super::plain_table;
use crate::output::ResultSet;
use crate::view::three_axis::angles;
use crate::view::words::{MOST_ROWS, how_long, joint, percent, plain, shares_of_all, why};

/// m or rad. A task whose error is smaller counts as kept in the table of a run.
const REACHED: f64 = 1e-3;
/// Angles nearer than this, degrees, are one.
const ALIKE_ANGLES: f64 = 0.05;
/// The note about joints with three axes.
const ABOUT_AXES: &str = "angles and torques of a joint with three axes are those about each axis; `final_deg` in summary.json is the \
                          coordinate itself\n";

/// `relief by the active strategy` of a whole body; of single joints the cases of their decisions, too.
pub(crate) fn strategy_in_words(scenario: &Scenario, summary: &CoordinateSummary) -> String {
    if !scenario.has_supports_or_tasks() {
        return strategy_and_cases(scenario, summary);
    }
    let kind = match scenario.strategy.kind {
        contrapposto::hybrid::Strategy::Active => "active",
        contrapposto::hybrid::Strategy::Passive => "passive",
    };
    let relief = if summary.case_changes == 0 { "no relief needed" } else { "tired joints seek relief" };
    format!("{kind} strategy: {relief}")
}

/// `none needed`, `sought`; of a single joint the cases of its decisions.
fn relief_in_words(scenario: &Scenario, summary: &CoordinateSummary) -> String {
    match summary.case_changes {
        0 => "none needed".to_owned(),
        _ if scenario.has_supports_or_tasks() => "sought".to_owned(),
        _ => cases(summary),
    }
}

/// `active, R_min 0.2: cases 3.1 x6, 3.3 x33, 2.1 x1`.
pub(crate) fn strategy_and_cases(scenario: &Scenario, summary: &CoordinateSummary) -> String {
    let ratio = scenario.strategy.minimum_decrease_ratio;
    let strategy = match scenario.strategy.kind {
        contrapposto::hybrid::Strategy::Active => format!("active strategy, R_min {ratio}"),
        contrapposto::hybrid::Strategy::Passive => "passive strategy".to_owned(),
    };
    format!("{strategy}: {}", cases(summary))
}

/// `cases 3.1 x6, 3.3 x33, 2.1 x1`.
pub(crate) fn cases(summary: &CoordinateSummary) -> String {
    if summary.case_changes == 0 {
        return "no relief needed".to_owned();
    }
    let count = |case: Case| summary.iterations[case as usize];
    let mut kinds = summary.cases.clone();
    kinds.sort();
    kinds.dedup();
    if summary.case_changes as usize > kinds.len() {
        let list: Vec<String> = kinds.iter().map(|&case| format!("{case} x{}", count(case))).collect();
        return format!("cases {} in {} changes", list.join(", "), summary.case_changes - 1);
    }
    let list: Vec<String> = summary.cases.iter().map(|&case| format!("{case} x{}", count(case))).collect();
    format!("cases {}", list.join(", "))
}

/// The table of the coordinates with the greatest loads, and the notes below it.
fn coordinates(scenario: &Scenario, summary: &Summary) -> (comfy_table::Table, String) {
    let mut table = plain_table();
    table.set_header(["joint", "end", "external", "passive", "active, N m", "peak load", "peak fatigue +/-", "relief"]);
    let last: Vec<f64> = summary.coordinates.iter().map(|coordinate| coordinate.final_value).collect();
    let angles = angles(&scenario.model, &last);
    let all = scenario.model.coordinates().iter().zip(&angles).zip(&summary.coordinates).zip(&scenario.free);
    let mut all: Vec<_> = all.collect();
    let more = all.len().saturating_sub(MOST_ROWS);
    if more > 0 {
        all.sort_by(|((_, a), _), ((_, b), _)| b.peak_load.total_cmp(&a.peak_load));
        all.truncate(MOST_ROWS);
    }
    let mut about_axes = false;
    for (((coordinate, angle), summary), free) in all {
        about_axes |= (angle - summary.final_value).abs().to_degrees() >= ALIKE_ANGLES;
        let [external, passive, active] = summary.final_torques;
        let [positive, negative] = summary.peak_fatigue;
        // Without a strength there is neither load nor fatigue.
        let known = coordinate.groups.is_some();
        table.add_row([
            format!("{}{}", joint(&coordinate.name), if *free { "" } else { " (locked)" }),
            match coordinate.kind {
                CoordinateKind::Rotation => format!("{:.1} deg", angle.to_degrees()),
                CoordinateKind::Translation => format!("{:.3} m", summary.final_value),
                CoordinateKind::Quaternion => format!("{:.4}", summary.final_value),
            },
            format!("{external:.2}"),
            format!("{passive:.2}"),
            format!("{active:.2}"),
            if known { percent(summary.peak_load) } else { String::new() },
            if known { format!("{positive:.2} / {negative:.2}") } else { String::new() },
            if *free { relief_in_words(scenario, summary) } else { String::new() },
        ]);
    }
    let more = match more {
        0 => String::new(),
        more => format!("and {more} coordinates with lower loads, which summary.json lists\n"),
    };
    (table, if about_axes { more + ABOUT_AXES } else { more })
}

/// The tables of a run, below its first lines and its title.
pub(crate) fn report(scenario: &Scenario, summary: &Summary) -> String {
    let (table, notes) = coordinates(scenario, summary);
    let reason = match summary.reason {
        StopReason::Settled => "settled",
        StopReason::Duration => "ran its full duration",
        StopReason::Interrupted => "interrupted",
        StopReason::Fell => "fell",
        StopReason::Slid => "stopped because the supports slid,",
    };
    let standing =
        summary.standing.as_ref().map_or(String::new(), |standing| standing_text(scenario, summary, standing));
    let (end, samples) = (how_long(summary.end_time), summary.samples);
    format!("{table}\n{notes}{standing}{reason} after {end} ({samples} samples)\n")
}

/// The lines that name the page and the pictures of a run.
pub(crate) fn files_of_run(scenario: &Scenario, folder: &ResultSet) -> String {
    let picture = if scenario.has_supports_or_tasks() { "postures.svg" } else { "torque-balance.svg" };
    let [page, first, second] = ["report.html", picture, "time-line.svg"].map(|name| folder.path(name));
    format!("report: {}\npictures: {}, {}\n", page.display(), first.display(), second.display())
}

/// `right foot carries 85.0 %, left foot carries 15.0 % of body and loads; effort (sum of squared shares of strength) 0.097 at the start, 0.059
/// at the end`, and below it `tasks: point hand_r (above relief), head upright, effort`, with the error of those that are off at the end.
fn standing_text(scenario: &Scenario, summary: &Summary, standing: &Standing) -> String {
    let segments = scenario.model.segments();
    let shares = shares_of_all(&standing.contacts.iter().map(|contact| contact.share).collect::<Vec<_>>());
    let share = |(support, share): (&Support, f64)| {
        format!("{} carries {:.1} %", plain(&segments[support.segment].name), 100.0 * share)
    };
    let carried: Vec<String> = scenario.supports.iter().zip(shares).map(share).collect();
    let carried = if carried.is_empty() { String::new() } else { carried.join(", ") + " of body and loads; " };
    let start = summary.effort_at_start.unwrap_or(standing.effort);
    let mut text = format!(
        "{carried}effort (sum of squared shares of strength) {start:.4} at the start, {:.4} at the end\n",
        standing.effort
    );
    if !scenario.tasks.is_empty() {
        let task = |(task, error): (&TaskSettings, &f64)| {
            let place = if task.above_relief { " (above relief)" } else { "" };
            let effort = task.goal.tasks.iter().any(|task| matches!(task, Task::Effort(_)));
            let off = if effort || *error < REACHED {
                String::new()
            } else {
                format!(" (off by {})", error_in_words(&task.goal, *error))
            };
            task.label(&scenario.model) + place + &off
        };
        let tasks: Vec<String> = scenario.tasks.iter().zip(&standing.errors).map(task).collect();
        text += &format!("tasks: {}\n", tasks.join(", "));
    }
    for step in &summary.foot_steps {
        let segment = plain(&segments[scenario.supports[step.support].segment].name);
        let ([x, y, z], [to_x, to_y, to_z]) = step.place;
        let what = match step.kind {
            StepKind::Elsewhere => "put elsewhere",
            StepKind::PutDown => "put down to rest",
            StepKind::TakenOff => "taken up again",
        };
        text += &format!(
            "{segment} was {what} at {}, within {}, from ({x:.2}, {y:.2}, {z:.2}) to ({to_x:.2}, {to_y:.2}, {to_z:.2}) m, \
             {}: effort {:.4} before, {:.4} after\n",
            how_long(step.time.0),
            how_long(step.time.1 - step.time.0),
            why(&scenario.model, step),
            step.effort.0,
            step.effort.1
        );
    }
    text
}
