//! `contrapposto pose`: goals in order of priority in, a posture out.

use crate::support;

use std::path::{Path, PathBuf};

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Sex, adult};
use serde_json::Value;
use support::{Run, column, contrapposto, joint, numbers, page, scenarios};

fn pose(scenario: &Path, out: &Path, more: &[&str]) -> Run {
    contrapposto(["pose"]).arg(scenario).arg("--out").arg(out).args(more).run()
}

fn shelf() -> PathBuf {
    scenarios().join("poses/reach-shelf.toml")
}

fn residuals(pose: &Value, task: &str) -> Vec<f64> {
    let levels = pose["levels"].as_array().unwrap();
    let of = levels.iter().filter(|level| level["task"].as_str().unwrap().starts_with(task));
    of.map(|level| level["residual"].as_f64().unwrap()).collect()
}

#[test]
fn the_shelf_is_reached_on_both_feet() {
    let folder = tempfile::tempdir().unwrap();
    let run = pose(&shelf(), folder.path(), &["--json", "--figures"]);
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
    for file in found["files"].as_array().unwrap() {
        assert!(std::fs::metadata(folder.path().join(file.as_str().unwrap())).unwrap().len() > 100, "{file}");
    }
    assert_eq!(found["files"].as_array().unwrap().len(), 8 + 2 * 5);
    shown_as_found(&page(folder.path()), &found);
}

/// The page has the posture of `pose.json`, no time, and forces that carry the body through its centre of mass.
fn shown_as_found(page: &Value, found: &Value) {
    assert!(page["times"].is_null() && page["levels"].is_null());
    assert_eq!((&page["frames"], page["names"].as_array().unwrap().len()), (&serde_json::json!(1), 1));
    // Joints of one axis: of three-axis joints the page has the angles about their axes.
    for name in ["elbow_flex_r", "knee_angle_l", "ankle_angle_r"] {
        let angle = found["coordinates"][name].as_f64().unwrap().to_degrees();
        assert!((column(&joint(page, name)["angle"], 1)[0] - angle).abs() < 0.011, "{name}");
        assert!(joint(page, name)["groups"][0]["fatigue"].is_null(), "nothing tires in a posture");
    }
    let center = numbers(&found["center_of_mass_m"]);
    let [mut force, mut moment] = [0.0, 0.0];
    for support in page["supports"].as_array().unwrap() {
        let [up, at] = [&support["force"][1], &support["at"][0]].map(|value| column(value, 1)[0]);
        (force, moment) = (force + up, moment + up * at);
    }
    assert!((force - 60.0 * 9.80665).abs() < 2.0 && (moment / force - center[0]).abs() < 1e-3, "{force} {moment}");
    for k in 0..3 {
        assert!((column(&page["center"][k], 1)[0] - center[k]).abs() < 1e-4);
    }
    let target: Vec<f64> = page["targets"][0]["at"].as_array().unwrap().iter().map(|k| column(k, 1)[0]).collect();
    assert!(target.iter().zip([0.45, 1.55, 0.25]).all(|(a, b)| (a - b).abs() < 1e-9), "{target:?}");
    assert_eq!(page["table"]["rows"].as_array().unwrap().len(), 9);
    assert_eq!(page["list"]["entries"], serde_json::json!([]));
}

/// The seat under the pelvis is drawn, level and at the place of the patch; the feet stand on the ground.
#[test]
fn a_seat_is_drawn_under_a_body_that_sits() {
    const SITS: &str = "format = 1\n[model]\nadult = { sex = \"female\", stature_m = 1.65, mass_kg = 60 }\n\
        [posture]\npelvis_ty_m = 0.512\nhip_flexion_r_deg = 85\nhip_flexion_l_deg = 85\nknee_angle_r_deg = 85\n\
        knee_angle_l_deg = 85\n[[support]]\nsegment = \"pelvis\"\n[[support]]\nsegment = \"calcn_r\"\n\
        [[support]]\nsegment = \"calcn_l\"\n[[task]]\nkind = \"posture\"\n";
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("sits.toml");
    std::fs::write(&scenario, SITS).unwrap();
    assert_eq!(pose(&scenario, folder.path(), &[]).code, 0);
    let page = page(folder.path());
    let model = adult(&Adult { sex: Sex::Female, stature: 1.65, mass: 60.0, ..Adult::default() }).unwrap();
    let mut posture = model.default_posture();
    for (name, value) in
        [("pelvis_ty", 0.512), ("hip_flexion_r", 85f64.to_radians()), ("knee_angle_r", 85f64.to_radians())]
    {
        posture.values_mut()[model.coordinate(name).unwrap()] = value;
    }
    let mut kinematics = Kinematics::new(&model);
    kinematics.update(&model, &posture).unwrap();
    let patch = |segment: &str| -> Vec<_> {
        let segment = model.segment(segment).unwrap();
        model.segments()[segment].patch.iter().map(|corner| kinematics.station(&model, segment, *corner)).collect()
    };
    let (seat, sole) = (patch("pelvis"), patch("calcn_r"));
    let surfaces = page["surfaces"].as_array().unwrap();
    assert_eq!(surfaces.len(), 1);
    let corners: Vec<Vec<f64>> = surfaces[0]["corners"].as_array().unwrap().iter().map(numbers).collect();
    for corner in &seat {
        assert!(corners.iter().all(|drawn| (drawn[1] - corner.y).abs() < 1e-3), "{corners:?} {corner}");
        for (axis, value) in [(0, corner.x), (2, corner.z)] {
            let across = corners.iter().map(|drawn| drawn[axis]);
            let (low, high) = (across.clone().fold(f64::INFINITY, f64::min), across.fold(f64::NEG_INFINITY, f64::max));
            assert!(low < value - 0.05 && high > value + 0.05, "{corners:?} {corner}");
        }
    }
    let ground = sole.iter().map(|corner| corner.y).sum::<f64>() / sole.len() as f64;
    assert!((page["ground"].as_f64().unwrap() - ground).abs() < 1e-3);
}

