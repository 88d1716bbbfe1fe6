//! `contrapposto simulate` and `contrapposto demo`: a scenario over time.

mod body;
mod recording;
mod snapshot;
mod tables;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use comfy_table::Table;
use contrapposto::contact::Support;
use contrapposto::hybrid::Case;
use contrapposto::model::CoordinateKind;
use contrapposto::simulation::{Contact, CoordinateSummary, Run, Scenario, Standing, StopReason, Summary};
use contrapposto_formats::{MOST_BYTES, SummaryText, decisions_csv, read_scenario};
use contrapposto_plot::{Figure, SketchRole, body_figure, time_line, torque_balance};
use indicatif::{ProgressBar, ProgressStyle};

pub(crate) use self::recording::{Recording, Row};
use self::snapshot::{SNAPSHOT, go_on, save};
use crate::args::{DemoArgs, SimulateArgs};
use crate::chart::{Sweep, course};
use crate::fail::Fail;
use crate::input::read;
use crate::output::{Folder, print};
use crate::pose::model_of;
use crate::report::{before_and_after, figures_of_run, main_coordinate, report_of_run};

/// The scenario of `contrapposto demo`.
const DEMO: (&str, &str) = ("scenarios/figure-08.toml", include_str!("../../../scenarios/figure-08.toml"));

/// A run that takes longer is saved so often, so that a crash of the machine loses little.
const BETWEEN_SAVES: Duration = Duration::from_secs(20);

/// Someone pressed Ctrl-C.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

pub(crate) fn simulate(args: &SimulateArgs) -> Result<(), Fail> {
    let bytes = read(&args.scenario, MOST_BYTES)?;
    let name = args.scenario.display().to_string();
    let model = model_of(&args.scenario, &name, &bytes)?;
    let scenario = read_scenario(&name, &bytes, model)?;
    carry_out(&scenario, &args.out, args.resume, args.figures, args.json)
}

pub(crate) fn demo(args: &DemoArgs) -> Result<(), Fail> {
    let scenario = read_scenario(DEMO.0, DEMO.1.as_bytes(), None)?;
    carry_out(&scenario, &args.out, false, false, args.json)
}

fn carry_out(scenario: &Scenario, out: &Path, resume: bool, figures: bool, json: bool) -> Result<(), Fail> {
    let folder = Folder::open(out)?;
    // A second handler is refused, which only happens if there is one already.
    let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
    let failed = |error| Fail::job("simulation", error);
    let (mut run, mut recording) = match resume {
        true => go_on(scenario, &folder.path(SNAPSHOT))?,
        false => (Run::new(scenario).map_err(failed)?, Recording::new(scenario)),
    };
    let progress = progress_bar(scenario.run.duration);
    let mut number = run.snapshot().samples;
    let mut saved = (Instant::now(), number);
    // The start is always shown.
    while number == 0 || !INTERRUPTED.load(Ordering::Relaxed) {
        let Some(sample) = run.next_sample().map_err(failed)? else { break };
        recording.take(number, &sample);
        number += 1;
        if number.is_multiple_of(256) {
            progress.set_position(sample.time as u64);
            if saved.0.elapsed() > BETWEEN_SAVES && run.snapshot().samples > saved.1 {
                save(scenario, &run, &recording, &folder)?;
                saved = (Instant::now(), run.snapshot().samples);
            }
        }
    }
    progress.finish_and_clear();
    let summary = run.summary();
    let figures = if figures { figures_of_run(scenario, &recording, &summary)? } else { vec![] };
    let json_text = write(scenario, &summary, &recording, &figures, &folder)?;
    let partial = summary.reason == StopReason::Interrupted;
    if partial {
        save(scenario, &run, &recording, &folder)?;
    } else {
        folder.remove(SNAPSHOT)?;
    }
    print(&if json { json_text } else { report(scenario, &summary, &folder) })?;
    match summary.fall {
        Some(fall) => Err(Fail::Job(format!("{fall}; what came before is in {}", out.display()))),
        None if partial => Err(Fail::Job(format!(
            "interrupted at {:.2} of {} s: what is done is in {}; the same command with --resume goes on",
            summary.end_time,
            scenario.run.duration,
            out.display()
        ))),
        None => Ok(()),
    }
}

/// All files but the snapshot; gives the text of `summary.json`.
fn write(
    scenario: &Scenario,
    summary: &Summary,
    recording: &Recording,
    figures: &[(String, Vec<u8>)],
    folder: &Folder,
) -> Result<String, Fail> {
    let mut contents = vec![
        ("trajectory.csv", tables::trajectory(scenario, recording).into_bytes()),
        ("motion.mot", tables::motion(scenario, recording)?.into_bytes()),
        ("torques.sto", tables::torques(scenario, recording)?.into_bytes()),
        ("fatigue.sto", tables::fatigue(scenario, recording)?.into_bytes()),
        ("report.html", report_of_run(scenario, recording, summary)?.into_bytes()),
        ("decisions.csv", decisions_csv(&scenario.model, &summary.reliefs).into_bytes()),
    ];
    contents.extend(body::bodies(scenario, recording)?);
    if !scenario.supports.is_empty() {
        contents.push(("ground_reaction.mot", tables::ground_reaction(scenario, recording)?.into_bytes()));
    }
    let names = if scenario.is_whole() {
        ["postures.svg", "postures.png"]
    } else {
        ["torque-balance.svg", "torque-balance.png"]
    };
    let [first, second] = pictures(scenario, summary, recording)?;
    for (names, figure) in [(names, first), (["time-line.svg", "time-line.png"], second)] {
        contents.push((names[0], figure.svg().into_bytes()));
        contents.push((names[1], figure.png().map_err(|error| Fail::job("PNG", error))?));
    }
    contents.extend(figures.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())));
    let files = contents.iter().map(|(name, _)| (*name).to_owned()).chain(["summary.json".to_owned()]).collect();
    let text = SummaryText::new(scenario, summary, files);
    let json = serde_json::to_string_pretty(&text).map_err(|error| Fail::job("summary.json", error))? + "\n";
    contents.push(("summary.json", json.clone().into_bytes()));
    folder.write(&contents)?;
    Ok(json)
}

