//! `contrapposto capacity`: a scenario in, the greatest forces at a point of the body out.

use crate::support;

use std::path::{Path, PathBuf};

use serde_json::Value;
use support::{Run, contrapposto, numbers, page, scenarios};

/// A person on both feet, the forearms forward, and what is added.
const STANDING: &str = r#"
format = 1
title = "Standing"
[model]
adult = { sex = "male", stature_m = 1.75, mass_kg = 75 }
[posture]
arm_flex_r_deg = 40
arm_flex_l_deg = 40
elbow_flex_r_deg = 70
elbow_flex_l_deg = 70
[[support]]
segment = "calcn_r"
[[support]]
segment = "calcn_l"
[[task]]
kind = "center_of_mass"
margin_m = 0.03
[[task]]
kind = "posture"
"#;

fn scenario(folder: &Path, more: &str) -> PathBuf {
    let path = folder.join("job.toml");
    std::fs::write(&path, format!("{STANDING}{more}")).unwrap();
    path
}

fn capacity(scenario: &Path, more: &[&str]) -> Run {
    contrapposto(["capacity"]).arg(scenario).args(more).run()
}

#[test]
fn a_standing_person_has_forces_in_642_directions_and_all_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let run = capacity(&scenario(folder.path(), ""), &["--at", "hand_r", "--json", "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{} {}", run.stdout, run.stderr);
    let found: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(std::fs::read_to_string(out.join("capacity.json")).unwrap().trim(), run.stdout.trim());
    let directions = found["directions"].as_array().unwrap();
    assert_eq!((directions.len(), found["faces"].as_array().unwrap().len()), (642, 1280));
    let force = |force: &Value| force["force_n"].as_f64().unwrap();
    let (weakest, strongest) = (force(&found["weakest"]), force(&found["strongest"]));
    assert!(weakest > 1.0 && weakest < strongest && strongest < 2000.0, "{weakest} {strongest}");
    for one in directions {
        assert!(force(one) >= weakest * (1.0 - 1e-12) && force(one) <= strongest);
        assert!(one["weaker_n"].as_f64().unwrap() <= force(one) * (1.0 + 1e-9));
        assert!(one["stronger_n"].as_f64().unwrap() >= force(one) * (1.0 - 1e-9));
        assert!(!one["limits"].as_array().unwrap().is_empty());
    }
    let sentence = found["sentence"].as_str().unwrap();
    assert!(sentence.starts_with("Right hand: at least ") && sentence.contains(" limits)"), "{sentence}");
    let main: Vec<&str> = found["main"].as_array().unwrap().iter().map(|one| one["toward"].as_str().unwrap()).collect();
    assert_eq!(main, ["forward", "back", "up", "down", "left", "right"]);
    for file in found["files"].as_array().unwrap() {
        assert!(std::fs::metadata(out.join(file.as_str().unwrap())).unwrap().len() > 100, "{file}");
    }
    let csv = std::fs::read_to_string(out.join("capacity.csv")).unwrap();
    assert_eq!(csv.lines().count(), 643);
    let page = page(&out);
    assert_eq!(page["headline"], found["sentence"]);
    assert_eq!(
        (page["solid"]["corners"].as_array().unwrap().len(), page["solid"]["faces"].as_array().unwrap().len()),
        (642, 1280)
    );
    // The largest force is half a metre long.
    let at = numbers(&page["solid"]["at"]);
    let away = |corner: &Value| numbers(corner).iter().zip(&at).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let longest = page["solid"]["corners"].as_array().unwrap().iter().map(away).fold(0.0, f64::max);
    assert!((longest - 0.5).abs() < 1e-3, "{longest}");
}

#[test]
fn a_force_that_is_held_is_smaller_and_the_left_hand_has_the_same_as_the_right_one() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenario(folder.path(), "");
    let weakest = |more: &[&str]| {
        let run = capacity(&file, &[more, &["--json"]].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        let found: Value = serde_json::from_str(&run.stdout).unwrap();
        let volume: f64 =
            found["directions"].as_array().unwrap().iter().map(|one| one["force_n"].as_f64().unwrap().powi(3)).sum();
        (found["weakest"]["force_n"].as_f64().unwrap(), volume)
    };
    let (now, held, long) = (
        weakest(&["--at", "hand_r"]),
        weakest(&["--at", "hand_r", "--hold", "2min"]),
        weakest(&["--at", "hand_r", "--hold", "5min"]),
    );
    assert!(now.0 >= held.0 && held.0 >= long.0 && now.1 > held.1 && held.1 > long.1, "{now:?} {held:?} {long:?}");
    let left = weakest(&["--at", "hand_l"]);
    assert!((left.0 - now.0).abs() < 1e-4 * now.0, "{left:?} {now:?}");
    // A time that is said and held.
    let run = capacity(&file, &["--at", "hand_r", "--hold", "2min"]);
    assert!(run.stdout.starts_with("Right hand, held for 2.0\u{a0}min: at least "), "{}", run.stdout);
}

#[test]
fn the_verdict_comes_first_where_the_posture_cannot_be_held() {
    let folder = tempfile::tempdir().unwrap();
    let heavy = scenario(folder.path(), "[[load]]\nsegment = \"hand_r\"\nmass_kg = 60\n");
    let run = capacity(&heavy, &["--at", "hand_l"]);
    assert_eq!(run.code, 1, "{}", run.stdout);
    assert!(run.stdout.starts_with("Cannot be done: ") || run.stdout.starts_with("Cannot stand: "), "{}", run.stdout);
    let run = capacity(&heavy, &["--at", "hand_l", "--json", "--out", folder.path().join("out").to_str().unwrap()]);
    let found: Value = serde_json::from_str(&run.stdout).unwrap();
    assert!(found["weakest"].is_null() && found["directions"].as_array().unwrap().is_empty());
    assert!(page(&folder.path().join("out"))["solid"].is_null());
    // Held for an instant, but not for an hour.
    let tiring = scenario(folder.path(), "[[load]]\nsegment = \"hand_r\"\nmass_kg = 6\n");
    assert_eq!(capacity(&tiring, &["--at", "hand_l"]).code, 0);
    let run = capacity(&tiring, &["--at", "hand_l", "--hold", "1h"]);
    assert_eq!(run.code, 1);
    assert!(
        run.stdout.starts_with("No force can be held for 60\u{a0}min, because the posture cannot. Can be held "),
        "{}",
        run.stdout
    );
}

#[test]
fn wrong_arguments_are_refused_by_what_would_be_accepted() {
    let file = scenarios().join("poses/reach-shelf.toml");
    for (more, message) in [
        (vec!["--at", "hnd_r"], "`hand_r` is one"),
        (vec!["--at", "hand_r", "--hold", "2"], "such as 30s, 2min or 1.5h"),
        (vec!["--at", "hand_r", "--hold", "0s"], "a time above 0"),
        (vec!["--at", "hand_r", "--point", "1,2"], "three numbers in m"),
        (vec![], "--at <SEGMENT>"),
    ] {
        let run = capacity(&file, &more);
        assert_eq!(run.code, 2, "{more:?}");
        assert!(run.stderr.contains(message), "{more:?}: {}", run.stderr);
    }
}
