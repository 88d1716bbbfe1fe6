//! `contrapposto torques` through the real program: numbers of OpenSim and Pinocchio, the shape of the JSON, and what it
//! says to arguments that make no sense.

use crate::support;

use serde_json::Value;
use support::{json, keys, leg, numbers, refused, run, shared, vectors, write};

/// Greatest size of what must add up to zero, N m.
const BALANCE: f64 = 1e-9;

fn assert_balanced(frame: &Value) {
    for map in ["coordinates", "uncoupled"] {
        for (name, row) in frame[map].as_object().unwrap() {
            let torques = keys(row).into_iter().filter(|key| !["strength", "passive_source"].contains(key));
            let torques: Vec<&str> = torques.collect();
            assert_eq!(torques, ["active", "angle", "external", "passive"], "{name}");
            let sum: f64 = ["external", "passive", "active"].iter().map(|key| row[*key].as_f64().unwrap()).sum();
            assert!(sum.abs() < BALANCE, "{name}: {row}");
        }
    }
}

#[test]
fn a_held_weight_at_the_adults_elbow() {
    let folder = tempfile::tempdir().unwrap();
    let level = write(folder.path(), "level.csv", "time,elbow_flex_r_deg,arm_add_r_deg\n0,90,0\n");
    let empty = &json(&["torques", "adult", &level, "--json"])[0];
    let held = &json(&["torques", "adult", &level, "--json", "--load", "hand_r 3kg at 0,0,0"])[0];
    assert_balanced(held);
    assert_eq!(held["coordinates"]["elbow_flex_r"]["angle"].as_f64().unwrap(), 90f64.to_radians());
    let external = |frame: &Value| frame["coordinates"]["elbow_flex_r"]["external"].as_f64().unwrap();
    // The wrist of the 1.741 m man is 0.2689 m from the elbow (de Leva).
    let expected = -3.0 * 9.81 * 0.2689;
    assert!((external(held) - external(empty) - expected).abs() < 0.02, "{}", external(held) - external(empty));
    // The same pull as a force, and as a longer text.
    let force = &json(&["torques", "adult", &level, "--json", "--force", "hand_r 0,-29.43,0 at 0,0,0 world"])[0];
    assert!((external(force) - external(held)).abs() < 1e-12);
    // Passive torque is that of the built-in curve.
    let curve = json(&["passive", "elbow_flex_r", "--json"]);
    let (angles, torques) = (numbers(&curve["angle_deg"]), numbers(&curve["torque_nm"]));
    let at = angles.iter().position(|angle| (angle - 90.0).abs() < 1e-9).unwrap();
    let passive = held["coordinates"]["elbow_flex_r"]["passive"].as_f64().unwrap();
    assert!((passive - torques[at]).abs() < 1e-9);
}

#[test]
fn json_has_the_promised_shape() {
    let folder = tempfile::tempdir().unwrap();
    let model = write(folder.path(), "leg.xml", &leg(1, "shin"));
    let two = write(folder.path(), "two.csv", "time,hip_deg,shin_deg\n0,10,20\n0.5,-10,0\n");
    let frames = json(&["torques", &model, &two, "--json", "--gradient"]);
    let frames = frames.as_array().unwrap();
    assert_eq!(frames.len(), 2);
    for (index, frame) in frames.iter().enumerate() {
        assert_eq!(
            keys(frame),
            [
                "center_of_mass",
                "coordinate_order",
                "coordinates",
                "effort",
                "frame",
                "gradient",
                "joints",
                "quasi_static",
                "time_s",
                "uncoupled"
            ]
        );
        assert_eq!(frame["frame"], index);
        assert_eq!(frame["coordinate_order"], serde_json::json!(["hip", "shin"]));
        assert_eq!(keys(&frame["coordinates"]), ["hip", "shin"]);
        assert_eq!(frame["uncoupled"], serde_json::json!({}));
        assert_eq!(numbers(&frame["center_of_mass"]).len(), 3);
        assert_eq!(
            frame["gradient"].as_array().unwrap().iter().map(|row| numbers(row).len()).collect::<Vec<_>>(),
            [2, 2]
        );
        assert_balanced(frame);
    }
    let plain = json(&["torques", &model, &two, "--json"]);
    assert_eq!(
        keys(&plain[0]),
        [
            "center_of_mass",
            "coordinate_order",
            "coordinates",
            "effort",
            "frame",
            "joints",
            "quasi_static",
            "time_s",
            "uncoupled"
        ]
    );
    // Hinges of a body without known strength.
    assert_eq!((&plain[0]["effort"], &plain[0]["joints"]), (&serde_json::json!(0.0), &serde_json::json!({})));
}

