//! Animations of glTF files: motions of the adult come back from its own files, keys of all kinds, scales, other buffers, refusals and mutations.

use std::collections::BTreeMap;

use contrapposto::model::{Adult, Model, Placement, adult};
use contrapposto::posture::Posture;
use contrapposto::tasks::Height;
use contrapposto::tracking::track;
use contrapposto_formats::animation::{Clip, glb};
use contrapposto_formats::rigs::{Assignment, Fitted, RigUnit, Sizing, Targets, read_gltf, settle_branches};
use nalgebra::{UnitQuaternion, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64;
use serde_json::{Value, json};

/// The default posture, then some within a third of the ranges.
fn motion(model: &Model, seed: u128) -> Vec<Posture> {
    let mut rng = Pcg64::new(seed, 0);
    let ends: Vec<f64> = model
        .coordinates()
        .iter()
        .map(|c| {
            let most = if c.name.starts_with("pelvis") { 0.3 } else { 1.5 };
            let (low, high) = ((c.range.0 - c.default).max(-most), (c.range.1 - c.default).min(most));
            rng.random_range(0.0..1.0) * (high - low) / 3.0 + low / 3.0
        })
        .collect();
    let frame = |k: usize| {
        let values = model.coordinates().iter().zip(&ends).map(|(c, end)| c.default + end * k as f64 / 12.0);
        let mut posture = Posture::new(values.collect());
        Height::raise_shoulders(model, [&mut posture]);
        posture
    };
    (0..=12).map(frame).collect()
}

fn own_file(model: &Model, motion: &[Posture]) -> Vec<u8> {
    let times: Vec<f64> = (0..motion.len()).map(|k| k as f64 * 0.05).collect();
    let postures: Vec<&[f64]> = motion.iter().map(Posture::values).collect();
    let directions = [-Vector3::z(), Vector3::y(), Vector3::x()];
    let clip = Clip {
        model,
        title: "t",
        directions,
        times: &times,
        postures: &postures,
        steps: false,
        things: &[],
        arrows: &[],
    };
    glb(&clip, &vec![vec![]; model.segments().len()]).unwrap()
}

#[test]
fn a_motion_of_the_adult_comes_back_from_its_own_glb() {
    for seed in 1..4 {
        println!("seed {seed}");
        let size = Adult { stature: 1.6 + 0.1 * seed as f64, ..Adult::default() };
        let model = adult(&size).unwrap();
        let motion = motion(&model, seed);
        let rig = read_gltf("a.glb", &own_file(&model, &motion)).unwrap();
        assert!(rig.warnings.is_empty(), "{:?}", rig.warnings);
        assert_eq!((rig.frames.len(), (rig.frame_time * 1e6).round()), (13, 50_000.0));
        let assignment = Assignment::find(&rig, &BTreeMap::new()).unwrap();
        let fitted = Fitted::new(&rig, &assignment, &Sizing::ToRig(size.sex), None).unwrap();
        assert_eq!(fitted.unit, RigUnit::Found("m"));
        assert!(!fitted.from_first_frame && fitted.feet_point_ahead);
        let frames: Vec<usize> = (0..rig.frames.len()).collect();
        let targets = Targets::new(&rig, &assignment, &fitted, &frames);
        let places: Vec<_> = frames.iter().map(|&frame| targets.places(frame)).collect();
        let start = fitted.model.default_posture();
        let answer = track(&fitted.model, targets.goals.clone(), &start, places.iter().map(Vec::as_slice)).unwrap();
        let mut found: Vec<Posture> = answer.into_iter().map(|frame| frame.posture).collect();
        settle_branches(&fitted.model, &mut found);
        for (found, wanted) in found.iter().zip(&motion) {
            for (c, coordinate) in model.coordinates().iter().enumerate() {
                let off = (found.values()[c] - wanted.values()[c]).abs();
                // Numbers of 32 bits.
                assert!(off < 2e-5, "{seed}: {} is off by {off}", coordinate.name);
            }
        }
    }
}

/// Joints that rest have no keys, and are joints of the rig nevertheless.
#[test]
fn joints_that_rest_are_found() {
    let model = adult(&Adult::default()).unwrap();
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    let bent = |turn: f64| {
        let mut posture = model.default_posture();
        posture.values_mut()[elbow] += turn;
        posture
    };
    let rig = read_gltf("a.glb", &own_file(&model, &[0.0, 0.4, 0.8].map(bent))).unwrap();
    let assignment = Assignment::find(&rig, &BTreeMap::new()).unwrap();
    assert!(assignment.joint("toes_l").is_some() && assignment.joint("hand_l").is_some());
}

/// A base64 text of numbers of 32 bits, by the letters of RFC 4648.
fn base64(numbers: &[f64]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| (*number as f32).to_le_bytes()).collect();
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let all = three.iter().enumerate().fold(0_usize, |all, (i, byte)| all | usize::from(*byte) << (16 - 8 * i));
        let letters = (0..4).map(|i| LETTERS[all >> (18 - 6 * i) & 63] as char);
        text.extend(letters.enumerate().map(|(i, letter)| if i <= three.len() { letter } else { '=' }));
    }
    text
}

