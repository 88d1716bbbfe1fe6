//! `contrapposto simulate` and `demo`: every scenario of the repository runs to whole, finite, balanced and repeatable files.

use crate::support;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use serde_json::Value;
use support::{Run, assert_numbers, contents, contrapposto, results, scenarios};

/// Files that a run of one joint writes, in order of names.
const FILES: [&str; 14] = [
    "decisions.csv",
    "fatigue.sto",
    "model.osim",
    "motion.bvh",
    "motion.glb",
    "motion.mot",
    "report.html",
    "summary.json",
    "time-line.png",
    "time-line.svg",
    "torque-balance.png",
    "torque-balance.svg",
    "torques.sto",
    "trajectory.csv",
];

/// Files that a run of a body on its supports writes.
const FILES_OF_A_BODY: [&str; 15] = [
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
    "torques.sto",
    "trajectory.csv",
];

/// Columns of a coordinate after its name: a rotation, or a slide.
const ROTATION: [&str; 8] =
    ["angle_deg", "external_nm", "passive_nm", "active_nm", "fatigue_positive", "fatigue_negative", "case", "goal_deg"];
const SLIDE: [&str; 8] =
    ["position_m", "external_n", "passive_n", "active_n", "fatigue_positive", "fatigue_negative", "case", "goal_m"];

fn columns(coordinate: &str) -> [&'static str; 8] {
    if coordinate.starts_with("pelvis_t") && coordinate != "pelvis_tilt" || coordinate.starts_with("shoulder_rise") {
        SLIDE
    } else {
        ROTATION
    }
}

/// Ends the trials of changes of a job early.
const FEW_TRIALS: [&str; 2] = ["--suggest-steps", "20000"];

/// Every scenario of the repository that runs over time; poses have a folder of their own.
fn paths() -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(scenarios()).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.is_file());
    paths.sort();
    assert!(paths.len() >= 10);
    paths
}

fn simulate(scenario: &Path, out: &Path, arguments: &[&str]) -> Run {
    contrapposto(["simulate"]).arg(scenario).arg("--out").arg(out).args(arguments).run()
}

/// Tables of scenarios whose body stands or sits.
const CARRIED: [&str; 8] =
    ["[[support]]", "[[box]]", "[[tool]]", "[[handle]]", "[seat]", "[[table]]", "[[counter]]", "[floor]"];

/// The text of a scenario, bodies on their supports for ten seconds only.
fn shortened(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let stands = CARRIED.iter().any(|table| text.contains(table));
    let Some((head, tail)) = text.split_once("duration_s").filter(|_| stands) else {
        return text;
    };
    let rest = tail.split_once('\n').map_or("", |(_, rest)| rest);
    format!("{head}duration_s = 10\n{rest}")
}

/// As [`simulate`], of what is [`shortened`], on standard input, with few trials of changes.
fn simulate_shortened(path: &Path, out: &Path) -> Run {
    let call = contrapposto(["simulate", "-", "--json", "--out"]).arg(out).args(FEW_TRIALS).stdin(shortened(path));
    call.folder(path.parent().unwrap()).run()
}

/// Runs a scenario text; gives the summary and the table.
fn simulate_text(text: &str) -> (Value, Table) {
    let folder = tempfile::tempdir().unwrap();
    let run = contrapposto(["simulate", "-", "--json", "--out"]).arg(folder.path()).stdin(text).run();
    assert_eq!((run.code, run.notes().as_str()), (0, ""));
    (serde_json::from_str(&run.stdout).unwrap(), Table::read(&folder.path().join("trajectory.csv")))
}

/// `trajectory.csv`.
struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        assert!(text.ends_with('\n') && !text.contains('\r') && !text.contains('"'));
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
        let header = lines.next().unwrap();
        let rows: Vec<_> = lines.collect();
        assert!(rows.iter().all(|row| row.len() == header.len()), "{}", path.display());
        Self { header, rows }
    }

    fn of_sto(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let lines = text.lines().skip_while(|line| !line.starts_with("time"));
        let mut lines = lines.map(|line| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>());
        Self { header: lines.next().unwrap(), rows: lines.collect() }
    }

    fn column(&self, name: &str) -> impl Iterator<Item = &str> + use<'_> {
        let at = self.header.iter().position(|column| column == name).unwrap_or_else(|| panic!("no column {name}"));
        self.rows.iter().map(move |row| row[at].as_str())
    }

    fn numbers(&self, name: &str) -> Vec<f64> {
        self.column(name).map(|cell| cell.parse().unwrap()).collect()
    }
}

