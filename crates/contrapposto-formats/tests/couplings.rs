//! Tests dependent coordinates, also of dependent ones: torques and gradients by central differences, beside a
//! model whose chains were composed by hand, and beside OpenSim.

use contrapposto::kinematics::Kinematics;
use contrapposto::math::Function;
use contrapposto::model::{CoordinateSpec, JointKind, Model, ModelBuilder, SegmentSpec};
use contrapposto::posture::Posture;
use contrapposto::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadKind};
use contrapposto_formats::osim;
use nalgebra::{Isometry3, Matrix3, Translation3, Unit, UnitQuaternion, Vector3};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// A chain of hinges `a`, `x`, `b`, `c`, `d` about axes that are not parallel.
fn chain(couplings: &[(&str, &str, Function)]) -> Model {
    let mut builder = ModelBuilder::new("chain", Vector3::new(0.3, -9.8, 0.1));
    let axes = [[0.0, 0.0, 1.0], [1.0, 0.2, 0.0], [0.1, 0.3, 1.0], [0.2, 1.0, -0.4], [0.0, -0.6, 0.8]];
    let mut parent = None;
    for (name, axis) in ["a", "x", "b", "c", "d"].into_iter().zip(axes) {
        let turn = UnitQuaternion::from_euler_angles(0.1, -0.2, 0.3);
        let spec = SegmentSpec {
            name: format!("s{name}"),
            parent: parent.replace(format!("s{name}")),
            mass: 1.5,
            center_of_mass: Vector3::new(0.05, -0.1, 0.02),
            inertia: Matrix3::identity(),
            joint: format!("j{name}"),
            kind: JointKind::Hinge(Unit::new_normalize(Vector3::from(axis))),
            in_parent: Isometry3::from_parts(Translation3::new(0.02, -0.3, 0.01), turn),
            in_segment: Isometry3::identity(),
            coordinates: vec![CoordinateSpec::new(name, (-3.0, 3.0))],
        };
        builder.segment(spec).unwrap();
    }
    for (dependent, independent, function) in couplings {
        builder.couple(dependent, independent, function.clone()).unwrap();
    }
    builder.build()
}

fn loads() -> [Load; 3] {
    let load = |segment, kind| Load { segment, point: Vector3::new(0.1, -0.05, 0.2), kind };
    [
        load(4, LoadKind::Force(Vector3::new(3.0, -20.0, 5.0), FixedIn::World)),
        load(3, LoadKind::Force(Vector3::new(-4.0, 6.0, 2.0), FixedIn::Segment)),
        load(4, LoadKind::Couple(Vector3::new(0.5, 1.0, -2.0), FixedIn::Segment)),
    ]
}

/// Torque of every rate, folded and raw, and the gradient.
fn statics(model: &Model, values: &[f64]) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let (mut kinematics, mut external) = (Kinematics::new(model), ExternalTorque::new(model));
    kinematics.update(model, &Posture::new(values.to_vec())).unwrap();
    external.update(model, &kinematics, &loads()).unwrap();
    let mut gradient = Gradient::new(model);
    external.gradient(model, &kinematics, &mut gradient);
    let rows = (0..gradient.size()).flat_map(|row| gradient.row(row).to_vec()).collect();
    (external.torques().to_vec(), external.uncoupled_torques(model).to_vec(), rows)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}

/// b = 0.2 + 0.7 a - 0.3 a^2, c = 0.1 - 0.5 b + 0.4 b^2, d = -0.8 c.
fn towers() -> [(&'static str, &'static str, Function); 3] {
    [
        ("b", "a", Function::Polynomial(vec![0.2, 0.7, -0.3])),
        ("c", "b", Function::Polynomial(vec![0.1, -0.5, 0.4])),
        ("d", "c", Function::Linear { slope: -0.8, intercept: 0.0 }),
    ]
}

const VALUES: [[f64; 5]; 3] = [[0.0; 5], [0.4, -0.7, 9.0, 9.0, 9.0], [-1.1, 0.6, 0.0, 1.0, 2.0]];

