//! `contrapposto figures`: the published elbow cases, Figures 1 and 7-14 of Rodriguez & Boulic 2007.
//!
//! One scenario file a figure, one named elbow curve for all of them; nothing is tuned per figure. The paper gives no angles
//! for its oblique and lateral arms: they are chosen once, in the scenario files, and disclosed in docs/deviations.md.

use comfy_table::Table;
use contrapposto::hybrid::{Case, Strategy};
use contrapposto::model::data;
use contrapposto::simulation::{CoordinateSummary, Scenario, run};
use contrapposto_formats::{iterations, read_scenario};
use contrapposto_plot::{SketchRole, TorqueBalance, torque_balance};
use serde::Serialize;
use std::collections::BTreeMap;

use crate::args::{ElbowCurve, FiguresArgs};
use crate::fail::Fail;
use crate::output::{Folder, json_text, print};
use crate::view::charts::Sweep;
use crate::view::text::plain_table;
use crate::view::text::simulate::{cases, strategy_and_cases};

/// One published figure.
struct Published {
    number: u8,
    scenario: &'static str,
    /// Strategies and `R_min` shown in the figure; none where it only shows torques.
    runs: &'static [(Strategy, f64)],
    /// The cases as printed.
    printed: &'static [Case],
}

const ACTIVE: Strategy = Strategy::Active;
const PASSIVE: Strategy = Strategy::Passive;

const FIGURES: [Published; 9] = [
    Published { number: 1, scenario: include_str!("../../../../scenarios/figure-01.toml"), runs: &[], printed: &[] },
    Published {
        number: 7,
        scenario: include_str!("../../../../scenarios/figure-07.toml"),
        runs: &[(ACTIVE, 1.0), (PASSIVE, 1.0)],
        printed: &[Case::C32, Case::C21],
    },
    Published {
        number: 8,
        scenario: include_str!("../../../../scenarios/figure-08.toml"),
        runs: &[(ACTIVE, 0.2)],
        printed: &[Case::C31, Case::C33, Case::C21],
    },
    Published {
        number: 9,
        scenario: include_str!("../../../../scenarios/figure-09.toml"),
        runs: &[(PASSIVE, 1.0)],
        printed: &[Case::C34, Case::C23],
    },
    Published { number: 10, scenario: include_str!("../../../../scenarios/figure-10.toml"), runs: &[], printed: &[] },
    Published {
        number: 11,
        scenario: include_str!("../../../../scenarios/figure-11.toml"),
        runs: &[(ACTIVE, 1.0), (ACTIVE, 0.2), (PASSIVE, 1.0), (PASSIVE, 0.2)],
        printed: &[Case::C32, Case::C11],
    },
    Published { number: 12, scenario: include_str!("../../../../scenarios/figure-12.toml"), runs: &[], printed: &[] },
    Published {
        number: 13,
        scenario: include_str!("../../../../scenarios/figure-13.toml"),
        runs: &[(ACTIVE, 1.0), (PASSIVE, 1.0)],
        printed: &[Case::C32, Case::C11],
    },
    Published {
        number: 14,
        scenario: include_str!("../../../../scenarios/figure-14.toml"),
        runs: &[(ACTIVE, 1.0)],
        printed: &[Case::C33, Case::C21],
    },
];

#[derive(Serialize)]
struct FigureText {
    figure: u8,
    runs: Vec<RunText>,
    zero_torque_deg: Vec<f64>,
    files: Vec<String>,
}

#[derive(Serialize)]
struct RunText {
    strategy: &'static str,
    minimum_decrease_ratio: f64,
    start_deg: f64,
    cases: Vec<&'static str>,
    iterations: BTreeMap<&'static str, u64>,
    final_deg: f64,
    final_active_nm: f64,
}

pub(crate) fn figures(args: &FiguresArgs) -> Result<(), Fail> {
    let known: Vec<u8> = FIGURES.iter().map(|figure| figure.number).collect();
    if let Some(unknown) = args.only.iter().find(|number| !known.contains(number)) {
        return Err(Fail::Refused(format!("--only {unknown}: there are figures {known:?}")));
    }
    let folder = Folder::open(&args.out)?;
    let mut texts = vec![];
    let mut table = plain_table();
    table.set_header(["figure", "strategy", "cases", "ends", "as printed"]);
    for figure in FIGURES.iter().filter(|figure| args.only.is_empty() || args.only.contains(&figure.number)) {
        texts.push(draw(figure, args.curve, &folder, &mut table)?);
    }
    if args.json {
        return print(&json_text("JSON", &texts)?);
    }
    print(&format!("{table}\npictures in {}\n", args.out.display()))
}