/// Columns as promised, finite numbers, torques that add up to zero, angles inside their ranges, a steady clock.
fn assert_table(table: &Table, summary: &Value) {
    let order: Vec<&str> =
        summary["coordinate_order"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let mut wanted = vec!["time".to_owned()];
    wanted.extend(order.iter().flat_map(|name| columns(name).map(|column| format!("{name}.{column}"))));
    assert_eq!(table.header, wanted);
    assert_eq!(table.rows.len() as u64, summary["samples"].as_u64().unwrap());
    let times = table.numbers("time");
    assert_eq!(times[0], 0.0);
    assert!(times.windows(2).all(|pair| pair[1] > pair[0]));
    assert!(same(*times.last().unwrap(), summary["end_s"].as_f64().unwrap()));
    let cases = ["1.1", "1.2", "1.3", "2.1", "2.2", "2.3", "3.1", "3.2", "3.3", "3.4"];
    for name in order {
        let column = |column: &str| table.numbers(&format!("{name}.{column}"));
        let keys = columns(name);
        let [angle, external, passive, active, positive, negative] = std::array::from_fn(|i| column(keys[i]));
        let (min, max) = range_deg(name);
        for i in 0..times.len() {
            let numbers = [angle[i], external[i], passive[i], active[i], positive[i], negative[i]];
            assert!(numbers.iter().all(|number| number.is_finite()), "{name} {numbers:?}");
            assert_eq!(external[i] + passive[i] + active[i], 0.0, "{name}, row {i}");
            assert!(angle[i] >= min - 1e-9 && angle[i] <= max + 1e-9, "{name} at {}", angle[i]);
            assert!((0.0..=1.0).contains(&positive[i]) && (0.0..=1.0).contains(&negative[i]), "{name}, row {i}");
        }
        let decisions = table.column(&format!("{name}.case")).zip(table.column(&format!("{name}.{}", keys[7])));
        for (case, goal) in decisions {
            assert!(case.is_empty() || cases.contains(&case), "{case}");
            assert!(!case.is_empty() || goal.is_empty());
            if let Ok(goal) = goal.parse::<f64>() {
                assert!(goal >= min - 1e-9 && goal <= max + 1e-9, "{name} wants {goal}");
            } else {
                assert_eq!(goal, "");
            }
        }
        let last = &summary["coordinates"][name];
        for (key, column) in
            [("deg", &angle), ("external_nm", &external), ("passive_nm", &passive), ("active_nm", &active)]
        {
            let (said, shown) = (last[format!("final_{key}")].as_f64().unwrap(), *column.last().unwrap());
            assert!(same(said, shown), "{name} {key}: {said} and {shown}");
        }
    }
}

/// Equal but for the last digit, which serde_json may read differently.
fn same(one: f64, other: f64) -> bool {
    (one - other).abs() <= 4.0 * f64::EPSILON * one.abs()
}

/// The ranges of the adult, as the data file says them.
fn range_deg(name: &str) -> (f64, f64) {
    match name {
        "arm_flex_r" => (-60.0, 180.0),
        "arm_add_r" => (-180.0, 10.0),
        "arm_rot_r" => (-90.0, 70.0),
        "elbow_flex_r" => (0.0, 150.0),
        "pro_sup_r" => (-80.0, 80.0),
        "wrist_flex_r" => (-70.0, 80.0),
        "wrist_dev_r" => (-20.0, 30.0),
        _ => (-360.0, 360.0),
    }
}

/// Nothing is left on the root of a body on its supports: 1e-8 of the lightest one's weight, and of that times 1 m.
fn assert_root_is_held(table: &Table, path: &Path) {
    for slide in ["pelvis_tx", "pelvis_ty", "pelvis_tz"] {
        let worst =
            table.numbers(&format!("{slide}.external_n")).into_iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        assert!(worst < 5e-6, "{}: {slide} {worst} N", path.display());
    }
    for hinge in ["pelvis_tilt", "pelvis_list", "pelvis_rotation"] {
        let worst =
            table.numbers(&format!("{hinge}.external_nm")).into_iter().fold(0.0, |most: f64, m| most.max(m.abs()));
        assert!(worst < 5e-6, "{}: {hinge} {worst} N m", path.display());
    }
}

#[test]
fn every_scenario_runs_and_gives_the_same_bytes_again() {
    for path in paths() {
        let folder = tempfile::tempdir().unwrap();
        let run = simulate_shortened(&path, folder.path());
        let expected = |line: &str| ["note: ", "progress: "].iter().any(|start| line.starts_with(start));
        let silent = run.stderr.lines().all(expected);
        assert!(run.code == 0 && silent, "{}: {}", path.display(), run.stderr);
        let files = results(folder.path());
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        let expected = if names.contains(&"postures.svg") { &FILES_OF_A_BODY[..] } else { &FILES };
        assert_eq!(names, expected, "{}", path.display());
        let at = names.iter().position(|name| *name == "summary.json").unwrap();
        assert_eq!(files[at].1, run.stdout.as_bytes(), "--json prints summary.json");
        let summary: Value = serde_json::from_str(&run.stdout).unwrap();
        assert_numbers(&summary, "");
        let mut named: Vec<&str> =
            summary["files"].as_array().unwrap().iter().map(|file| file.as_str().unwrap()).collect();
        named.sort_unstable();
        assert_eq!(named, expected);
        let table = Table::read(&folder.path().join("trajectory.csv"));
        assert_table(&table, &summary);
        if expected == FILES_OF_A_BODY {
            assert_root_is_held(&table, &path);
        }
        for (name, bytes) in &files {
            match name.rsplit_once('.').unwrap().1 {
                "svg" => support::assert_svg(bytes),
                "png" => support::assert_png(bytes),
                _ => {}
            }
        }
        // A file is as good as standard input, and old results are replaced.
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("scenario.toml");
        std::fs::write(&file, shortened(&path)).unwrap();
        std::fs::create_dir(place.path().join("models")).unwrap();
        for model in std::fs::read_dir(scenarios().join("models")).unwrap() {
            let model = model.unwrap();
            std::fs::copy(model.path(), place.path().join("models").join(model.file_name())).unwrap();
        }
        let before = contents(folder.path());
        let again = simulate(&file, folder.path(), &[&["--json"], &FEW_TRIALS[..]].concat());
        assert!((again.code, &again.stdout) == (0, &run.stdout), "{}", path.display());
        assert!(contents(folder.path()) == before, "{}", path.display());
    }
}

#[test]
fn without_a_report_the_answer_is_the_same_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let (with, without) = (folder.path().join("with"), folder.path().join("without"));
    std::fs::create_dir(&without).unwrap();
    let scenario = shortened(&scenarios().join("hold-tool.toml"));
    let json = |arguments: &[&str]| {
        let run = contrapposto(["simulate", "-", "--json"]).args(arguments).stdin(&scenario).folder(&without).run();
        let mut summary: Value = serde_json::from_str(&run.stdout).unwrap();
        let files = summary["files"].take();
        (summary, files.as_array().unwrap().len(), run.code)
    };
    let (report, files, code) = json(&["--out", with.to_str().unwrap()]);
    assert_eq!(files, FILES_OF_A_BODY.len());
    assert_eq!(json(&["--no-report"]), (report.clone(), 0, code));
    assert_eq!(json(&[]), (report, 0, code));
    assert_eq!(std::fs::read_dir(&without).unwrap().count(), 0);
    for other in ["--resume", "--figures", "--out=x"] {
        let run = contrapposto(["simulate", "-", "--no-report", other]).stdin(&scenario).run();
        assert_eq!(run.code, 2, "{other}");
    }
    for command in ["pose", "relax"] {
        let run = contrapposto([command, "-", "--no-report", "--figures"]).stdin(&scenario).run();
        assert_eq!(run.code, 2, "{command}");
    }
    for folder_needed in ["--resume", "--figures"] {
        let run = contrapposto(["simulate", "-", folder_needed]).stdin(&scenario).run();
        assert!(run.code == 2 && run.notes().contains("--out <DIR>"), "{}", run.notes());
    }
}