/// Length of three numbers.
fn length(three: &Value) -> f64 {
    numbers(three).iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[test]
fn an_arm_held_out_sideways_has_one_moment_load_and_effort_by_both_triples_of_angles() {
    let folder = tempfile::tempdir().unwrap();
    let motion = "time,arm_flex_r_deg,arm_add_r_deg\n0,0,-90\n1,90,-90\n";
    let motion = write(folder.path(), "sideways.csv", motion);
    let frames = json(&["torques", "adult:female,1.65m,60kg", &motion, "--json"]);
    let shoulder = |frame: usize| &frames[frame]["joints"]["shoulder_r"];
    for frame in 0..2 {
        let moment = length(&shoulder(frame)["external_nm"]);
        assert!((moment - 7.19).abs() < 0.005, "{moment} N m in row {frame}");
        // external + passive + active = 0.
        for k in 0..3 {
            let parts = ["external_nm", "passive_nm", "active_nm"].map(|part| numbers(&shoulder(frame)[part])[k]);
            assert!(parts.iter().sum::<f64>().abs() < BALANCE, "{parts:?}");
        }
    }
    // Turned by flexion about its long axis: the weight's moment has the same length, and its coordinates have no torque.
    let lost = ["arm_flex_r", "arm_add_r", "arm_rot_r"]
        .map(|name| frames[1]["coordinates"][name]["external"].as_f64().unwrap().abs());
    assert!(lost.iter().all(|torque| *torque < 1e-3), "{lost:?}");
    let lengths = [0, 1].map(|frame| length(&shoulder(frame)["external_nm"]));
    assert!((lengths[0] - lengths[1]).abs() < 1e-9, "{lengths:?}");
    let axes: Vec<&str> =
        shoulder(0)["axes"].as_array().unwrap().iter().map(|axis| axis["name"].as_str().unwrap()).collect();
    assert_eq!(axes, ["arm_flex_r", "arm_add_r", "arm_rot_r"]);
    for (k, axis) in shoulder(0)["axes"].as_array().unwrap().iter().enumerate() {
        // Flexion z, adduction x, axial rotation y of the humerus.
        let expected = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]][k];
        let direction = numbers(&axis["direction"]);
        assert!(direction.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{direction:?}");
    }
    for frame in 0..2 {
        let load = shoulder(frame)["load"].as_f64().unwrap();
        let effort = frames[frame]["effort"].as_f64().unwrap();
        assert!(load > 0.1 && effort >= load * load, "load {load}, effort {effort} in row {frame}");
    }
}

#[test]
fn one_orientation_by_two_triples_of_angles_has_one_load_and_one_effort() {
    let folder = tempfile::tempdir().unwrap();
    // (f, a, r) and (f + 180, 180 - a, r + 180) are one orientation; 260 degrees are -100.
    let motion = "time,arm_flex_r_deg,arm_add_r_deg,arm_rot_r_deg\n0,30,-80,20\n1,-150,-100,-160\n";
    let motion = write(folder.path(), "twice.csv", motion);
    let frames = json(&["torques", "adult:female,1.65m,60kg", &motion, "--json"]);
    let number = |frame: usize, pointer: &str| frames[frame].pointer(pointer).unwrap().as_f64().unwrap();
    for pointer in ["/effort", "/joints/shoulder_r/load"] {
        assert!((number(0, pointer) - number(1, pointer)).abs() < 1e-9, "{pointer}");
    }
    for part in ["external_nm", "passive_nm", "active_nm"] {
        let [first, second] = [0, 1].map(|frame: usize| numbers(&frames[frame]["joints"]["shoulder_r"][part]));
        assert!(first.iter().zip(&second).all(|(a, b)| (a - b).abs() < 1e-9), "{part}: {first:?} {second:?}");
    }
}