#[test]
fn out_of_reach_the_hand_gives_way_and_the_feet_do_not() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        std::fs::read_to_string(shelf()).unwrap().replace("target_m = [0.45, 1.55, 0.25]", "target_m = [2, 2.5, 0.25]");
    let scenario = folder.path().join("far.toml");
    std::fs::write(&scenario, text).unwrap();
    let run = pose(&scenario, folder.path(), &["--json"]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    let found: Value = serde_json::from_str(&run.stdout).unwrap();
    let words = found["verdict"]["sentence"].as_str().unwrap();
    assert!(words.starts_with("Not reached: point right hand is missed by "), "{words}");
    assert!(residuals(&found, "support").iter().all(|r| r.abs() < 1e-6));
    assert!(residuals(&found, "point hand_r")[0].abs() > 0.5);
    assert_eq!(found["reason"], "closest");
}

/// The steps of `[solver]` that run out are a failure, those toward a posture in balance are not: its answer gives the exit code.
#[test]
fn steps_that_run_out_are_a_failure_and_steps_toward_balance_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let few = folder.path().join("few.toml");
    let arm = "format = 1\n[model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 75, part = \"right_arm\" }\n[[task]]\nkind = \"point\"\n\
               segment = \"hand_r\"\ntarget_m = [0.45, 1.3, 0.2]\n[solver]\nmax_steps = 1\n";
    std::fs::write(&few, arm).unwrap();
    let run = pose(&few, folder.path(), &["--no-suggest"]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(
        run.stdout.contains("the step limit was reached") && run.stderr.contains("not converged"),
        "{}",
        run.stderr
    );
    let run = pose(&scenarios().join("reach-floor.toml"), folder.path(), &["--no-suggest"]);
    let found: Value = serde_json::from_slice(&std::fs::read(folder.path().join("pose.json")).unwrap()).unwrap();
    assert_eq!((run.code, found["reason"].as_str()), (0, Some("steps")), "{}", run.stderr);
    assert!(
        !run.stdout.contains("step limit") && run.stdout.contains("in balance; its effort still fell"),
        "{}",
        run.stdout
    );
    assert!(run.stderr.contains("balance over the supports came before the tasks"), "{}", run.stderr);
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

/// A target in centimetres is 193 m away: the cell says metres, and no cell is empty.
#[test]
fn a_target_a_hundred_metres_away_is_missed_by_metres_and_every_task_has_a_result() {
    let folder = tempfile::tempdir().unwrap();
    let text = "format = 1\n[model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 75 }\n\
        [[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n\
        [[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.4, 195, 0.2]\n[[task]]\nkind = \"effort\"\n";
    let run = contrapposto(["pose", "-", "--out"]).arg(folder.path()).stdin(text).run();
    assert_eq!(run.code, 1, "{}", run.stderr);
    let row = run.stdout.lines().find(|line| line.contains(" point hand_r ")).unwrap();
    assert!(row.contains("193 m ") && row.contains("limited by higher priorities"), "{row}");
    let page = support::page(folder.path());
    for row in page["table"]["rows"].as_array().unwrap() {
        assert!(row.as_array().unwrap().iter().all(|cell| !cell.as_str().unwrap().is_empty()), "{row}");
    }
    assert!(page["table"]["rows"].as_array().unwrap().iter().any(|row| row[2] == "193 m"), "{}", page["table"]);
}
