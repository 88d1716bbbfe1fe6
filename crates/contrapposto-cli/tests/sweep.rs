//! `contrapposto sweep`: the same bytes for any number of threads and after any kill, rows equal to single runs, refusals that write nothing.

use crate::support;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use contrapposto_formats::read_plan;
use contrapposto_sweep::Study;
use rand::{RngExt, SeedableRng};
use serde_json::Value;
use support::{contrapposto, scenarios};

/// A weight in the hand of an arm, held until the shoulder fails.
const BASE: &str = "format = 1\ntitle = \"Held out\"\n\
    [model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 75, part = \"right_arm\" }\n\
    [posture]\narm_flex_r_deg = 60\nelbow_flex_r_deg = 20\n[coordinates]\nfree = [\"elbow_flex_r\"]\n\
    [[load]]\nsegment = \"hand_r\"\nmass_kg = 3\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 200\n";

const PLAN: &str = "base = \"base.toml\"\ndesign = \"sobol\"\nrows = 60\nrows_per_part = 7\n[parameters]\n\
    \"model.adult.stature_m\" = { normal = [1.7, 0.07], correlate = { \"model.adult.mass_kg\" = 0.5 } }\n\
    \"model.adult.mass_kg\" = { lognormal = [75, 0.16] }\n\"load.0.mass_kg\" = { range = [0, 12] }\n\
    \"strength.deviations\" = { normal = [0, 1], within = [-1.5, 3.5] }\n\"model.adult.sex\" = { list = [\"female\", \"male\"] }\n";

/// A plan and its base scenario in a new folder.
fn plan(plan: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("base.toml"), BASE).unwrap();
    let path = folder.path().join("plan.toml");
    std::fs::write(&path, plan).unwrap();
    (folder, path)
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries.map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap())).collect()
}

fn sweep(plan: &Path, out: &Path, more: &[&str]) -> (i32, String) {
    let call = contrapposto(["sweep"]).arg(plan).arg("--out").arg(out).args(more.iter());
    let run = call.run();
    (run.code, run.stdout + &run.stderr)
}

/// The study whose list stands in a folder.
fn study(folder: &Path) -> (Study, Value) {
    let list: Value = serde_json::from_slice(&files(folder)["sweep.json"]).unwrap();
    let text = |name: &str| list[name].as_str().unwrap().as_bytes().to_vec();
    let plan = read_plan("plan.toml", &text("plan")).unwrap();
    (Study::new("base.toml", &text("scenario"), &plan).unwrap(), list)
}

/// Rows of all parts in order, cells by column. No cell of these plans holds a comma.
fn rows(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let ((study, list), files) = (study(folder), files(folder));
    let names = list["parts"].as_array().unwrap().iter().map(|name| name.as_str().unwrap());
    let answers: Vec<_> = names.enumerate().flat_map(|(i, name)| study.read(i, &files[name]).unwrap()).collect();
    let text = study.csv(&answers);
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let row = |line: Vec<String>| {
        assert_eq!(line.len(), header.len());
        header.iter().cloned().zip(line).collect()
    };
    lines.map(row).collect()
}

#[test]
fn one_thread_two_threads_and_random_kills_with_resume_give_the_same_bytes() {
    let (folder, plan) = plan(PLAN);
    let out = |name: &str| folder.path().join(name);
    for (name, threads) in [("one", "1"), ("two", "2")] {
        let (code, text) = sweep(&plan, &out(name), &["--threads", threads]);
        assert_eq!(code, 0, "{text}");
        assert!(text.contains("60 rows in 9 parts: "), "{text}");
    }
    let expected = files(&out("one"));
    assert_eq!(expected.len(), 10, "nine parts and their list");
    assert!(expected == files(&out("two")));
    let seed = 20;
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let mut killed = 0;
    for attempt in 0..20 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_contrapposto"))
            .args(["sweep", plan.to_str().unwrap(), "--out", out("killed").to_str().unwrap(), "--resume"])
            .args(["--threads", if attempt % 2 == 0 { "1" } else { "2" }])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(random.random_range(1..60)));
        killed += usize::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(killed > 0, "seed {seed}: no run lived long enough to be killed");
    let (code, text) = sweep(&plan, &out("killed"), &["--resume", "--threads", "2"]);
    assert_eq!(code, 0, "{text}");
    assert!(expected == files(&out("killed")), "seed {seed}: {text}");
}