#[test]
fn the_demo_is_figure_8() {
    let [demo, figure] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let run = contrapposto(["demo", "--figure-8", "--out"]).arg(demo.path()).run();
    assert_eq!((run.code, run.notes().as_str()), (0, ""));
    assert!(run.stdout.contains("elbow_flex_r") && run.stdout.contains("3.1"), "{}", run.stdout);
    assert_eq!(simulate(&scenarios().join("figure-08.toml"), figure.path(), &[]).code, 0);
    assert!(contents(demo.path()) == contents(figure.path()));
}

/// All of the body, nothing named: what can be relieved is free, the rest held; slides are in metres and newtons.
#[test]
fn the_whole_body_runs() {
    let text = "format = 1\n[posture]\npelvis_ty_m = 0.9\nlumbar_extension_deg = -40\n[strategy]\nkind = \"passive\"\n\
        [[load]]\nsegment = \"hand_r\"\nmass_kg = 6\n[fatigue]\ncritical_level = 0.05\nrecovery_level = 0.01\n\
        [run]\nduration_s = 10\nstep_s = 0.1\n";
    let (summary, table) = simulate_text(text);
    assert_table(&table, &summary);
    assert_numbers(&summary, "");
    let coordinates = summary["coordinates"].as_object().unwrap();
    println!("{} coordinates, {} rows", coordinates.len(), table.rows.len());
    assert!(coordinates.len() > 30);
    assert_eq!(summary["coordinates"]["pelvis_ty"]["final_deg"], 0.9, "a slide is in metres");
    assert_eq!(summary["coordinates"]["pelvis_ty"]["free"], false);
    assert_eq!(summary["coordinates"]["elbow_flex_r"]["free"], true);
    let folder = tempfile::tempdir().unwrap();
    let run = contrapposto(["simulate", "-", "--out"]).arg(folder.path()).stdin(text).run();
    assert!(run.stdout.starts_with("Can be held for all of the 10\u{a0}s asked"), "{}", run.stdout);
    assert!(run.stdout.contains(" coordinates with lower loads, which summary.json lists"), "{}", run.stdout);
}

