//! `contrapposto pose`: one posture from tasks in order of priority.

use std::path::Path;

use contrapposto::posture_solver::{Engine, EngineError, Reason, SolvedPosture};
use contrapposto_formats::motion::{write_csv, write_sto};
use contrapposto_formats::tissue::fatigue_notes;
use contrapposto_formats::{PoseScenario, PoseText, read_pose};
use contrapposto_plot::body_figure;

use crate::args::PoseArgs;
use crate::fail::Fail;
use crate::output::{Folder, json_text, print, print_note};
use crate::scenario_file::ScenarioFile;
use crate::view::pose_picture::pose_picture;
use crate::view::report::pose::{figures_of_pose, report_of_pose};
use crate::view::text::pose::{all_remaining, reached, report, subtitle, tasks};

const POSE_FILES: [&str; 6] = ["pose.json", "report.html", "pose.mot", "pose.csv", "pose.svg", "pose.png"];

pub(crate) fn pose(args: &PoseArgs) -> Result<(), Fail> {
    let ScenarioFile { name, bytes, model } = ScenarioFile::read(&args.scenario)?;
    let scenario = read_pose(&name, &bytes, model)?;
    if !scenario.unused.is_empty() {
        let list: Vec<String> = scenario.unused.iter().map(|table| format!("[{table}]")).collect();
        print_note("note", &format!("{} is ignored by `pose`; it is for `simulate`", list.join(", ")));
    }
    scenario.notes.iter().for_each(|note| print_note("note", note));
    fatigue_notes(&scenario.model).iter().for_each(|note| print_note("note", note));
    let refused = |error: EngineError| Fail::Refused(format!("{name}: {error}"));
    let (levels, limits) = scenario.levels();
    let mut engine = Engine::new(&scenario.model, levels, &scenario.loads, scenario.options).map_err(refused)?;
    scenario.locked.iter().for_each(|&rate| engine.lock(rate));
    let mut pose = engine.solve(&scenario.start).map_err(|error| Fail::job("pose", error))?;
    // The limits are not among the goals that are reported.
    limits.map(|place| pose.levels.remove(place));
    let figures = if args.figures { figures_of_pose(&scenario, &pose)? } else { vec![] };
    let names = POSE_FILES.into_iter().chain(figures.iter().map(|(name, _)| name.as_str())).map(str::to_owned);
    let text = PoseText::new(&scenario, &pose, names.collect());
    let json = write(&scenario, &pose, &text, &figures, &args.out)?;
    let folder = Folder::open(&args.out)?;
    print(&if args.json { json } else { report(&scenario, &pose, &text, &folder) })?;
    verdict(&scenario, &pose, &text)
}

/// Writes all files, and gives back the text of `pose.json`.
fn write(
    scenario: &PoseScenario,
    pose: &SolvedPosture,
    text: &PoseText,
    figures: &[(String, Vec<u8>)],
    out: &Path,
) -> Result<String, Fail> {
    let columns: Vec<_> = scenario.model.coordinates().iter().map(|c| (c.name.as_str(), c.kind)).collect();
    let rows = [pose.posture.values()];
    let title = if scenario.title.is_empty() { "pose" } else { &scenario.title };
    let mot = write_sto(title, &columns, true, &[0.0], &rows).map_err(|error| Fail::job("pose.mot", error))?;
    let csv = write_csv(&columns, &[0.0], &rows).map_err(|error| Fail::job("pose.csv", error))?;
    let json = json_text("pose.json", &text)?;
    let picture = body_figure(&pose_picture(scenario, pose, &subtitle(text))?);
    let (svg, png) = (picture.svg(), picture.png().map_err(|error| Fail::job("PNG", error))?);
    let page = report_of_pose(scenario, pose, text)?;
    let contents = [json.as_bytes(), page.as_bytes(), mot.as_bytes(), csv.as_bytes(), svg.as_bytes(), png.as_slice()];
    let figures = figures.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    Folder::open(out)?.write(&POSE_FILES.into_iter().zip(contents).chain(figures).collect::<Vec<_>>())?;
    Ok(json)
}

/// A task that yields is no failure; supports that slip, and the step limit, are.
fn verdict(scenario: &PoseScenario, pose: &SolvedPosture, text: &PoseText) -> Result<(), Fail> {
    if !text.supports_hold {
        let lost: Vec<String> = tasks(text)
            .filter(|entries| scenario.goals[entries[0].priority - 1].hard && !reached(entries))
            .map(|entries| format!("{} {}", entries[0].task, all_remaining(entries)))
            .collect();
        return Err(Fail::Job(format!("the supports move from their places: {}", lost.join(", "))));
    }
    match pose.reason {
        Reason::StepLimit => Err(Fail::Job(format!(
            "not converged after {} steps; the best posture is written. [solver] max_steps allows more",
            pose.steps
        ))),
        Reason::Reached | Reason::Converged => Ok(()),
    }
}
