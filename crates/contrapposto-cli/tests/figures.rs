//! `contrapposto figures`: the published elbow cases replayed, each with the printed cases in the printed order, as pictures
//! and as JSON; "as printed" is claimed only where the path also has the kink that the text names; the same bytes every time.

use crate::support;

use std::path::{Path, PathBuf};

use contrapposto::passive::PassiveCurve;
use contrapposto_formats::read_scenario;
use serde_json::{Value, json};
use support::{contents, contrapposto, results};

/// Largest difference of an angle from the one on record, deg.
const NEAR_DEG: f64 = 0.3;

fn figures(out: &Path, arguments: &[&str]) -> Vec<Value> {
    let run = contrapposto(["figures", "--json", "--out"]).arg(out).args(arguments).run();
    assert_eq!((run.code, run.notes().as_str()), (0, ""));
    println!("figures {arguments:?}: {:.2} s", run.seconds);
    serde_json::from_str(&run.stdout).unwrap()
}

fn figure(figures: &[Value], number: u64) -> &Value {
    figures.iter().find(|figure| figure["figure"] == number).unwrap()
}

/// `(strategy, R_min, cases, final angle in deg)` of every run of a figure.
fn runs(figure: &Value) -> Vec<(String, f64, Vec<String>, f64)> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let run = |run: &Value| {
        let cases = run["cases"].as_array().unwrap().iter().map(text).collect();
        let ratio = run["minimum_decrease_ratio"].as_f64().unwrap();
        (text(&run["strategy"]), ratio, cases, run["final_deg"].as_f64().unwrap())
    };
    figure["runs"].as_array().unwrap().iter().map(run).collect()
}

fn assert_ends(figure: &Value, wanted: f64) {
    for (strategy, ratio, _, end) in runs(figure) {
        assert!((end - wanted).abs() <= NEAR_DEG, "{strategy} {ratio}: {end} deg, not {wanted}");
    }
}

#[test]
fn cases_come_as_printed() {
    let out = tempfile::tempdir().unwrap();
    let all = figures(out.path(), &[]);
    let numbers: Vec<&Value> = all.iter().map(|figure| &figure["figure"]).collect();
    assert_eq!(json!(numbers), json!([1, 7, 8, 9, 10, 11, 12, 13, 14]));

    for (number, count, cases, end) in [
        (7, 2, &["3.2", "2.1"][..], 4.7),
        (8, 1, &["3.1", "3.3", "2.1"], 93.5),
        (9, 1, &["3.4", "2.3"], 122.8),
        (14, 1, &["3.3", "2.1"], 103.1),
    ] {
        let figure = figure(&all, number);
        assert_eq!(runs(figure).len(), count, "figure {number}");
        for (strategy, ratio, found, _) in runs(figure) {
            assert_eq!(found, cases, "figure {number}, {strategy}, R_min {ratio}");
        }
        assert_ends(figure, end);
    }
    // 1.2 may stand between (docs/deviations.md, D13).
    for (number, count, end) in [(11, 4, 5.1), (13, 2, 4.9)] {
        let figure = figure(&all, number);
        assert_eq!(runs(figure).len(), count, "figure {number}");
        for (strategy, ratio, found, _) in runs(figure) {
            let ends = (found.first().unwrap().as_str(), found.last().unwrap().as_str());
            assert_eq!(ends, ("3.2", "1.1"), "figure {number}, {strategy}, R_min {ratio}");
            assert!(found[1..found.len() - 1].iter().all(|case| case == "1.2"), "{found:?}");
        }
        assert_ends(figure, end);
    }
    for (number, count) in [(1, 3), (10, 1)] {
        let figure = figure(&all, number);
        assert_eq!(figure["zero_torque_deg"].as_array().unwrap().len(), count, "figure {number}");
        assert!(runs(figure).is_empty());
    }
    // Every run ends within the tolerance of its scenario, 0.05 N m.
    for run in all.iter().flat_map(|figure| figure["runs"].as_array().unwrap()) {
        assert!(run["final_active_nm"].as_f64().unwrap().abs() <= 0.05, "{run}");
        let total: u64 = run["iterations"].as_object().unwrap().values().map(|n| n.as_u64().unwrap()).sum();
        assert!(total > 1, "{run}");
    }
}

#[test]
fn pictures_are_whole() {
    let out = tempfile::tempdir().unwrap();
    let all = figures(out.path(), &[]);
    let named: Vec<&str> =
        all.iter().flat_map(|figure| figure["files"].as_array().unwrap()).map(|name| name.as_str().unwrap()).collect();
    let files = results(out.path());
    assert_eq!(files.len(), 18, "nine figures, two files each, nothing else");
    for (name, bytes) in &files {
        assert!(named.contains(&name.as_str()), "{name}");
        if name.ends_with(".svg") {
            support::assert_svg(bytes);
        } else {
            support::assert_png(bytes);
        }
    }
}