fn draw(figure: &Published, curve: ElbowCurve, folder: &Folder, table: &mut Table) -> Result<FigureText, Fail> {
    let file_name = format!("scenarios/figure-{:02}.toml", figure.number);
    let mut scenario = read_scenario(&file_name, figure.scenario.as_bytes(), None)?;
    let elbow = elbow(&scenario)?;
    if curve == ElbowCurve::Measured {
        scenario = with_measured_curve(scenario, elbow)?;
    }
    let mut sweep = Sweep::new(&scenario.model, &scenario.loads, elbow, scenario.start.values());
    let tolerance = scenario.relief.torque_tolerance;
    let zeros = sweep.zeros()?;
    let mut runs = vec![];
    let mut panels: Vec<TorqueBalance> = vec![];
    if figure.runs.is_empty() {
        let subtitle = format!("{} without active torque", postures(zeros.len()));
        let mut panel = sweep.balance(&scenario.title, &subtitle, tolerance)?;
        for &zero in &zeros {
            panel.postures.push(sweep.sketch(&format!("{zero:.1} deg"), zero, SketchRole::Zero)?);
        }
        panels.push(panel);
        table.add_row([figure.number.to_string(), String::new(), subtitle, list(&zeros), String::new()]);
    }
    for &(strategy, ratio) in figure.runs {
        let mut scenario = scenario.clone();
        scenario.strategy.kind = strategy;
        scenario.strategy.minimum_decrease_ratio = ratio;
        if !panels.is_empty() {
            scenario.title.clear();
        }
        let (text, panel) = carry_out(figure, &scenario, elbow, &mut sweep, table)?;
        panels.push(panel);
        runs.push(text);
    }
    let picture = torque_balance(&panels);
    let names = [format!("figure-{:02}.svg", figure.number), format!("figure-{:02}.png", figure.number)];
    let png = picture.png().map_err(|error| Fail::job(&names[1], error))?;
    folder.write(&[(&names[0], picture.svg().into_bytes()), (&names[1], png)])?;
    Ok(FigureText { figure: figure.number, runs, zero_torque_deg: zeros, files: names.to_vec() })
}

/// One run of a figure: its row of the table, its text, and its panel.
fn carry_out(
    figure: &Published,
    scenario: &Scenario,
    elbow: usize,
    sweep: &mut Sweep<'_>,
    table: &mut Table,
) -> Result<(RunText, TorqueBalance), Fail> {
    let (strategy, ratio) = (scenario.strategy.kind, scenario.strategy.minimum_decrease_ratio);
    let mut path = vec![];
    let summary = run(scenario, |sample| path.push((sample.posture[elbow].to_degrees(), sample.active[elbow])))
        .map_err(|error| Fail::job(format!("figure {}", figure.number), error))?;
    let summary = &summary.coordinates[elbow];
    let text = RunText {
        strategy: if strategy == ACTIVE { "active" } else { "passive" },
        minimum_decrease_ratio: ratio,
        start_deg: scenario.start.values()[elbow].to_degrees(),
        cases: summary.cases.iter().map(|case| case.number()).collect(),
        iterations: iterations(&summary.iterations),
        final_deg: summary.final_value.to_degrees(),
        final_active_nm: summary.final_torques[2],
    };
    let verdict = verdict(figure, summary);
    table.add_row([
        figure.number.to_string(),
        if strategy == ACTIVE { format!("active, R_min {ratio}") } else { "passive".to_owned() },
        cases(summary),
        format!("{:.1} deg", text.final_deg),
        verdict.to_owned(),
    ]);
    let note = if verdict == "yes" { String::new() } else { format!(" ({verdict})") };
    let tolerance = scenario.relief.torque_tolerance;
    let mut panel = sweep.balance(&scenario.title, &(strategy_and_cases(scenario, summary) + &note), tolerance)?;
    let (start, goal) = (path.first().copied(), path.last().copied());
    for (point, label, role) in [(start, "start", SketchRole::Start), (goal, "end", SketchRole::Goal)] {
        if let Some((angle, _)) = point {
            panel.postures.push(sweep.sketch(&format!("{label}, {angle:.1} deg"), angle, role)?);
        }
    }
    (panel.path, panel.start, panel.goal) = (path, start, goal);
    Ok((text, panel))
}

/// How the cases that occurred compare with the printed ones.
fn verdict(figure: &Published, summary: &CoordinateSummary) -> &'static str {
    let inner: Vec<Case> = summary.cases.iter().copied().filter(|case| *case != Case::C12).collect();
    if summary.cases == figure.printed {
        "yes"
    } else if inner == figure.printed {
        "with 1.2 between: docs/deviations.md, D13"
    } else {
        "no"
    }
}

fn elbow(scenario: &Scenario) -> Result<usize, Fail> {
    scenario.model.coordinate("elbow_flex_r").ok_or_else(|| Fail::Job("the adult has no elbow".into()))
}

fn with_measured_curve(mut scenario: Scenario, elbow: usize) -> Result<Scenario, Fail> {
    let range = scenario.model.coordinates()[elbow].range;
    let row = data::library().curve("elbow_flexion").ok_or_else(|| Fail::Job("no curve `elbow_flexion`".into()))?;
    let curve = row.over(range, 1.0).map_err(|error| Fail::job("elbow_flexion", error))?;
    scenario.model = scenario.model.with_passive(elbow, curve);
    Ok(scenario)
}

fn postures(count: usize) -> String {
    match count {
        1 => "one posture".to_owned(),
        2 => "two postures".to_owned(),
        3 => "three postures".to_owned(),
        n => format!("{n} postures"),
    }
}

fn list(angles: &[f64]) -> String {
    let shown: Vec<String> = angles.iter().map(|angle| format!("{angle:.1}")).collect();
    shown.join(", ") + " deg"
}
