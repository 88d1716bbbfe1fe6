//! `contrapposto simulate` and `contrapposto demo`: a scenario over time.

mod snapshot;

use std::path::Path;
use std::time::{Duration, Instant};

use contrapposto::contact::Missing;
use contrapposto::simulation::{Fall, Run, Scenario, ScenarioError, StopReason, Summary};
use contrapposto::suggestions::Advice;
use contrapposto::verdict::Verdict;
use contrapposto_formats::tissue::fatigue_notes;
use contrapposto_formats::{RunScenario, SummaryText, Thing, decisions_csv, read_run};
use indicatif::ProgressBar;

use self::snapshot::{SNAPSHOT, go_on, save};
use super::trials::{advice_of_run, advice_without_posture, cores, largest_load};
use crate::args::{DemoArgs, SimulateArgs, SuggestArgs};
use crate::fail::Fail;
use crate::interruption;
use crate::output::{ResultSet, json_text, print, print_note};
use crate::progress::{TRYING_CHANGES, progress_bar, spinner};
use crate::scenario_file::ScenarioFile;
use crate::view::answer::{Answer, answered, without_posture};
use crate::view::figures::{figures_of_run, pictures_of_run};
use crate::view::muscle_work::MusclesAtWork;
use crate::view::recording::Recording;
use crate::view::report::run::{muscles_of_run, report_of_run};
use crate::view::text::simulate::{files_of_run, report};
use crate::view::words::how_long;
use crate::view::{animation, tables};

/// The scenarios of `contrapposto demo`: a person who waits, and the paper's Figure 8.
const DEMO: (&str, &str) = ("scenarios/stand-relaxed.toml", scenario!("stand-relaxed"));
const FIGURE_8: (&str, &str) = ("scenarios/figure-08.toml", scenario!("figure-08"));

/// Files that a run may write, beside figures.
const RUN_FILES: [&str; 17] = [
    "decisions.csv",
    "fatigue.sto",
    "ground_reaction.mot",
    "model.osim",
    "motion.bvh",
    "motion.glb",
    "motion.mot",
    "postures.png",
    "postures.svg",
    "report.html",
    "summary.json",
    "time-line.png",
    "time-line.svg",
    "torque-balance.png",
    "torque-balance.svg",
    "torques.sto",
    "trajectory.csv",
];

/// A run that takes longer is saved so often, so that a crash of the machine loses little.
const BETWEEN_SAVES: Duration = Duration::from_secs(20);

pub(crate) fn simulate(args: &SimulateArgs) -> Result<(), Fail> {
    let mut run = read(ScenarioFile::read_from(&args.scenario, args.start_from.as_deref())?)?;
    run.scenario.run.threads = cores();
    run.notes.iter().for_each(|note| print_note("note", note));
    fatigue_notes(&run.scenario.model).iter().for_each(|note| print_note("note", note));
    let SimulateArgs { resume, figures, json, suggest, wooden, largest_load, .. } = *args;
    carry_out(&run, args.out.as_deref(), How { resume, figures, json, suggest, wooden, largest_load })
}

/// The run of a file, with the muscles of its model.
pub(crate) fn read(file: ScenarioFile) -> Result<RunScenario, Fail> {
    let ScenarioFile { name, bytes, model, muscles } = file;
    let mut run = read_run(&name, &bytes, model)?;
    run.take_muscles(muscles).map_err(|why| Fail::Refused(format!("{name}: {why}")))?;
    Ok(run)
}

pub(crate) fn demo(args: &DemoArgs) -> Result<(), Fail> {
    let (name, text) = if args.figure_8 { FIGURE_8 } else { DEMO };
    let mut run = read_run(name, text.as_bytes(), None)?;
    run.scenario.run.threads = cores();
    carry_out(&run, Some(&args.out), How { json: args.json, ..How::default() })?;
    if args.json {
        return Ok(());
    }
    let page = args.out.join("report.html");
    print(&format!(
        "\nOpen {} in a browser. Then: `contrapposto new lift --out job.toml` writes a job of your own, `contrapposto simulate job.toml \
         --out out` answers it; `contrapposto --help` lists all commands.\n",
        page.display()
    ))
}

/// Choices of the command line for carrying out a scenario.
#[derive(Clone, Copy, Default)]
struct How {
    resume: bool,
    figures: bool,
    json: bool,
    suggest: SuggestArgs,
    wooden: bool,
    largest_load: bool,
}

