//! Compares the torques of moving bodies with numbers of Pinocchio, MuJoCo and OpenSim (`scripts/inertia_reference.py`): of small models
//! that our writers wrote (`written/`) and of published models (`../shared`). Filters, splines and inverse dynamics of motions are
//! compared with OpenSim's (`scripts/rates_reference.py`).

use crate::common::shared;

use std::path::Path;

use contrapposto::dynamics::{Inertia, Smoothing, differentiate};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{CoordinateSpec, JointKind, Model, ModelBuilder, Placement, SegmentSpec};
use contrapposto::posture::Posture;
use contrapposto::statics::ExternalTorque;
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::{mjcf, osim, urdf};
use nalgebra::{Matrix3, Vector3};
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
            let mut loads = vec![];
            inertia.add_loads(&model, &kinematics, &mut loads);
            external.update(&model, &kinematics, &loads).unwrap();
            let theirs = by_rate(&model, &case["torque"]);
            // The torques of inertia added to those of weight: the same by one pass less.
            let mut summed = ExternalTorque::new(&model);
            inertia.external_torque(&model, &kinematics, &[], &mut summed).unwrap();
            let size = theirs.iter().fold(0f64, |size, torque| size.max(torque.abs()));
            let difference = external.torques().iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(size > 1.0, "{}: no torque", reference["file"]);
            let apart = external.torques().iter().zip(summed.torques()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < RELATIVE * size, "{}: {apart:e} N m of {size} between both ways", reference["file"]);
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

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn rates_reference() -> Value {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/rates_reference.json");
    serde_json::from_slice(&std::fs::read(data).unwrap()).unwrap()
}

/// A body with one slide.
fn slide() -> Model {
    let mut builder = ModelBuilder::new("slide", Vector3::zeros());
    builder
        .segment(SegmentSpec {
            name: "body".to_owned(),
            parent: None,
            mass: 1.0,
            center_of_mass: Vector3::zeros(),
            inertia: Matrix3::identity(),
            joint: "joint".to_owned(),
            kind: JointKind::Slide(Vector3::x_axis()),
            in_parent: Placement::identity(),
            in_segment: Placement::identity(),
            coordinates: vec![CoordinateSpec::new("q", (-9.0, 9.0))],
        })
        .unwrap();
    builder.build()
}

/// Value, speed and acceleration at every frame of motions at even and uneven times, filtered and not.
#[test]
fn values_speeds_and_accelerations_of_motions_are_opensims() {
    let data = rates_reference();
    let model = slide();
    let signals = data["signals"].as_array().unwrap();
    assert_eq!(signals.len(), 4);
    for signal in signals {
        let times = numbers(&signal["times"]);
        let values = numbers(&signal["values"]);
        let motion: Vec<_> = times.iter().zip(values).map(|(&time, value)| (time, Posture::new(vec![value]))).collect();
        let filtered = signal["filtered"] == true;
        let cutoff = data["cutoff"].as_f64().unwrap();
        let smoothing = if filtered { Smoothing::OpenSim(cutoff) } else { Smoothing::None };
        let moving = differentiate(&model, &motion, smoothing).unwrap();
        let (mut worst, mut size) = ([0f64; 3], [0f64; 3]);
        for (i, row) in signal["rows"].as_array().unwrap().iter().enumerate() {
            let rates = &moving.rates[i];
            let ours = [moving.motion[i].1.values()[0], rates.speeds[0], rates.accelerations[0]];
            for (k, theirs) in numbers(row).into_iter().enumerate() {
                worst[k] = worst[k].max((ours[k] - theirs).abs());
                size[k] = size[k].max(theirs.abs());
            }
        }
        println!("filtered {filtered}: differences {worst:?} of {size:?}");
        assert!((0..3).all(|k| worst[k] < 1e-9 * size[k]), "{worst:?}");
    }
}

/// From the values of a motion to torques: OpenSim's InverseDynamicsTool on the same model and motion.
#[test]
fn inverse_dynamics_of_a_recorded_motion_is_opensims() {
    let data = rates_reference();
    let tool = &data["inverse_dynamics"];
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/written/right_arm.osim");
    let model = osim::read(&std::fs::read(path).unwrap(), "right_arm.osim").unwrap().model().unwrap().model;
    let columns: Vec<Vec<f64>> =
        model.coordinates().iter().map(|coordinate| numbers(&tool["motion"][&coordinate.name])).collect();
    let posture = |i: usize| Posture::new(columns.iter().map(|column| column[i]).collect());
    let motion: Vec<_> = numbers(&tool["times"]).into_iter().enumerate().map(|(i, time)| (time, posture(i))).collect();
    let moving = differentiate(&model, &motion, Smoothing::OpenSim(data["cutoff"].as_f64().unwrap())).unwrap();
    let (mut kinematics, mut external) = (Kinematics::new(&model), ExternalTorque::new(&model));
    let mut inertia = Inertia::new(&model);
    let (mut worst, mut size, mut moved) = (0f64, 0f64, 0f64);
    let times = numbers(&tool["force_times"]);
    assert_eq!(times.len(), motion.len());
    for (i, (time, posture)) in moving.motion.iter().enumerate() {
        assert!((times[i] - time).abs() < 1e-9);
        kinematics.update(&model, posture).unwrap();
        let rates = &moving.rates[i];
        inertia.update(&model, &kinematics, (&rates.speeds, &rates.accelerations), &[]).unwrap();
        let mut loads = vec![];
        inertia.add_loads(&model, &kinematics, &mut loads);
        external.update(&model, &kinematics, &loads).unwrap();
        for (rate, torque) in model.rates().iter().zip(external.torques()) {
            let theirs = numbers(&tool["forces"][&rate.name])[i];
            worst = worst.max((torque + theirs).abs());
            size = size.max(theirs.abs());
        }
        moved = inertia.torques().iter().fold(moved, |most, torque| most.max(torque.abs()));
    }
    println!("inverse dynamics: {worst:.1e} of {size:.2} N m, inertia {moved:.2} N m");
    // OpenSim's file has eight decimals, and its interpolated times shift by rounding.
    assert!(worst < 1e-6 && moved > 0.1, "{worst}");
}
