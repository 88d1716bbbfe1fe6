//! `contrapposto pose`: one posture from goals in order of priority.

pub(crate) mod drawing;

use std::path::{Path, PathBuf};

use contrapposto::model::Model;
use contrapposto::posture_solver::inverse_kinematics::{Engine, Pose, Reason};
use contrapposto_formats::body::BodyRoot;
use contrapposto_formats::motion::{write_csv, write_sto};
use contrapposto_formats::{MOST_BYTES, ModelFile, PoseLevelText, PoseScenario, PoseText, read_pose, scenario_model};
use contrapposto_plot::body_figure;

use crate::args::{ModelArgs, PoseArgs, RootChoice};
use crate::fail::Fail;
use crate::input::read;
use crate::model_file::{open, tell};
use crate::output::{Folder, print};
use crate::report::{figures_of_pose, report_of_pose};
use crate::torques::plain_table;

pub(crate) use drawing::directions;

const FILES: [&str; 6] = ["pose.json", "report.html", "pose.mot", "pose.csv", "pose.svg", "pose.png"];

pub(crate) fn pose(args: &PoseArgs) -> Result<(), Fail> {
    let bytes = read(&args.scenario, MOST_BYTES)?;
    let name = args.scenario.display().to_string();
    let model = model_of(&args.scenario, &name, &bytes)?;
    let scenario = read_pose(&name, &bytes, model)?;
    if !scenario.unused.is_empty() {
        let list: Vec<String> = scenario.unused.iter().map(|table| format!("[{table}]")).collect();
        tell("note", &format!("{} is for `simulate` and has no part in a pose", list.join(", ")));
    }
    let refused =
        |error: contrapposto::posture_solver::inverse_kinematics::GoalError| Fail::Refused(format!("{name}: {error}"));
    let mut engine =
        Engine::new(&scenario.model, scenario.goals.clone(), &scenario.loads, scenario.options).map_err(refused)?;
    scenario.locked.iter().for_each(|&rate| engine.lock(rate));
    let pose = engine.solve(&scenario.start).map_err(|error| Fail::job("pose", error))?;
    let figures = if args.figures { figures_of_pose(&scenario, &pose)? } else { vec![] };
    let names = FILES.into_iter().chain(figures.iter().map(|(name, _)| name.as_str())).map(str::to_owned);
    let text = PoseText::new(&scenario, &pose, names.collect());
    let json = write(&scenario, &pose, &text, &figures, &args.out)?;
    let folder = Folder::open(&args.out)?;
    print(&if args.json { json } else { report(&scenario, &pose, &text, &folder) })?;
    verdict(&scenario, &pose, &text)
}

/// The model file that a scenario names, if it names one.
pub(crate) fn model_of(scenario: &Path, name: &str, bytes: &[u8]) -> Result<Option<Model>, Fail> {
    let Some(file) = scenario_model(name, bytes)? else { return Ok(None) };
    let opened = open(&model_args(scenario, &file), true)?;
    opened.notes.iter().for_each(|note| tell("note", note));
    Ok(Some(opened.model))
}

/// How the scenario's model file is opened: its paths are seen from the scenario's folder.
fn model_args(scenario: &Path, file: &ModelFile) -> ModelArgs {
    let folder = scenario.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let path = |name: &String| -> PathBuf { folder.join(name) };
    ModelArgs {
        model: path(&file.file),
        overlay: file.overlay.as_ref().map(path),
        root: file.root.map(|root| match root {
            BodyRoot::Fixed => RootChoice::Fixed,
            BodyRoot::Free => RootChoice::Free,
        }),
        passive: None,
    }
}

