//! `contrapposto muscles --hold`: how long muscles hold a posture, who fails and who takes over, through the real program.

use crate::support;

use serde_json::Value;
use support::{Run, hinge_with_muscles, refused, run, shared, write};

/// A body on a hinge about z, pulled forward by muscles 0.04 m in front of the hinge, each of a greatest force (N).
fn model(muscles: &[(&str, f64)]) -> String {
    hinge_with_muscles(&muscles.iter().map(|&(name, force)| (name, 0.04, force)).collect::<Vec<_>>())
}

/// The answer to a force (N) backward, 0.3 m below the hinge, with the exit code.
fn hold(file: &str, force: f64, time: &str, more: &[&str]) -> (Run, Value) {
    let force = format!("b {},0,0 at 0,-0.3,0 world", -force);
    let arguments = ["muscles", file, "--force", &force, "--hold", time];
    let words = run(&[&arguments, more].concat());
    let json = run(&[&arguments, more, &["--json"]].concat());
    assert_eq!(words.code, json.code, "{}", words.stderr);
    (words, serde_json::from_str(&json.stdout).unwrap_or_else(|why| panic!("{why}: {} {}", json.stdout, json.stderr)))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

#[test]
fn one_muscle_holds_as_long_as_the_law_of_its_joint_says() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model(&[("flexor", 500.0)]));
    let (words, found) = hold(&file, 25.0, "1h", &[]);
    assert_eq!(words.code, 1);
    let first = words.stdout.lines().next().unwrap();
    assert!(first.starts_with("The muscles hold this posture for ") && first.contains(" of 60\u{a0}min: "), "{first}");
    assert!(first.ends_with(" fails, with flexor exhausted."), "{first}");
    assert!(words.stdout.contains("First exhausted: flexor, after "), "{}", words.stdout);
    let (held, law) = (number(&found["held_s"]), &found["joint_law"]);
    let flexor = &found["muscles"]["flexor"];
    // 25 N at 0.3 m, of the active force of the muscle at 0.04 m.
    let load = 25.0 * 0.3 / (0.04 * number(&flexor["force_n"]));
    assert!(
        (number(&flexor["load_start"]) - load).abs() < 1e-9 && (number(&law["load"]) - load).abs() < 1e-9,
        "{found}"
    );
    // The closed form has no controller, whose steady load is less by F / (10 / s).
    assert!(held > 60.0 && (held / number(&law["held_s"]) - 1.0).abs() < 3e-3, "{held} s: {law}");
    assert!((number(&flexor["fatigued_end"]) - (1.0 - load)).abs() < 1e-6, "{flexor}");
    assert!((number(&flexor["exhausted_s"]) - held).abs() < 0.2, "{flexor}");
    assert_eq!(flexor["works_for"]["coordinate"], "q");
    let group = &found["groups"][0];
    assert!(
        (number(&group["fatigue_end"]) - 1.0).abs() < 1e-6 && (number(&group["asked_nm"]) - 7.5).abs() < 1e-9,
        "{group}"
    );
    assert!((number(&group["strength_end_nm"]) - 7.5).abs() < 1e-5, "{group}");
    assert_eq!(
        (&found["failed_muscles"][0], &found["failed_groups"][0]["coordinate"]),
        (&"flexor".into(), &"q".into())
    );
    // Part of that time is held, and nothing fails.
    let (words, found) = hold(&file, 25.0, &format!("{}s", 0.5 * held), &[]);
    assert!(words.code == 0 && found["held"] == true && found["failed_groups"] == Value::Array(vec![]), "{found}");
    assert!(words.stdout.contains("No muscle is exhausted."), "{}", words.stdout);
    let fatigue = number(&found["groups"][0]["fatigue_end"]);
    assert!(fatigue > 0.4 && fatigue < 0.6, "{fatigue}");
    // More than the muscle has.
    let (words, found) = hold(&file, 100.0, "1h", &[]);
    assert!(
        words.code == 1 && words.stdout.starts_with("The muscles cannot hold this posture: they give "),
        "{}",
        words.stdout
    );
    assert_eq!(number(&found["held_s"]), 0.0);
    let most = 0.04 * number(&found["muscles"]["flexor"]["force_n"]) / 30.0;
    assert!((number(&found["torque_limit"]) - most).abs() < 1e-9, "{found}");
}

#[test]
fn the_stronger_muscle_is_exhausted_first_and_the_other_one_takes_over() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model(&[("weak", 150.0), ("strong", 600.0)]));
    let (words, found) = hold(&file, 40.0, "1h", &[]);
    let [weak, strong] = ["weak", "strong"].map(|name| &found["muscles"][name]);
    // Least squares: loads in proportion to moments.
    assert!((number(&strong["load_start"]) / number(&weak["load_start"]) - 4.0).abs() < 1e-9, "{found}");
    assert!(number(&strong["exhausted_s"]) < 0.9 * number(&found["held_s"]), "{found}");
    assert!(number(&weak["load_end"]) > number(&weak["load_at_first_exhaustion"]) + 0.1, "{found}");
    let sentence = words.stdout.lines().nth(2).unwrap();
    assert!(
        sentence.starts_with("First exhausted: strong, after ") && sentence.contains("Then take over: weak (load "),
        "{sentence}"
    );
    // The shares of the two in the limit are what they still give.
    let shares = number(&weak["share_of_limit"]) + number(&strong["share_of_limit"]);
    assert!((shares - 1.0).abs() < 1e-6, "{found}");
}

