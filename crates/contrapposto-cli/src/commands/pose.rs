//! `contrapposto pose`: one posture from tasks in order of priority.

use contrapposto::contact::Slip;
use contrapposto::posture_solver::{Engine, EngineError, Reason, SolvedPosture};
use contrapposto::verdict::{HeldPosture, Missed, Verdict};
use contrapposto_formats::motion::{write_csv, write_sto};
use contrapposto_formats::tissue::fatigue_notes;
use contrapposto_formats::{PoseScenario, PoseText, read_pose};
use contrapposto_plot::body_figure;

use crate::args::PoseArgs;
use crate::fail::Fail;
use crate::output::{ResultSet, json_text, print, print_note};
use crate::scenario_file::ScenarioFile;
use crate::view::answer::answered;
use crate::view::held::{Held, held};
use crate::view::pose_picture::pose_picture;
use crate::view::report::pose::{figures_of_pose, report_of_pose};
use crate::view::text::pose::{report, subtitle};

const POSE_FILES: [&str; 6] = ["pose.json", "report.html", "pose.mot", "pose.csv", "pose.svg", "pose.png"];

pub(crate) fn pose(args: &PoseArgs) -> Result<(), Fail> {
    let file = ScenarioFile::read_from(&args.scenario, args.start_from.as_deref())?;
    let name = file.name.clone();
    let scenario = read(file)?;
    let folder = args.out.as_deref().map(|out| ResultSet::open(out, &POSE_FILES)).transpose()?;
    let pose = solve(&name, &scenario)?;
    let figures = if args.figures { figures_of_pose(&scenario, &pose)? } else { vec![] };
    let names = POSE_FILES.into_iter().chain(figures.iter().map(|(name, _)| name.as_str())).map(str::to_owned);
    let files = if args.out.is_some() { names.collect() } else { vec![] };
    let held = held(&scenario.model, &pose.posture, &scenario.loads, &scenario.supports)?;
    let verdict = verdict(&scenario, &pose, &held);
    let text = PoseText::new(&scenario, &pose, &verdict, files);
    let json = json_text("pose.json", &text)?;
    if let Some(folder) = &folder {
        write(&scenario, &pose, (&text, &json), &figures, held, folder)?;
    }
    print(&if args.json { json } else { report(&scenario, &pose, &text, &verdict, folder.as_ref()) })?;
    exit(&pose, &verdict)
}

/// The scenario of a file; notes about it go to standard error.
pub(crate) fn read(file: ScenarioFile) -> Result<PoseScenario, Fail> {
    let ScenarioFile { name, bytes, model } = file;
    let scenario = read_pose(&name, &bytes, model)?;
    if !scenario.unused.is_empty() {
        let list: Vec<String> = scenario.unused.iter().map(|table| format!("[{table}]")).collect();
        print_note("note", &format!("{} is ignored by `pose`; it is for `simulate`", list.join(", ")));
    }
    scenario.notes.iter().for_each(|note| print_note("note", note));
    fatigue_notes(&scenario.model).iter().for_each(|note| print_note("note", note));
    Ok(scenario)
}

/// The posture of a scenario named `name`, with the errors of its goals.
pub(crate) fn solve(name: &str, scenario: &PoseScenario) -> Result<SolvedPosture, Fail> {
    let refused = |error: EngineError| Fail::Refused(format!("{name}: {error}"));
    let (levels, limits) = scenario.levels();
    let mut engine = Engine::new(&scenario.model, levels, &scenario.loads, scenario.options).map_err(refused)?;
    scenario.locked.iter().for_each(|&rate| engine.lock(rate));
    let mut pose = engine.solve(&scenario.start).map_err(|error| Fail::job("pose", error))?;
    // The limits are not among the goals that are reported.
    limits.map(|place| pose.levels.remove(place));
    Ok(pose)
}

/// Writes all files.
fn write(
    scenario: &PoseScenario,
    pose: &SolvedPosture,
    (text, json): (&PoseText, &str),
    figures: &[(String, Vec<u8>)],
    held: Held,
    folder: &ResultSet,
) -> Result<(), Fail> {
    let columns: Vec<_> = scenario.model.coordinates().iter().map(|c| (c.name.as_str(), c.kind)).collect();
    let rows = [pose.posture.values()];
    let title = if scenario.title.is_empty() { "pose" } else { &scenario.title };
    let mot = write_sto(title, &columns, true, &[0.0], &rows).map_err(|error| Fail::job("pose.mot", error))?;
    let csv = write_csv(&columns, &[0.0], &rows).map_err(|error| Fail::job("pose.csv", error))?;
    let picture = body_figure(&pose_picture(scenario, pose, &subtitle(text))?);
    let (svg, png) = (picture.svg(), picture.png().map_err(|error| Fail::job("PNG", error))?);
    let page = report_of_pose(scenario, pose, text, held)?;
    let contents = [json.as_bytes(), page.as_bytes(), mot.as_bytes(), csv.as_bytes(), svg.as_bytes(), png.as_slice()];
    let figures = figures.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    folder.write(&POSE_FILES.into_iter().zip(contents).chain(figures).collect::<Vec<_>>())
}

/// The answer of a posture that is held.
pub(crate) fn verdict(scenario: &PoseScenario, pose: &SolvedPosture, held: &Held) -> Verdict {
    let levels = || scenario.goals.iter().zip(&pose.levels);
    let targets = levels().filter(|(goal, _)| !goal.hard).map(|(goal, level)| (goal, level.length));
    let posture = HeldPosture {
        groups: held.groups.clone(),
        missing: held.missing,
        slip: levels().filter(|(goal, _)| goal.hard).fold(Slip::default(), |slip, (_, level)| slip.with(level.slip())),
        missed: Missed::of_levels(&scenario.model, targets),
        hazards: held.hazards.clone(),
    };
    Verdict::of_posture(&scenario.model, &posture)
}

/// A target of lower priority that is missed is no failure; the step limit is one.
fn exit(pose: &SolvedPosture, verdict: &Verdict) -> Result<(), Fail> {
    match pose.reason {
        Reason::StepLimit => Err(Fail::Job(format!(
            "not converged after {} steps; the best posture is written. [solver] max_steps allows more",
            pose.steps
        ))),
        Reason::Reached | Reason::Converged => answered(verdict),
    }
}
