//! Compares the torques of moving bodies with numbers of Pinocchio, MuJoCo and OpenSim (`scripts/inertia_reference.py`): of small models
//! that our writers wrote (`written/`) and of published models (`../shared`).

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests: helpers outside #[test] functions too")]

#[path = "common/shared.rs"]
mod shared;

use std::path::Path;

use contrapposto::dynamics::Inertia;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::ExternalTorque;
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::{mjcf, osim, urdf};
use serde_json::Value;

/// Greatest difference over the greatest torque of a case.
const RELATIVE: f64 = 1e-10;
/// Greatest difference from OpenSim, N m.
const OPENSIM: f64 = 1e-6;

fn read(case: &Value) -> Model {
    let file = case["file"].as_str().unwrap();
    let written = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/written").join(file);
    let path = if case["where"] == "written" { written } else { shared::shared(file) };
    let bytes = std::fs::read(path).unwrap();
    if file.ends_with(".urdf") {
        let root = if case["free"] == true { RootAttachment::Free } else { RootAttachment::Fixed };
        urdf::read(&bytes, file, &urdf::Options { root, ..urdf::Options::default() }).unwrap().model().unwrap().model
    } else if file.ends_with(".osim") {
        osim::read(&bytes, file).unwrap().model().unwrap().model
    } else {
        let mut include = |_: &str| Err("no includes here".to_owned());
        mjcf::read(&bytes, file, &mut include, &mjcf::Options::default()).unwrap().model().unwrap().model
    }
}

/// Entries of the model's rates by the names of the reference.
fn by_rate(model: &Model, named: &Value) -> Vec<f64> {
    model.rates().iter().map(|rate| named[&rate.name].as_f64().unwrap_or_else(|| panic!("{}", rate.name))).collect()
}

fn compare(place: &str) -> usize {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/inertia_reference.json");
    let data: Value = serde_json::from_slice(&std::fs::read(data).unwrap()).unwrap();
    let mut compared = 0;
    for reference in data["models"].as_array().unwrap().iter().filter(|reference| reference["where"] == place) {
        let model = read(reference);
        let (mut kinematics, mut external) = (Kinematics::new(&model), ExternalTorque::new(&model));
        let mut inertia = Inertia::new(&model);
        let (mut relative, mut largest) = (0f64, 0f64);
        for case in reference["cases"].as_array().unwrap() {
            let value = |c: &contrapposto::model::Coordinate| case["q"][&c.name].as_f64().unwrap();
            let posture = Posture::new(model.coordinates().iter().map(value).collect());
            kinematics.update(&model, &posture).unwrap();
            let (speeds, accelerations) = (by_rate(&model, &case["speed"]), by_rate(&model, &case["acceleration"]));
            inertia.update(&model, &kinematics, (&speeds, &accelerations), &[]).unwrap();
            external.update(&model, &kinematics, inertia.loads()).unwrap();
            let theirs = by_rate(&model, &case["torque"]);
            let size = theirs.iter().fold(0f64, |size, torque| size.max(torque.abs()));
            let difference = external.torques().iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(size > 1.0, "{}: no torque", reference["file"]);
            (relative, largest) = (relative.max(difference / size), largest.max(difference));
            compared += 1;
        }
        println!("{} by {}: {relative:.1e} relative, {largest:.1e} N m", reference["file"], reference["tool"]);
        let opensim = reference["tool"].as_str().unwrap().starts_with("opensim");
        assert!(if opensim { largest < OPENSIM } else { relative < RELATIVE }, "{}", reference["file"]);
    }
    compared
}

#[test]
fn moving_written_models_are_pinocchios_mujocos_and_opensims() {
    assert_eq!(compare("written"), 8 * 3);
}

#[test]
#[ignore = "needs ../shared: published models, moving, with torques by Pinocchio, MuJoCo and OpenSim"]
fn moving_published_models_are_pinocchios_mujocos_and_opensims() {
    assert_eq!(compare("shared"), 7 * 3);
}
