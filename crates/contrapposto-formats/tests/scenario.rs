//! The scenario reader is total: any bytes give an experiment or a complaint, never a panic; and what it accepts runs without
//! a number that is not finite.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use std::path::Path;

use common::toml::{ODD, hammer_toml, numbers};
use contrapposto::simulation::{Sample, Scenario, run};
use contrapposto_formats::{csv_header, csv_row, read_scenario};

/// Every scenario of the repository that runs over time, and one with every table a scenario may have.
fn corpus() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    let mut texts: Vec<String> = paths.iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
    texts.retain(|text| text.contains("[run]"));
    assert!(texts.len() >= 10);
    texts.push(FULL.to_owned());
    texts
}

const FULL: &str = r#"format = 1
title = "Every table"
[model]
adult = { sex = "female", stature_m = 1.65, mass_kg = 60, part = "right_arm", lengths_m = { humerus = 0.31 } }
[passive]
elbow_flex_r = { double_exponential = { lower = { torque_nm = 12.67, rate_per_rad = 19.92, angle_deg = 0.5 }, upper = { torque_nm = 9.324, rate_per_rad = 3.811, angle_deg = 150 }, stiffness_nm_per_rad = 0.4, neutral_deg = 73 }, reshape = { zone_deg = 5, end_torque_nm = 20 } }
wrist_flex_r = { coordinate_limit_force = { upper_stiffness_nm_per_deg = 1.5, upper_limit_deg = 60, lower_stiffness_nm_per_deg = 1.2, lower_limit_deg = -50, transition_deg = 8 } }
wrist_dev_r = { table_deg_nm = [[-20, 3.5], [-10, 0.5], [15, -0.6], [30, -4.5]], reshape = true }
[posture]
arm_flex_r_deg = 60
elbow_flex_r_deg = 90
[coordinates]
locked = ["arm_rot_r"]
[[load]]
segment = "hand_r"
mass_kg = 2
[[load]]
segment = "ulna_r"
force_n = [3, -20, 1]
at_m = [0.01, -0.08, 0.02]
fixed_in = "segment"
[strategy]
kind = "passive"
minimum_decrease_ratio = 0.9
[relief]
step_gain = 0.3
max_step_deg = 2
torque_tolerance_nm = 0.05
tables = "total"
[fatigue]
law = "endurance"
curve = "rohmert_general"
critical_level = 0.6
recovery_level = 0.3
start = { elbow_flex_r = { positive = 0.7, negative = 0.1 }, arm_flex_r = { positive = 0.8 } }
[run]
duration_s = 2
step_s = 0.0333
stop_when_settled = false
"#;

/// Runs at most a second of it; every number of every sample must be finite, in memory and as written.
fn assert_sound(mut scenario: Scenario, told: &dyn Fn() -> String) {
    scenario.run.duration = scenario.run.duration.min(1.0);
    scenario.run.step = scenario.run.step.max(scenario.run.duration / 40.0);
    let columns = csv_header(&scenario.model).split(',').count();
    let mut row = String::new();
    let summary = run(&scenario, |sample: &Sample| {
        row.clear();
        csv_row(&scenario.model, sample, &mut row);
        assert_eq!(row.trim_end().split(',').count(), columns);
        for (at, cell) in row.trim_end().split(',').enumerate() {
            let number: f64 = if cell.is_empty() { 0.0 } else { cell.parse().unwrap() };
            assert!(number.is_finite(), "column {at}: {cell}\n{}", told());
        }
        assert!(sample.load.iter().all(|load| load.is_finite()), "load\n{}", told());
        for (&value, coordinate) in sample.posture.iter().zip(scenario.model.coordinates()) {
            assert!(value >= coordinate.range.0 && value <= coordinate.range.1, "{}\n{}", coordinate.name, told());
        }
        for (&level, torques) in sample.fatigue.iter().flatten().zip(sample.active.iter().flat_map(|t| [t, t])) {
            assert!((0.0..=1.0).contains(&level) && torques.is_finite(), "fatigue {level}\n{}", told());
        }
    });
    let summary = summary.unwrap_or_else(|error| panic!("{error}\n{}", told()));
    assert!(summary.end_time.is_finite() && summary.samples > 0);
}

/// Complaints are printed, too: that must not panic either.
fn complaint(error: contrapposto_formats::InputError) -> String {
    let mut text = String::new();
    miette::NarratableReportHandler::new().render_report(&mut text, &error).unwrap();
    text
}

#[test]
fn mutated_scenarios_never_panic() {
    hammer_toml("scenario", 20_070_902, 20_000, &corpus(), |bytes| {
        let told = || String::from_utf8_lossy(bytes).into_owned();
        match read_scenario("mutant.toml", bytes, None) {
            Ok(scenario) => {
                assert_sound(scenario, &told);
                true
            }
            Err(error) => {
                let text = complaint(error);
                assert!(text.contains("mutant.toml"), "no place: {text}\n{}", told());
                assert!(!text.contains('\u{1b}'), "{text:?}");
                false
            }
        }
    });
}

/// NaN, infinities, the ends of the doubles, negative zero and a subnormal in each number in turn.
#[test]
fn odd_numbers_in_every_field() {
    let full = corpus().pop().unwrap();
    let places = numbers(full.as_bytes());
    assert_eq!(places.len(), 47, "numbers of the full scenario");
    let (mut accepted, mut refused) = (0, 0);
    for &(from, to) in &places {
        for odd in ODD {
            let text = format!("{}{odd}{}", &full[..from], &full[to..]);
            let told = || format!("{odd} for {} in\n{text}", &full[from..to]);
            match read_scenario("odd.toml", text.as_bytes(), None) {
                Ok(scenario) => {
                    let finite = odd.parse::<f64>().map_or(true, f64::is_finite);
                    assert!(finite, "accepted {}", told());
                    accepted += 1;
                    assert_sound(scenario, &told);
                }
                Err(error) => {
                    let text = complaint(error);
                    let line = full[..from].matches('\n').count() + 1;
                    let near = text.contains(&format!("line {line}, column"))
                        || !matches!(odd, "nan" | "inf" | "-inf" | "1e999");
                    assert!(near, "points elsewhere: {text}\n{}", told());
                    refused += 1;
                }
            }
        }
    }
    println!("{} fields x {} values: {accepted} accepted and run, {refused} refused", places.len(), ODD.len());
}

#[test]
fn the_full_scenario_is_read() {
    for text in corpus() {
        let scenario =
            read_scenario("corpus.toml", text.as_bytes(), None).unwrap_or_else(|error| panic!("{}", complaint(error)));
        assert_sound(scenario, &|| text.clone());
        // Line ends and a byte order mark are the editor's business.
        read_scenario("crlf.toml", text.replace('\n', "\r\n").as_bytes(), None).unwrap();
        read_scenario("bom.toml", format!("\u{feff}{text}").as_bytes(), None).unwrap();
    }
}

/// Every prefix of a file is a value or a complaint.
#[test]
fn truncated_scenarios_never_panic() {
    let full = corpus().pop().unwrap();
    for end in 0..full.len() {
        if let Err(error) = read_scenario("cut.toml", &full.as_bytes()[..end], None) {
            assert!(complaint(error).contains("cut.toml"));
        }
    }
}