#[test]
fn five_rows_carried_out_singly_by_simulate_give_the_same_answers() {
    let (folder, plan) = plan(PLAN);
    let out = folder.path().join("out");
    assert_eq!(sweep(&plan, &out, &[]).0, 0);
    let rows = rows(&out);
    let numbers: Vec<usize> = rows.iter().map(|row| row["row"].parse().unwrap()).collect();
    assert_eq!(numbers, (0..60).collect::<Vec<_>>());
    let kinds: Vec<&str> = rows.iter().map(|row| row["kind"].as_str()).collect();
    for kind in ["held_until", "holds", "cannot_be_done"] {
        assert!(kinds.contains(&kind), "the plan should have rows that are {kind}: {kinds:?}");
    }
    let (study, list) = study(&out);
    let deviations = &list["parameters"][3];
    assert_eq!(
        *deviations,
        serde_json::json!({ "normal": [0.0, 1.0], "within": [-1.5, 3.5], "key": "strength.deviations" })
    );
    let least = rows.iter().map(|row| row["strength.deviations"].parse::<f64>().unwrap()).fold(f64::MAX, f64::min);
    assert!((-1.5..-1.3).contains(&least), "{least}");
    for number in [0, 7, 19, 33, 59] {
        let single = folder.path().join("single.toml");
        std::fs::write(&single, study.scenario(number)).unwrap();
        let run = contrapposto(["simulate"]).arg(&single).args(["--no-report", "--json", "--no-suggest"]).run();
        let verdict = &serde_json::from_str::<Value>(&run.stdout).unwrap()["verdict"];
        let row = &rows[number];
        let cell = |column: &str| row[column].parse::<f64>().ok();
        assert_eq!(row["kind"], verdict["kind"].as_str().unwrap());
        assert_eq!(cell("minutes"), verdict["minutes"].as_f64(), "row {number}");
        assert_eq!(cell("load"), verdict["hardest"]["load"].as_f64(), "row {number}");
        assert_eq!(row["who"], verdict["who"].as_str().unwrap_or_default());
    }
}

#[test]
fn a_changed_plan_keeps_the_parts_that_it_does_not_change_and_removes_the_others() {
    let (folder, path) = plan(PLAN);
    let out = folder.path().join("out");
    assert_eq!(sweep(&path, &out, &[]).0, 0);
    let (code, text) = sweep(&path, &out, &[]);
    assert!(code == 2 && text.contains("--resume keeps those of this plan"), "{text}");
    let before = files(&out);
    // Rows 0 to 55 are the same: eight of nine parts; the others of the list end.
    std::fs::write(&path, PLAN.replace("rows = 60", "rows = 56")).unwrap();
    let (code, text) = sweep(&path, &out, &["--resume"]);
    assert!(code == 0 && text.contains("56 rows in 8 parts, 8 of them kept"), "{text}");
    let after = files(&out);
    assert_eq!(after.len(), 9);
    assert!(after.iter().filter(|(name, _)| name.ends_with(".parquet")).all(|(name, bytes)| before[name] == *bytes));
    // Another base scenario changes every row.
    std::fs::write(folder.path().join("base.toml"), BASE.replace("duration_s = 200", "duration_s = 201")).unwrap();
    let (code, text) = sweep(&path, &out, &["--resume"]);
    assert!(code == 0 && text.contains("56 rows in 8 parts: "), "{text}");
    assert!(files(&out).keys().filter(|name| name.ends_with(".parquet")).all(|name| !after.contains_key(name)));
}

