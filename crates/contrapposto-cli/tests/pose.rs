//! `contrapposto pose`: goals in order of priority in, a posture out.

#![allow(clippy::unwrap_used, reason = "tests: helpers outside #[test] functions too")]

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

struct Run {
    code: i32,
    stdout: String,
    stderr: String,
}

fn pose(scenario: &Path, out: &Path, more: &[&str]) -> Run {
    let output = Command::new(env!("CARGO_BIN_EXE_contrapposto"))
        .arg("pose")
        .arg(scenario)
        .arg("--out")
        .arg(out)
        .args(more)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Run { code: output.status.code().unwrap(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

fn shelf() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/poses/reach-shelf.toml")
}

fn residuals(pose: &Value, task: &str) -> Vec<f64> {
    let levels = pose["levels"].as_array().unwrap();
    let of = levels.iter().filter(|level| level["task"].as_str().unwrap().starts_with(task));
    of.map(|level| level["residual"].as_f64().unwrap()).collect()
}

#[test]
fn the_shelf_is_reached_on_both_feet() {
    let folder = tempfile::tempdir().unwrap();
    let run = pose(&shelf(), folder.path(), &["--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let written = std::fs::read_to_string(folder.path().join("pose.json")).unwrap();
    assert_eq!(run.stdout.trim(), written.trim());
    let found: Value = serde_json::from_str(&written).unwrap();
    assert_eq!(found["supports_hold"], true);
    for task in ["support", "center_of_mass", "point hand_r", "look_at"] {
        let left = residuals(&found, task);
        assert!(!left.is_empty() && left.iter().all(|r| r.abs() < 1e-9), "{task}: {left:?}");
    }
    let order = found["coordinate_order"].as_array().unwrap();
    assert_eq!(order.len(), found["coordinates"].as_object().unwrap().len());
    for file in ["pose.mot", "pose.csv", "pose.svg"] {
        assert!(std::fs::metadata(folder.path().join(file)).unwrap().len() > 100, "{file}");
    }
}

#[test]
fn out_of_reach_the_hand_gives_way_and_the_feet_do_not() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        std::fs::read_to_string(shelf()).unwrap().replace("target_m = [0.45, 1.55, 0.25]", "target_m = [2, 2.5, 0.25]");
    let scenario = folder.path().join("far.toml");
    std::fs::write(&scenario, text).unwrap();
    let run = pose(&scenario, folder.path(), &["--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let found: Value = serde_json::from_str(&run.stdout).unwrap();
    assert!(residuals(&found, "support").iter().all(|r| r.abs() < 1e-6));
    assert!(residuals(&found, "point hand_r")[0].abs() > 0.5);
    assert_eq!(found["reason"], "closest");
}

#[test]
fn a_wrong_name_is_shown_where_it_stands() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(shelf()).unwrap().replace("segment = \"hand_r\"", "segment = \"hand_rr\"");
    let scenario = folder.path().join("wrong.toml");
    std::fs::write(&scenario, text).unwrap();
    let out = folder.path().join("out");
    let run = pose(&scenario, &out, &[]);
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(
        run.stderr.contains("no segment `hand_rr`") && run.stderr.contains("did you mean `hand_r`"),
        "{}",
        run.stderr
    );
    assert!(!out.exists());
}
