//! `contrapposto figures`: the published elbow cases, Figures 1 and 7-14 of Rodriguez & Boulic 2007.
//!
//! One scenario file a figure, one reshaped elbow curve for all of them; nothing is tuned per figure. The paper gives no angles
//! for its oblique and lateral arms: they are chosen once, in the scenario files, and disclosed in docs/deviations.md. A run
//! is as printed if its cases are the printed ones and its path has a kink exactly where the text names one.

use comfy_table::Table;
use contrapposto::hybrid::{Case, Strategy};
use contrapposto::model::{Model, data};
use contrapposto::simulation::{CoordinateSummary, Scenario, run};
use contrapposto_formats::{iterations, read_scenario};
use contrapposto_plot::{SketchRole, TorqueBalance, torque_balance};
use serde::Serialize;
use std::collections::BTreeMap;

use crate::args::{ElbowCurve, FiguresArgs};
use crate::fail::Fail;
use crate::output::{ResultSet, json_text, print};
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
    /// Whether the text says that reshaping shows as a kink in the path (section 4.1).
    kink: bool,
}

/// A close-up shows so much on each side of a kink, deg.
const CLOSE_UP_DEG: f64 = 3.0;

const ACTIVE: Strategy = Strategy::Active;
const PASSIVE: Strategy = Strategy::Passive;

const FIGURES: [Published; 9] = [
    Published { number: 1, scenario: scenario!("figure-01"), runs: &[], printed: &[], kink: false },
    Published {
        number: 7,
        scenario: scenario!("figure-07"),
        runs: &[(ACTIVE, 1.0), (PASSIVE, 1.0)],
        printed: &[Case::C32, Case::C21],
        kink: true,
    },
    Published {
        number: 8,
        scenario: scenario!("figure-08"),
        runs: &[(ACTIVE, 0.2)],
        printed: &[Case::C31, Case::C33, Case::C21],
        kink: false,
    },
    Published {
        number: 9,
        scenario: scenario!("figure-09"),
        runs: &[(PASSIVE, 1.0)],
        printed: &[Case::C34, Case::C23],
        kink: true,
    },
    Published { number: 10, scenario: scenario!("figure-10"), runs: &[], printed: &[], kink: false },
    Published {
        number: 11,
        scenario: scenario!("figure-11"),
        runs: &[(ACTIVE, 1.0), (ACTIVE, 0.2), (PASSIVE, 1.0), (PASSIVE, 0.2)],
        printed: &[Case::C32, Case::C11],
        kink: false,
    },
    Published { number: 12, scenario: scenario!("figure-12"), runs: &[], printed: &[], kink: false },
    Published {
        number: 13,
        scenario: scenario!("figure-13"),
        runs: &[(ACTIVE, 1.0), (PASSIVE, 1.0)],
        printed: &[Case::C32, Case::C11],
        kink: false,
    },
    Published {
        number: 14,
        scenario: scenario!("figure-14"),
        runs: &[(ACTIVE, 1.0)],
        printed: &[Case::C33, Case::C21],
        kink: false,
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
    /// Angle between start and end where the passive slope jumps.
    kink_deg: Option<f64>,
    as_printed: bool,
    /// Differences from the printed figure.
    differences: Vec<&'static str>,
}

pub(crate) fn figures(args: &FiguresArgs) -> Result<(), Fail> {
    let known: Vec<u8> = FIGURES.iter().map(|figure| figure.number).collect();
    if let Some(unknown) = args.only.iter().find(|number| !known.contains(number)) {
        return Err(Fail::Refused(format!("--only {unknown}: there are figures {known:?}")));
    }
    let folder = ResultSet::open(&args.out, &[])?;
    let (mut texts, mut files) = (vec![], vec![]);
    let mut table = plain_table();
    table.set_header(["figure", "strategy", "cases", "ends", "kink", "as printed"]);
    for figure in FIGURES.iter().filter(|figure| args.only.is_empty() || args.only.contains(&figure.number)) {
        texts.push(draw(figure, args.curve, &mut files, &mut table)?);
    }
    folder.write(&files.iter().map(|(name, bytes)| (name.as_str(), bytes)).collect::<Vec<_>>())?;
    if args.json {
        return print(&json_text("JSON", &texts)?);
    }
    print(&format!("{table}\nD13, D14: docs/deviations.md\npictures in {}\n", args.out.display()))
}

/// Carries out the runs of a figure and adds its pictures to `files`.
fn draw(
    figure: &Published,
    curve: ElbowCurve,
    files: &mut Vec<(String, Vec<u8>)>,
    table: &mut Table,
) -> Result<FigureText, Fail> {
    let file_name = format!("scenarios/figure-{:02}.toml", figure.number);
    let mut scenario = read_scenario(&file_name, figure.scenario.as_bytes(), None)?;
    let elbow = elbow(&scenario)?;
    if curve == ElbowCurve::Measured {
        scenario = with_measured_curve(scenario, elbow)?;
    }
    let mut sweep = Sweep::new(&scenario.model, &scenario.loads, elbow, scenario.start.values())?;
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
        let none = String::new;
        table.add_row([figure.number.to_string(), none(), subtitle, list(&zeros), none(), none()]);
    }
    for &(strategy, ratio) in figure.runs {
        let mut scenario = scenario.clone();
        scenario.strategy.kind = strategy;
        scenario.strategy.minimum_decrease_ratio = ratio;
        if !panels.is_empty() {
            scenario.title.clear();
        }
        let (text, panel) = carry_out(figure, &scenario, elbow, &mut sweep, table)?;
        let close_up = text.kink_deg.map(|kink| close_up(&panel, kink));
        panels.push(panel);
        panels.extend(close_up);
        runs.push(text);
    }
    let picture = torque_balance(&panels);
    let names = [format!("figure-{:02}.svg", figure.number), format!("figure-{:02}.png", figure.number)];
    let png = picture.png().map_err(|error| Fail::job(&names[1], error))?;
    files.extend(names.iter().cloned().zip([picture.svg().into_bytes(), png]));
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
    let start = scenario.start.values()[elbow];
    let kink = kink(&scenario.model, elbow, (start, summary.final_value));
    let differences = differences(figure, summary, kink);
    let text = RunText {
        strategy: if strategy == ACTIVE { "active" } else { "passive" },
        minimum_decrease_ratio: ratio,
        start_deg: start.to_degrees(),
        cases: summary.cases.iter().map(|case| case.number()).collect(),
        iterations: iterations(&summary.iterations),
        final_deg: summary.final_value.to_degrees(),
        final_active_nm: summary.final_torques[2],
        kink_deg: kink.map(f64::to_degrees),
        as_printed: differences.is_empty(),
        differences,
    };
    let verdict = if text.as_printed { "yes".to_owned() } else { format!("no: {}", text.differences.join(", ")) };
    table.add_row([
        figure.number.to_string(),
        format!("{}, R_min {ratio}", text.strategy),
        cases(summary),
        format!("{:.1} deg", text.final_deg),
        text.kink_deg.map_or(String::new(), |angle| format!("{angle:.1} deg")),
        verdict,
    ]);
    let note =
        if text.as_printed { String::new() } else { format!("; not as printed: {}", text.differences.join(", ")) };
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

/// Differences of a run from the printed figure.
fn differences(figure: &Published, summary: &CoordinateSummary, kink: Option<f64>) -> Vec<&'static str> {
    let without_12: Vec<Case> = summary.cases.iter().copied().filter(|case| *case != Case::C12).collect();
    let cases = if summary.cases == figure.printed {
        None
    } else if without_12 == figure.printed {
        Some("case 1.2 between (D13)")
    } else {
        Some("other cases")
    };
    let kink = match (figure.kink, kink.is_some()) {
        (true, false) => Some("no kink (D14)"),
        (false, true) => Some("a kink that the text does not name (D14)"),
        _ => None,
    };
    cases.into_iter().chain(kink).collect()
}