#[test]
fn parts_of_another_plan_stay_until_all_parts_of_this_one_are_there() {
    let (folder, path) = plan(PLAN);
    let out = folder.path().join("out");
    assert_eq!(sweep(&path, &out, &[]).0, 0);
    let before = files(&out);
    std::fs::write(folder.path().join("base.toml"), BASE.replace("duration_s = 200", "duration_s = 201")).unwrap();
    std::fs::write(&path, PLAN.replace("rows = 60", "rows = 100000")).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_contrapposto"))
        .args(["sweep", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--resume"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // A sweep under way has a temporary folder beside the parts.
    let names = || std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let new_part = || names().any(|name| name.ends_with(".parquet") && !before.contains_key(&name));
    while !new_part() {
        assert!(child.try_wait().unwrap().is_none(), "the sweep ended without a part");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(before.iter().all(|(name, bytes)| std::fs::read(out.join(name)).unwrap() == *bytes));
    // The whole of a third plan removes the parts of both others.
    std::fs::write(&path, PLAN.replace("rows = 60", "rows = 7")).unwrap();
    assert_eq!(sweep(&path, &out, &["--resume"]).0, 0);
    assert_eq!(files(&out).keys().filter(|name| name.ends_with(".parquet")).count(), 1);
}

#[test]
fn a_plan_whose_first_row_is_no_scenario_goes_on_and_its_list_has_the_texts() {
    let text = "base = \"base.toml\"\ndesign = \"grid\"\nrows_per_part = 3\n[parameters]\n\"load.0.mass_kg\" = { list = [-1, 1] }\n";
    let (folder, path) = plan(text);
    let out = folder.path().join("out");
    let (code, words) = sweep(&path, &out, &[]);
    assert_eq!(code, 0, "{words}");
    let kinds: Vec<String> = rows(&out).iter().map(|row| row["kind"].clone()).collect();
    assert!(kinds[0] == "refused" && kinds[1] != "refused", "{kinds:?}");
    let cuts: Vec<String> = rows(&out).iter().map(|row| row["search_cut"].clone()).collect();
    assert_eq!(cuts, ["", "false"]);
    let list: Value = serde_json::from_slice(&files(&out)["sweep.json"]).unwrap();
    assert_eq!((list["plan"].as_str().unwrap(), list["scenario"].as_str().unwrap()), (text, BASE));
    assert_eq!((list["seed"].as_u64(), list["design"].as_str()), (Some(0), Some("grid")));
}

#[test]
fn a_body_that_its_supports_do_not_hold_cannot_stand_and_is_not_refused() {
    let (folder, plan) =
        plan("base = \"base.toml\"\ndesign = \"grid\"\n[parameters]\n\"support.0.friction\" = { list = [0, 0.6] }\n");
    let on = |foot: &str| {
        format!("[[support]]\nsegment = \"calcn_{foot}\"\non = {{ normal = [0.45, 1, 0] }}\nfriction = 0\n")
    };
    let base = format!("format = 1\n{}{}[strategy]\nkind = \"active\"\n[run]\nduration_s = 1\n", on("r"), on("l"));
    std::fs::write(folder.path().join("base.toml"), base).unwrap();
    let out = folder.path().join("out");
    let (code, words) = sweep(&plan, &out, &[]);
    assert_eq!(code, 0, "{words}");
    let rows = rows(&out);
    assert_eq!((rows[0]["kind"].as_str(), rows[0]["note"].as_str()), ("cannot_stand", ""), "{rows:?}");
}

#[test]
fn a_refused_plan_or_base_names_its_file_line_and_column_and_writes_nothing() {
    for (from, to, words) in [
        ("rows = 60", "rows = -1", "plan.toml:3:8"),
        ("base.toml", "missing.toml", "missing.toml"),
        ("model.adult.stature_m\" =", "model.adult.statur_m\" =", "did you mean `stature_m`?"),
        ("load.0.mass_kg", "load.1.mass_kg", "there are 1 entries"),
        ("[1.7, 0.07]", "[2.5, 0.07]", "stature (m) of the adult is 2.5; it must lie in 1.2..2.3"),
    ] {
        let (folder, plan) = plan(&PLAN.replace(from, to));
        let out = folder.path().join("out");
        let (code, text) = sweep(&plan, &out, &[]);
        assert_eq!(code, 2, "{to}: {text}");
        assert!(text.contains(words), "{to}: {text}");
        assert!(!out.exists(), "{to}");
    }
}

#[test]
fn a_row_with_values_that_the_reader_refuses_says_why_and_the_others_go_on() {
    let (folder, plan) = plan(&PLAN.replace("normal = [1.7, 0.07]", "range = [1.5, 2.5]"));
    let out = folder.path().join("out");
    let (code, text) = sweep(&plan, &out, &[]);
    assert_eq!(code, 0, "{text}");
    let rows = rows(&out);
    let refused = rows.iter().filter(|row| row["kind"] == "refused").count();
    let tall = rows.iter().filter(|row| row["model.adult.stature_m"].parse::<f64>().unwrap() > 2.3).count();
    assert!(refused == tall && tall > 0 && refused < 60, "{refused} and {tall}");
    assert!(rows.iter().filter(|row| row["kind"] == "refused").all(|row| row["note"].contains("must lie in 1.2..2.3")));
}

#[test]
fn every_stored_plan_is_read_with_its_base() {
    let folder = scenarios().join("sweeps");
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let plan = read_plan(&path.display().to_string(), &std::fs::read(&path).unwrap()).unwrap();
        let base = std::fs::read(folder.join(&plan.base)).unwrap();
        let study = Study::new(&plan.base, &base, &plan).unwrap();
        for row in [0, plan.rows - 1] {
            contrapposto_formats::read_run(&plan.base, study.scenario(row).as_bytes(), None).unwrap();
        }
        count += 1;
    }
    assert_eq!(count, 2);
}

#[test]
fn a_folder_in_which_another_sweep_writes_is_refused_and_any_number_of_threads_is_taken() {
    let (folder, plan) = plan(PLAN);
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    let held = std::fs::File::create(out.join("sweep.lock")).unwrap();
    held.try_lock().unwrap();
    let (code, words) = sweep(&plan, &out, &[]);
    assert!(code == 2 && words.contains("another sweep writes into this folder"), "{words}");
    drop(held);
    let (code, words) = sweep(&plan, &out, &["--threads", "18446744073709551615"]);
    assert_eq!(code, 0, "{words}");
    assert!(!files(&out).contains_key("sweep.lock"));
}

#[test]
fn one_value_has_one_key_and_texts_are_kept_as_they_are() {
    let (folder, two) = plan(&PLAN.replace("\"strength.deviations\"", "\"load.00.mass_kg\""));
    let (code, words) = sweep(&two, &folder.path().join("out"), &[]);
    assert!(code == 2 && words.contains("`00` of `load.00.mass_kg`"), "{words}");
    let (folder, plan) = plan(&PLAN.replace("[parameters]\n", "[parameters]\n\"title\" = { list = [\"=1+1\"] }\n"));
    let out = folder.path().join("out");
    assert_eq!(sweep(&plan, &out, &[]).0, 0);
    let parts = files(&out).into_iter().filter(|(name, _)| name.ends_with(".parquet"));
    for (name, bytes) in parts {
        assert!(bytes.windows(4).any(|window| window == b"=1+1"), "{name}");
    }
}
