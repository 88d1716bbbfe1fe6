//! Robots through the real program: motors have the strength of their file and do not tire.

use crate::support;

use std::path::Path;

use serde_json::Value;
use support::{json, refused, run, write};

fn biped() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../contrapposto-formats/tests/models/biped.urdf");
    path.to_str().unwrap().to_owned()
}

fn group<'a>(report: &'a Value, coordinate: &str, side: &str) -> &'a Value {
    let groups = report["groups"].as_array().unwrap();
    groups.iter().find(|group| group["coordinate"] == coordinate && group["side"] == side).unwrap()
}

/// The foot of 1 kg, 0.03 m below the ankle, and nothing else hangs on the ankle: its load is known by hand.
#[test]
fn assess_of_a_robot_uses_its_effort_limits_and_no_motor_tires() {
    let folder = tempfile::tempdir().unwrap();
    let held = write(folder.path(), "held.csv", "time,left_hip,left_ankle\n0,0,1\n36000,0,1\n");
    let report = json(&["assess", &biped(), &held, "--fixed-root", "--json", "--radians"]);
    let ankle = group(&report, "left_ankle", "positive");
    let other = group(&report, "left_ankle", "negative");
    let load = |group: &Value| group["peak_load"]["value"].as_f64().unwrap();
    let expected = 9.81 * 0.03 * libm::sin(1.0) / 60.0;
    assert!((load(ankle) + load(other) - expected).abs() < 1e-12, "{ankle} {other}, {expected}");
    for group in [ankle, other] {
        assert_eq!((group["fatigue_at_end"].as_f64(), &group["exhausted_at_s"]), (Some(0.0), &Value::Null), "{group}");
        assert_eq!(group["fatigue"]["parameters"], "none (does not tire)");
    }
}

/// 90 N m hold about 34 kg at 0.27 m, not 100 kg at the end of the leg.
#[test]
fn a_motor_above_its_strength_fails_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let held = write(folder.path(), "held.csv", "time,left_hip\n0,-1.5\n10,-1.5\n");
    let run = run(&["assess", &biped(), &held, "--json", "--radians", "--load", "left_foot 100kg"]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    let hips = ["positive", "negative"].map(|side| group(&report, "left_hip", side));
    let hip = hips.into_iter().find(|group| group["peak_load"]["value"].as_f64().unwrap() > 1.0).unwrap();
    assert_eq!(hip["exhausted_at_s"].as_f64(), Some(0.0), "{hip}");
}

/// A body that motors move has no muscles, neither in the terminal nor in JSON nor in the page's own words; a person has.
#[test]
fn motors_are_called_motors_and_muscles_muscles() {
    let folder = tempfile::tempdir().unwrap();
    let held = write(folder.path(), "held.csv", "time,left_hip,left_ankle\n0,-1,1\n700,-1,1\n");
    let out = folder.path().join("out");
    let report = |model: &str, held: &str| {
        let run = run(&["assess", model, held, "--fixed-root", "--radians", "--out", out.to_str().unwrap()]);
        let page = support::page(&out);
        let words = [&page["headline"], &page["reasons"], &page["figures"], &page["list"], &page["table"]];
        let words: String = words.iter().map(|part| part.to_string()).collect();
        (run.stdout.to_lowercase(), words.to_lowercase(), page["motors"].as_bool().unwrap())
    };
    let (said, shown, motors) = report(&biped(), &held);
    assert!(motors && said.contains("motor") && !said.contains("muscle"), "{said}");
    assert!(shown.contains("motor") && !shown.contains("muscle"), "{shown}");
    let held = write(folder.path(), "arm.csv", "time,elbow_flex_r\n0,1\n700,1\n");
    let (said, shown, motors) = report("adult", &held);
    assert!(!motors && said.contains("muscle") && !said.contains("motor"), "{said}");
    assert!(shown.contains("muscle") && !shown.contains("motor"), "{shown}");
}

