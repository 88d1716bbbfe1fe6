//! `contrapposto simulate` and `contrapposto demo`: a scenario over time.

use std::path::Path;
use std::time::Duration;

use comfy_table::Table;
use contrapposto::hybrid::Case;
use contrapposto::model::CoordinateKind;
use contrapposto::simulation::{CoordinateSummary, Scenario, Summary, run};
use contrapposto_formats::{MOST_BYTES, SummaryText, csv_header, csv_row, read_scenario};
use contrapposto_plot::{SketchRole, time_line, torque_balance};
use indicatif::{ProgressBar, ProgressStyle};

use crate::args::{DemoArgs, SimulateArgs};
use crate::chart::{Course, Sweep};
use crate::fail::Fail;
use crate::input::read;
use crate::output::{Folder, print};
use crate::pose::model_of;
use crate::report::{Recording, report_of_run};

/// The scenario of `contrapposto demo`.
const DEMO: (&str, &str) = ("scenarios/figure-08.toml", include_str!("../../../scenarios/figure-08.toml"));

const FILES: [&str; 7] = [
    "summary.json",
    "report.html",
    "trajectory.csv",
    "torque-balance.svg",
    "torque-balance.png",
    "time-line.svg",
    "time-line.png",
];

pub(crate) fn simulate(args: &SimulateArgs) -> Result<(), Fail> {
    let bytes = read(&args.scenario, MOST_BYTES)?;
    let name = args.scenario.display().to_string();
    let model = model_of(&args.scenario, &name, &bytes)?;
    let scenario = read_scenario(&name, &bytes, model)?;
    carry_out(&scenario, &args.out, args.json)
}

pub(crate) fn demo(args: &DemoArgs) -> Result<(), Fail> {
    let scenario = read_scenario(DEMO.0, DEMO.1.as_bytes(), None)?;
    carry_out(&scenario, &args.out, args.json)
}

fn carry_out(scenario: &Scenario, out: &Path, json: bool) -> Result<(), Fail> {
    let folder = Folder::open(out)?;
    let mut table = folder.begin("trajectory.csv")?;
    table.append(csv_header(&scenario.model).as_bytes())?;
    table.append(b"\n")?;
    let progress = progress_bar(scenario.run.duration);
    let mut courses: Vec<Course> = scenario.free.iter().map(|_| Course::default()).collect();
    let mut recording = Recording::default();
    let mut row = String::new();
    let mut written = Ok(());
    let mut samples = 0u64;
    let summary = run(scenario, |sample| {
        row.clear();
        csv_row(&scenario.model, sample, &mut row);
        if written.is_ok() {
            written = table.append(row.as_bytes());
        }
        for (i, course) in courses.iter_mut().enumerate().filter(|(i, _)| scenario.free[*i]) {
            course.take(i, sample);
        }
        recording.take(scenario, sample);
        samples += 1;
        if samples.is_multiple_of(1024) {
            progress.set_position(sample.time as u64);
        }
    })
    .map_err(|error| Fail::job("simulation", error))?;
    progress.finish_and_clear();
    written?;

    let main = main_coordinate(scenario, &summary);
    let coordinate = &scenario.model.coordinates()[main];
    let subtitle = story(scenario, &summary.coordinates[main]);
    let posture: Vec<f64> = summary.coordinates.iter().map(|c| c.final_value).collect();
    let mut line = courses.swap_remove(main).finish();
    line.title = scenario.title.clone();
    line.subtitle.clone_from(&subtitle);
    line.coordinate.clone_from(&coordinate.name);
    line.critical_level = scenario.hysteresis.critical_level;
    line.recovery_level = scenario.hysteresis.recovery_level;

    let mut sweep = Sweep::new(scenario, main, &posture);
    let mut balance = sweep.balance(&scenario.title, &subtitle)?;
    balance.path = line.angle_deg.iter().copied().zip(line.active_nm.iter().copied()).collect();
    balance.start = balance.path.first().copied();
    balance.goal = balance.path.last().copied();
    if let (Some(start), Some(goal)) = (balance.start, balance.goal) {
        balance.postures.push(sweep.sketch("start", start.0, SketchRole::Start)?);
        balance.postures.push(sweep.sketch("end", goal.0, SketchRole::Goal)?);
    }

    let text = SummaryText::new(scenario, &summary, FILES.map(str::to_owned).to_vec());
    let json_text = serde_json::to_string_pretty(&text).map_err(|error| Fail::job("summary.json", error))? + "\n";
    let png_failed = |error| Fail::job("PNG", error);
    let (balance, line) = (torque_balance(&[balance]), time_line(&line));
    let mut files = vec![table];
    for (name, bytes) in [
        ("torque-balance.svg", balance.svg().into_bytes()),
        ("torque-balance.png", balance.png().map_err(png_failed)?),
        ("time-line.svg", line.svg().into_bytes()),
        ("time-line.png", line.png().map_err(png_failed)?),
        ("report.html", report_of_run(scenario, &recording, &summary)?.into_bytes()),
        ("summary.json", json_text.clone().into_bytes()),
    ] {
        let mut file = folder.begin(name)?;
        file.append(&bytes)?;
        files.push(file);
    }
    folder.commit(files)?;
    print(&if json { json_text } else { report(scenario, &summary, &folder) })
}

/// The coordinate worth a picture: the one most often relieved, else the first free one, else the first.
fn main_coordinate(scenario: &Scenario, summary: &Summary) -> usize {
    let decisions = |i: usize| summary.coordinates[i].iterations.iter().sum::<u64>();
    let free = (0..scenario.free.len()).filter(|&i| scenario.free[i]);
    // The first of equals: ties are broken by the model's order.
    free.rev().max_by_key(|&i| decisions(i)).unwrap_or(0)
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
        contrapposto::simulation::StopReason::Settled => "settled",
        contrapposto::simulation::StopReason::Duration => "ran its whole duration",
    };
    format!(
        "{}\n{table}\n{reason} after {:.2} s ({} samples)\nreport: {}\npictures: {}, {}\n",
        scenario.title,
        summary.end_time,
        summary.samples,
        folder.path("report.html").display(),
        folder.path("torque-balance.svg").display(),
        folder.path("time-line.svg").display(),
    )
}

/// Simulated time on standard error; invisible when that is no terminal.
fn progress_bar(duration: f64) -> ProgressBar {
    let bar = ProgressBar::new(duration.ceil() as u64);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {bar:40} {pos} of {len} s simulated") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
