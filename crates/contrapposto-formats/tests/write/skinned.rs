//! glTF with a skin: a whole file, whose skeleton in T-pose leaves the mesh as it is, and in any posture stands at the joint centres.

use std::collections::BTreeMap;

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::posture::Posture;
use contrapposto_formats::animation::{Arrow, Clip, Skin, glb, skinned_glb};
use contrapposto_formats::{Swing, Thing};
use nalgebra::{Matrix4, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use serde_json::Value;

use super::players::{Glb, index, list};
use super::skin::{joints, people, random, with};

const SEED: u64 = 22;
/// Greatest distance of a bone's head from the joint's centre, m; rounding to `f32` is far below.
const NEAR: f64 = 0.005;
/// Rounding of places in the file, m.
const ROUNDING: f64 = 2e-6;

fn clip<'a>(model: &'a Model, times: &'a [f64], postures: &'a [&'a [f64]]) -> Clip<'a> {
    let directions = [-Vector3::z(), Vector3::y(), Vector3::x()];
    Clip { model, title: "any", directions, times, postures, steps: false, things: &[], arrows: &[] }
}

fn drawn(p: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-p.z, p.y, p.x)
}

/// Rows of an accessor of bytes.
fn bytes(file: &Glb, accessor: &Value) -> Vec<[u8; 4]> {
    let accessor = &file.json["accessors"][index(accessor)];
    assert_eq!((&accessor["componentType"], &accessor["type"]), (&5121.into(), &"VEC4".into()));
    let start = index(&file.json["bufferViews"][index(&accessor["bufferView"])]["byteOffset"]);
    let rows = file.binary[start..start + 4 * index(&accessor["count"])].chunks_exact(4);
    rows.map(|row| row.try_into().unwrap()).collect()
}

/// Everything of the file is within its bounds, and is as wide as the file says.
pub(super) fn check(file: &Glb) {
    let size = |kind: u64| match kind {
        5121 => 1,
        5123 => 2,
        5126 => 4,
        _ => panic!("component {kind}"),
    };
    let width = BTreeMap::from([("SCALAR", 1), ("VEC3", 3), ("VEC4", 4), ("MAT4", 16)]);
    for view in list(&file.json["bufferViews"]) {
        assert_eq!(index(&view["byteOffset"]) % 4, 0);
        assert!(index(&view["byteOffset"]) + index(&view["byteLength"]) <= file.binary.len());
    }
    assert_eq!(index(&file.json["buffers"][0]["byteLength"]), file.binary.len());
    for accessor in list(&file.json["accessors"]) {
        let view = &file.json["bufferViews"][index(&accessor["bufferView"])];
        let row = size(accessor["componentType"].as_u64().unwrap()) * width[accessor["type"].as_str().unwrap()];
        let (stride, offset) = (view.get("byteStride").map_or(row, index), accessor.get("byteOffset").map_or(0, index));
        let count = index(&accessor["count"]);
        assert!(count > 0 && offset + stride * (count - 1) + row <= index(&view["byteLength"]), "{accessor}");
    }
}

/// Vertices of a mesh of the file, moved by its skeleton as glTF says.
pub(super) fn moved(file: &Glb, mesh: usize, frames: &BTreeMap<String, Matrix4<f64>>) -> Vec<Vector3<f64>> {
    let attributes = &file.json["meshes"][mesh]["primitives"][0]["attributes"];
    let (bones, weights) = (bytes(file, &attributes["JOINTS_0"]), bytes(file, &attributes["WEIGHTS_0"]));
    let skin = &file.json["skins"][0];
    let accessor = &file.json["accessors"][index(&skin["inverseBindMatrices"])];
    let start = index(&file.json["bufferViews"][index(&accessor["bufferView"])]["byteOffset"]);
    let number = |at: usize| f64::from(f32::from_le_bytes(file.binary[at..at + 4].try_into().unwrap()));
    let back = |i: usize| Matrix4::from_iterator((0..16).map(|k| number(start + 64 * i + 4 * k)));
    let joints = list(&skin["joints"]);
    assert_eq!(index(&accessor["count"]), joints.len());
    let name = |joint: &Value| file.json["nodes"][index(joint)]["name"].as_str().unwrap();
    let matrices: Vec<Matrix4<f64>> = joints.iter().enumerate().map(|(i, j)| frames[name(j)] * back(i)).collect();
    let positions = file.floats(&attributes["POSITION"], 3);
    let vertex = |((at, bones), weights): ((&Vec<f64>, &[u8; 4]), &[u8; 4])| {
        assert_eq!(weights.iter().map(|&w| u32::from(w)).sum::<u32>(), 255);
        assert!(bones.iter().zip(weights).all(|(&bone, &w)| usize::from(bone) < joints.len() && (w > 0 || bone == 0)));
        let at = nalgebra::Point3::new(at[0], at[1], at[2]);
        let parts = bones
            .iter()
            .zip(weights)
            .map(|(&bone, &w)| f64::from(w) / 255.0 * matrices[usize::from(bone)].transform_point(&at).coords);
        parts.sum()
    };
    positions.iter().zip(&bones).zip(&weights).map(vertex).collect()
}

fn farthest(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

fn place(frame: &Matrix4<f64>) -> Vector3<f64> {
    Vector3::new(frame[(0, 3)], frame[(1, 3)], frame[(2, 3)])
}

#[test]
fn bones_and_skin_of_the_file_are_where_kinematics_is() {
    println!("seed {SEED}");
    let mut numbers = Pcg64Mcg::seed_from_u64(SEED);
    for (size, model) in people() {
        let postures: Vec<Posture> = (0..20).map(|_| random(&model, &mut numbers)).collect();
        let rows: Vec<&[f64]> = postures.iter().map(Posture::values).collect();
        let times: Vec<f64> = (0..20).map(f64::from).collect();
        let skin = Skin::of(&model).unwrap();
        let file = skinned_glb(&clip(&model, &times, &rows), &skin).unwrap();
        assert_eq!(file, skinned_glb(&clip(&model, &times, &rows), &skin).unwrap());
        let file = Glb::read(&file);
        check(&file);
        let segment = |node: &Value| node["extras"]["segment"].as_str().map(|name| model.segment(name).unwrap());
        let mut worst = [0.0_f64; 2];
        for (time, posture) in times.iter().zip(&postures) {
            let (frames, centers) = (file.frames(*time), joints(&model, posture));
            for node in list(&file.json["nodes"]) {
                let Some(segment) = segment(node) else { continue };
                let frame = &frames[node["name"].as_str().unwrap()];
                worst[0] = worst[0].max((place(frame) - drawn(centers[segment])).norm());
            }
            let places = skin.skeleton.place_in(&model, posture).unwrap();
            let wanted: Vec<Vector3<f64>> = skin.moved(&places).into_iter().map(drawn).collect();
            worst[1] = worst[1].max(farthest(&moved(&file, 0, &frames), &wanted));
        }
        println!("{} m: bones {:.1e} m, skin {:.1e} m", size.stature, worst[0], worst[1]);
        assert!(worst[0] < NEAR && worst[1] < 10.0 * ROUNDING, "{worst:?}");
    }
}

#[test]
fn the_t_pose_leaves_the_mesh_as_it_is_and_needs_no_animation() {
    let model = adult(&Adult::default()).unwrap();
    let skin = Skin::of(&model).unwrap();
    let t_pose = with(&model, &[("arm_add_r", -90.0), ("arm_add_l", -90.0)]);
    let file = Glb::read(&skinned_glb(&clip(&model, &[0.0], &[t_pose.values()]), &skin).unwrap());
    check(&file);
    assert!(file.json.get("animations").is_none(), "{}", file.json["animations"]);
    let frames = file.frames(0.0);
    let positions = file.floats(&file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"], 3);
    let positions: Vec<Vector3<f64>> = positions.iter().map(|p| Vector3::new(p[0], p[1], p[2])).collect();
    assert!(farthest(&moved(&file, 0, &frames), &positions) < ROUNDING);
    let at = |name: &str| place(&frames[name]);
    let (left, right) = (at("leftHand") - at("leftUpperArm"), at("rightHand") - at("rightUpperArm"));
    assert!(left.x > 0.4 && left.yz().norm() < 1e-6, "the left arm is out to the left: {left}");
    assert!(right.x < -0.4 && right.yz().norm() < 1e-6, "the right arm is out to the right: {right}");
    assert!(at("leftToes").z > at("leftFoot").z && at("head").y > at("hips").y + 0.5);
}

/// The bones that VRM's humanoid asks for, each below the one that it asks for.
#[test]
fn bones_have_the_names_of_a_humanoid() {
    let model = adult(&Adult::default()).unwrap();
    let file = skinned_glb(&clip(&model, &[0.0], &[model.default_posture().values()]), &Skin::of(&model).unwrap());
    let file = Glb::read(&file.unwrap());
    let nodes = list(&file.json["nodes"]);
    let find = |name: &str| nodes.iter().position(|node| node["name"] == name).unwrap_or_else(|| panic!("no {name}"));
    let below = |upper: usize, lower: usize| {
        let mut open = vec![upper];
        while let Some(node) = open.pop() {
            let children: Vec<usize> = nodes[node].get("children").map_or(&[][..], list).iter().map(index).collect();
            if children.contains(&lower) {
                return true;
            }
            open.extend(children);
        }
        false
    };
    let trunk = ["hips", "spine", "chest", "neck", "head"].map(str::to_owned);
    let mut chains = vec![trunk.to_vec()];
    for side in ["left", "right"] {
        let of = |names: &[&str]| names.iter().map(|name| format!("{side}{name}")).collect::<Vec<_>>();
        chains.push([vec!["chest".to_owned()], of(&["Shoulder", "UpperArm", "LowerArm", "Hand"])].concat());
        chains.push([vec!["hips".to_owned()], of(&["UpperLeg", "LowerLeg", "Foot", "Toes"])].concat());
    }
    for pair in chains.iter().flat_map(|chain| chain.windows(2)) {
        assert!(below(find(&pair[0]), find(&pair[1])), "{} is not below {}", pair[1], pair[0]);
    }
}

#[test]
fn postures_in_steps_last_a_second_each() {
    let model = adult(&Adult::default()).unwrap();
    let skin = Skin::of(&model).unwrap();
    let postures = [30.0, 90.0].map(|degrees| with(&model, &[("hip_flexion_r", degrees)]));
    let rows: Vec<&[f64]> = postures.iter().map(Posture::values).collect();
    let steps = Clip { steps: true, ..clip(&model, &[0.0, 1.0], &rows) };
    let file = Glb::read(&skinned_glb(&steps, &skin).unwrap());
    check(&file);
    for (time, posture) in [(0.0, 0), (0.9, 0), (1.0, 1), (2.0, 1)] {
        let knee = joints(&model, &postures[posture])[model.segment("tibia_r").unwrap()];
        assert!((place(&file.frames(time)["rightLowerLeg"]) - drawn(knee)).norm() < ROUNDING, "at {time} s");
    }
    let sampler = &file.json["animations"][0]["samplers"][0];
    assert_eq!(file.floats(&sampler["input"], 1).last().unwrap()[0], 2.0);
    let one = Glb::read(&skinned_glb(&Clip { steps: true, ..clip(&model, &[0.0], &rows[..1]) }, &skin).unwrap());
    let sampler = &one.json["animations"][0]["samplers"][0];
    assert_eq!(one.floats(&sampler["input"], 1), [[0.0], [1.0]]);
}

/// A table stays, a bag hangs straight down from the fist wherever the hand is, and arrows go from their points to their tips.
#[test]
fn things_and_forces_of_the_file_are_where_the_body_has_them() {
    let model = adult(&Adult::default()).unwrap();
    let postures = [0.0, 40.0, 80.0].map(|degrees| with(&model, &[("arm_flex_r", degrees), ("elbow_flex_r", 30.0)]));
    let rows: Vec<&[f64]> = postures.iter().map(Posture::values).collect();
    let (hand, fist) = (model.segment("hand_r").unwrap(), Vector3::new(0.0, -0.07, 0.0));
    let table = Thing::new("table", [0.6, 0.04, 1.2], nalgebra::Isometry3::translation(0.6, 0.7, 0.1), None);
    let bag = Thing::new("bag", [0.3, 0.26, 0.1], nalgebra::Isometry3::translation(0.0, -0.27, 0.0), Some(hand));
    let things = [table, Thing { swing: Some(Swing { at: fist, up: Vector3::y() }), until: Some(2.0), ..bag }];
    let at = [Vector3::new(0.1, 0.0, 0.2), Vector3::new(0.1, 0.0, -0.2), Vector3::new(0.3, 0.1, 0.0)];
    let along = [Vector3::new(0.0, 0.5, 0.0), Vector3::zeros(), Vector3::new(0.2, 0.3, -0.1)];
    let arrow = Arrow { name: "right foot".to_owned(), contact: true, at: at.into(), along: along.into() };
    let (times, arrows) = ([0.0, 1.0, 2.0], [arrow]);
    let clip = Clip { things: &things, arrows: &arrows, ..clip(&model, &times, &rows) };
    let skin = Skin::of(&model).unwrap();
    let rigid = glb(&clip, &vec![vec![]; model.segments().len()]).unwrap();
    for bytes in [skinned_glb(&clip, &skin).unwrap(), rigid] {
        let file = Glb::read(&bytes);
        check(&file);
        let mut kinematics = Kinematics::new(&model);
        for (k, posture) in postures.iter().enumerate() {
            kinematics.update(&model, posture).unwrap();
            let frames = file.frames(k as f64);
            let near = |found: Vector3<f64>, wanted: Vector3<f64>, grain: f64| {
                let wanted = drawn(wanted);
                assert!((found - wanted).norm() < grain, "posture {k}: {found} for {wanted}");
            };
            near(place(&frames["table"]), Vector3::new(0.6, 0.7, 0.1), ROUNDING);
            let fist = kinematics.station(&model, hand, fist);
            near(place(&frames["bag"]), fist - Vector3::new(0.0, 0.2, 0.0), ROUNDING);
            let up = frames["bag"].transform_vector(&Vector3::y());
            let there = if k < 2 { Vector3::y() } else { Vector3::zeros() };
            assert!((up - there).norm() < ROUNDING, "the bag hangs aslant, or is there after it is put down: {up}");
            let tip = file.corners("right foot").into_iter().max_by(|a, b| a.y.total_cmp(&b.y)).unwrap();
            near(place(&frames["right foot"]), at[k], 2e-3);
            // Points are rounded to 2 mm, and the tip is a ball of 2 mm.
            near(frames["right foot"].transform_point(&tip.into()).coords, at[k] + along[k], 8e-3);
        }
        let size = |name: &str, k: usize| {
            let corners = file.corners(name);
            corners.iter().map(|c| c[k]).fold(f64::MIN, f64::max)
                - corners.iter().map(|c| c[k]).fold(f64::MAX, f64::min)
        };
        // Ahead and aside of ground are z and x of the skinned file; the rigid one has its root node turned.
        assert!(
            (size("table", 1) - 0.04).abs() < ROUNDING && (size("table", 0) + size("table", 2) - 1.8).abs() < ROUNDING
        );
    }
}