/// The body before and after (one joint: its torques over angle), and the main coordinate over time.
fn pictures(scenario: &Scenario, summary: &Summary, recording: &Recording) -> Result<[Figure; 2], Fail> {
    let main = main_coordinate(scenario, summary);
    let coordinate = &scenario.model.coordinates()[main];
    let subtitle = story(scenario, &summary.coordinates[main]);
    let mut line = course(recording, &summary.reliefs, main);
    line.title = scenario.title.clone();
    line.subtitle.clone_from(&subtitle);
    line.coordinate.clone_from(&coordinate.name);
    line.critical_level = scenario.hysteresis.critical_level;
    line.recovery_level = scenario.hysteresis.recovery_level;
    if scenario.is_whole() {
        return Ok([body_figure(&before_and_after(scenario, recording, &subtitle)?), time_line(&line)]);
    }
    let posture: Vec<f64> = summary.coordinates.iter().map(|c| c.final_value).collect();
    let mut sweep = Sweep::new(&scenario.model, &scenario.loads, main, &posture);
    let mut balance = sweep.balance(&scenario.title, &subtitle, scenario.relief.torque_tolerance)?;
    balance.path = line.angle_deg.iter().copied().zip(line.active_nm.iter().copied()).collect();
    balance.start = balance.path.first().copied();
    balance.goal = balance.path.last().copied();
    if let (Some(start), Some(goal)) = (balance.start, balance.goal) {
        balance.postures.push(sweep.sketch("start", start.0, SketchRole::Start)?);
        balance.postures.push(sweep.sketch("end", goal.0, SketchRole::Goal)?);
    }
    Ok([torque_balance(&[balance]), time_line(&line)])
}

/// `active, R_min 0.2: cases 3.1 x6, 3.3 x33, 2.1 x1`.
pub(crate) fn story(scenario: &Scenario, summary: &CoordinateSummary) -> String {
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
        return "no relief asked for".to_owned();
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

fn report(scenario: &Scenario, summary: &Summary, folder: &Folder) -> String {
    let mut table = Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    table.set_header(["coordinate", "end", "external", "passive", "active, N m", "peak load", "fatigue +/-", "cases"]);
    for ((coordinate, summary), free) in
        scenario.model.coordinates().iter().zip(&summary.coordinates).zip(&scenario.free)
    {
        let [external, passive, active] = summary.final_torques;
        let [positive, negative] = summary.peak_fatigue;
        table.add_row([
            format!("{}{}", coordinate.name, if *free { "" } else { " (locked)" }),
            match coordinate.kind {
                CoordinateKind::Rotation => format!("{:.1} deg", summary.final_value.to_degrees()),
                CoordinateKind::Translation => format!("{:.3} m", summary.final_value),
                CoordinateKind::Quaternion => format!("{:.4}", summary.final_value),
            },
            format!("{external:.2}"),
            format!("{passive:.2}"),
            format!("{active:.2}"),
            format!("{:.0} %", 100.0 * summary.peak_load),
            format!("{positive:.2} / {negative:.2}"),
            if *free { cases(summary) } else { String::new() },
        ]);
    }
    let reason = match summary.reason {
        StopReason::Settled => "settled",
        StopReason::Duration => "ran its whole duration",
        StopReason::Interrupted => "interrupted",
        StopReason::Fell => "fell",
    };
    let picture = if scenario.is_whole() { "postures.svg" } else { "torque-balance.svg" };
    let standing =
        summary.standing.as_ref().map_or(String::new(), |standing| standing_text(scenario, summary, standing));
    format!(
        "{}\n{table}\n{standing}{reason} after {:.2} s ({} samples)\npictures: {}, {}\n",
        scenario.title,
        summary.end_time,
        summary.samples,
        folder.path(picture).display(),
        folder.path("time-line.svg").display(),
    )
}

/// `calcn_r carries 85.0 %, calcn_l 15.0 %; effort 0.097 at the start, 0.059 at the end`.
fn standing_text(scenario: &Scenario, summary: &Summary, standing: &Standing) -> String {
    let segments = scenario.model.segments();
    let share = |(support, contact): (&Support, &Contact)| {
        format!("{} carries {:.1} %", segments[support.segment].name, 100.0 * contact.share)
    };
    let mut parts: Vec<String> = scenario.supports.iter().zip(&standing.contacts).map(share).collect();
    let start = summary.effort_at_start.unwrap_or(standing.effort);
    parts.push(format!("effort {start:.4} at the start, {:.4} at the end", standing.effort));
    parts.join(", ") + "\n"
}

/// Simulated time on standard error; invisible when that is no terminal.
pub(crate) fn progress_bar(duration: f64) -> ProgressBar {
    let bar = ProgressBar::new(duration.ceil() as u64);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {bar:40} {pos} of {len} s simulated") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