#[test]
fn the_demo_is_a_person_who_waits_and_says_where_to_look_next() {
    let folder = tempfile::tempdir().unwrap();
    let run = contrapposto(["demo", "--out"]).arg(folder.path()).run();
    assert_eq!((run.code, run.notes().as_str()), (0, ""));
    let first = run.stdout.lines().next().unwrap();
    let summary: Value = serde_json::from_slice(&std::fs::read(folder.path().join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["verdict"]["sentence"], first);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains(&serde_json::to_string(first).unwrap().trim_matches('"').to_owned()));
    assert!(run.stdout.contains("report.html in a browser") && run.stdout.contains("contrapposto new lift"));
}

fn case_changes(text: &str) -> (u64, Vec<String>) {
    let (summary, table) = simulate_text(text);
    let changes = summary["coordinates"]["elbow_flex_r"]["case_changes"].as_u64().unwrap();
    let mut cases: Vec<String> = table.column("elbow_flex_r.case").map(str::to_owned).collect();
    cases.dedup();
    (changes, cases)
}

#[test]
fn chatter_is_literal_only() {
    let text = std::fs::read_to_string(scenarios().join("chatter.toml")).unwrap();
    let (changes, cases) = case_changes(&text);
    println!("literal: {changes} changes");
    assert!(changes >= 50, "{changes} changes");
    let alternating = cases.windows(2).filter(|pair| pair == &["3.1", "3.2"] || pair == &["3.2", "3.1"]).count();
    assert!(alternating >= 50, "{cases:?}");
    let total = text.replace("\"literal\"", "\"total\"");
    assert_ne!(total, text);
    let (changes, cases) = case_changes(&total);
    println!("total: {changes} changes, {cases:?}");
    assert!(changes <= 4, "{cases:?}");
    let (summary, _) = simulate_text(&total);
    assert_eq!(summary["stopped"], "settled");
}

