//! `.glb` files of all commands: the built-in adult has a skin, the wooden figure and other bodies have none.

use crate::support;

use std::path::Path;

use serde_json::Value;
use support::{contrapposto, scenarios};

/// A body with strength that is no adult.
const PENDULUM: &str = r#"<robot name="pendulum"><link name="base"/><link name="bob"><inertial><origin xyz="0 0 -0.5"/><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="swing" type="revolute"><parent link="base"/><child link="bob"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="20" velocity="1"/></joint></robot>"#;

/// The JSON of a binary glTF file.
fn gltf(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap();
    assert_eq!(&bytes[..4], b"glTF", "{}", path.display());
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

fn has_skin(file: &Value) -> bool {
    let has_hips = file["nodes"].as_array().unwrap().iter().any(|node| node["name"] == "hips");
    assert_eq!(has_hips, file.get("skins").is_some());
    has_hips
}

#[test]
fn a_pose_of_the_adult_has_a_skin_and_lasts_a_second_and_wood_is_a_choice() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let pose = |more: &[&str]| {
        let call = contrapposto(["pose"]).arg(scenarios().join("poses/reach-shelf.toml")).arg("--out").arg(&out);
        let run = call.args(more).arg("--no-suggest").run();
        assert!(run.code < 2, "{}", run.stderr);
        gltf(&out.join("pose.glb"))
    };
    let file = pose(&[]);
    assert!(has_skin(&file));
    assert_eq!(file["animations"][0]["samplers"][0]["interpolation"], "STEP");
    let input = file["animations"][0]["samplers"][0]["input"].as_u64().unwrap() as usize;
    assert_eq!((&file["accessors"][input]["count"], &file["accessors"][input]["max"][0]), (&2.into(), &1.0.into()));
    assert!(std::fs::read_to_string(out.join("pose.bvh")).unwrap().contains("Frames: 1\n"));
    let file = pose(&["--wooden"]);
    assert!(!has_skin(&file) && file["nodes"].as_array().unwrap().iter().any(|node| node["name"] == "femur_r"));
}

#[test]
fn an_assessed_motion_has_a_skin_if_the_body_is_the_adult() {
    let folder = tempfile::tempdir().unwrap();
    let motion = folder.path().join("motion.csv");
    std::fs::write(&motion, "time,elbow_flex_r_deg\n0,10\n0.5,60\n1,90\n").unwrap();
    let swinging = folder.path().join("swinging.csv");
    std::fs::write(&swinging, "time,swing_deg\n0,10\n0.5,20\n1,30\n").unwrap();
    std::fs::write(folder.path().join("pendulum.urdf"), PENDULUM).unwrap();
    for (body, skin) in [("adult:female,1.65m,60kg", true), ("pendulum.urdf", false)] {
        let motion = if skin { &motion } else { &swinging };
        let out = folder.path().join(if skin { "adult" } else { "pendulum" });
        let call = contrapposto(["assess", body]).arg(motion).folder(folder.path()).args([
            "--fixed-root",
            "--no-suggest",
            "--out",
        ]);
        let run = call.arg(&out).run();
        assert!(run.code < 2, "{}", run.stderr);
        let file = gltf(&out.join("motion.glb"));
        assert_eq!(has_skin(&file), skin, "{body}");
        assert_eq!(file["animations"][0]["samplers"][0]["interpolation"], "LINEAR");
    }
}
