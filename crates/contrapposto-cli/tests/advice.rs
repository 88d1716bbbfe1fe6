//! Changes that `relax`, `pose` and `assess` suggest, written into the job by hand: the job alone gives the minutes that were promised.

use crate::support;

use std::path::Path;

use contrapposto::kinematics::Kinematics;
use serde_json::Value;
use support::contrapposto;

/// The right arm of a man holds a weight, kg, at a place, m.
fn held(target: [f64; 3], kilograms: f64) -> String {
    format!(
        "format = 1\nupright = false\n[model]\nadult = {{ sex = \"male\", stature_m = 1.75, mass_kg = 75 }}\n\
         [posture]\narm_flex_r_deg = 60\nelbow_flex_r_deg = 60\nelbow_flex_l_deg = 20\n\
         [[load]]\nsegment = \"hand_r\"\nmass_kg = {kilograms}\n\
         [[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [{}, {}, {}]\n[[task]]\nkind = \"effort\"\n\
         [coordinates]\nfree = [\"arm_flex_r\", \"arm_add_r\", \"arm_rot_r\", \"elbow_flex_r\", \"pro_sup_r\"]\n",
        target[0], target[1], target[2]
    )
}

const TARGET: [f64; 3] = [0.45, 1.25, 0.2];
const KILOGRAMS: f64 = 4.0;

/// The JSON that a command prints of a job.
fn answer(folder: &Path, command: &[&str]) -> Value {
    let run = contrapposto(command).folder(folder).run();
    serde_json::from_str(&run.stdout).unwrap_or_else(|error| panic!("{command:?}: {error}: {}", run.stderr))
}

/// The suggested changes of a job, each with its minutes.
fn suggested(found: &Value) -> Vec<(String, f64)> {
    let all = found["suggestions"].as_array().unwrap();
    all.iter().map(|one| (one["change"].as_str().unwrap().to_owned(), one["minutes"].as_f64().unwrap())).collect()
}

/// The minutes of a job without suggestions.
fn minutes(found: &Value) -> f64 {
    assert!(found["suggestions"].as_array().is_none_or(Vec::is_empty), "{}", found["suggestions"]);
    found["verdict"]["minutes"].as_f64().unwrap()
}

fn changes_of_a_held_weight_give_the_minutes_of_the_changed_file(command: &str) {
    let folder = tempfile::tempdir().unwrap();
    let job = |name: &str, text: String, more: &[&str]| {
        std::fs::write(folder.path().join(name), text).unwrap();
        answer(folder.path(), &[&[command, name, "--json", "--out", "out"], more].concat())
    };
    let found = job("job.toml", held(TARGET, KILOGRAMS), &[]);
    let before = found["verdict"]["minutes"].as_f64().unwrap();
    let all = suggested(&found);
    assert!(all.iter().any(|(change, _)| change.contains("less load")), "{all:?}");
    let nearer = nearer(&held(TARGET, KILOGRAMS));
    for (change, promised) in &all {
        let moved = |by: f64| held([TARGET[0], TARGET[1] + by, TARGET[2]], KILOGRAMS);
        let text = match change.replace('\u{a0}', " ").as_str() {
            "right hand 10 cm lower (height 1.15 m instead of 1.25 m)" => moved(-0.1),
            "right hand 10 cm higher (height 1.35 m instead of 1.25 m)" => moved(0.1),
            "20 % less load (3.2 kg instead of 4 kg)" => held(TARGET, 0.8 * KILOGRAMS),
            change if change.starts_with("right hand 10 cm nearer (") => held(nearer, KILOGRAMS),
            change => panic!("{change} was not written by hand"),
        };
        let alone = minutes(&job("changed.toml", text, &["--no-suggest"]));
        println!("{command}: {change}: {promised} min promised, {alone}");
        assert!((promised - alone).abs() < 1e-3 * alone, "{command}: {change}: {promised} min promised, {alone}");
        assert!(*promised > before, "{change}: {promised} min, without {before}");
    }
    let counted = |words: &str| all.iter().filter(|(change, _)| change.contains(words)).count();
    assert_eq!(["cm lower", "cm nearer", "less load"].map(counted), [1, 1, 1], "{all:?}");
}

/// The target 10 cm nearer, level, to the centre of mass at the start.
fn nearer(text: &str) -> [f64; 3] {
    let scenario = contrapposto_formats::read_pose("job.toml", text.as_bytes(), None).unwrap();
    let mut kinematics = Kinematics::new(&scenario.model);
    kinematics.update(&scenario.model, &scenario.start).unwrap();
    let center = kinematics.center_of_mass(&scenario.model).unwrap();
    let (x, z) = (center.x - TARGET[0], center.z - TARGET[2]);
    let share = 0.1 / libm::hypot(x, z);
    [TARGET[0] + share * x, TARGET[1], TARGET[2] + share * z]
}

#[test]
fn changes_that_relax_suggests_give_the_minutes_of_the_changed_file() {
    changes_of_a_held_weight_give_the_minutes_of_the_changed_file("relax");
}