/// The angle (rad) between `start` and `end` where reshaping makes the passive slope of the coordinate jump.
fn kink(model: &Model, coordinate: usize, (start, end): (f64, f64)) -> Option<f64> {
    let curve = model.coordinates()[coordinate].curve()?;
    let (reshape, (min, max)) = (curve.reshape()?, curve.range());
    let kinks = [(min + reshape.zone, reshape.lower_stiffness), (max - reshape.zone, reshape.upper_stiffness)];
    let passed = |angle: f64| start.min(end) < angle && angle < start.max(end);
    kinks.into_iter().find(|&(angle, stiffness)| stiffness > 0.0 && passed(angle)).map(|(angle, _)| angle)
}

/// The part of a panel around the kink of its path.
fn close_up(panel: &TorqueBalance, kink_deg: f64) -> TorqueBalance {
    let near = |angle: f64| (angle - kink_deg).abs() <= CLOSE_UP_DEG;
    let part = |torques: &[f64]| -> Vec<f64> {
        let points = panel.angles_deg.iter().zip(torques).filter(|point| near(*point.0));
        points.map(|point| *point.1).collect()
    };
    TorqueBalance {
        subtitle: format!("close-up of the kink at {kink_deg:.1} deg"),
        angle_label: panel.angle_label.clone(),
        angles_deg: part(&panel.angles_deg),
        external_nm: part(&panel.external_nm),
        minus_passive_nm: part(&panel.minus_passive_nm),
        active_nm: part(&panel.active_nm),
        tolerance_nm: panel.tolerance_nm,
        path: panel.path.iter().copied().filter(|point| near(point.0)).collect(),
        goal: panel.goal.filter(|point| near(point.0)),
        ..TorqueBalance::default()
    }
}

fn elbow(scenario: &Scenario) -> Result<usize, Fail> {
    scenario.model.coordinate("elbow_flex_r").ok_or_else(|| Fail::Job("the adult has no elbow".into()))
}

fn with_measured_curve(mut scenario: Scenario, elbow: usize) -> Result<Scenario, Fail> {
    let range = scenario.model.coordinates()[elbow].range;
    let row = data::library().curve("elbow_flexion").ok_or_else(|| Fail::Job("no curve `elbow_flexion`".into()))?;
    let (zone, end_torque, _) = data::library().reshape();
    let curve = row.over(range, 1.0).and_then(|curve| data::reshaped(&curve, zone, end_torque));
    let curve = curve.map_err(|error| Fail::job("elbow_flexion", error))?;
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