/// Writes all files, and gives back the text of `pose.json`.
fn write(
    scenario: &PoseScenario,
    pose: &Pose,
    text: &PoseText,
    figures: &[(String, Vec<u8>)],
    out: &Path,
) -> Result<String, Fail> {
    let columns: Vec<_> = scenario.model.coordinates().iter().map(|c| (c.name.as_str(), c.kind)).collect();
    let rows = [pose.posture.values()];
    let title = if scenario.title.is_empty() { "pose" } else { &scenario.title };
    let mot = write_sto(title, &columns, true, &[0.0], &rows).map_err(|error| Fail::job("pose.mot", error))?;
    let csv = write_csv(&columns, &[0.0], &rows).map_err(|error| Fail::job("pose.csv", error))?;
    let json = serde_json::to_string_pretty(text).map_err(|error| Fail::job("pose.json", error))? + "\n";
    let picture = body_figure(&drawing::pose_picture(scenario, pose, &subtitle(text))?);
    let (svg, png) = (picture.svg(), picture.png().map_err(|error| Fail::job("PNG", error))?);
    let page = report_of_pose(scenario, pose, text)?;
    let contents = [json.as_bytes(), page.as_bytes(), mot.as_bytes(), csv.as_bytes(), svg.as_bytes(), png.as_slice()];
    let figures = figures.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    Folder::open(out)?.write(&FILES.into_iter().zip(contents).chain(figures).collect::<Vec<_>>())?;
    Ok(json)
}

/// `left: look_at head 3.100 deg; posture 80.500 mm, 2.000 deg`.
fn subtitle(text: &PoseText) -> String {
    let missing: Vec<String> = tasks(text)
        .filter(|entries| !reached(entries))
        .map(|entries| format!("{} {}", entries[0].task, all_left(entries)))
        .collect();
    if missing.is_empty() { "everything is reached".to_owned() } else { format!("left: {}", missing.join("; ")) }
}

/// The entries of each task: one, or one for each of its units.
pub(crate) fn tasks(text: &PoseText) -> impl Iterator<Item = &[PoseLevelText]> {
    text.levels.chunk_by(|a, b| a.priority == b.priority && a.task == b.task && a.unit != b.unit)
}

pub(crate) fn reached(entries: &[PoseLevelText]) -> bool {
    entries.iter().all(|entry| entry.reached)
}

fn all_left(entries: &[PoseLevelText]) -> String {
    entries.iter().map(left).collect::<Vec<_>>().join(", ")
}

/// `0.412 mm`, in units that people read.
fn left(level: &PoseLevelText) -> String {
    let (value, unit) = match level.unit {
        "m" => (1e3 * level.residual, " mm"),
        "rad" => (level.residual.to_degrees(), " deg"),
        _ => (level.residual, " of strength"),
    };
    // What counts as nothing is not worth its digits.
    if !level.reached && value < 5e-4 { format!("{value:.0e}{unit}") } else { format!("{value:.3}{unit}") }
}

fn report(scenario: &PoseScenario, pose: &Pose, text: &PoseText, folder: &Folder) -> String {
    let mut table = plain_table();
    table.set_header(["priority", "task", "what is left", ""]);
    for entries in tasks(text) {
        table.add_row([
            entries[0].priority.to_string(),
            entries[0].task.clone(),
            all_left(entries),
            if reached(entries) { "reached" } else { "" }.to_owned(),
        ]);
    }
    let reason = match pose.reason {
        Reason::Reached => "everything is reached",
        Reason::Closest => "nothing moves any more: what is left is as near as the tasks above allow",
        Reason::Steps => "the largest number of steps was made, and the body still moves",
    };
    let steps = if pose.steps == 1 { "1 step".to_owned() } else { format!("{} steps", pose.steps) };
    let title = if scenario.title.is_empty() { String::new() } else { format!("{}\n", scenario.title) };
    format!("{title}{table}\n{reason} ({steps})\nreport: {}\n", folder.path("report.html").display())
}

/// A task that yields is no failure; supports that slip, and steps that ran out, are.
fn verdict(scenario: &PoseScenario, pose: &Pose, text: &PoseText) -> Result<(), Fail> {
    if !text.supports_hold {
        let lost: Vec<String> = tasks(text)
            .filter(|entries| scenario.goals[entries[0].priority - 1].hard && !reached(entries))
            .map(|entries| format!("{} {}", entries[0].task, all_left(entries)))
            .collect();
        return Err(Fail::Job(format!("supports do not stay where they are: {}", lost.join(", "))));
    }
    match pose.reason {
        Reason::Steps => Err(Fail::Job(format!(
            "no end after {} steps; the best posture is written. [solver] max_steps allows more",
            pose.steps
        ))),
        Reason::Reached | Reason::Closest => Ok(()),
    }
}