#[test]
fn the_same_bytes_every_time() {
    let (first, second) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let jsons = [&first, &second].map(|out| figures(out.path(), &[]));
    assert_eq!(jsons[0], jsons[1]);
    for (one, other) in contents(first.path()).iter().zip(&contents(second.path())) {
        assert!(one == other, "{} differs", one.0);
    }
}

#[test]
fn only_some() {
    let out = tempfile::tempdir().unwrap();
    let some = figures(out.path(), &["--only", "8,7"]);
    let numbers: Vec<&Value> = some.iter().map(|figure| &figure["figure"]).collect();
    assert_eq!(json!(numbers), json!([7, 8]));
    let names: Vec<String> = results(out.path()).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["figure-07.png", "figure-07.svg", "figure-08.png", "figure-08.svg"]);
}

#[test]
fn figures_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    for (only, part) in [("3", "3"), ("7,3", "3"), ("seven", "seven"), ("300", "300"), ("-1", "-1"), ("", "")] {
        let run = contrapposto(["figures", "--json", "--out"]).arg(&out).arg(format!("--only={only}")).run();
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "--only {only}");
        assert!(run.stderr.contains("--only") && run.stderr.contains(part), "{}", run.stderr);
        assert!(!out.exists(), "nothing is written, --only {only}");
    }
    let run = contrapposto(["figures", "--only", "3", "--out"]).arg(&out).run();
    assert!(run.stderr.contains("1, 7, 8, 9, 10, 11, 12, 13, 14"), "{}", run.stderr);
}

/// With the measured mid-range stiffness of 0.4 N m/rad the printed cases no longer all come: the paper's drawings have none.
#[test]
fn the_measured_curve_changes_cases() {
    let out = tempfile::tempdir().unwrap();
    let all = figures(out.path(), &["--curve", "measured"]);
    let mut found = vec![];
    for number in [7, 8, 9, 11, 13, 14] {
        for (strategy, ratio, cases, end) in runs(figure(&all, number)) {
            println!("figure {number} {strategy} {ratio}: {cases:?}, {end:.1} deg");
            found.push((number, cases.join(" ")));
        }
    }
    for number in [1, 10, 12] {
        println!("figure {number}: {}", figure(&all, number)["zero_torque_deg"]);
    }
    assert_eq!(json!(found), json!(MEASURED));
}

/// Found with `elbow_flexion`: cases by figure and run.
const MEASURED: [(u64, &str); 11] = [
    (7, "3.2 1.2 1.1"),
    (7, "3.2 1.2 1.1"),
    (8, "3.1 3.3 2.1"),
    (9, "2.3"),
    (11, "3.2 1.2 1.1"),
    (11, "3.2 1.2 1.1"),
    (11, "3.2 1.2 1.1"),
    (11, "3.2 1.2 1.1"),
    (13, "3.2 1.2 1.1"),
    (13, "3.2 1.2 1.1"),
    (14, "3.2 1.2 1.1"),
];

/// The figures of the paper that show a run: the printed cases, and whether section 4.1 names a kink.
const PRINTED: [(u64, &str, bool); 6] = [
    (7, "3.2 2.1", true),
    (8, "3.1 3.3 2.1", false),
    (9, "3.4 2.3", true),
    (11, "3.2 1.1", false),
    (13, "3.2 1.1", false),
    (14, "3.3 2.1", false),
];

fn scenario_path(number: u64) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenarios/figure-{number:02}.toml"))
}

/// The elbow's curve in the scenario of a figure.
fn elbow_curve(number: u64) -> PassiveCurve {
    let text = std::fs::read(scenario_path(number)).unwrap();
    let scenario = read_scenario("figure", &text, None).unwrap();
    let elbow = scenario.model.coordinate("elbow_flex_r").unwrap();
    scenario.model.coordinates()[elbow].curve().unwrap().clone()
}

/// Whether the slope of the torque jumps by more than 1 N m/rad between two angles (deg), by second differences: the smooth
/// curve's slope changes by less than 0.1 N m/rad over one step, 0.001 deg.
fn slope_jumps(curve: &PassiveCurve, from: f64, to: f64) -> bool {
    let step = 0.001f64.to_radians();
    let torque = |i: f64| curve.torque(from.min(to).to_radians() + i * step);
    let steps = ((to - from).abs() / 0.001) as u32;
    let bend = |i: f64| (torque(i + 1.0) - 2.0 * torque(i) + torque(i - 1.0)) / step;
    (1..steps).any(|i| bend(f64::from(i)).abs() > 1.0)
}