/// An armature in cm with a bone that turns a quarter about z within a second, and a bone on it that goes along x.
fn two_bones(turn_kind: &str, turns: &[f64], place_kind: &str, places: &[f64]) -> Value {
    let numbers = [&[0.0, 1.0][..], turns, places].concat();
    let view = |first: usize, count: usize| json!({ "buffer": 0, "byteOffset": 4 * first, "byteLength": 4 * count });
    json!({
        "asset": { "version": "2.0" },
        "nodes": [
            { "name": "Armature", "scale": [0.01, 0.01, 0.01], "children": [2] },
            { "name": "tip", "matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 30, 0, 0, 1] },
            { "name": "bone", "translation": [0, 100, 0], "children": [1] },
            { "name": "lamp" },
        ],
        "animations": [{
            "name": "walk",
            "samplers": [
                { "input": 0, "output": 1, "interpolation": turn_kind },
                { "input": 0, "output": 2, "interpolation": place_kind },
            ],
            "channels": [
                { "sampler": 0, "target": { "node": 2, "path": "rotation" } },
                { "sampler": 1, "target": { "node": 1, "path": "translation" } },
                { "sampler": 1, "target": { "node": 1, "path": "scale" } },
            ],
        }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR" },
            { "bufferView": 1, "componentType": 5126, "count": turns.len() / 4, "type": "VEC4" },
            { "bufferView": 2, "componentType": 5126, "count": places.len() / 3, "type": "VEC3" },
        ],
        "bufferViews": [view(0, 2), view(2, turns.len()), view(2 + turns.len(), places.len())],
        "buffers": [{ "uri": format!("data:application/octet-stream;base64,{}", base64(&numbers)), "byteLength": 4 * numbers.len() }],
    })
}

const QUARTER: [f64; 4] = [0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2];
const NONE: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

#[test]
fn keys_of_all_kinds_scales_and_matrices_are_read() {
    let linear_turns = [NONE, QUARTER].concat();
    let linear_places = [30.0, 0.0, 0.0, 40.0, 0.0, 0.0];
    // In and out slopes of 0: half of the way in the middle, a tenth of the way times 3 - 2 / 10 at a tenth.
    let cubic = |a: &[f64], b: &[f64]| {
        [&vec![0.0; a.len()], a, &vec![0.0; a.len()], &vec![0.0; a.len()], b, &vec![0.0; a.len()]].concat()
    };
    let cubic_places = cubic(&linear_places[..3], &linear_places[3..]);
    for (kind, places, at_tenth) in [
        ("LINEAR", &linear_places[..], 31.0),
        ("STEP", &linear_places[..], 30.0),
        ("CUBICSPLINE", &cubic_places[..], 30.28),
    ] {
        let text = two_bones("LINEAR", &linear_turns, kind, places).to_string();
        let rig = read_gltf("a.gltf", text.as_bytes()).unwrap();
        let names: Vec<&str> = rig.joints.iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(names, ["Armature", "bone", "tip"], "the lamp is no joint");
        // Keys of a second: sampled ten times a second.
        assert_eq!((rig.frames.len(), rig.frame_time), (11, 0.1));
        let mut placed: Vec<Placement> = vec![];
        rig.place(None, &mut placed);
        let near = |v: Vector3<f64>, x: f64, y: f64, z: f64| (v - Vector3::new(x, y, z)).norm() < 1e-6;
        assert!(near(placed[1].translation.vector, 0.0, 1.0, 0.0) && near(placed[2].translation.vector, 0.3, 1.0, 0.0));
        let upright = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
        assert!(placed[2].rotation.angle_to(&upright) < 1e-6);
        rig.place(Some(1), &mut placed);
        let (sin, cos) = libm::sincos(std::f64::consts::FRAC_PI_2 / 10.0);
        let (x, y) = (0.01 * at_tenth * cos, 1.0 + 0.01 * at_tenth * sin);
        assert!(near(placed[2].translation.vector, x, y, 0.0), "{kind}: {} {x} {y}", placed[2].translation.vector);
        rig.place(Some(10), &mut placed);
        assert!(near(placed[2].translation.vector, 0.0, 1.4, 0.0), "{kind}: {}", placed[2].translation.vector);
        assert!(placed[2].rotation.angle_to(&(placed[1].rotation * upright)) < 1e-6, "a node without turns rests");
    }
}

#[test]
fn files_that_are_no_animation_are_refused_with_their_place() {
    let good = two_bones("LINEAR", &[NONE, QUARTER].concat(), "LINEAR", &[0.0; 6]);
    let refusal = |change: &dyn Fn(&mut Value)| {
        let mut file = good.clone();
        change(&mut file);
        read_gltf("a.gltf", file.to_string().as_bytes()).unwrap_err().to_string()
    };
    for (said, part) in [
        (
            refusal(&|f| f["asset"]["version"] = json!("1.0")),
            "/asset/version: the version is `1.0`; glTF 2.0 is accepted",
        ),
        (refusal(&|f| f["animations"] = json!([])), "/animations: the file has no animation"),
        (refusal(&|f| f["nodes"] = json!([])), "/nodes: the file has 0 nodes"),
        (refusal(&|f| f["nodes"][2]["children"] = json!([1, 0])), "/nodes: some nodes carry each other"),
        (refusal(&|f| f["nodes"][0]["children"] = json!([2, 1])), "the child 1 is not there, or has two parents"),
        (refusal(&|f| f["nodes"][0]["children"] = json!([9])), "the child 9 is not there"),
        (refusal(&|f| f["nodes"][2]["rotation"] = json!([0, 0, 0, 0])), "the node `bone` has no place, turn and scale"),
        (refusal(&|f| f["buffers"][0]["uri"] = json!("walk.bin")), "the buffer is in another file (`walk.bin`)"),
        (
            refusal(&|f| f["accessors"][1]["type"] = json!("VEC3")),
            "the accessor is of type `VEC3`, 4 numbers are needed",
        ),
        (refusal(&|f| f["accessors"][1]["count"] = json!(9)), "beyond the end of the buffer; was the file cut off?"),
        (refusal(&|f| f["accessors"][1]["count"] = json!(1)), "2 times and 4 numbers"),
        (refusal(&|f| f["accessors"][1]["sparse"] = json!({})), "the accessor is sparse"),
        (
            refusal(&|f| f["animations"][0]["samplers"][0]["interpolation"] = json!("BEZIER")),
            "the interpolation is `BEZIER`",
        ),
        (refusal(&|f| f["animations"][0]["channels"][0]["target"]["node"] = json!(44)), "names a node or a sampler"),
    ] {
        assert!(said.starts_with("a.gltf: /") && said.contains(part), "`{part}` is not in\n{said}");
    }
    assert!(read_gltf("a.glb", b"glTF\x02\0\0\0").unwrap_err().to_string().contains("was it cut off?"));
    assert!(read_gltf("a.gltf", b"{").unwrap_err().to_string().starts_with("a.gltf: JSON: "));
}

#[test]
fn mutated_files_are_read_or_refused() {
    const SEED: u64 = 2017;
    println!("seed {SEED}");
    let mut rng = Pcg64::new(u128::from(SEED), 0);
    let model = adult(&Adult::default()).unwrap();
    let plain = own_file(&model, &motion(&model, 5));
    let text = two_bones("LINEAR", &[NONE, QUARTER].concat(), "STEP", &[0.0; 6]).to_string().into_bytes();
    let (mut read, mut refused) = (0, 0);
    for round in 0..2000 {
        let mut bytes = if round % 2 == 0 { plain.clone() } else { text.clone() };
        for _ in 0..rng.random_range(1..4) {
            let at = rng.random_range(0..bytes.len());
            bytes[at] = if rng.random_bool(0.5) { rng.random() } else { b"0123456789-e."[rng.random_range(0..13)] };
        }
        if round % 20 == 0 {
            bytes.truncate(rng.random_range(0..bytes.len()));
        }
        match read_gltf("m.glb", &bytes) {
            Ok(rig) => {
                read += 1;
                assert!(rig.frames.iter().flatten().all(|value| value.is_finite()) && rig.frame_time > 0.0);
                let mut placed = vec![];
                rig.place(Some(0), &mut placed);
                assert!(placed.iter().all(|place| place.translation.vector.iter().all(|x| x.is_finite())));
            }
            Err(error) => {
                refused += 1;
                assert!(error.to_string().starts_with("m.glb: "), "{error}");
            }
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > 200 && refused > 200, "{read} {refused}");
}

#[test]
fn a_scale_that_is_not_the_same_along_its_axes_is_told_with_the_name_of_its_node() {
    let warnings = |scale: [f64; 3]| {
        let mut file = two_bones("LINEAR", &[NONE, QUARTER].concat(), "LINEAR", &[0.0; 6]);
        file["nodes"][0]["scale"] = json!(scale);
        let warnings = read_gltf("a.gltf", file.to_string().as_bytes()).unwrap().warnings;
        warnings.into_iter().filter(|warning| warning.contains("not the same along its axes")).collect::<Vec<_>>()
    };
    assert!(warnings([0.01, 0.01, 0.01]).is_empty() && warnings([0.01, 0.01, 0.010_000_1]).is_empty());
    let told = warnings([0.01, 0.02, 0.01]);
    assert!(told.len() == 1 && told[0].contains("`Armature`"), "{told:?}");
}