const TIRED: &str = r#"format = 1
title = "A tired elbow"
[model]
adult = { sex = "male", stature_m = 1.741, mass_kg = 73, part = "right_arm" }
[posture]
arm_flex_r_deg = 0
elbow_flex_r_deg = 90
[coordinates]
free = ["elbow_flex_r"]
[strategy]
kind = "passive"
[fatigue]
start = { elbow_flex_r = { positive = 0.7 } }
[run]
duration_s = 600
step_s = 0.1
"#;

/// Relief brings fatigue down to the recovery level; there the constraint is released, and nothing is asked any more.
#[test]
fn a_recovered_group_asks_for_nothing() {
    let text = TIRED.replace("start =", "recovery_level = 0.5\nstart =");
    let (summary, table) = simulate_text(&text);
    let levels = table.numbers("elbow_flex_r.fatigue_positive");
    let cases: Vec<&str> = table.column("elbow_flex_r.case").collect();
    assert_ne!(cases[0], "", "0.7 is above the critical level of 0.6: relief from the start");
    let release = cases.iter().position(|case| case.is_empty()).expect("a release within 600 s");
    println!("released at {} s, fatigue {}", table.numbers("time")[release], levels[release]);
    assert!(levels[release] <= 0.5 && levels[release - 1] > 0.5, "{} then {}", levels[release - 1], levels[release]);
    assert!(cases[release..].iter().all(|case| case.is_empty()), "asked again");
    let angles = table.numbers("elbow_flex_r.angle_deg");
    assert!(angles[release + 1..].iter().all(|&angle| angle == angles[release + 1]), "moved without being asked");
    assert_eq!(summary["coordinates"]["elbow_flex_r"]["positive"]["peak_fatigue"], 0.7);
}

#[test]
fn a_rested_group_asks_when_it_is_tired() {
    let text = TIRED
        .replace("start = { elbow_flex_r = { positive = 0.7 } }", "critical_level = 0.2\nrecovery_level = 0.1")
        .replace("[run]", "[[load]]\nsegment = \"hand_r\"\nmass_kg = 8\n[run]");
    let (_, table) = simulate_text(&text);
    let levels = table.numbers("elbow_flex_r.fatigue_positive");
    let cases: Vec<&str> = table.column("elbow_flex_r.case").collect();
    let first = cases.iter().position(|case| !case.is_empty()).expect("8 kg tire an elbow");
    println!("asked at {} s", table.numbers("time")[first]);
    assert!(first > 0 && levels[first] >= 0.2 && levels[first - 1] < 0.2);
}

#[test]
fn the_endurance_law_tires_by_its_curve() {
    let text = |law: &str| {
        TIRED
            .replace("start = { elbow_flex_r = { positive = 0.7 } }", law)
            .replace("[run]", "[[load]]\nsegment = \"hand_r\"\nmass_kg = 5\n[run]")
            .replace("600", "60")
    };
    let finals: Vec<f64> = ["law = \"endurance\"", "law = \"endurance\"\ncurve = \"rohmert_general\"", ""]
        .iter()
        .map(|law| {
            let levels = simulate_text(&text(law)).1.numbers("elbow_flex_r.fatigue_positive");
            assert!(levels.windows(2).all(|pair| pair[1] >= pair[0]), "a loaded group does not recover, {law}");
            *levels.last().unwrap()
        })
        .collect();
    println!("fatigue after 60 s at 5 kg: {finals:?}");
    assert!(finals.iter().all(|&level| level > 0.0) && finals[0] != finals[1] && finals[0] != finals[2]);
}