#[test]
fn arguments_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "m.osim", &model(&[("flexor", 500.0)]));
    let two = write(folder.path(), "two.csv", "time,q_deg\n0,0\n1,5\n");
    assert!(refused(&["muscles", &file, &two, "--hold", "1min"]).contains("has 2 postures, and one posture is wanted"));
    assert_eq!(run(&["muscles", &file, &two, "--hold", "1min", "--from", "0.5"]).code, 0);
    assert!(refused(&["muscles", &file, "--load", "b 1kg"]).contains("--load: counts for a posture that is held"));
    assert!(refused(&["muscles", &file, "--fatigue", "muscle_group"]).contains("add --hold TIME"));
    assert!(refused(&["muscles", &file, "--hold", "1min", "--rule", "opensim"]).contains("cannot be used with"));
    assert!(refused(&["muscles", &file, "--hold", "1"]).contains("a time above 0 and up to 24h"));
    assert!(refused(&["muscles", "adult", "--hold", "1min"]).contains("--hold: no muscle could be read"));
    let six: String = ["a", "b", "c", "d", "e", "f"].map(|name| format!("<Coordinate name=\"{name}\"/>")).concat();
    let free = model(&[("flexor", 500.0)]).replace("PinJoint", "FreeJoint").replace("<Coordinate name=\"q\"/>", &six);
    let file = write(folder.path(), "free.osim", &free);
    let message = refused(&["muscles", &file, "--hold", "1min"]);
    assert!(message.contains("nothing holds the body up: the root carries 9.81 N"), "{message}");
}

/// The table of docs/strength.md.
#[test]
#[ignore = "needs ../shared: a published OpenSim model"]
fn gait2392_holds_crouches_as_the_documentation_says() {
    let folder = tempfile::tempdir().unwrap();
    let model = shared("models/opensim/gait2392_thelen2003muscle.osim");
    let header = "time,pelvis_tilt,hip_flexion_r,hip_flexion_l,knee_angle_r,knee_angle_l,ankle_angle_r,ankle_angle_l,lumbar_extension";
    let patch = |foot: &str| format!("{foot} 0.2,-0.02,0.04 0.2,-0.02,-0.04 -0.04,-0.02,-0.03 -0.04,-0.02,0.03");
    let patches = ["calcn_r", "calcn_l"].map(patch);
    for (row, held, joint, first) in [
        ("-20,60,60,-60,-60,20,20,0", 225.0, 226.0, ("vas_lat", 118.0)),
        ("-40,90,90,-90,-90,35,35,0", 207.0, 276.0, ("vas_lat", 91.0)),
        ("-15,20,20,-10,-10,5,5,-15", 492.0, 481.0, ("ercspn", 492.0)),
    ] {
        let posture = write(folder.path(), "posture.csv", &format!("{header}\n0,{row}\n"));
        let answer = run(&[
            "muscles",
            model.to_str().unwrap(),
            &posture,
            "--degrees",
            "--support",
            "calcn_r,calcn_l",
            "--patch",
            &patches[0],
            "--patch",
            &patches[1],
            "--hold",
            "2h",
            "--json",
        ]);
        assert_eq!(answer.code, 1, "{}", answer.stderr);
        let found: Value = serde_json::from_str(&answer.stdout).unwrap();
        let near = |value: &Value, expected: f64| (number(value) - expected).abs() < 0.6;
        assert!(near(&found["held_s"], held) && near(&found["joint_law"]["held_s"], joint), "{row}: {found}");
        let muscles = found["muscles"].as_object().unwrap();
        // By the greater moment arm of the default posture: rectus femoris 42 mm at the hip and 50 at the knee, gastrocnemius 21 at the
        // knee and 46 at the ankle, semimembranosus 49 at the hip and 32 at the knee.
        for (name, coordinate, parameters) in [
            ("rect_fem_r", "knee_angle_r", "knee"),
            ("med_gas_r", "ankle_angle_r", "ankle"),
            ("semimem_r", "hip_flexion_r", "general"),
        ] {
            let group = &muscles[name]["works_for"];
            assert_eq!(
                (&group["coordinate"], &group["fatigue"]["parameters"]),
                (&coordinate.into(), &parameters.into()),
                "{name}"
            );
        }
        let exhausted = muscles.iter().filter(|(_, muscle)| !muscle["exhausted_s"].is_null());
        let time = |muscle: &Value| number(&muscle["exhausted_s"]);
        let earliest = exhausted.min_by(|a, b| time(a.1).total_cmp(&time(b.1))).unwrap();
        assert!(earliest.0.starts_with(first.0) && near(&earliest.1["exhausted_s"], first.1), "{row}: {earliest:?}");
    }
}