#[test]
fn as_printed_needs_the_printed_cases_and_the_named_kink() {
    let out = tempfile::tempdir().unwrap();
    for (curve, claimed) in [("neutral", vec![7, 8, 14]), ("measured", vec![8])] {
        let all = figures(out.path(), &["--curve", curve]);
        let mut as_printed = vec![];
        for (number, cases, named) in PRINTED {
            for run in figure(&all, number)["runs"].as_array().unwrap() {
                let [start, end] = ["start_deg", "final_deg"].map(|key| run[key].as_f64().unwrap());
                // Both curves have the same linear terms.
                let jumps = slope_jumps(&elbow_curve(number), start, end);
                assert_eq!(run["kink_deg"].is_number(), jumps, "figure {number}: {run}");
                let found: Vec<&str> = run["cases"].as_array().unwrap().iter().map(|c| c.as_str().unwrap()).collect();
                let claim = found.join(" ") == cases && jumps == named;
                assert_eq!(run["as_printed"], json!(claim), "figure {number}: {run}");
                assert_eq!(run["differences"].as_array().unwrap().is_empty(), claim, "figure {number}: {run}");
                if claim && !as_printed.contains(&number) {
                    as_printed.push(number);
                }
            }
        }
        assert_eq!(as_printed, claimed, "{curve}");
    }
}

#[test]
fn a_curve_without_reshaping_has_no_kink() {
    let curve = elbow_curve(7);
    assert!(slope_jumps(&curve, 20.0, 4.7));
    let plain = PassiveCurve::new(curve.form().clone(), curve.range(), None).unwrap();
    assert!(!slope_jumps(&plain, 0.0, 150.0));
}

/// The zone that would give Figure 9 its kink (docs/deviations.md, D14).
#[test]
fn a_zone_of_30_deg_reaches_the_end_of_figure_9_but_changes_the_cases_of_figure_13() {
    let folder = tempfile::tempdir().unwrap();
    let wide = |number: u64| {
        let text = std::fs::read_to_string(scenario_path(number)).unwrap();
        assert!(text.contains("reshape = true"));
        let file = folder.path().join("wide.toml");
        let text = text.replace("reshape = true", "reshape = { zone_deg = 30, end_torque_nm = 20 }");
        std::fs::write(&file, text).unwrap();
        let run = contrapposto(["simulate", "--json", "--out"]).arg(folder.path().join("out")).arg(&file).run();
        assert_eq!((run.code, run.notes().as_str()), (0, ""));
        let summary: Value = serde_json::from_str(&run.stdout).unwrap();
        let elbow = &summary["coordinates"]["elbow_flex_r"];
        (elbow["cases"].clone(), elbow["final_deg"].as_f64().unwrap())
    };
    let (cases, end) = wide(9);
    assert_eq!(cases, json!(["3.4", "2.3"]));
    assert!(120.0 < end && end < 121.0, "{end}");
    let (cases, end) = wide(13);
    assert_eq!(cases, json!(["3.2", "2.1"]));
    assert!(19.0 < end && end < 21.0, "{end}");
}

#[test]
fn the_table_says_how_cases_compare() {
    let out = tempfile::tempdir().unwrap();
    let run = contrapposto(["figures", "--out"]).arg(out.path()).run();
    assert_eq!((run.code, run.notes().as_str()), (0, ""));
    for number in ["1", "7", "8", "9", "10", "11", "12", "13", "14"] {
        let shown = run.stdout.lines().any(|line| line.split_whitespace().next() == Some(number));
        assert!(shown, "figure {number} is missing:\n{}", run.stdout);
    }
    for (number, verdict) in [
        ("7", "yes"),
        ("8", "yes"),
        ("9", "no: no kink (D14)"),
        ("11", "no: case 1.2 between (D13)"),
        ("13", "no: case 1.2 between (D13), a kink that the text does not name (D14)"),
        ("14", "yes"),
    ] {
        let rows = run.stdout.lines().filter(|line| line.split_whitespace().next() == Some(number));
        let wrong: Vec<&str> = rows.filter(|row| !row.trim_end().ends_with(verdict)).collect();
        assert!(wrong.is_empty(), "{verdict}: {wrong:?}");
    }
    assert!(run.stdout.contains("three postures") && run.stdout.contains("one posture"), "{}", run.stdout);
}