/// The words of the user stay as they are: a title and a folder that say "muscle" are not those of the program.
#[test]
fn titles_and_folders_of_a_robot_keep_the_words_of_the_user() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(biped(), folder.path().join("biped.urdf")).unwrap();
    let lines = "format = 1\ntitle = \"muscle test\"\n[model]\nfile = \"biped.urdf\"\nroot = \"free\"\n\
                 [[support]]\nsegment = \"left_foot\"\n[[support]]\nsegment = \"right_foot\"\n\
                 [[task]]\nkind = \"effort\"\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 1\n";
    let scenario = write(folder.path(), "stand.toml", lines);
    for command in ["simulate", "pose", "relax"] {
        let out = folder.path().join(format!("muscle-{command}"));
        let run = run(&[command, &scenario, "--out", out.to_str().unwrap()]);
        let page = run.stdout.lines().find_map(|line| line.strip_prefix("report: ")).unwrap();
        assert!(Path::new(page).is_file() && page.contains("muscle-"), "{command}: {page}");
        let mine = run.stdout.lines().filter(|line| !line.contains("muscle-") && *line != "muscle test");
        assert!(mine.clone().all(|line| !line.contains("muscle")), "{command}: {}", run.stdout);
        assert!(!run.stdout.contains("people"), "{command}: {}", run.stdout);
        assert!(command == "relax" || run.stdout.lines().any(|line| line == "muscle test"), "{}", run.stdout);
    }
}

#[test]
fn without_the_strength_of_the_file_a_robot_is_not_assessed() {
    let folder = tempfile::tempdir().unwrap();
    let held = write(folder.path(), "held.csv", "time,left_hip\n0,0\n1,0\n");
    let said = refused(&["assess", &biped(), &held, "--no-strength", "--radians"]);
    assert!(said.contains("no strength of this model is known"), "{said}");
    let said = run(&["inspect", &biped()]).stdout;
    assert!(said.contains("strength of 6 joints from the file (`effort`)"), "{said}");
    let said = run(&["inspect", &biped(), "--no-strength"]).stdout;
    assert!(!said.contains("strength of 6 joints"), "{said}");
}

#[test]
fn relax_of_a_robot_on_its_soles_finds_postures() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(biped(), folder.path().join("biped.urdf")).unwrap();
    let lines = |model: &str| {
        format!(
            "format = 1\n[model]\nfile = \"biped.urdf\"\nroot = \"free\"\n{model}\n[posture]\nleft_hip_deg = -20\nleft_knee_deg = 40\n\
             left_ankle_deg = -20\nright_hip_deg = -20\nright_knee_deg = 40\nright_ankle_deg = -20\n\
             [[support]]\nsegment = \"left_foot\"\n[[support]]\nsegment = \"right_foot\"\n"
        )
    };
    let scenario = write(folder.path(), "stand.toml", &lines(""));
    let report = json(&["relax", &scenario, "--json"]);
    let postures = report["equilibria"].as_array().or(report["postures"].as_array()).unwrap();
    assert!(!postures.is_empty(), "{report}");
    let without = write(folder.path(), "weak.toml", &lines("file_strength = false"));
    let said = refused(&["relax", &without, "--json"]);
    assert!(said.contains("strength"), "{said}");
}

#[test]
fn a_run_of_a_robot_without_strength_warns_and_prints_no_loads() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(biped(), folder.path().join("biped.urdf")).unwrap();
    let simulated = |strength: &str| {
        let text = format!(
            "format = 1\n[model]\nfile = \"biped.urdf\"\nfile_strength = {strength}\n[posture]\nleft_hip_deg = -60\n[strategy]\n\
             kind = \"passive\"\n[fatigue]\n[run]\nduration_s = 3\nstep_s = 1\n"
        );
        let scenario = write(folder.path(), "run.toml", &text);
        run(&["simulate", &scenario, "--out", folder.path().join("out").to_str().unwrap()])
    };
    let hip = |stdout: &str| stdout.lines().find(|line| line.contains("left_hip")).unwrap().to_owned();
    let without = simulated("false");
    assert!(without.stderr.contains("warning: `biped`: no strength of its joints is known"), "{}", without.stderr);
    assert!(!hip(&without.stdout).contains('%'), "{}", without.stdout);
    let with = simulated("true");
    assert!(!with.stderr.contains("no strength"), "{}", with.stderr);
    assert!(hip(&with.stdout).contains('%'), "{}", with.stdout);
}