#[test]
fn loads_pull() {
    let external = |load: &str| {
        let text = TIRED.replace("[run]", &format!("{load}\n[run]")).replace("600", "0");
        let (summary, table) = simulate_text(&text);
        assert_eq!(summary["samples"], 1, "a run of nothing is one sample");
        table.numbers("elbow_flex_r.external_nm")[0]
    };
    let bare = external("");
    let weight = external("[[load]]\nsegment = \"hand_r\"\nmass_kg = 2");
    let force = external("[[load]]\nsegment = \"hand_r\"\nforce_n = [0, -19.62, 0]");
    let up = external("[[load]]\nsegment = \"hand_r\"\nforce_n = [0, 19.62, 0]");
    let both = external("[[load]]\nsegment = \"hand_r\"\nmass_kg = 1\n[[load]]\nsegment = \"hand_r\"\nmass_kg = 1");
    println!("elbow: bare {bare:.3}, with 2 kg {weight:.3} N m");
    assert!(weight < bare && bare < 0.0, "weights extend the elbow");
    assert!((weight - both).abs() < 1e-12, "two of one are one of two");
    assert!((weight - force).abs() < 1e-9, "2 kg are 19.62 N: {weight} {force}");
    assert!((up + weight - 2.0 * bare).abs() < 1e-9, "a force up is a force down turned round");
}

/// Ten minutes at thirty steps a second: the table grows, memory does not.
#[test]
fn a_long_run_needs_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let text = TIRED.replace("step_s = 0.1", "");
    // 256 MiB of address space, the program and its libraries included; a run that kept its samples would need more later.
    let script = format!("ulimit -v 262144; exec '{}' simulate - --json --out out", env!("CARGO_BIN_EXE_contrapposto"));
    let scenario = folder.path().join("scenario.toml");
    std::fs::write(&scenario, text).unwrap();
    let start = Instant::now();
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
        .stdin(File::open(&scenario).unwrap())
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{error}");
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    println!("600 s, {} samples in {:.2} s", summary["samples"], start.elapsed().as_secs_f64());
    assert_eq!(summary["samples"], 18_001);
    assert_eq!(summary["end_s"], 600.0);
    assert_table(&Table::read(&folder.path().join("out/trajectory.csv")), &summary);
}

#[test]
fn a_reader_that_leaves_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [&["demo", "--figure-8", "--out"][..], &["demo", "--figure-8", "--json", "--out"]] {
        let mut child = contrapposto(arguments).arg(folder.path()).spawn();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(output.stderr.is_empty());
        assert_eq!(results(folder.path()).len(), FILES.len(), "the files are written all the same");
    }
    for arguments in [&["schema"][..], &["passive", "elbow_flex_r", "--json"], &["--help"]] {
        let mut child = contrapposto(arguments).spawn();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0), "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_under_standard_output_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let full = || File::options().write(true).open("/dev/full").unwrap();
    let example = r#"{"angle_deg": 1}"#;
    for arguments in [
        &["demo", "--figure-8", "--out", out][..],
        &["demo", "--figure-8", "--json", "--out", out],
        &["figures", "--only", "1", "--out", out],
        &["passive", "elbow_flex_r", "--json"],
        &["schema"],
        &["minimize"],
    ] {
        let run = contrapposto(arguments).stdin(example).stdout_to(full()).run();
        assert_eq!(run.code, 1, "{arguments:?}");
        assert!(run.stderr.contains("standard output: No space left on device"), "{arguments:?}: {}", run.stderr);
    }
}

/// Results are for everybody the user's mask allows, and for nobody else.
#[cfg(unix)]
#[test]
fn files_follow_the_mask_of_the_user() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    for (mask, mode) in [("022", 0o644), ("077", 0o600), ("002", 0o664)] {
        let out = folder.path().join(mask);
        let script = format!(
            "umask {mask}; exec '{}' demo --figure-8 --out '{}'",
            env!("CARGO_BIN_EXE_contrapposto"),
            out.display()
        );
        assert!(Command::new("sh").args(["-c", &script]).output().unwrap().status.success());
        for name in FILES {
            let found = out.join(name).metadata().unwrap().permissions().mode() & 0o777;
            assert_eq!(found, mode, "{name} under umask {mask}");
        }
    }
}