#[test]
fn moments_at_angles_zero_are_the_torques_of_the_coordinates() {
    let folder = tempfile::tempdir().unwrap();
    let zero = write(folder.path(), "zero.csv", "time,arm_add_r_deg,arm_add_l_deg\n0,0,0\n");
    let frames = json(&["torques", "adult", &zero, "--json"]);
    let joints = frames[0]["joints"].as_object().unwrap();
    assert!(joints.len() >= 5, "{:?}", joints.keys());
    for (joint, moment) in joints {
        for (k, axis) in moment["axes"].as_array().unwrap().iter().enumerate() {
            let row = &frames[0]["coordinates"][axis["name"].as_str().unwrap()];
            for part in ["external", "passive", "active"] {
                let (torque, about_axis) = (row[part].as_f64().unwrap(), numbers(&moment[&format!("{part}_nm")])[k]);
                assert!((torque - about_axis).abs() < BALANCE, "{joint}, {axis}, {part}: {torque} {about_axis}");
            }
        }
    }
}

#[test]
fn a_ball_of_a_file_has_a_moment_about_the_moved_frames_axes_and_no_load() {
    let folder = tempfile::tempdir().unwrap();
    let ball = leg(1, "shin").replace(
        r#"<joint name="hip" type="hinge" axis="0 0 1" range="-1 1"/>"#,
        "<joint name=\"hip\" type=\"ball\"/>",
    );
    let model = write(folder.path(), "ball.xml", &ball);
    // A quarter of a turn about z: the leg, 12 kg, lies level, and its moment about z is its weight times its lever arm.
    let half = 0.5f64.sqrt();
    let level =
        write(folder.path(), "level.csv", &format!("time,hip_qw,hip_qx,hip_qy,hip_qz\n0,{half:?},0,0,{half:?}\n"));
    let frame = &json(&["torques", &model, &level, "--json"])[0];
    let hip = &frame["joints"]["hip"];
    let names: Vec<&str> = hip["axes"].as_array().unwrap().iter().map(|axis| axis["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["hip_mx", "hip_my", "hip_mz"]);
    assert_eq!((&hip["passive_nm"], &hip["load"]), (&serde_json::json!([0.0, 0.0, 0.0]), &Value::Null));
    let external = numbers(&hip["external_nm"]);
    let center = numbers(&frame["center_of_mass"]);
    let expected = -12.0 * 9.81 * center[0];
    assert!(expected.abs() > 1.0 && (external[2] - expected).abs() < 1e-9, "{external:?}, {expected}");
    assert_eq!(external[2], -numbers(&hip["active_nm"])[2]);
    assert!(external[0].abs() < 1e-9 && external[1].abs() < 1e-9, "{external:?}");
}

#[test]
fn coupled_coordinates_are_folded_and_told_raw() {
    let folder = tempfile::tempdir().unwrap();
    let coupled = leg(1, "shin").replace(
        "</mujoco>",
        r#"<equality><joint joint1="shin" joint2="hip" polycoef="0.1 -2 0 0 0"/></equality></mujoco>"#,
    );
    let model = write(folder.path(), "coupled.xml", &coupled);
    let one = write(folder.path(), "one.csv", "time,hip_deg\n0,20\n");
    let frame = &json(&["torques", &model, &one, "--json", "--gradient"])[0];
    assert_eq!(frame["coordinate_order"], serde_json::json!(["hip"]));
    assert_eq!(keys(&frame["uncoupled"]), ["hip", "shin"]);
    assert_eq!(frame["gradient"].as_array().unwrap().len(), 1);
    assert_balanced(frame);
    let raw = |name: &str| frame["uncoupled"][name]["external"].as_f64().unwrap();
    let folded = frame["coordinates"]["hip"]["external"].as_f64().unwrap();
    assert!((folded - (raw("hip") - 2.0 * raw("shin"))).abs() < 1e-12);
    let follower = frame["uncoupled"]["shin"]["angle"].as_f64().unwrap();
    assert!((follower - (0.1 - 2.0 * 20f64.to_radians())).abs() < 1e-12);
}

#[test]
fn a_freed_root_has_forces_and_warns_of_its_residual() {
    let folder = tempfile::tempdir().unwrap();
    let model = write(
        folder.path(),
        "leg.xml",
        &leg(1, "shin").replace(r#"<joint name="hip" type="hinge" axis="0 0 1" range="-1 1"/>"#, ""),
    );
    let answer = run(&["torques", &model, "default", "--json", "--root", "free", "--gradient"]);
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    assert!(answer.stderr.contains("warning: nothing holds the body up"), "{}", answer.stderr);
    assert!(answer.stderr.contains("117.72 N"), "{}", answer.stderr);
    let frames: Value = serde_json::from_str(&answer.stdout).unwrap();
    let root = ["root_fx", "root_fy", "root_fz", "root_mx", "root_my", "root_mz"];
    let order: Vec<&str> = root.into_iter().chain(["shin"]).collect();
    assert_eq!(frames[0]["coordinate_order"], serde_json::json!(order));
    assert_eq!(frames[0]["gradient"].as_array().unwrap().len(), 7);
    assert_eq!(frames[0]["coordinates"]["root_fy"]["angle"], Value::Null);
    assert!((frames[0]["coordinates"]["root_fy"]["external"].as_f64().unwrap() + 12.0 * 9.81).abs() < 1e-9);
    assert_eq!(frames[0]["coordinates"]["root_fy"]["passive"], 0.0);
    let values = ["root_qw", "root_qx", "root_qy", "root_qz", "root_tx", "root_ty", "root_tz"];
    assert_eq!(keys(&frames[0]["values"]), values);
    assert_balanced(&frames[0]);
    // What is read is what is written.
    let table =
        run(&["torques", &model, "default", "--root", "free", "--out", folder.path().join("t.csv").to_str().unwrap()]);
    assert_eq!(table.code, 0, "{}", table.stderr);
    let text = std::fs::read_to_string(folder.path().join("t.csv")).unwrap();
    assert!(text.starts_with("time,root_tx.position_m,"), "{text}");
    assert!(text.contains(",root_fx.external_n,root_fx.passive_n,root_fx.active_n,"), "{text}");
    assert!(
        text.contains(",root_mz.active_nm,shin.angle_deg,shin.external_nm,shin.passive_nm,shin.active_nm"),
        "{text}"
    );
}

#[test]
fn the_ground_holds_a_free_body() {
    let folder = tempfile::tempdir().unwrap();
    let hip = r#"<joint name="hip" type="hinge" axis="0 0 1" range="-1 1"/>"#;
    let model = write(folder.path(), "leg.xml", &leg(1, "shin").replace(hip, "<freejoint name=\"root\"/>"));
    let still = "time,shin_deg\n0,0\n1,0\n";
    let still = write(folder.path(), "still.csv", still);
    // Its weight of 117.72 N at 2 s, nothing at 0 s: half of it at 1 s. The leg hangs straight below (0, 1, 0).
    let head = "name forces\nversion=1\nnRows=2\nnColumns=7\ninDegrees=no\nendheader\n";
    let labels =
        "time\tground_force_vx\tground_force_vy\tground_force_vz\tground_force_px\tground_force_py\tground_force_pz\n";
    let rows = "0\t0\t0\t0\t0.1\t0\t0\n2\t0\t117.72\t0\t0.1\t0\t0\n";
    let forces = write(folder.path(), "forces.mot", &format!("{head}{labels}{rows}"));
    let frames = json(&["torques", &model, &still, "--grf", &forces, "--grf-on", "shank", "--json"]);
    let external = |frame: usize, name: &str| frames[frame]["coordinates"][name]["external"].as_f64().unwrap();
    assert!((external(0, "root_fy") + 117.72).abs() < 1e-9);
    assert!((external(1, "root_fy") + 58.86).abs() < 1e-9);
    // 58.86 N at 0.1 m before the axes of root and shin, both about z.
    assert!((external(1, "root_mz") - 5.886).abs() < 1e-9, "{}", external(1, "root_mz"));
    assert!((external(1, "shin") - 5.886).abs() < 1e-9);
    let late = write(folder.path(), "late.csv", "time,shin_deg\n0,0\n3,0\n");
    let message = run(&["torques", &model, &late, "--grf", &forces, "--grf-on", "shank"]).stderr;
    assert!(message.contains("1 of 2 instants are left out") && message.contains("from 0 s to 2 s"), "{message}");
    let message = refused(&["torques", &model, &still, "--grf", &forces]);
    assert!(message.contains("--grf-on"), "{message}");
    let message = refused(&["torques", &model, &still, "--grf", &forces, "--grf-on", "shanc"]);
    assert!(message.contains("did you mean `shank`"), "{message}");
    let message = refused(&["torques", &model, &still, "--grf", &still, "--grf-on", "shank"]);
    assert!(message.contains("ground_force_vx"), "{message}");
}

#[test]
fn an_overlay_is_laid_over_and_library_signs_are_verified() {
    let folder = tempfile::tempdir().unwrap();
    let passive_at = |degrees: i32, model: &str, more: &[&str]| {
        let bent = write(folder.path(), "bent.csv", &format!("time,elbow_flex_r_deg\n0,{degrees}\n"));
        let arguments: Vec<&str> = ["torques", model, &bent, "--json"].iter().chain(more).copied().collect();
        let answer = run(&arguments);
        assert_eq!(answer.code, 0, "{}", answer.stderr);
        let frames: Value = serde_json::from_str(&answer.stdout).unwrap();
        (frames[0]["coordinates"]["elbow_flex_r"]["passive"].as_f64().unwrap(), answer.stderr)
    };
    let passive = |model: &str, more: &[&str]| passive_at(100, model, more);
    // The adult's elbow turns about +z; a model's that turns about -z has its curve the other way round.
    let same = write(folder.path(), "same.xml", &leg(1, "elbow_flex_r"));
    let against = write(folder.path(), "against.xml", &leg(-1, "elbow_flex_r"));
    let (forward, message) = passive(&same, &[]);
    assert!(message.contains("`elbow_flex_r`: passive torque and strength from the built-in data"), "{message}");
    assert!(forward < 0.0);
    let (backward, message) = passive_at(-100, &against, &[]);
    assert!((backward + forward).abs() < 1e-12);
    assert!(message.contains("turned round: flexion is negative here"), "{message}");
    assert_eq!(passive(&same, &["--passive", "file"]).0, 0.0);
    // Across the expected axis, or with gravity along z: not applied, and said.
    let across = write(
        folder.path(),
        "across.xml",
        &leg(1, "elbow_flex_r").replace(r#"axis="0 0 1" range="-2"#, r#"axis="1 0 0" range="-2"#),
    );
    let (none, message) = passive(&across, &[]);
    assert!(none == 0.0 && message.contains("stands at 90 deg to the expected one"), "{message}");
    let z_up = write(folder.path(), "z_up.xml", &leg(1, "elbow_flex_r").replace("0 -9.81 0", "0 0 -9.81"));
    let (none, message) = passive(&z_up, &[]);
    assert!(none == 0.0 && message.contains("gravity does not act along -y"), "{message}");

    let text = "[coordinates.elbow_flex_r]\nrange_deg = [-140, 10]\nstrength = { positive_nm = 70, negative_nm = 50 }\n\
                fatigue = \"elbow\"\npassive = { curve = \"elbow_flexion\", sign = -1 }\n";
    let overlay = write(folder.path(), "overlay.toml", text);
    let (laid, message) = passive_at(-100, &same, &["--overlay", &overlay]);
    assert!(message.contains("range -140 .. 10 deg") && message.contains("with flexion negative"), "{message}");
    assert!((laid + forward).abs() < 1e-12, "{laid}");
    for (text, part) in [
        ("[coordinates.elbow_flex_l]\nrange_deg = [0, 1]\n", "did you mean `elbow_flex_r`"),
        ("[coordinates.elbow_flex_r]\nrange_dge = [0, 1]\n", "did you mean `range_deg`"),
        ("[coordinates.elbow_flex_r]\nrange_m = [0, 1]\n", "give range_deg"),
        ("[coordinates.elbow_flex_r]\nrange_deg = [1, 0]\n", "is empty"),
        ("[coordinates.elbow_flex_r]\nfatigue = \"elbow\"\n", "no muscle groups yet"),
        ("[coordinates.elbow_flex_r]\npassive = { curve = \"elbow_flexon\" }\n", "did you mean `elbow_flexion`"),
        ("[coordinates.elbow_flex_r]\npassive = { curve = \"elbow_flexion\", sign = 2 }\n", "sign is 2"),
        ("[coordinates.elbow_flex_r]\npassive = { curve = \"elbow_flexion\", sign = -1 }\n", "run the other way"),
        ("[coordinates.elbow_flex_r]\n", "nothing is laid over"),
    ] {
        let file = write(folder.path(), "bad.toml", text);
        let message = refused(&["inspect", &same, "--overlay", &file]);
        assert!(message.contains(part) && message.contains("bad.toml:"), "{text}: {message}");
    }
}

#[test]
fn arguments_without_sense_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let model = write(folder.path(), "leg.xml", &leg(1, "shin"));
    let unnamed = write(folder.path(), "unnamed.csv", "time,shin\n0,1\n");
    let out = folder.path().join("out.txt");
    let out = out.to_str().unwrap();
    for (arguments, part) in [
        (vec!["torques", "adult", "default", "--load", "han_r 3kg"], "did you mean `hand_r`"),
        (vec!["torques", "adult", "default", "--load", "hand_r 3"], "hand_r 3kg"),
        (vec!["torques", "adult", "default", "--force", "hand_r 0,-20"], "FX,FY,FZ"),
        (vec!["torques", "adult:woman,1.65m,60kg", "default"], "adult:female,1.65m,60kg"),
        (vec!["torques", "adult:female,1.65m,600kg", "default"], "30..250"),
        (vec!["torques", "adult", "default", "--root", "free"], "URDF and MJCF"),
        (vec!["torques", "nowhere.osim", "default"], "nowhere.osim"),
        (vec!["torques", &model, "nowhere.mot"], "or `default`"),
        (vec!["torques", &model, &unnamed], "--degrees"),
        (vec!["torques", &model, "default", "--out", out], ".csv, .sto, .mot or .json"),
        (vec!["torques", &model, "default", "--grf-on", "shank"], "--grf"),
        (vec!["torques", &model, "default", "--degrees", "--radians"], "--radians"),
        (vec!["torques", &unnamed, "default"], "unnamed.csv"),
    ] {
        let message = refused(&arguments);
        assert!(message.contains(part), "{arguments:?}: {message}");
    }
    assert!(!folder.path().join("out.txt").exists());
}

#[test]
fn tables_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let model = write(folder.path(), "leg.xml", &leg(1, "shin"));
    let two = write(folder.path(), "two.csv", "time,hip,shin\n0,0.1,0.2\n0.5,-0.1,0\n");
    let csv = run(&["torques", &model, &two, "--radians"]);
    assert_eq!(csv.code, 0, "{}", csv.stderr);
    let lines: Vec<&str> = csv.stdout.lines().collect();
    assert_eq!(lines.len(), 3);
    let head = "time,hip.angle_deg,hip.external_nm,hip.passive_nm,hip.active_nm,shin.angle_deg,shin.external_nm,shin.passive_nm,shin.active_nm";
    assert_eq!(lines[0], head);
    let sto = folder.path().join("t.sto");
    let answer = run(&["torques", &model, &two, "--radians", "--gradient", "--out", sto.to_str().unwrap()]);
    assert!(answer.code == 0 && answer.stdout.contains("2 instants in"), "{}{}", answer.stdout, answer.stderr);
    // The postures in it are the postures that went in.
    let again = json(&["torques", &model, sto.to_str().unwrap(), "--json"]);
    let angle = again[0]["coordinates"]["shin"]["angle"].as_f64().unwrap();
    assert!((angle - 0.2).abs() < 1e-15, "{angle}");
    let readable = run(&["torques", &model, "default"]);
    assert!(readable.stdout.contains("centre of mass"), "{}", readable.stdout);
}

/// Greatest difference from OpenSim's inverse dynamics at rest, N m.
fn opensim(vectors_file: &str, model: &str) {
    let (vectors, model) = (vectors(vectors_file), shared(model));
    let folder = tempfile::tempdir().unwrap();
    let names: Vec<&str> = vectors["coordinates"].as_array().unwrap().iter().map(|x| x.as_str().unwrap()).collect();
    let cases = vectors["cases"].as_array().unwrap();
    let mut text =
        format!("cases\nversion=1\nnRows={}\nnColumns={}\ninDegrees=no\nendheader\ntime", cases.len(), names.len() + 1);
    names.iter().for_each(|name| text.push_str(&format!("\t{name}")));
    for (time, case) in cases.iter().enumerate() {
        text.push_str(&format!("\n{time}"));
        names.iter().for_each(|name| text.push_str(&format!("\t{:?}", case["q"][name].as_f64().unwrap())));
    }
    let motion = write(folder.path(), "cases.mot", &(text + "\n"));
    let frames = json(&["torques", model.to_str().unwrap(), &motion, "--json"]);
    assert_eq!(frames.as_array().unwrap().len(), cases.len());
    let (mut worst, mut mass) = (0f64, 0f64);
    for (frame, case) in frames.as_array().unwrap().iter().zip(cases) {
        assert_balanced(frame);
        for name in &names {
            let raw = if frame["uncoupled"][name].is_null() { &frame["coordinates"] } else { &frame["uncoupled"] };
            let ours = -raw[name]["external"].as_f64().unwrap();
            worst = worst.max((ours - case["tau_id"][name].as_f64().unwrap()).abs());
        }
        for (ours, theirs) in numbers(&frame["center_of_mass"]).iter().zip(numbers(&case["com"])) {
            mass = mass.max((ours - theirs).abs());
        }
    }
    assert!(worst < 1e-6 && mass < 1e-9, "torque {worst:.1e} N m, centre of mass {mass:.1e} m");
}

#[test]
#[ignore = "needs ../shared: published models with torques by OpenSim"]
fn opensim_gait2392() {
    opensim("vectors/opensim_gait2392_first5.json", "models/opensim/gait2392_thelen2003muscle.osim");
}

#[test]
#[ignore = "needs ../shared: published models with torques by OpenSim"]
fn opensim_arm26() {
    opensim("vectors/opensim_arm26.json", "models/opensim/arm26.osim");
}

#[test]
#[ignore = "needs ../shared: published models with torques by Pinocchio"]
fn pinocchio_human48() {
    let vectors = vectors("vectors/pinocchio_human48_fixed_first5.json");
    let model = shared("models/human-gazebo/humanSubject01_48dof.urdf");
    let folder = tempfile::tempdir().unwrap();
    let names: Vec<&str> =
        vectors["joint_names"].as_array().unwrap().iter().skip(1).map(|x| x.as_str().unwrap()).collect();
    let cases = vectors["cases"].as_array().unwrap();
    let mut text = format!("time,{}\n", names.join(","));
    for (time, case) in cases.iter().enumerate() {
        let row: Vec<String> = numbers(&case["q"]).iter().map(|q| format!("{q:?}")).collect();
        text.push_str(&format!("{time},{}\n", row.join(",")));
    }
    let motion = write(folder.path(), "cases.csv", &text);
    let frames = json(&["torques", model.to_str().unwrap(), &motion, "--radians", "--json", "--gradient"]);
    let (mut worst, mut slope) = (0f64, 0f64);
    for (frame, case) in frames.as_array().unwrap().iter().zip(cases) {
        assert_balanced(frame);
        let order: Vec<&str> =
            frame["coordinate_order"].as_array().unwrap().iter().map(|x| x.as_str().unwrap()).collect();
        let place = |name: &str| order.iter().position(|other| *other == name).unwrap();
        let gradient: Vec<Vec<f64>> = frame["gradient"].as_array().unwrap().iter().map(numbers).collect();
        for (i, name) in names.iter().enumerate() {
            let ours = -frame["coordinates"][*name]["external"].as_f64().unwrap();
            worst = worst.max((ours - numbers(&case["g"])[i]).abs());
            for (j, other) in names.iter().enumerate() {
                let theirs = numbers(&case["dg_dq"][i])[j];
                slope = slope.max((-gradient[place(name)][place(other)] - theirs).abs());
            }
        }
    }
    assert!(worst < 1e-9 && slope < 1e-9, "torque {worst:.1e} N m, gradient {slope:.1e} N m/rad");
}
