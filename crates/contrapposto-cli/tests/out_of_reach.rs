//! Targets out of reach: a run ends no farther from them than `pose`, in whatever direction they lie.

use crate::support;

use support::{contrapposto, write};

/// A man on both feet, his right hand asked to a place.
fn reaching(target: [f64; 3], above_relief: bool) -> String {
    let [x, y, z] = target;
    format!(
        "format = 1\n[model]\nadult = {{ sex = \"male\", stature_m = 1.75, mass_kg = 75 }}\n[[support]]\nsegment = \"calcn_r\"\n\
         [[support]]\nsegment = \"calcn_l\"\n[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [{x}, {y}, {z}]\n\
         above_relief = {above_relief}\n[[task]]\nkind = \"effort\"\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 3\n"
    )
}

/// Up (near and 195 m away), ahead, behind, to both sides, up and ahead, ahead below the floor.
const TARGETS: [[f64; 3]; 8] = [
    [0.4, 2.6, 0.2],
    [0.4, 195.0, 0.2],
    [2.0, 1.0, 0.2],
    [-1.5, 1.0, 0.2],
    [0.4, 1.0, 2.0],
    [0.4, 1.2, -1.8],
    [1.5, 2.0, 0.8],
    [0.8, -0.6, 0.2],
];
/// A run ends no farther from the target than `pose` by more, m: the distance from which on a target is missed.
const FARTHER: f64 = 5e-3;

#[test]
fn a_run_ends_as_near_to_a_target_out_of_reach_as_pose() {
    let folder = tempfile::tempdir().unwrap();
    for (i, target) in TARGETS.into_iter().enumerate() {
        let job = write(folder.path(), "job.toml", &reaching(target, i.is_multiple_of(2)));
        let distance = |command: &str| {
            let call = contrapposto([command, &job, "--out", command, "--json", "--no-suggest"]);
            let run = call.folder(folder.path()).run();
            let answer: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
            assert_eq!(answer["verdict"]["kind"], "not_reached", "{target:?}: {}", answer["verdict"]["sentence"]);
            answer["verdict"]["missed"][0]["distance"].as_f64().unwrap()
        };
        let [run, pose] = ["simulate", "pose"].map(distance);
        println!("{target:?}: {run:.4} m by simulate, {pose:.4} m by pose");
        assert!(run < pose + FARTHER, "{target:?}: {run} m by simulate, {pose} m by pose");
    }
}