#[test]
fn no_colour_and_no_progress_where_none_is_wanted() {
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("bad.toml");
    std::fs::write(&bad, "format = 1\nstratgy = 3\n").unwrap();
    let out = folder.path().join("out");
    // A pipe is no terminal: no escape codes at all, with NO_COLOR or without.
    for no_color in ["1", ""] {
        for (path, code) in [(&bad, 2), (&scenarios().join("figure-08.toml"), 0)] {
            let run = contrapposto(["simulate", "--out"]).arg(&out).arg(path).env("NO_COLOR", no_color).run();
            assert_eq!(run.code, code);
            assert!(!(run.stdout + &run.stderr).contains('\u{1b}'));
        }
    }
    // On a terminal there is colour, unless NO_COLOR is set.
    let on_terminal = |no_color: &str| {
        let (program, bad, out) = (env!("CARGO_BIN_EXE_contrapposto"), bad.display(), out.display());
        let call = format!("{no_color} '{program}' simulate '{bad}' --out '{out}'");
        let output = Command::new("script").args(["-qec", &call, "/dev/null"]).env_remove("NO_COLOR").output();
        output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let Ok(coloured) = on_terminal("env TERM=xterm-256color") else {
        return println!("no `script` here: terminals are not tried");
    };
    let plain = on_terminal("env TERM=xterm-256color NO_COLOR=1").unwrap();
    assert!(coloured.contains("\u{1b}[") && coloured.contains("stratgy"), "{coloured:?}");
    assert!(!plain.contains("\u{1b}[3") && plain.contains("stratgy"), "{plain:?}");
}

/// A body that is pushed over ends the job, and every output says when and why; the samples before the fall are there.
#[test]
fn a_fall_ends_the_job_and_every_output_reports_it() {
    let folder = tempfile::tempdir().unwrap();
    let push = "[[event]]\nat_s = 1\nload = [{ segment = \"torso\", force_n = [300, 0, 0] }]\n";
    let text = shortened(&scenarios().join("stand-ready.toml")) + push;
    let run = contrapposto(["simulate", "-", "--json", "--out"]).arg(folder.path()).stdin(text.as_str()).run();
    assert_eq!(run.code, 1, "{}", run.stderr);
    let summary: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((&summary["stopped"], &summary["partial"]), (&Value::from("fell"), &Value::from(false)));
    assert_eq!(summary["fell"]["at_s"], 1.0);
    assert_eq!(summary["verdict"]["kind"], "cannot_stand");
    let words = summary["verdict"]["sentence"].as_str().unwrap();
    assert!(words.contains(" from 1.0\u{a0}s on; ") && words.contains(" m beyond the supports"), "{words}");
    assert_table(&Table::read(&folder.path().join("trajectory.csv")), &summary);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("the supports could no longer hold the body"));
    assert!(!folder.path().join("snapshot.json").exists());
    // A comparison says so, too.
    let fallen = folder.path().join("fallen.toml");
    std::fs::write(&fallen, text).unwrap();
    let out = folder.path().join("compared");
    let ready = scenarios().join("poses/reach-shelf.toml");
    let run = contrapposto(["compare"]).arg(&ready).arg(&fallen).arg("--out").arg(&out).run();
    assert!(run.code == 1 && run.stdout.contains("; B cannot stand.\n"), "{} {}", run.code, run.stdout);
}

/// Ground reaction and motion of a run, given to `torques`, give back its torques and leave nothing at the root.
#[test]
fn ground_reaction_and_motion_give_back_the_torques() {
    let folder = tempfile::tempdir().unwrap();
    let run = simulate_shortened(&scenarios().join("stand-relaxed.toml"), folder.path());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let (motion, reaction) = (folder.path().join("motion.mot"), folder.path().join("ground_reaction.mot"));
    let call = contrapposto(["torques", "adult:female,1.65m,60kg"]).arg(&motion).arg("--grf").arg(&reaction);
    let run = call.args(["--grf-on", "calcn_r,calcn_l", "--json"]).run();
    assert_eq!(run.code, 0, "{}", run.stderr);
    let frames: Value = serde_json::from_str(&run.stdout).unwrap();
    let table = Table::of_sto(&folder.path().join("torques.sto"));
    let frames = frames.as_array().unwrap();
    assert_eq!(frames.len(), table.rows.len());
    let mut worst = 0.0_f64;
    for (row, frame) in frames.iter().enumerate().step_by(20) {
        for (name, found) in frame["coordinates"].as_object().unwrap() {
            for part in ["external", "passive", "active"] {
                let expected = table.numbers(&format!("{name}_{part}"))[row];
                worst = worst.max((found[part].as_f64().unwrap() - expected).abs());
            }
        }
    }
    println!("{} frames, worst difference {worst:e} N m", frames.len());
    assert!(worst < 1e-9, "{worst}");
}