#[test]
fn chains_of_followers_are_as_composed_by_hand() {
    let composed = [
        ("b", "a", Function::Polynomial(vec![0.2, 0.7, -0.3])),
        // 0.1 - 0.5 (0.2 + 0.7 a - 0.3 a^2) + 0.4 (0.04 + 0.28 a + 0.37 a^2 - 0.42 a^3 + 0.09 a^4)
        ("c", "a", Function::Polynomial(vec![0.016, -0.238, 0.298, -0.168, 0.036])),
        ("d", "a", Function::Polynomial(vec![-0.0128, 0.1904, -0.2384, 0.1344, -0.0288])),
    ];
    let by_hand = chain(&composed);
    let [b, c, d] = towers();
    for order in [[&b, &c, &d], [&d, &c, &b], [&c, &d, &b], [&d, &b, &c]] {
        let model = chain(&order.map(Clone::clone));
        let follower = |i: usize| model.couplings()[i].dependent;
        assert_eq!([follower(0), follower(1), follower(2)], [2, 3, 4], "leaders first");
        for values in VALUES {
            let (ours, expected) = (statics(&model, &values), statics(&by_hand, &values));
            assert!(distance(&ours.0, &expected.0) < 1e-12 && distance(&ours.1, &expected.1) < 1e-12);
            assert!(distance(&ours.2, &expected.2) < 1e-11, "{:e}", distance(&ours.2, &expected.2));
            assert!(ours.0[2..].iter().all(|&torque| torque == 0.0), "followers have given all they have");
        }
    }
}

#[test]
fn gradients_of_chains_by_central_differences() {
    let model = chain(&towers());
    let (n, h) = (5, 1e-5);
    for values in VALUES {
        let gradient = statics(&model, &values).2;
        for column in 0..n {
            let at = |by: f64| {
                let mut moved = values;
                moved[column] += by;
                statics(&model, &moved).0
            };
            let (more, less) = (at(h), at(-h));
            for row in 0..n {
                let slope = (more[row] - less[row]) / (2.0 * h);
                let error = (gradient[row * n + column] - slope).abs();
                assert!(error < 1e-7, "{row}, {column}: {error:e}");
            }
        }
    }
}

#[test]
fn circles_and_second_leaders_are_refused() {
    let mut builder = ModelBuilder::new("m", Vector3::zeros());
    for name in ["a", "b", "c"] {
        builder
            .segment(SegmentSpec {
                name: name.to_owned(),
                parent: None,
                mass: 1.0,
                center_of_mass: Vector3::zeros(),
                inertia: Matrix3::identity(),
                joint: name.to_owned(),
                kind: JointKind::Hinge(Vector3::z_axis()),
                in_parent: Isometry3::identity(),
                in_segment: Isometry3::identity(),
                coordinates: vec![CoordinateSpec::new(name, (-1.0, 1.0))],
            })
            .unwrap();
    }
    let mut couple = |d, i| builder.couple(d, i, Function::Constant(0.0)).map_err(|e| e.to_string());
    assert_eq!(couple("a", "a").unwrap_err(), "`a` cannot follow `a`: it would follow itself");
    couple("b", "a").unwrap();
    couple("c", "b").unwrap();
    assert_eq!(couple("a", "c").unwrap_err(), "`a` cannot follow `c`: it would follow itself");
    assert_eq!(couple("c", "a").unwrap_err(), "`c` cannot follow `a`: it already follows another coordinate");
}

fn numbers(value: &Value) -> BTreeMap<String, f64> {
    value.as_object().unwrap().iter().map(|(name, x)| (name.clone(), x.as_f64().unwrap())).collect()
}

/// The file of the project among those that `scripts/opensim_reference.py` asks OpenSim about.
const OURS: &str = "coupled.osim";

#[test]
fn our_coupled_body_is_opensims() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models");
    coupled_bodies_are_opensims(&folder, |file| file == OURS);
}

