//! The answer is the first line of the terminal, and warnings follow it; a misspelt column is named.

#![allow(clippy::unwrap_used, reason = "tests: helpers outside #[test] functions too")]

mod support;

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
