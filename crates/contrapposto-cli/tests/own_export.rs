//! The body and the motion that `simulate` writes for other programs, assessed by this one, give the answer of the run.

use crate::support;

use std::path::Path;

use serde_json::Value;
use support::{contrapposto, write};

/// A woman bends over with a weight in each hand: shoulders and hips of three axes, a lumbar spine that its ligaments hold.
const STOOP: &str = "format = 1\n[model]\nadult = { sex = \"female\", stature_m = 1.65, mass_kg = 62 }\n\
    [posture]\nhip_flexion_r_deg = 70\nhip_flexion_l_deg = 70\nknee_angle_r_deg = 50\nknee_angle_l_deg = 50\npelvis_tilt_deg = -35\n\
    ankle_angle_r_deg = 15\nankle_angle_l_deg = 15\narm_flex_r_deg = 70\narm_flex_l_deg = 70\nlumbar_extension_deg = -50\n\
    [floor]\n[[load]]\nsegment = \"hand_r\"\nmass_kg = 6\n[[load]]\nsegment = \"hand_l\"\nmass_kg = 2\n\
    [[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.4, 0.35, 0.3]\n[[task]]\nkind = \"effort\"\n\
    [strategy]\nkind = \"active\"\n[run]\nduration_s = 20\n";

/// The JSON that a command prints.
fn answer(folder: &Path, command: &[&str]) -> Value {
    let run = contrapposto(command).folder(folder).run();
    serde_json::from_str(&run.stdout).unwrap_or_else(|error| panic!("{command:?}: {error}: {}", run.stderr))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

/// Minutes within 1 % and angles within 0.1 degrees: the assessment takes the loads between two rows of the motion as linear, the run
/// as those of its step.
#[test]
fn a_run_and_the_assessment_of_its_export_give_the_same_verdict_and_the_same_hazards() {
    let folder = tempfile::tempdir().unwrap();
    let job = write(folder.path(), "stoop.toml", STOOP);
    let run = answer(folder.path(), &["simulate", &job, "--out", "out", "--json", "--no-suggest"]);
    let loads = ["--load", "hand_r 6kg", "--load", "hand_l 2kg", "--json", "--no-suggest"];
    let [verdict, hazards] = [&run["verdict"], &run["verdict"]["hazards"]];
    assert!(!hazards.as_array().unwrap().is_empty(), "the run has no hazard: {verdict}");
    for carried in [["--support", "calcn_r,calcn_l"], ["--grf", "out/ground_reaction.mot"]] {
        let command = [&["assess", "out/model.osim", "out/motion.mot"][..], &carried, &loads].concat();
        let again = &answer(folder.path(), &command)["verdict"];
        for same in ["kind", "who", "asked_minutes"] {
            assert_eq!(again[same], verdict[same], "{same}: {again} and {verdict}");
        }
        for close in ["minutes", "load"] {
            let (a, b) = (number(&again[close]), number(&verdict[close]));
            assert!((a - b).abs() < 0.01 * b, "{close}: {a} and {b}");
        }
        let (found, expected) = (again["hazards"].as_array().unwrap(), hazards.as_array().unwrap());
        let names = |all: &[Value]| all.iter().map(|one| one["coordinate"].clone()).collect::<Vec<_>>();
        assert_eq!(names(found), names(expected));
        for (a, b) in found.iter().zip(expected) {
            assert!((number(&a["angle_deg"]) - number(&b["angle_deg"])).abs() < 0.1, "{a} and {b}");
        }
    }
}

/// A file whose lumbar force was changed keeps it, and says so; the person that is given counts, not the one of the file.
#[test]
fn a_changed_force_of_an_export_stays_and_a_given_person_counts() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("body.osim");
    let written = contrapposto(["convert", "adult:female,1.65m,62kg", "body.osim"]).folder(folder.path()).run();
    assert_eq!(written.code, 0, "{}", written.stderr);
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains("<credits>Built-in adult of contrapposto: adult:female,1.65m,62kg</credits>"), "{text}");
    let notes = |more: &[&str]| {
        let command = [&["inspect", "body.osim", "--verbose"], more].concat();
        contrapposto(&command).folder(folder.path()).run().stdout
    };
    let said = notes(&["--passive", "library"]);
    assert!(said.contains("the file is the built-in adult, a woman of 1.65 m and 62 kg"), "{said}");
    assert!(!said.contains("changed there"), "{said}");
    let said = notes(&["--passive", "library", "--person", "male"]);
    assert!(!said.contains("the file is the built-in adult") && said.contains("a man (given)"), "{said}");
    let at = text.find("lumbar_extension_passive").unwrap();
    let begin = at + text[at..].find("<expression>").unwrap() + "<expression>".len();
    std::fs::write(&file, format!("{}1.5+{}", &text[..begin], &text[begin..])).unwrap();
    let said = notes(&["--passive", "library"]);
    assert!(said.contains("the passive torque of `lumbar_extension` is that of the file"), "{said}");
}