#[test]
fn changes_that_pose_suggests_give_the_minutes_of_the_changed_file() {
    changes_of_a_held_weight_give_the_minutes_of_the_changed_file("pose");
}

#[test]
fn less_load_that_assess_suggests_gives_the_minutes_of_the_smaller_load() {
    let folder = tempfile::tempdir().unwrap();
    let motion = "time,elbow_flex_r_deg,elbow_flex_l_deg,arm_flex_r_deg\n0,90,20,60\n900,90,20,60\n";
    std::fs::write(folder.path().join("held.csv"), motion).unwrap();
    let assess = |load: &str, more: &[&str]| {
        let command = ["assess", "adult", "held.csv", "--fixed-root", "--load", load, "--json"];
        answer(folder.path(), &[&command, more].concat())
    };
    let found = assess("hand_r 4kg", &[]);
    let all = suggested(&found);
    let (_, promised) = all.iter().find(|(change, _)| change.contains("less load")).unwrap();
    let alone = minutes(&assess("hand_r 3.2kg", &["--no-suggest"]));
    assert!((promised - alone).abs() < 1e-9 * alone, "{promised} min promised, {alone}");
    assert!(*promised > found["verdict"]["minutes"].as_f64().unwrap());
}

/// A break of a minute after every ten, which `assess` promises, is what `--work` and `--break` compute of the same posture, held for a minute and
/// repeated.
#[test]
fn a_break_that_assess_suggests_gives_the_minutes_of_the_repeated_job_with_that_break() {
    let folder = tempfile::tempdir().unwrap();
    for (angle, load, lasts) in
        [(25, "hand_r 0.5kg", "held_until"), (20, "hand_r 0.6kg", "held_until"), (25, "hand_r 0.1kg", "holds")]
    {
        let held = |seconds: f64| {
            let head = "time,elbow_flex_r_deg,elbow_flex_l_deg,arm_flex_r_deg";
            let motion = format!("{head}\n0,90,20,{angle}\n{seconds},90,20,{angle}\n");
            std::fs::write(folder.path().join("held.csv"), motion).unwrap();
        };
        let assess = |more: &[&str]| {
            let command = ["assess", "adult", "held.csv", "--fixed-root", "--load", load, "--json"];
            answer(folder.path(), &[&command, more].concat())
        };
        held(3600.0);
        let found = assess(&[]);
        let all = found["suggestions"].as_array().unwrap();
        let promised = all.iter().find(|one| one["change"].as_str().unwrap().contains("break of a minute")).unwrap();
        held(60.0);
        let alone = assess(&["--repeat", "1h", "--work", "10min", "--break", "1min", "--no-suggest"]);
        let verdict = &alone["verdict"];
        println!("{load}: {promised}, alone {verdict}; without breaks {}", found["verdict"]["minutes"]);
        assert_eq!((promised["kind"].as_str(), &promised["kind"]), (Some(lasts), &verdict["kind"]));
        let alike = |promised: &Value, alone: &Value| match (promised.as_f64(), alone.as_f64()) {
            (Some(promised), Some(alone)) => (promised - alone).abs() < 0.01 * alone,
            (promised, alone) => promised == alone,
        };
        assert!(alike(&promised["minutes"], &verdict["minutes"]), "{promised} {verdict}");
        assert!(alike(&promised["least_minutes"], &verdict["minutes_range"][0]), "{promised} {verdict}");
        let without = found["verdict"]["minutes"].as_f64().unwrap();
        assert!(promised["minutes"].as_f64().is_none_or(|minutes| minutes > 1.5 * without), "{promised} {without}");
    }
}

/// Rows of the table of a job whose weaker people alone lack time say whose time they shorten, and a lighter load that comes out as shorter is no row.
#[test]
fn simulate_lists_no_change_that_shortens_the_time_of_anybody_without_saying_so() {
    let folder = tempfile::tempdir().unwrap();
    let job = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/screw-overhead.toml");
    let run = contrapposto(["simulate"]).arg(job).arg("--out").arg(folder.path()).run();
    let text = std::fs::read(folder.path().join("summary.json")).unwrap();
    let found: Value = serde_json::from_slice(&text).unwrap();
    let verdict = &found["verdict"];
    let [mean, weaker] = [&verdict["minutes"], &verdict["minutes_range"][0]].map(|value| value.as_f64().unwrap());
    let all = found["suggestions"].as_array().unwrap();
    assert!(weaker < 5.0 && mean > 5.0 && !all.is_empty(), "{verdict}");
    for one in all {
        let change = one["change"].as_str().unwrap();
        let row = run.stdout.lines().find(|line| line.trim_start().starts_with(change)).unwrap();
        let [minutes, least] = ["minutes", "least_minutes"].map(|name| one[name].as_f64().unwrap());
        assert!(least > weaker && minutes >= 5.0, "{one}");
        assert_eq!(row.contains("; shorter for people of mean strength"), minutes < mean, "{row}");
        assert!(!change.contains("less load") || minutes >= mean, "{row}");
    }
}