#[test]
fn every_verb_has_help_with_an_example() {
    for verb in ["simulate", "demo", "figures", "minimize", "passive", "schema"] {
        let run = contrapposto([verb, "--help"]).run();
        assert_eq!((run.code, run.notes().as_str()), (0, ""));
        assert!(
            run.stdout.contains("Example") && run.stdout.contains(&format!("contrapposto {verb}")),
            "{}",
            run.stdout
        );
    }
    for arguments in [&[][..], &["simulat"], &["simulate"], &["demo", "--ouput", "x"], &["figures"], &["passive"]] {
        let run = contrapposto(arguments).run();
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments:?}");
        assert!(run.stderr.contains("Usage"), "{}", run.stderr);
    }
    let run = contrapposto(["passive", "elbow_flx_r", "--json"]).run();
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("did you mean `elbow_flex_r`?"), "{}", run.stderr);
}

/// The schema names every key of every scenario here.
#[test]
fn the_schema_is_one() {
    let run = contrapposto(["schema"]).run();
    let schema: Value = serde_json::from_str(&run.stdout).unwrap();
    for path in paths() {
        let text = std::fs::read_to_string(path).unwrap();
        for table in text.lines().filter_map(|line| line.strip_prefix('[')?.split(']').next()) {
            let key = table.trim_start_matches('[');
            assert!(schema["properties"][key].is_object(), "{key}");
        }
    }
    assert_eq!(schema["additionalProperties"], false);
}

/// A weight held out by an arm, until the shoulder fails.
const HELD_OUT: &str = "format = 1\ntitle = \"Held out\"\n\
    [model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 75, part = \"right_arm\" }\n\
    [posture]\narm_flex_r_deg = 40\nelbow_flex_r_deg = 60\n[[load]]\nsegment = \"hand_r\"\nmass_kg = 5\n\
    [[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.45, 1.2, 0.2]\nabove_relief = true\n\
    [[task]]\nkind = \"effort\"\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 300\nstep_s = 0.1\n";

#[test]
fn a_job_that_is_held_for_a_time_says_who_fails_first_and_what_helps_most() {
    let folder = tempfile::tempdir().unwrap();
    let run = contrapposto(["simulate", "-", "--out"]).arg(folder.path()).stdin(HELD_OUT).run();
    assert_eq!(run.code, 0, "{}", run.stderr);
    let lines: Vec<&str> = run.stdout.lines().collect();
    assert!(lines[0].starts_with("Can be held ") && lines[0].ends_with(" fails first."), "{}", lines[0]);
    let begins = ["Fails first: right shoulder flexion (", "Hardest worked: right shoulder flexion, ", "Most tired: "];
    assert!(lines[1..].iter().zip(begins).all(|(line, begin)| line.starts_with(begin)), "{lines:?}");
    assert!(lines[4].starts_with("In words: shoulder flexion raises the arm forward"), "{}", lines[4]);
    assert!(lines[5].starts_with(" What would help"), "{}", lines[5]);
    assert!(lines[6].starts_with(" as it is "), "{}", lines[6]);
    let summary: Value = serde_json::from_slice(&std::fs::read(folder.path().join("summary.json")).unwrap()).unwrap();
    let minutes = summary["verdict"]["minutes"].as_f64().unwrap();
    assert!((60.0 * minutes - summary["failed_first"]["at_s"].as_f64().unwrap()).abs() < 1e-9);
    let suggested = summary["suggestions"].as_array().unwrap();
    assert!(!suggested.is_empty() && suggested.iter().all(|one| one["minutes"].as_f64().unwrap() > minutes));
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains(lines[0]) && page.contains("What would help"));
    // Without the changes the answer is the same.
    let bare = contrapposto(["simulate", "-", "--no-suggest", "--out"]).arg(folder.path()).stdin(HELD_OUT).run();
    assert_eq!(bare.stdout.lines().next(), Some(lines[0]));
    assert!(!bare.stdout.contains("What would help"));
}
