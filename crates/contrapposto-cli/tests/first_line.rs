//! The answer is the first line of the terminal, and warnings follow it; a misspelt column is named.

use crate::support;

use std::process::{Command, Stdio};

use support::{run, write};

/// Both streams of `assess` go into one file, as into a terminal: a warning (nothing carries the body) comes after the answer.
#[test]
fn warnings_of_assess_follow_its_answer() {
    let folder = tempfile::tempdir().unwrap();
    let hold = write(folder.path(), "hold.csv", "time,elbow_flex_r_deg\n0,90\n10,90\n");
    let file = std::fs::File::create(folder.path().join("terminal")).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_contrapposto"));
    command.args(["assess", "adult", &hold, "--no-suggest"]).stdin(Stdio::null());
    command.stdout(file.try_clone().unwrap()).stderr(file).status().unwrap();
    let text = std::fs::read_to_string(folder.path().join("terminal")).unwrap();
    assert!(text.starts_with("Cannot stand: "), "{text}");
    let (answer, warning) = (text.find("Cannot stand"), text.find("warning: nothing holds the body up"));
    assert!(warning.is_some() && answer < warning, "{text}");
}

#[test]
fn a_misspelt_column_is_warned_of_with_the_coordinate_that_was_meant() {
    let folder = tempfile::tempdir().unwrap();
    let hold =
        write(folder.path(), "hold.csv", "time,elbow_flx_r_deg,knee_angle_r_deg,sampling\n0,90,3,1\n10,90,3,1\n");
    for command in ["assess", "torques"] {
        let said = run(&[command, "adult", &hold]).stderr;
        let words =
            "the column `elbow_flx_r_deg` is no coordinate of the model and is ignored; did you mean `elbow_flex_r`?";
        assert!(said.contains(words), "{command}: {said}");
        assert!(!said.contains("column `sampling`"), "{said}");
    }
}

/// A load of tonnes is named in the first line, with what may be wrong with it; a pull is named, too.
#[test]
fn a_fall_names_the_loads() {
    let folder = tempfile::tempdir().unwrap();
    let job = |command: &str, load: &str| {
        let text = format!(
            "format = 1\n[model]\nadult = {{ sex = \"male\", stature_m = 1.75, mass_kg = 75 }}\n[[support]]\nsegment = \"calcn_r\"\n\
             [[support]]\nsegment = \"calcn_l\"\n[[load]]\nsegment = \"hand_r\"\n{load}\n[[task]]\nkind = \"effort\"\n[strategy]\n\
             kind = \"active\"\n[run]\nduration_s = 1\n"
        );
        let scenario = write(folder.path(), "job.toml", &text);
        let run = run(&[command, &scenario, "--no-suggest", "--out", &format!("{scenario}-out")]);
        assert_eq!(run.code, 1, "{}", run.stderr);
        run.stdout.lines().next().unwrap().replace('\u{a0}', " ")
    };
    let heavy = job("relax", "mass_kg = 3000");
    assert!(
        heavy.starts_with("Cannot stand: the supports do not hold the body under its load of 3000 kg; "),
        "{heavy}"
    );
    assert!(heavy.ends_with(" are missing. The body weighs 75 kg: are kilograms meant?"), "{heavy}");
    let missing = heavy.split("3000 kg; ").nth(1).and_then(|rest| rest.split(" N").next()).unwrap();
    let missing: f64 = missing.parse().unwrap();
    assert!(missing > 1e4 && missing < 3075.0 * 9.81, "{missing} N of a weight of 30,166 N: {heavy}");
    for command in ["relax", "simulate"] {
        let pulled = job(command, "force_n = [1000, 0, 0]\nfixed_in = \"world\"");
        let words = "Cannot stand: the supports do not hold the body under a force of 1000 N on right hand toward +x; they slip, and ";
        assert!(pulled.starts_with(words), "{pulled}");
        assert!(!pulled.contains("kilograms"), "{pulled}");
    }
}

/// Nobody judges ligaments and grip of a body that falls; the table of changes says so instead of `none` and `less than half` of 3 tonnes in a hand.
#[test]
fn the_grip_and_ligaments_of_a_body_that_falls_are_told_as_not_judged() {
    let folder = tempfile::tempdir().unwrap();
    let text = "format = 1\n[model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 75 }\n[[support]]\nsegment = \"calcn_r\"\n\
                [[support]]\nsegment = \"calcn_l\"\n[[load]]\nsegment = \"hand_r\"\nmass_kg = 3000\n[[task]]\nkind = \"effort\"\n[strategy]\n\
                kind = \"active\"\n[run]\nduration_s = 5\n";
    let scenario = write(folder.path(), "job.toml", text);
    let run = run(&["simulate", &scenario, "--no-report"]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    let row = |start: &str| run.stdout.lines().find(|line| line.trim_start().starts_with(start)).unwrap().to_owned();
    let as_it_is = row("as it is");
    // A column is there where it tells some row from the others.
    let header = row("What would help");
    let judged =
        ["hazard for ligaments", "strength of the grip"].iter().filter(|column| header.contains(**column)).count();
    assert!(header.contains("strength of the grip"), "{header}");
    assert_eq!(as_it_is.matches("not judged").count(), judged, "{}", run.stdout);
    assert!(!as_it_is.contains("less than half") && !as_it_is.contains("none"), "{as_it_is}");
    let lighter = row("98");
    assert!(lighter.contains("half or more") || lighter.contains("less than half"), "{lighter}");
}