#[test]
#[ignore = "needs CONTRAPPOSTO_OPENSIM_MODELS: a folder of published full bodies and arms"]
fn published_coupled_bodies_are_opensims() {
    let folder =
        std::env::var_os("CONTRAPPOSTO_OPENSIM_MODELS").expect("CONTRAPPOSTO_OPENSIM_MODELS: a folder of models");
    coupled_bodies_are_opensims(Path::new(&folder), |file| file != OURS);
}

/// Compares raw and folded torques, places of dependent coordinates and the centre of mass with OpenSim 4.6
/// (`scripts/opensim_reference.py`).
fn coupled_bodies_are_opensims(folder: &Path, wanted: impl Fn(&str) -> bool) {
    let reference: Value = serde_json::from_str(include_str!("data/opensim_torques.json")).unwrap();
    let models = reference["models"].as_array().unwrap();
    let entries: Vec<&Value> = models.iter().filter(|entry| wanted(entry["file"].as_str().unwrap())).collect();
    assert!(!entries.is_empty());
    for entry in entries {
        let file = entry["file"].as_str().unwrap();
        let bytes = std::fs::read(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        let read = || osim::read(&bytes, file).unwrap_or_else(|e| panic!("{e}")).model().unwrap().model;
        let timed = |_| {
            let start = Instant::now();
            drop(read());
            start.elapsed().as_secs_f64()
        };
        let seconds = (0..5).map(timed).fold(f64::INFINITY, f64::min);
        let model = read();
        let (mut kinematics, mut external) = (Kinematics::new(&model), ExternalTorque::new(&model));
        let mut worst = [0.0_f64; 5];
        for case in entry["cases"].as_array().unwrap() {
            let [q, raw, folded, passive] = ["q", "raw", "folded", "passive"].map(|key| numbers(&case[key]));
            assert!(q.len() >= model.coordinates().len() && folded.len() + model.couplings().len() == q.len());
            // Followers are left anywhere: they have to find their own place.
            let mut values: Vec<f64> = model.coordinates().iter().map(|c| q[&c.name]).collect();
            model.couplings().iter().for_each(|coupling| values[coupling.dependent] = 0.123);
            kinematics.update(&model, &Posture::new(values)).unwrap();
            external.update(&model, &kinematics, &[]).unwrap();
            for (i, coordinate) in model.coordinates().iter().enumerate() {
                let (name, rate) = (&coordinate.name, coordinate.rate.unwrap());
                worst[0] = worst[0].max((kinematics.values()[i] - q[name]).abs());
                // OpenSim prints what actuators must supply.
                worst[1] = worst[1].max((-external.uncoupled_torques(&model)[rate] - raw[name]).abs());
                let law = coordinate.passive.as_ref();
                let torque = law.map_or(0.0, |law| law.torque(i, kinematics.values()));
                worst[4] = worst[4].max((torque - passive.get(name).unwrap_or(&0.0)).abs());
                if let Some(theirs) = folded.get(name) {
                    worst[2] = worst[2].max((-external.torques()[rate] - theirs).abs());
                }
            }
            let center = kinematics.center_of_mass(&model).unwrap();
            let theirs: Vec<f64> = case["center"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
            worst[3] = worst[3].max((center - Vector3::from_vec(theirs)).amax());
        }
        let (coordinates, couplings, milliseconds) =
            (model.coordinates().len(), model.couplings().len(), 1e3 * seconds);
        println!(
            "{file}: {coordinates} coordinates, {couplings} couplings, read in {milliseconds:.1} ms; followers {:.1e}, raw \
             {:.1e} N m, folded {:.1e} N m, centre of mass {:.1e} m, passive {:.1e} N m",
            worst[0], worst[1], worst[2], worst[3], worst[4]
        );
        let most = [1e-12, 1e-9, 1e-9, 1e-12, 1e-9];
        assert!(worst.iter().zip(most).all(|(worst, most)| *worst < most), "{file}: {worst:?}");
        assert!(seconds < 0.05, "{file} took {seconds} s");
    }
}
