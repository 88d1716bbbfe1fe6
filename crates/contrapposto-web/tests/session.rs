//! Sessions of the studio, natively: requests in, answers out.

#![allow(clippy::unwrap_used, reason = "tests")]

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Sex, adult};
use contrapposto::posture::Posture;
use contrapposto_formats::RelaxScenario;
use contrapposto_web::Studio;
use serde_json::{Value, json};

/// A bar on a hinge with a motor.
const ARM: &str = r#"<robot name="arm"><link name="base"/><link name="bar"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="hinge" type="revolute"><parent link="base"/>
<child link="bar"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="20" velocity="1"/></joint></robot>"#;

fn ask(studio: &mut Studio, request: Value) -> Value {
    let answer: Value = serde_json::from_str(&studio.call(&request.to_string())).unwrap();
    assert_ne!(answer["is"], "refused", "{request}: {}", answer["sentence"]);
    answer
}

fn refused(studio: &mut Studio, request: Value) -> String {
    let answer: Value = serde_json::from_str(&studio.call(&request.to_string())).unwrap();
    assert_eq!(answer["is"], "refused", "{request}");
    answer["sentence"].as_str().unwrap().to_owned()
}

fn scenario(name: &str) -> String {
    std::fs::read_to_string(format!("{}/../../scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The place of a point of a segment, ground, m.
fn place(scene: &Value, shown: &Value, handle: &Value) -> [f64; 3] {
    let segments = scene["segments"].as_array().unwrap();
    let s = segments.iter().position(|segment| segment["name"] == handle["segment"]).unwrap();
    let n: Vec<f64> = shown["places"][s].as_array().unwrap().iter().map(number).collect();
    let turn = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(n[6], n[3], n[4], n[5]));
    let point: Vec<f64> = handle["point"].as_array().unwrap().iter().map(number).collect();
    let at = turn * nalgebra::Vector3::new(point[0], point[1], point[2]);
    [n[0] + at.x, n[1] + at.y, n[2] + at.z]
}

fn handle(scene: &Value, label: &str) -> Value {
    scene["handles"].as_array().unwrap().iter().find(|handle| handle["label"] == label).unwrap().clone()
}

/// Drags a point by `way` in `steps` steps, then some more; gives the scene and the last answer.
fn drag(studio: &mut Studio, label: &str, way: [f64; 3], steps: usize) -> (Value, Value) {
    let scene = ask(studio, json!({ "do": "open", "scenario": "" }));
    let handle = handle(&scene, label);
    let from = place(&scene, &scene["shown"], &handle);
    ask(studio, json!({ "do": "grab", "segment": handle["segment"], "point": handle["point"] }));
    let mut last = Value::Null;
    for step in 1..=steps + 20 {
        let share = (step as f64 / steps as f64).min(1.0);
        let target = [0, 1, 2].map(|k| from[k] + share * way[k]);
        last = ask(studio, json!({ "do": "drag", "target": target }));
    }
    (scene, last)
}

#[test]
fn a_dragged_hand_follows_and_the_feet_stay() {
    let mut studio = Studio::new();
    let (scene, last) = drag(&mut studio, "right hand", [0.25, 0.35, 0.05], 40);
    assert!(number(&last["miss"]) < 0.002, "{}", last["miss"]);
    let patches = |shown: &Value| -> Vec<f64> {
        shown["patches"]
            .as_array()
            .unwrap()
            .iter()
            .flat_map(|p| p.as_array().unwrap().clone())
            .map(|x| number(&x))
            .collect()
    };
    let slip = patches(&scene["shown"]).iter().zip(patches(&last)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(slip < 1e-3, "the feet slid by {slip} m");
    let sentence = last["verdict"]["sentence"].as_str().unwrap();
    assert!(["holds", "held_until"].contains(&last["verdict"]["kind"].as_str().unwrap()), "{sentence}");
}

#[test]
fn a_hand_dragged_out_of_reach_leaves_the_body_in_balance() {
    let mut studio = Studio::new();
    let (_, last) = drag(&mut studio, "right hand", [3.0, 1.0, 0.0], 60);
    assert!(number(&last["miss"]) > 1.0);
    let shares: f64 = last["contacts"].as_array().unwrap().iter().map(|contact| number(&contact["share"])).sum();
    assert!((shares - 1.0).abs() < 1e-6, "{shares}");
}

#[test]
fn five_kilograms_on_a_hand_change_the_torques_and_are_undone() {
    let mut studio = Studio::new();
    let before = ask(&mut studio, json!({ "do": "open", "scenario": "" }));
    let loaded = ask(&mut studio, json!({ "do": "load", "segment": "hand_r", "mass": 5.0 }));
    let names: Vec<&str> =
        before["coordinates"].as_array().unwrap().iter().map(|c| c["name"].as_str().unwrap()).collect();
    let shoulder = names.iter().position(|name| name.starts_with("arm_flex_r")).unwrap();
    let of = |scene: &Value| number(&scene["shown"]["external"][shoulder]);
    assert_eq!(loaded["loads"][0], json!({ "segment": "hand_r", "mass": 5.0 }));
    assert_ne!(of(&before), of(&loaded));
    let undone = ask(&mut studio, json!({ "do": "undo" }));
    assert_eq!(before["shown"]["external"], undone["shown"]["external"]);
    let redone = ask(&mut studio, json!({ "do": "redo" }));
    assert_eq!(loaded["shown"]["external"], redone["shown"]["external"]);
}

#[test]
fn an_exported_posture_is_read_as_the_one_that_was_shown() {
    let mut studio = Studio::new();
    drag(&mut studio, "left hand", [0.2, 0.3, -0.1], 30);
    let released = ask(&mut studio, json!({ "do": "release", "hold": true }));
    assert_eq!(released["held"][0]["label"], "left hand");
    let mut shown = Value::Null;
    for _ in 0..50 {
        shown = ask(&mut studio, json!({ "do": "settle" }));
    }
    let text = exported(&mut studio);
    let opened = ask(&mut Studio::new(), json!({ "do": "open", "scenario": text }));
    for key in ["q", "active"] {
        let (a, b) = (&shown[key], &opened["shown"][key]);
        let far = a.as_array().unwrap().iter().zip(b.as_array().unwrap()).map(|(a, b)| (number(a) - number(b)).abs());
        let far = far.fold(0.0, f64::max);
        assert!(far < 1e-6, "{key}: {far}");
    }
    assert_eq!(shown["verdict"]["kind"], opened["shown"]["verdict"]["kind"]);
}

#[test]
fn time_runs_until_the_tired_hip_asks() {
    let mut studio = Studio::new();
    ask(&mut studio, json!({ "do": "open", "scenario": scenario("stand-relaxed") }));
    let mut asked = vec![];
    for _ in 0..40 {
        let played = ask(&mut studio, json!({ "do": "play", "samples": 30 }));
        asked.extend(played["asking"].as_array().unwrap().iter().map(|who| who.as_str().unwrap().to_owned()));
        if !asked.is_empty() {
            assert!(!played["log"].as_array().unwrap().is_empty());
            break;
        }
    }
    assert!(asked.iter().any(|who| who.contains("hip")), "{asked:?}");
}

#[test]
fn a_broken_scenario_is_refused_with_its_place_and_nothing_changes() {
    let mut studio = Studio::new();
    let before = ask(&mut studio, json!({ "do": "open", "scenario": "" }));
    let sentence = refused(&mut studio, json!({ "do": "open", "scenario": "format = 1\n[model]\nadult = 3\n" }));
    assert!(sentence.contains("line 3"), "{sentence}");
    for text in ["format = ", "\u{0}", "[[[", "format = 2"] {
        refused(&mut studio, json!({ "do": "open", "scenario": text }));
    }
    refused(&mut studio, json!({ "do": "adult", "sex": "male", "stature": 0.2, "mass": 70.0 }));
    refused(&mut studio, json!({ "do": "open_model", "name": "body.osim", "text": "<html>" }));
    refused(&mut studio, json!({ "do": "grab", "segment": "tail", "point": [0, 0, 0] }));
    refused(&mut studio, json!({ "do": "drag", "target": [0, 0, 0] }));
    refused(&mut studio, json!({ "do": "dance" }));
    let after = ask(&mut studio, json!({ "do": "free", "segment": "hand_r" }));
    assert_eq!(before["shown"]["q"], after["shown"]["q"]);
}

#[test]
fn the_torques_of_a_joint_meet_at_its_posture() {
    let mut studio = Studio::new();
    let scene = ask(&mut studio, json!({ "do": "open", "scenario": scenario("figure-08") }));
    let coordinates = scene["coordinates"].as_array().unwrap();
    let elbow = coordinates.iter().position(|c| c["name"] == "elbow_flex_r").unwrap();
    let curve = ask(&mut studio, json!({ "do": "balance", "coordinate": "elbow_flex_r" }));
    let (angle, now) = (&curve["angle"], number(&scene["shown"]["angles"][elbow]));
    let after = (1..91).find(|k| number(&angle[k]) >= now).unwrap();
    let share = (now - number(&angle[after - 1])) / (number(&angle[after]) - number(&angle[after - 1]));
    for (key, sign, shown) in [("external", 1.0, "external"), ("minus_passive", -1.0, "passive")] {
        let on_curve = (1.0 - share) * number(&curve[key][after - 1]) + share * number(&curve[key][after]);
        let shown = number(&scene["shown"][shown][elbow]);
        assert!((sign * on_curve - shown).abs() < 0.05, "{key}: {on_curve} {shown}");
    }
}

/// The file of a session.
fn exported(studio: &mut Studio) -> String {
    ask(studio, json!({ "do": "export" }))["text"].as_str().unwrap().to_owned()
}

fn settled(studio: &mut Studio, steps: usize) -> Value {
    (0..steps).map(|_| ask(studio, json!({ "do": "settle" }))).last().unwrap()
}

#[test]
fn undo_brings_back_the_posture_that_was_shown_and_redo_the_next_one() {
    let mut studio = Studio::new();
    ask(&mut studio, json!({ "do": "open", "scenario": "" }));
    let before = settled(&mut studio, 20);
    ask(&mut studio, json!({ "do": "load", "segment": "hand_r", "mass": 5.0 }));
    let after = settled(&mut studio, 20);
    assert_ne!(before["q"], after["q"]);
    let undone = ask(&mut studio, json!({ "do": "undo" }));
    assert_eq!(before["q"], undone["shown"]["q"]);
    let redone = ask(&mut studio, json!({ "do": "redo" }));
    assert_eq!(after["q"], redone["shown"]["q"]);
}

#[test]
fn a_grab_without_a_motion_changes_nothing() {
    let mut studio = Studio::new();
    ask(&mut studio, json!({ "do": "open", "scenario": "" }));
    ask(&mut studio, json!({ "do": "load", "segment": "hand_r", "mass": 5.0 }));
    ask(&mut studio, json!({ "do": "undo" }));
    ask(&mut studio, json!({ "do": "grab", "segment": "hand_l", "point": [0, 0, 0] }));
    let released = ask(&mut studio, json!({ "do": "release", "hold": false }));
    assert_eq!((&released["can_undo"], &released["can_redo"]), (&json!(false), &json!(true)));
    let redone = ask(&mut studio, json!({ "do": "redo" }));
    assert_eq!(redone["loads"][0]["mass"], 5.0);
}

#[test]
fn a_drag_is_one_change() {
    let mut studio = Studio::new();
    let (scene, last) = drag(&mut studio, "left hand", [0.1, 0.2, 0.0], 10);
    let released = ask(&mut studio, json!({ "do": "release", "hold": true }));
    assert_ne!(scene["shown"]["q"], last["q"]);
    assert_eq!(released["can_undo"], true);
    let undone = ask(&mut studio, json!({ "do": "undo" }));
    assert_eq!((&undone["can_undo"], &undone["held"]), (&json!(false), &json!([])));
    assert_eq!(scene["shown"]["q"], undone["shown"]["q"]);
}

#[test]
fn refused_requests_leave_a_run_a_grab_and_the_history_as_they_are() {
    let mut studio = Studio::new();
    ask(&mut studio, json!({ "do": "open", "scenario": scenario("stand-relaxed") }));
    ask(&mut studio, json!({ "do": "load", "segment": "hand_r", "mass": 2.0 }));
    let before = exported(&mut studio);
    let first = ask(&mut studio, json!({ "do": "play", "samples": 30 }));
    for request in [
        json!({ "do": "open", "scenario": "format = 1\n[run]\nduration_s = 1\nstep_s = 0.1\n" }),
        json!({ "do": "open_model", "name": "body.osim", "text": "<html>" }),
        json!({ "do": "load", "segment": "hand_r", "mass": -1e300 }),
        json!({ "do": "strategy", "kind": "lazy" }),
        json!({ "do": "adult", "sex": "male", "stature": 9.0, "mass": 70.0 }),
        json!({ "do": "grab", "segment": "hand_r", "point": [0, 0, 0] }),
        json!({ "do": "settle" }),
        json!({ "do": "redo" }),
    ] {
        refused(&mut studio, request);
    }
    let second = ask(&mut studio, json!({ "do": "play", "samples": 30 }));
    assert!(number(&second["time"]) > number(&first["time"]), "the run began anew");
    ask(&mut studio, json!({ "do": "stop", "take": false }));
    assert_eq!(before, exported(&mut studio));

    ask(&mut studio, json!({ "do": "grab", "segment": "hand_l", "point": [0, 0, 0] }));
    for request in [
        json!({ "do": "load", "segment": "hand_r", "mass": 1.0 }),
        json!({ "do": "undo" }),
        json!({ "do": "play", "samples": 2 }),
        json!({ "do": "grab", "segment": "hand_r", "point": [0, 0, 0] }),
    ] {
        refused(&mut studio, request);
    }
    ask(&mut studio, json!({ "do": "drag", "target": [0.3, 1.0, -0.2] }));
    ask(&mut studio, json!({ "do": "release", "hold": false }));
}

#[test]
fn a_held_point_does_not_change_which_task_an_event_names() {
    let text = format!("{}\n[[event]]\nat_s = 2\ntask = 1\ntarget_m = [0.05, 0, 0]\n", scenario_with_a_task());
    let mut studio = Studio::new();
    ask(&mut studio, json!({ "do": "open", "scenario": text }));
    ask(&mut studio, json!({ "do": "grab", "segment": "hand_l", "point": [0, 0, 0] }));
    ask(&mut studio, json!({ "do": "release", "hold": true }));
    let saved = saved(&mut studio);
    let (tasks, event) = (saved["task"].as_array().unwrap(), &saved["event"][0]);
    let named = &tasks[event["task"].as_integer().unwrap() as usize - 1];
    assert_eq!(tasks.len(), 3);
    assert_eq!(named["kind"].as_str(), Some("center_of_mass"));
    ask(&mut studio, json!({ "do": "play", "samples": 30 }));
}

/// A body that keeps its centre of mass, then saves effort.
fn scenario_with_a_task() -> String {
    "format = 1\n[floor]\n[strategy]\nkind = \"passive\"\n[run]\nduration_s = 10\nstep_s = 0.1\n[[task]]\nkind = \"center_of_mass\"\n\
     axes = \"xz\"\ntarget_m = [0.03, 0, 0]\n[[task]]\nkind = \"effort\"\n"
        .to_owned()
}

fn saved(studio: &mut Studio) -> toml::Table {
    exported(studio).parse().unwrap()
}

#[test]
fn the_saved_scenario_of_a_run_has_no_event_after_its_end() {
    let text = format!("{}\n[[event]]\nat_s = 5\nstrategy = \"active\"\n", scenario_with_a_task());
    let mut studio = Studio::new();
    ask(&mut studio, json!({ "do": "open", "scenario": text }));
    let played = ask(&mut studio, json!({ "do": "play", "samples": 21 }));
    assert_eq!(number(&played["time"]), 2.0);
    let text = exported(&mut studio);
    let mut again = Studio::new();
    ask(&mut again, json!({ "do": "open", "scenario": text }));
    let replayed = ask(&mut again, json!({ "do": "play", "samples": 30 }));
    assert_eq!(replayed["ended"], "duration");
    assert_eq!(played["shown"]["q"], replayed["shown"]["q"]);
}

#[test]
fn a_posture_that_is_kept_begins_after_the_events_that_have_happened() {
    let events = "[[event]]\nat_s = 1\nstrategy = \"active\"\nload = [{ segment = \"hand_r\", mass_kg = 3 }]\n\
                  [[event]]\nat_s = 1.5\ntask = 1\ntarget_m = [0.05, 0, 0]\n\
                  [[event]]\nat_s = 1.5\nstrategy_of = { legs = \"passive\" }\n\
                  [[event]]\nat_s = 5\nload = []\n";
    let mut studio = Studio::new();
    ask(&mut studio, json!({ "do": "open", "scenario": format!("{}{events}", scenario_with_a_task()) }));
    let played = ask(&mut studio, json!({ "do": "play", "samples": 21 }));
    assert_eq!(played["shown"]["pushes"].as_array().unwrap().len(), 1);
    let kept = ask(&mut studio, json!({ "do": "stop", "take": true }));
    assert_eq!(kept["loads"], json!([{ "segment": "hand_r", "mass": 3.0 }]));
    let saved = saved(&mut studio);
    assert_eq!(saved["task"][0]["target_m"], toml::from_str::<toml::Table>("a = [0.05, 0, 0]").unwrap()["a"]);
    let events = saved["event"].as_array().unwrap();
    assert_eq!((events.len(), events[0]["at_s"].as_float()), (1, Some(3.0)));
    let of = |name: &str| saved["strategy"]["of"].get(name).unwrap_or(&saved["strategy"]["kind"]).as_str().unwrap();
    assert_eq!((of("elbow_flex_r"), of("knee_angle_r")), ("active", "passive"));
    ask(&mut studio, json!({ "do": "play", "samples": 21 }));
}

#[test]
fn a_hand_on_a_thing_is_not_dragged_and_a_dragged_point_comes_after_it() {
    let text = "format = 1\n[model]\nadult = { sex = \"female\", stature_m = 1.65, mass_kg = 60 }\n[[box]]\nmass_kg = 4\n\
                at_m = [0.35, 1.0, 0]\nsize_m = [0.3, 0.25, 0.35]\n";
    let mut studio = Studio::new();
    let scene = ask(&mut studio, json!({ "do": "open", "scenario": text }));
    let sentence = refused(&mut studio, json!({ "do": "grab", "segment": "hand_r", "point": [0, 0, 0] }));
    assert!(sentence.contains("holds the box"), "{sentence}");
    let handle = handle(&scene, "pelvis");
    let hand = json!({ "segment": "hand_r", "point": [0.0, -0.04 * 1.65, 0.0] });
    let (from, before) = (place(&scene, &scene["shown"], &handle), place(&scene, &scene["shown"], &hand));
    ask(&mut studio, json!({ "do": "grab", "segment": handle["segment"], "point": handle["point"] }));
    let mut last = Value::Null;
    for _ in 0..60 {
        last = ask(&mut studio, json!({ "do": "drag", "target": [from[0] - 0.4, from[1], from[2]] }));
    }
    let after = place(&scene, &last, &hand);
    let way = (0..3).map(|k| (after[k] - before[k]).powi(2)).sum::<f64>().sqrt();
    assert!(way < 0.01, "the hand left the box by {way} m");
}

#[test]
fn another_session_takes_over_a_state_with_its_held_points_events_and_files() {
    let text = format!("{}\n[[event]]\nat_s = 2\ntask = 1\ntarget_m = [0.05, 0, 0]\n", scenario_with_a_task());
    let mut studio = Studio::new();
    ask(&mut studio, json!({ "do": "open", "scenario": text, "files": { "notes.txt": "\"a\"\n\u{1}" } }));
    ask(&mut studio, json!({ "do": "grab", "segment": "hand_l", "point": [0, 0, 0] }));
    ask(&mut studio, json!({ "do": "release", "hold": true }));
    ask(&mut studio, json!({ "do": "load", "segment": "hand_r", "mass": 5.0 }));
    let shown = settled(&mut studio, 5);
    let state = ask(&mut studio, json!({ "do": "state" }))["text"].clone();

    let mut other = Studio::new();
    ask(&mut other, json!({ "do": "open", "scenario": text }));
    let scene = ask(&mut other, json!({ "do": "restore", "state": state }));
    assert_eq!(scene["shown"]["q"], shown["q"]);
    assert_eq!((&scene["held"][0]["segment"], &scene["loads"][0]["mass"]), (&json!("hand_l"), &json!(5.0)));
    assert_eq!(ask(&mut other, json!({ "do": "state" }))["text"], state);
    assert_eq!(exported(&mut other), exported(&mut studio));
    ask(&mut other, json!({ "do": "free", "segment": "hand_l" }));
    ask(&mut other, json!({ "do": "undo" }));
    ask(&mut other, json!({ "do": "undo" }));
    refused(&mut other, json!({ "do": "restore", "state": "table = 3" }));
}

/// Drags a hand of adults of several sizes through 20 places: a bone of the skin is where the joint of its segment is, by the model.
#[test]
fn bones_of_the_skin_are_at_the_joint_centres_in_every_posture() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../contrapposto-formats/data/skin/adult.skin");
    let mut studio = Studio::new();
    assert_eq!(refused(&mut studio, json!({ "do": "skin" })), "the skin has not been loaded");
    studio.take_skin(std::fs::read(file).unwrap());
    let (mut postures, mut farthest) = (0, 0.0_f64);
    for (sex, stature, mass) in [("female", 1.5, 45.0), ("male", 1.95, 110.0)] {
        let scene = ask(&mut studio, json!({ "do": "adult", "sex": sex, "stature": stature, "mass": mass }));
        let answer = ask(&mut studio, json!({ "do": "skin" }));
        let skin = &answer["skin"];
        let count = |key: &str| skin[key].as_array().unwrap().len();
        assert_eq!((count("vertices"), count("heads"), count("segments")), (count("light"), 41, 41));
        let heights = skin["vertices"].as_array().unwrap().iter().map(|vertex| number(&vertex[1]));
        let tall = heights.clone().fold(0.0, f64::max) - heights.fold(f64::INFINITY, f64::min);
        assert!((tall - stature).abs() < 0.03 * stature, "{tall} m for {stature} m");
        let sex = if sex == "male" { Sex::Male } else { Sex::Female };
        let model = adult(&Adult { sex, stature, mass, ..Adult::default() }).unwrap();
        let hand = handle(&scene, "right hand");
        ask(&mut studio, json!({ "do": "grab", "segment": hand["segment"], "point": hand["point"] }));
        for k in 0..10 {
            let turn = f64::from(k) * 0.7;
            let target = [0.3 + 0.2 * libm::sin(turn), 1.1 + 0.4 * libm::cos(turn), 0.2];
            let mut shown = Value::Null;
            (0..8).for_each(|_| shown = ask(&mut studio, json!({ "do": "drag", "target": target })));
            let q: Vec<f64> = shown["q"].as_array().unwrap().iter().map(number).collect();
            let mut kinematics = Kinematics::new(&model);
            kinematics.update(&model, &Posture::new(q)).unwrap();
            for (bone, segment) in shown["bones"].as_array().unwrap().iter().zip(skin["segments"].as_array().unwrap()) {
                let segment = segment.as_u64().unwrap() as usize;
                let center =
                    kinematics.station(&model, segment, model.segments()[segment].in_segment.translation.vector);
                let at = nalgebra::Vector3::new(number(&bone[0]), number(&bone[1]), number(&bone[2]));
                farthest = farthest.max((at - center).norm());
            }
            postures += 1;
        }
        ask(&mut studio, json!({ "do": "release", "hold": false }));
    }
    assert!(postures == 20 && farthest < 1e-9, "{farthest} m in {postures} postures");
    let scene = ask(&mut studio, json!({ "do": "open_model", "name": "arm.urdf", "text": ARM }));
    assert_eq!(scene["shown"]["bones"], json!([]));
    assert_eq!(ask(&mut studio, json!({ "do": "skin" }))["skin"], Value::Null);
}

#[test]
fn ways_to_rest_are_those_of_relax_and_one_goes_there_and_back() {
    let mut studio = Studio::new();
    let scenario = scenario("stand-relaxed-feet-fixed");
    ask(&mut studio, json!({ "do": "open", "scenario": scenario }));
    let (mut told, mut last) = (0, 0);
    let answer = studio.call_watched(r#"{ "do": "relax" }"#, &mut |sought| {
        assert_eq!(sought, last + 1);
        (told, last) = (told + 1, sought);
    });
    let answer: Value = serde_json::from_str(&answer).unwrap();
    assert!(told > 20, "{told}: {answer}");
    let ways = answer["ways"].as_array().unwrap();
    let efforts: Vec<f64> = ways.iter().map(|way| number(&way["effort"])).collect();
    // The same scenario, searched by the library as the program does.
    let read = contrapposto_formats::read_relax("stand-relaxed-feet-fixed.toml", scenario.as_bytes(), None).unwrap();
    let found = contrapposto::equilibria::equilibria(&read.search(), RelaxScenario::OPTIONS).unwrap();
    assert_eq!(efforts, found.postures.iter().map(|posture| posture.relaxed.effort).collect::<Vec<_>>());
    assert!(efforts.len() > 1 && efforts.is_sorted(), "{efforts:?}");
    assert!(ways.iter().any(|way| {
        way["on_ligaments"].as_array().unwrap().iter().any(|joint| joint.as_str().unwrap().contains("hip"))
    }));
    let standing = ask(&mut studio, json!({ "do": "settle" }))["q"].clone();
    let scene = ask(&mut studio, json!({ "do": "go", "q": ways[1]["shown"]["q"] }));
    assert_eq!((&scene["shown"]["q"], &scene["can_undo"]), (&ways[1]["shown"]["q"], &json!(true)));
    assert_eq!(scene["shown"]["verdict"], ways[1]["shown"]["verdict"]);
    assert_eq!(ask(&mut studio, json!({ "do": "undo" }))["shown"]["q"], standing);
    assert!(refused(&mut studio, json!({ "do": "go", "q": [0.0] })).contains("coordinates"));
}

#[test]
fn the_mirror_image_has_the_torques_of_the_other_side_and_its_mirror_image_is_the_body_as_it_was() {
    let mut studio = Studio::new();
    drag(&mut studio, "right hand", [0.3, 0.35, 0.1], 20);
    ask(&mut studio, json!({ "do": "release", "hold": true }));
    let before = ask(&mut studio, json!({ "do": "load", "segment": "hand_r", "mass": 3.0 }));
    let image = ask(&mut studio, json!({ "do": "mirror" }));
    let index = |name: &str| {
        let coordinates = before["coordinates"].as_array().unwrap();
        coordinates.iter().position(|coordinate| coordinate["name"] == name).unwrap()
    };
    let near = |a: &Value, b: &Value, within: f64| assert!((number(a) - number(b)).abs() < within, "{a} and {b}");
    for name in ["arm_flex", "elbow_flex", "hip_flexion", "knee_angle"] {
        let [right, left] = ["_r", "_l"].map(|side| index(&format!("{name}{side}")));
        for key in ["q", "external", "passive", "load"] {
            near(&before["shown"][key][right], &image["shown"][key][left], 1e-7);
            near(&before["shown"][key][left], &image["shown"][key][right], 1e-7);
        }
    }
    assert_eq!(image["held"][0]["segment"], "hand_l");
    assert_eq!(image["loads"], json!([{ "segment": "hand_l", "mass": 3.0 }]));
    // What is held stays where it is: the body has no reason to move the hand.
    let [held, at] = [&before, &image].map(|scene| place(scene, &scene["shown"], &scene["held"][0]));
    assert!((held[0] - at[0]).abs() < 1e-9 && (held[1] - at[1]).abs() < 1e-9 && (held[2] + at[2]).abs() < 1e-9);
    let again = ask(&mut studio, json!({ "do": "mirror" }));
    for (a, b) in again["shown"]["q"].as_array().unwrap().iter().zip(before["shown"]["q"].as_array().unwrap()) {
        near(a, b, 1e-12);
    }
    ask(&mut studio, json!({ "do": "open", "scenario": scenario("hold-tool") }));
    assert!(refused(&mut studio, json!({ "do": "mirror" })).contains("tells left from right"));
}

#[test]
fn a_run_is_looked_at_as_it_was_and_goes_on_as_if_nobody_had_looked() {
    let (mut studio, mut other) = (Studio::new(), Studio::new());
    let open = json!({ "do": "open", "scenario": scenario("stand-relaxed") });
    let mut seen: Vec<Value> = vec![];
    ask(&mut studio, open.clone());
    ask(&mut other, open);
    for _ in 0..30 {
        seen.push(ask(&mut studio, json!({ "do": "play", "samples": 1 })));
        ask(&mut other, json!({ "do": "play", "samples": 1 }));
    }
    for k in [0, 7, 29] {
        let time = number(&seen[k]["time"]) + 1e-3;
        let looked = ask(&mut studio, json!({ "do": "look", "time": time }));
        for key in ["time", "fatigue", "asking"] {
            assert_eq!(looked[key], seen[k][key]);
        }
        for key in ["q", "external", "passive", "load", "contacts", "places"] {
            assert_eq!(looked["shown"][key], seen[k]["shown"][key], "{key} of sample {k}");
        }
    }
    // Many samples: one of so many is kept, from all of the run.
    let end = ask(&mut studio, json!({ "do": "play", "samples": 3500 }));
    assert_eq!(end, ask(&mut other, json!({ "do": "play", "samples": 3500 })));
    let (last, step) = (number(&end["time"]), number(&seen[1]["time"]) - number(&seen[0]["time"]));
    for share in [0.0, 0.1, 0.5, 0.99, 1.0] {
        let looked = ask(&mut studio, json!({ "do": "look", "time": share * last }));
        let late = share * last - number(&looked["time"]);
        assert!((-1e-9..4.0 * step).contains(&late), "{late} s late at {share}");
        assert!(
            looked["log"]
                .as_array()
                .unwrap()
                .iter()
                .all(|line| number(&line["time"]) <= number(&looked["time"]) + 1e-9)
        );
    }
    ask(&mut studio, json!({ "do": "stop", "take": false }));
    refused(&mut studio, json!({ "do": "look", "time": 0.0 }));
}

#[test]
fn things_are_put_there_in_the_words_of_the_scenario_file_and_taken_away() {
    let mut studio = Studio::new();
    let scene = ask(&mut studio, json!({ "do": "open", "scenario": "" }));
    let standing = scene["shown"]["q"].clone();
    let keys = [
        ("box", json!({ "mass_kg": 8, "size_m": [0.3, 0.25, 0.4], "at_m": [0.4, 1.0, 0.0] })),
        ("bag", json!({ "mass_kg": 6, "on": "right_shoulder" })),
        ("tool", json!({ "hand": "right", "mass_kg": 2, "at_m": [0.35, 1.3, 0.2] })),
        ("handle", json!({ "at_m": [0.5, 1.1, 0.0], "hands": "both", "push_n": 50 })),
        ("step", json!({ "height_m": 0.2, "under": "right_foot" })),
        ("floor", json!({ "stride_m": 0.3, "ahead": "right_foot", "may_step": false })),
        ("seat", json!({ "height_m": 0.43, "backrest": true })),
        ("table", json!({ "height_m": 0.74, "edge_m": 0.3 })),
        ("counter", json!({ "height_m": 0.95, "edge_m": 0.25 })),
        ("wall", json!({ "ahead_m": 0.5 })),
    ];
    for (word, keys) in keys {
        let scene = ask(&mut studio, json!({ "do": "put", "word": word, "keys": keys }));
        let tables = scene["tables"].as_array().unwrap();
        let table = tables.iter().find(|table| table["word"] == word).unwrap();
        for (key, value) in keys.as_object().unwrap() {
            assert_eq!(table["keys"][key], *value, "{word}");
        }
        let text = ask(&mut studio, json!({ "do": "export" }))["text"].as_str().unwrap().to_owned();
        contrapposto_formats::read_run("studio.toml", text.as_bytes(), None).unwrap();
        // It can be dragged, settled, and run.
        ask(&mut studio, json!({ "do": "settle" }));
        ask(&mut studio, json!({ "do": "play", "samples": 2 }));
        ask(&mut studio, json!({ "do": "stop", "take": false }));
        let scene = ask(&mut studio, json!({ "do": "take_away", "word": word, "number": 0 }));
        assert!(scene["tables"].as_array().unwrap().iter().all(|table| table["word"] != word || word == "floor"));
        let q = scene["shown"]["q"].as_array().unwrap().iter().zip(standing.as_array().unwrap());
        assert!(
            q.map(|(a, b)| (number(a) - number(b)).abs()).fold(0.0, f64::max) < 0.2,
            "{word}: the body does not stand"
        );
    }
    assert!(refused(&mut studio, json!({ "do": "put", "word": "piano", "keys": {} })).contains("`piano` is no thing"));
    assert!(
        refused(&mut studio, json!({ "do": "put", "word": "box", "keys": { "mass": 3 } }))
            .contains("unknown key `mass`")
    );
    assert!(
        refused(&mut studio, json!({ "do": "take_away", "word": "box", "number": 0 }))
            .contains("no thing `box` number 1")
    );
}

#[test]
fn a_run_is_written_as_gltf_and_bvh_with_all_samples_that_are_kept() {
    let mut studio = Studio::new();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../contrapposto-formats/data/skin/adult.skin");
    studio.take_skin(std::fs::read(file).unwrap());
    let gltf = |studio: &mut Studio, wooden: bool| {
        let answer = ask(studio, json!({ "do": "gltf", "wooden": wooden }));
        let bytes: Vec<u8> =
            answer["bytes"].as_array().unwrap().iter().map(|byte| byte.as_u64().unwrap() as u8).collect();
        assert_eq!(&bytes[..4], b"glTF");
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        serde_json::from_slice::<Value>(&bytes[20..20 + length]).unwrap()
    };
    assert_eq!(gltf(&mut studio, false)["skins"].as_array().unwrap().len(), 1);
    assert_eq!(gltf(&mut studio, true)["skins"], Value::Null);
    let played = ask(&mut studio, json!({ "do": "play", "samples": 12 }));
    let file = gltf(&mut studio, false);
    let times = &file["accessors"][file["animations"][0]["samplers"][0]["input"].as_u64().unwrap() as usize];
    assert!((number(&times["max"][0]) - number(&played["time"])).abs() < 1e-6, "{times}");
    let text = ask(&mut studio, json!({ "do": "bvh" }))["text"].as_str().unwrap().to_owned();
    assert!(text.starts_with("HIERARCHY") && text.contains("Frames: 12"), "{}", &text[..200]);
}

#[test]
fn a_dragged_foot_stands_elsewhere_and_the_other_one_stays() {
    let mut studio = Studio::new();
    let (scene, last) = drag(&mut studio, "left foot", [0.22, 0.3, -0.06], 40);
    let released = ask(&mut studio, json!({ "do": "release", "hold": true }));
    let feet = |shown: &Value, name: &str| place(&scene, shown, &handle(&scene, name));
    let moved = |name: &str| {
        let (before, after) = (feet(&scene["shown"], name), feet(&released["shown"], name));
        [0, 1, 2].map(|k| after[k] - before[k])
    };
    let [ahead, up, aside] = moved("left foot");
    assert!((ahead - 0.22).abs() < 0.005 && up.abs() < 1e-4 && (aside + 0.06).abs() < 0.005, "{ahead} {up} {aside}");
    assert!(moved("right foot").iter().all(|way| way.abs() < 1e-4));
    let shares: f64 = last["contacts"].as_array().unwrap().iter().map(|contact| number(&contact["share"])).sum();
    assert!((shares - 1.0).abs() < 1e-6, "{shares}");
    assert_eq!(released["held"], json!([]));
    // Sole and floor: all four corners of the patch are where the floor is.
    let heights = released["shown"]["patches"].as_array().unwrap().iter().map(|corner| number(&corner[1]).abs());
    assert!(heights.fold(0.0, f64::max) < 1e-4);
    // The file says so, too: another session has the foot in the same place, and undo brings it back.
    let text = exported(&mut studio);
    let opened = ask(&mut Studio::new(), json!({ "do": "open", "scenario": text }));
    let again = feet(&opened["shown"], "left foot");
    let there = feet(&released["shown"], "left foot");
    assert!((0..3).all(|k| (again[k] - there[k]).abs() < 1e-6), "{again:?} {there:?}");
    let undone = ask(&mut studio, json!({ "do": "undo" }));
    assert_eq!(feet(&undone["shown"], "left foot"), feet(&scene["shown"], "left foot"));
}

#[test]
fn a_foot_that_is_dragged_into_the_other_one_stops_beside_it() {
    let mut studio = Studio::new();
    let (scene, last) = drag(&mut studio, "left foot", [0.05, 0.0, 0.3], 40);
    let foot = |shown: &Value, name: &str| place(&scene, shown, &handle(&scene, name));
    let (before, after) = (foot(&scene["shown"], "right foot"), foot(&last, "right foot"));
    assert!((0..3).all(|k| (before[k] - after[k]).abs() < 1e-3), "the right foot moved from {before:?} to {after:?}");
    // Soles do not overlap: the left one ends 2 cm to the left of where the right one begins.
    let aside = |shown: &Value, from: usize| {
        shown["patches"].as_array().unwrap()[from..from + 4].iter().map(|corner| number(&corner[2])).collect::<Vec<_>>()
    };
    let (one, other) = (aside(&last, 0), aside(&last, 4));
    let most = |list: &[f64]| list.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = |list: &[f64]| list.iter().copied().fold(f64::INFINITY, f64::min);
    let gap = (least(&one) - most(&other)).max(least(&other) - most(&one));
    assert!((gap - 0.02).abs() < 0.003, "{gap}");
    let released = ask(&mut studio, json!({ "do": "release", "hold": false }));
    let verdict = &released["shown"]["verdict"];
    assert!(["holds", "held_until"].contains(&verdict["kind"].as_str().unwrap()), "{verdict}");
}

#[test]
fn a_pelvis_on_a_seat_and_a_foot_on_a_step_stay() {
    let mut studio = Studio::new();
    ask(&mut studio, json!({ "do": "open", "scenario": "format = 1\n[seat]\nheight_m = 0.45\n" }));
    let sentence = refused(&mut studio, json!({ "do": "grab", "segment": "pelvis", "point": [0, 0, 0] }));
    assert!(sentence.contains("carries weight"), "{sentence}");
    ask(
        &mut studio,
        json!({ "do": "open", "scenario": "format = 1\n[[step]]\nheight_m = 0.2\nunder = \"right_foot\"\n" }),
    );
    refused(&mut studio, json!({ "do": "grab", "segment": "calcn_r", "point": [0, 0, 0] }));
    ask(&mut studio, json!({ "do": "grab", "segment": "calcn_l", "point": [0, 0, 0] }));
}

#[test]
fn a_recorded_motion_is_read_and_its_moments_are_shown() {
    let mut studio = Studio::new();
    let scene = ask(&mut studio, json!({ "do": "open", "scenario": "" }));
    let head = "arms\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\nendheader\ntime\telbow_flex_r\ttail_flex\n";
    let text = format!("{head}0\t10\t1\n0.5\t90\t2\n");
    let motion = ask(&mut studio, json!({ "do": "motion", "name": "arms.mot", "text": text }));
    let names = scene["coordinates"].as_array().unwrap();
    let elbow = names.iter().position(|coordinate| coordinate["name"] == "elbow_flex_r").unwrap();
    assert_eq!(motion["course"]["times"], json!([0.0, 0.5]));
    assert!(motion["notes"].to_string().contains("tail_flex"), "{}", motion["notes"]);
    let q = &motion["course"]["postures"][1];
    assert!((number(&q[elbow]) - 90f64.to_radians()).abs() < 1e-12);
    let shown = ask(&mut studio, json!({ "do": "at", "q": q }));
    assert_eq!(&shown["q"], q);
    // A recorded moment has nothing to reach and slides nowhere, even where the job holds a hand.
    let mut other = Studio::new();
    drag(&mut other, "right hand", [0.2, 0.3, 0.0], 10);
    ask(&mut other, json!({ "do": "release", "hold": true }));
    let moment = ask(&mut other, json!({ "do": "at", "q": q }));
    assert!(
        ["holds", "held_until", "cannot_be_done"].contains(&moment["verdict"]["kind"].as_str().unwrap()),
        "{}",
        moment["verdict"]
    );
    // The weight of the bent forearm works about the elbow.
    assert!(number(&shown["external"][elbow]).abs() > 1.0, "{}", shown["external"][elbow]);
    // Nothing has changed.
    assert_eq!(exported(&mut studio), {
        let mut other = Studio::new();
        ask(&mut other, json!({ "do": "open", "scenario": "" }));
        exported(&mut other)
    });
    let sentence =
        refused(&mut studio, json!({ "do": "motion", "name": "arms.mot", "text": format!("{head}0\t10\n") }));
    assert!(sentence.contains("line 8"), "{sentence}");
    refused(&mut studio, json!({ "do": "at", "q": [1.0] }));
}

/// External torque of an arm's hinge by a force on the hand: the force times the way of its point a radian (virtual work), whatever the feet do.
#[test]
fn a_force_on_a_hand_does_the_work_of_its_point_and_is_taken_off() {
    let mut studio = Studio::new();
    drag(&mut studio, "right hand", [0.3, 0.35, 0.1], 20);
    let before = ask(&mut studio, json!({ "do": "release", "hold": true }));
    let (point, force) = ([0.01, -0.05, 0.02], [-40.0, 12.0, 7.0]);
    let push = json!({ "do": "push", "segment": "hand_r", "point": point, "force": force });
    let pushed = ask(&mut studio, push.clone());
    assert_eq!(
        pushed["forces"],
        json!([{ "segment": "hand_r", "label": "right hand", "point": point, "force": force }])
    );
    assert_eq!(before["shown"]["q"], pushed["shown"]["q"]);
    let person = &before["person"];
    let sex = if person["sex"] == "male" { Sex::Male } else { Sex::Female };
    let size = Adult { sex, stature: number(&person["stature"]), mass: number(&person["mass"]), ..Adult::default() };
    let model = adult(&size).unwrap();
    let q: Vec<f64> = before["shown"]["q"].as_array().unwrap().iter().map(number).collect();
    let hand = model.segment("hand_r").unwrap();
    let mut kinematics = Kinematics::new(&model);
    for name in ["elbow_flex_r", "pro_sup_r", "wrist_flex_r", "wrist_dev_r"] {
        let i = model.coordinate(name).unwrap();
        let mut at = |shift: f64| {
            let mut q = q.clone();
            q[i] += shift;
            kinematics.update(&model, &Posture::new(q)).unwrap();
            kinematics.station(&model, hand, point.into())
        };
        let work = (at(1e-6) - at(-1e-6)).dot(&nalgebra::Vector3::from(force)) / 2e-6;
        let change = number(&pushed["shown"]["external"][i]) - number(&before["shown"]["external"][i]);
        assert!((change - work).abs() < 1e-6, "{name}: {change} and {work} N m");
    }
    // Another force replaces it; a weight stays beside it; no force takes it off.
    ask(&mut studio, json!({ "do": "load", "segment": "hand_r", "mass": 2.0 }));
    let other =
        ask(&mut studio, json!({ "do": "push", "segment": "hand_r", "point": point, "force": [5.0, 0.0, 0.0] }));
    assert_eq!((other["forces"].as_array().unwrap().len(), other["loads"].as_array().unwrap().len()), (1, 1));
    assert_eq!(saved(&mut studio)["load"].as_array().unwrap().len(), 2);
    let off = ask(&mut studio, json!({ "do": "push", "segment": "hand_r", "point": point, "force": [0.0, 0.0, 0.0] }));
    assert_eq!((off["forces"].as_array().unwrap().len(), off["loads"].as_array().unwrap().len()), (0, 1));
    let missing = json!({ "do": "push", "segment": "tail", "point": point, "force": force });
    assert!(refused(&mut studio, missing).contains("there is no segment `tail`"));

    // The mirror image is pushed at the same place of the other hand, from the other side.
    let before = ask(&mut studio, push);
    let image = ask(&mut studio, json!({ "do": "mirror" }));
    assert_eq!(image["forces"][0]["segment"], "hand_l");
    assert_eq!(image["forces"][0]["force"], json!([-40.0, 12.0, -7.0]));
    let [held, at] = [&before, &image].map(|scene| place(scene, &scene["shown"], &scene["forces"][0]));
    assert!((held[0] - at[0]).abs() < 1e-9 && (held[1] - at[1]).abs() < 1e-9 && (held[2] + at[2]).abs() < 1e-9);
}

#[test]
fn a_strategy_of_a_region_is_that_of_its_joints_in_the_run_and_in_the_file() {
    let mut studio = Studio::new();
    let open = ask(&mut studio, json!({ "do": "open", "scenario": "" }));
    let kinds = |scene: &Value| -> Vec<(String, String)> {
        let word = |value: &Value| value.as_str().unwrap().to_owned();
        scene["regions"].as_array().unwrap().iter().map(|r| (word(&r["name"]), word(&r["strategy"]))).collect()
    };
    let regions = ["arms", "spine", "neck", "legs"];
    assert_eq!(kinds(&open), regions.map(|name| (name.to_owned(), "passive".to_owned())));
    let legs = ask(&mut studio, json!({ "do": "strategy", "kind": "active", "region": "legs" }));
    assert_eq!(kinds(&legs)[3], ("legs".to_owned(), "active".to_owned()));
    assert_eq!((kinds(&legs)[0].1.as_str(), &legs["strategy"]), ("passive", &json!("passive")));
    assert_eq!(saved(&mut studio)["strategy"]["of"]["legs"].as_str(), Some("active"));
    // A run reads the file: the program has the same strategies of the same joints.
    let text = exported(&mut studio);
    let run = contrapposto_formats::read_run("studio.toml", text.as_bytes(), None).unwrap().scenario;
    let of = |name: &str| run.strategies[run.model.coordinate(name).unwrap()];
    assert_ne!(of("knee_angle_r"), of("elbow_flex_r"));
    // A joint that the file names itself makes its region mixed; the region's own choice replaces it.
    let text = text.replace("legs = \"active\"", "legs = \"active\"\nknee_angle_r = \"passive\"");
    let mixed = ask(&mut studio, json!({ "do": "open", "scenario": text }));
    assert_eq!(kinds(&mixed)[3].1, "mixed");
    let again = ask(&mut studio, json!({ "do": "strategy", "kind": "passive", "region": "legs" }));
    assert_eq!(kinds(&again)[3].1, "passive");
    assert!(saved(&mut studio)["strategy"].get("of").is_none());
    let whole = ask(&mut studio, json!({ "do": "strategy", "kind": "active" }));
    assert!(kinds(&whole).iter().all(|(_, kind)| kind == "active"));
    let refusal = refused(&mut studio, json!({ "do": "strategy", "kind": "active", "region": "tail" }));
    assert_eq!(refusal, "`tail` is no region of the body; there are arms, spine, neck, legs");
    assert!(refused(&mut studio, json!({ "do": "strategy", "kind": "lazy" })).contains("passive, active"));
}

#[test]
fn a_percentile_is_the_size_that_so_many_people_do_not_exceed() {
    let mut studio = Studio::new();
    for (sex, percentile) in [("female", 5.0), ("male", 95.0)] {
        let scene = ask(&mut studio, json!({ "do": "percentile", "sex": sex, "percentile": percentile }));
        assert_eq!(scene["person"]["sex"], sex);
        for found in scene["person"]["percentiles"].as_array().unwrap() {
            // Statures are to a millimetre, masses to a tenth of a kilogram.
            assert!((number(found) - percentile).abs() < 0.2, "{found} for {percentile}");
        }
    }
    // Quantiles of the normal distribution by its tables: 1.756 + 1.6449 0.0686 m.
    let scene = ask(&mut studio, json!({ "do": "percentile", "sex": "male", "percentile": 95.0 }));
    assert!((number(&scene["person"]["stature"]) - 1.869).abs() < 1e-9, "{}", scene["person"]);
    let refusal = refused(&mut studio, json!({ "do": "percentile", "sex": "male", "percentile": 100.0 }));
    assert_eq!(refusal, "the percentile is 100; it must lie between 1 and 99");
}

#[test]
fn a_thing_that_is_put_down_in_a_run_is_told_from_then_on() {
    let text = "format = 1\n[model]\nadult = { sex = \"female\", stature_m = 1.65, mass_kg = 60 }\n[floor]\n[[bag]]\nmass_kg = 5\non = \"right_hand\"\n\
                [strategy]\nkind = \"passive\"\n[run]\nduration_s = 4\nstep_s = 0.5\n[[event]]\nat_s = 2\nload = []\n";
    let mut studio = Studio::new();
    let scene = ask(&mut studio, json!({ "do": "open", "scenario": text }));
    // The bag, and the strap that it hangs by.
    let things = scene["things"].as_array().unwrap();
    let bag: Vec<usize> = (0..things.len()).filter(|&i| !things[i]["segment"].is_null()).collect();
    assert!(!bag.is_empty());
    let before = ask(&mut studio, json!({ "do": "play", "samples": 4 }));
    assert_eq!((number(&before["time"]), &before["put_down"]), (1.5, &json!([])));
    let after = ask(&mut studio, json!({ "do": "play", "samples": 3 }));
    assert_eq!((number(&after["time"]), &after["put_down"]), (3.0, &json!(bag)));
    let looked = ask(&mut studio, json!({ "do": "look", "time": 1.0 }));
    assert_eq!(looked["put_down"], json!([]));
}