/// Runs a scenario; without `out` nothing is recorded, drawn and written.
fn carry_out(run: &RunScenario, out: Option<&Path>, how: How) -> Result<(), Fail> {
    let (RunScenario { scenario, things, .. }, How { resume, json, suggest, largest_load: largest, .. }) = (run, how);
    let folder = out.map(|out| ResultSet::open(out, &RUN_FILES)).transpose()?;
    interruption::watch();
    let goes_on = || !interruption::is_requested();
    let failed = |error| Fail::job("simulation", error);
    // The bar is there while the start is searched for, too.
    let progress = progress_bar(scenario.run.duration);
    let resumed =
        folder.as_ref().filter(|_| resume).map(|folder| go_on(scenario, &folder.path(SNAPSHOT))).transpose()?;
    let (mut run, recording) = match resumed {
        Some(resumed) => resumed,
        None => match Run::new(scenario) {
            Ok(run) => (run, Recording::new(scenario)),
            Err(ScenarioError::CannotStand(missing) | ScenarioError::Falls(Fall { missing, .. })) => {
                progress.finish();
                return not_standing(scenario, missing, folder.as_ref(), how);
            }
            Err(error) => return Err(failed(error)),
        },
    };
    let mut files = Files { folder, recording };
    go_through(scenario, &mut run, &mut files, &progress)?;
    progress.finish();
    let summary = run.summary();
    let muscles = muscles_of_run(scenario, &files.recording, &summary)?;
    let mut answer = Answer::of_run(scenario, &summary);
    let mut broken_off = false;
    if summary.reason != StopReason::Interrupted {
        // Who waits for the changes has the answer of the job as it is.
        let trying = spinner(format!("{} Now {TRYING_CHANGES}", answer.verdict.sentence));
        answer.advice = advice_of_run(&answer.verdict, scenario, (&summary, run.solver_steps()), suggest, goes_on);
        answer.advice.largest = largest_load(scenario, (largest, run.solver_steps()), suggest, goes_on);
        trying.finish();
        broken_off = interruption::is_requested();
        if broken_off {
            answer.advice = Advice::broken_off();
        }
    }
    let found = (&summary, muscles.as_ref());
    let text = match &files.folder {
        Some(folder) => files.write(folder, (scenario, things), (&run, found), &answer, how)?,
        None => summary_json(scenario, found, &answer, vec![])?,
    };
    print(&if json {
        text
    } else {
        let tables = report(scenario, &summary) + &muscles.map_or_else(String::new, |muscles| muscles.table());
        let files = files.folder.as_ref().map_or(String::new(), |folder| files_of_run(scenario, folder));
        answer.in_words(&scenario.model, &scenario.title, &tables) + &files
    })?;
    match (summary.reason, broken_off) {
        (StopReason::Interrupted, _) => Err(Fail::Job(interrupted(&summary, scenario.run.duration, out))),
        (_, true) => Err(Fail::Job("interrupted while changes of the job were tried; its answer is whole".to_owned())),
        _ => answered(&answer.verdict),
    }
}

/// Answers a scenario whose body cannot stand at the start.
fn not_standing(scenario: &Scenario, missing: Missing, folder: Option<&ResultSet>, how: How) -> Result<(), Fail> {
    let How { json, suggest, largest_load: largest, .. } = how;
    let goes_on = || !interruption::is_requested();
    let body = (&scenario.model, scenario.loads.as_slice());
    let advice = |verdict: &Verdict| {
        let advice = advice_without_posture(verdict, scenario, suggest, goes_on);
        if interruption::is_requested() {
            return Advice::broken_off();
        }
        Advice { largest: largest_load(scenario, (largest, 0), suggest, goes_on), ..advice }
    };
    without_posture("summary.json", &scenario.title, body, (missing, advice), folder, json)
}

/// Computes and records all samples up to the end of a run, or until it is interrupted. A run without files is recorded for its muscles only.
fn go_through<'a>(
    scenario: &'a Scenario,
    run: &mut Run<'a>,
    files: &mut Files,
    progress: &ProgressBar,
) -> Result<(), Fail> {
    let recorded = files.folder.is_some() || scenario.muscles.is_some();
    let mut number = run.snapshot().samples;
    let mut saved = (Instant::now(), number);
    // The start is always shown.
    while number == 0 || !interruption::is_requested() {
        let Some(sample) = run.next_sample().map_err(|error| Fail::job("simulation", error))? else { break };
        if recorded {
            files.recording.record(number, &sample);
        }
        number += 1;
        if number.is_multiple_of(256) {
            progress.set_position(sample.time as u64);
            if saved.0.elapsed() > BETWEEN_SAVES && run.snapshot().samples > saved.1 {
                files.folder.iter().try_for_each(|folder| save(scenario, run, &files.recording, folder))?;
                saved = (Instant::now(), run.snapshot().samples);
            }
        }
    }
    Ok(())
}

/// The error of an interrupted run.
fn interrupted(summary: &Summary, duration: f64, out: Option<&Path>) -> String {
    let files = out.map_or(String::new(), |out| {
        format!(": the results so far are in {}; the same command with --resume continues", out.display())
    });
    format!("interrupted at {} of {}{files}", how_long(summary.end_time), how_long(duration))
}

/// The text of `summary.json`.
pub(crate) fn summary_json(
    scenario: &Scenario,
    (summary, muscles): (&Summary, Option<&MusclesAtWork<'_>>),
    answer: &Answer,
    files: Vec<String>,
) -> Result<String, Fail> {
    let text = SummaryText::new(scenario, summary, &answer.verdict, &answer.advice, files);
    json_text("summary.json", &SummaryText { muscle_work: muscles.map(MusclesAtWork::text), ..text })
}

/// The folder of a run, if it has one, and all that its files show.
struct Files {
    folder: Option<ResultSet>,
    recording: Recording,
}

impl Files {
    /// Writes all files, on request with figures, and of an interrupted run the snapshot; gives the text of `summary.json`.
    fn write(
        &self,
        folder: &ResultSet,
        (scenario, things): (&Scenario, &[Thing]),
        (run, (summary, muscles)): (&Run, (&Summary, Option<&MusclesAtWork<'_>>)),
        answer: &Answer,
        How { figures, wooden, .. }: How,
    ) -> Result<String, Fail> {
        let recording = &self.recording;
        let figures = if figures { figures_of_run(scenario, things, (recording, muscles), summary)? } else { vec![] };
        let mut contents = vec![
            ("trajectory.csv", tables::trajectory(scenario, recording).into_bytes()),
            ("motion.mot", tables::motion(scenario, recording)?.into_bytes()),
            ("torques.sto", tables::torques(scenario, recording)?.into_bytes()),
            ("fatigue.sto", tables::fatigue(scenario, recording)?.into_bytes()),
            ("report.html", report_of_run((scenario, things), (recording, muscles), summary, answer)?.into_bytes()),
            ("decisions.csv", decisions_csv(&scenario.model, &summary.reliefs).into_bytes()),
        ];
        contents.extend(animation::bodies((scenario, things), (recording, muscles), wooden)?);
        if !scenario.supports.is_empty() {
            contents.push(("ground_reaction.mot", tables::ground_reaction(scenario, recording)?.into_bytes()));
        }
        let names = if scenario.has_supports_or_tasks() {
            ["postures.svg", "postures.png"]
        } else {
            ["torque-balance.svg", "torque-balance.png"]
        };
        let [first, second] = pictures_of_run(scenario, things, summary, (recording, muscles))?;
        for (names, figure) in [(names, first), (["time-line.svg", "time-line.png"], second)] {
            contents.push((names[0], figure.svg().into_bytes()));
            contents.push((names[1], figure.png().map_err(|error| Fail::job("PNG", error))?));
        }
        contents.extend(figures.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())));
        let files = contents.iter().map(|(name, _)| (*name).to_owned()).chain(["summary.json".to_owned()]).collect();
        let json = summary_json(scenario, (summary, muscles), answer, files)?;
        contents.push(("summary.json", json.clone().into_bytes()));
        // Whenever the program is killed from here on, either the run can be resumed or its whole set is there.
        if summary.reason == StopReason::Interrupted {
            save(scenario, run, recording, folder)?;
            folder.write(&contents)?;
        } else {
            folder.write(&contents)?;
            folder.remove(SNAPSHOT)?;
        }
        Ok(json)
    }
}
