//! The `.osim` reader: bodies are where OpenSim 4.6 puts them, functions and forces have its values, and what matters and is
//! not supported is refused with its place. References: `scripts/opensim_reference.py`; published models in `../shared`.

use crate::common::shared;

use contrapposto_formats::model_ir::{CoordinateKind, Drive, Function, ModelIr, MotionIr, PassiveLawIr, Spline};
use contrapposto_formats::osim;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use serde_json::Value;
use std::path::Path;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| value.as_str().unwrap().parse().unwrap())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

fn strings(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|v| v.as_str().unwrap()).collect()
}

/// Poses of all segments in ground; `value` gives a coordinate's value by name.
fn poses(body: &ModelIr, value: impl Fn(&str) -> f64) -> Vec<Isometry3<f64>> {
    let drive = |d: &Drive| match d {
        Drive::Coordinate(i) => value(&body.coordinates[*i].name),
        Drive::Function(f, i) => f.value(value(&body.coordinates[*i].name)),
        Drive::Fixed(v) => *v,
    };
    let mut poses: Vec<Isometry3<f64>> = Vec::new();
    for segment in &body.segments {
        let parent = segment.parent.map_or_else(Isometry3::identity, |p| poses[p]);
        let joint = segment.motions.iter().fold(segment.in_parent, |pose, motion| match motion {
            MotionIr::Hinge { axis, drive: d } => {
                pose * UnitQuaternion::from_axis_angle(&Unit::new_normalize(*axis), drive(d))
            }
            MotionIr::Slide { axis, drive: d } => pose * Translation3::from(axis * drive(d)),
            MotionIr::Ball { .. } => unreachable!("no quaternions in OpenSim's coordinates"),
        });
        poses.push(parent * joint * segment.in_segment.inverse());
    }
    poses
}

/// Largest difference of pose over all segments that OpenSim lists.
fn compare_poses(body: &ModelIr, poses: &[Isometry3<f64>], bodies: &Value, most: f64) -> f64 {
    let mut worst: f64 = 0.0;
    for (segment, pose) in body.segments.iter().zip(poses) {
        let theirs = &bodies[&segment.name];
        let origin = Vector3::from_vec(numbers(&theirs["origin"]));
        let rotation = pose.rotation.to_rotation_matrix();
        let mut error = (pose.translation.vector - origin).amax();
        for (i, row) in theirs["R"].as_array().unwrap().iter().enumerate() {
            for (j, entry) in numbers(row).into_iter().enumerate() {
                error = error.max((rotation[(i, j)] - entry).abs());
            }
        }
        assert!(error < most, "{}: {error:e}", segment.name);
        worst = worst.max(error);
    }
    worst
}

fn torque(law: &PassiveLawIr, q: f64) -> f64 {
    match law {
        PassiveLawIr::CoordinateLimitForce(law) => {
            let step = |x: f64| {
                let x = x.clamp(0.0, 1.0);
                x * x * x * (10.0 + x * (-15.0 + 6.0 * x))
            };
            let (above, below) = (q - law.upper_limit, law.lower_limit - q);
            law.lower_stiffness * step(below / law.transition) * below
                - law.upper_stiffness * step(above / law.transition) * above
        }
        PassiveLawIr::Spring { stiffness, rest } => -stiffness * (q - rest),
        PassiveLawIr::Expression(expression) => expression.value(q),
        other => panic!("{other:?}"),
    }
}

fn fixture(file: &str) -> ModelIr {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models").join(file);
    osim::read(&std::fs::read(path).unwrap(), file).unwrap_or_else(|e| panic!("{e}"))
}

fn references() -> Value {
    serde_json::from_str(include_str!("data/opensim_models.json")).unwrap()
}

#[test]
fn every_joint_kind_is_where_opensim_puts_it() {
    for model in references()["models"].as_array().unwrap() {
        let body = fixture(model["file"].as_str().unwrap());
        let names = strings(&model["coordinates"]);
        let mut ours: Vec<&str> = body.coordinates.iter().map(|c| c.name.as_str()).collect();
        let mut theirs = names.clone();
        ours.sort_unstable();
        theirs.sort_unstable();
        assert_eq!(ours, theirs);
        let (mut worst, mut worst_force): (f64, f64) = (0.0, 0.0);
        for case in model["cases"].as_array().unwrap() {
            let q = numbers(&case["q"]);
            let value = |name: &str| q[names.iter().position(|n| *n == name).unwrap()];
            let poses = poses(&body, value);
            assert_eq!(case["bodies"].as_object().unwrap().len(), body.segments.len());
            worst = worst.max(compare_poses(&body, &poses, &case["bodies"], 1e-12));
            for (name, segment, position) in &body.stations {
                let ours = poses[*segment] * nalgebra::Point3::from(*position);
                let theirs = Vector3::from_vec(numbers(&case["markers"][name]));
                assert!((ours.coords - theirs).amax() < 1e-12, "{name}");
            }
            assert_eq!(case["forces"].as_object().unwrap().len(), body.passive.len());
            for passive in &body.passive {
                let ours = torque(&passive.law, value(&body.coordinates[passive.coordinate].name));
                let theirs = number(&case["forces"][&passive.name]);
                let error = (ours - theirs).abs() / theirs.abs().max(1.0);
                assert!(error < 1e-12, "{}: {ours}, OpenSim {theirs}", passive.name);
                worst_force = worst_force.max(error);
            }
        }
        for coordinate in &body.coordinates {
            let range = numbers(&model["range"][&coordinate.name]);
            assert_eq!((coordinate.range.0, coordinate.range.1), (range[0], range[1]), "{}", coordinate.name);
            assert_eq!(coordinate.default, number(&model["default"][&coordinate.name]), "{}", coordinate.name);
            match number(&model["motion_type"][&coordinate.name]) as i64 {
                1 => assert_eq!(coordinate.kind, CoordinateKind::Rotation, "{}", coordinate.name),
                2 => assert_eq!(coordinate.kind, CoordinateKind::Translation, "{}", coordinate.name),
                _ => {}
            }
        }
        for pair in model["coupled_pin_angle_slide"].as_array().unwrap() {
            let pair = numbers(pair);
            let coupling = &body.couplings[0];
            assert_eq!(body.coordinates[coupling.dependent].name, "slide");
            // OpenSim's assembly is iterative.
            assert!((coupling.function.value(pair[0]) - pair[1]).abs() < 1e-8, "{pair:?}");
        }
        let mass: f64 = body.segments.iter().map(|s| s.mass).sum();
        assert!((mass - number(&model["mass"])).abs() < 1e-12);
        println!("{}: poses to {worst:.1e}, forces to {worst_force:.1e}", model["file"]);
    }
}

#[test]
fn what_is_read_past_is_reported() {
    let body = fixture("joints_4x.osim");
    let kinds: Vec<(&str, usize)> = body.ignored.iter().map(|(kind, n)| (kind.as_str(), *n)).collect();
    assert_eq!(
        kinds,
        [
            ("actuators", 1),
            ("constraints switched off", 1),
            ("forces switched off", 1),
            ("inertias that are not finite", 1),
            ("markers", 1),
            ("markers fixed to ground", 1),
            ("muscles", 1),
            ("wrap objects", 1),
        ]
    );
    let named = |name: &str| body.coordinates.iter().find(|c| c.name == name).unwrap();
    assert!(named("root_ty").locked && !named("root_tx").locked);
    assert!(named("pin_angle").clamped && !named("slide").clamped);
}

#[test]
fn functions_are_those_of_opensim() {
    let reference: Value = serde_json::from_str(include_str!("data/opensim_functions.json")).unwrap();
    let mut worst: f64 = 0.0;
    for row in reference["functions"].as_array().unwrap() {
        let list = |name: &str| numbers(&row[name]);
        let function = match row["kind"].as_str().unwrap() {
            "simm_spline" => Function::Spline(Spline::simm(&list("x"), &list("y")).unwrap()),
            "gcv_spline_cubic" => Function::NaturalSpline(Spline::natural(&list("x"), &list("y")).unwrap()),
            "piecewise_linear" => Function::Spline(Spline::piecewise_linear(&list("x"), &list("y")).unwrap()),
            "polynomial_highest_first" => Function::Polynomial(list("coefficients").into_iter().rev().collect()),
            "sine" => {
                let p = list("parameters");
                Function::Sine { amplitude: p[0], omega: p[1], phase: p[2], offset: p[3] }
            }
            other => panic!("{other}"),
        };
        for values in row["values"].as_array().unwrap() {
            let values = numbers(values);
            let ours = function.value_slope_curvature(values[0]);
            for (ours, theirs) in ours.iter().zip(&values[1..]) {
                let error = (ours - theirs).abs() / theirs.abs().max(1.0);
                assert!(error < 1e-10, "{} at {}: {ours}, OpenSim {theirs}", row["kind"], values[0]);
                worst = worst.max(error);
            }
        }
    }
    println!("functions to {worst:.1e} (value, first and second derivative)");
}

#[test]
#[ignore = "needs ../shared: published OpenSim models with OpenSim's own numbers"]
fn published_models() {
    let cases = [
        ("arm26.osim", "opensim_arm26.json", 3, 2, 6),
        ("gait2392_thelen2003muscle.osim", "opensim_gait2392_first5.json", 12, 23, 92),
    ];
    for (file, vectors, segments, coordinates, muscles) in cases {
        let text = std::fs::read(shared(&format!("models/opensim/{file}"))).unwrap();
        let mut fastest = f64::INFINITY;
        for _ in 0..5 {
            let start = std::time::Instant::now();
            osim::read(&text, file).unwrap();
            fastest = fastest.min(start.elapsed().as_secs_f64());
        }
        let body = osim::read(&text, file).unwrap();
        assert_eq!((body.segments.len(), body.coordinates.len()), (segments, coordinates));
        assert!(body.couplings.is_empty() && body.passive.is_empty());
        assert!(body.ignored.contains(&("muscles".to_owned(), muscles)), "{:?}", body.ignored);
        println!("{file}: {:.1} ms, {:?}", 1e3 * fastest, body.ignored);
        assert!(fastest < 0.05, "{file}: {fastest} s");
        let vectors: Value =
            serde_json::from_str(&std::fs::read_to_string(shared(&format!("vectors/{vectors}"))).unwrap()).unwrap();
        let mut worst: f64 = 0.0;
        for case in vectors["cases"].as_array().unwrap() {
            let poses = poses(&body, |name| number(&case["q"][name]));
            worst = worst.max(compare_poses(&body, &poses, &case["bodies"], 1e-9));
            let mass: f64 = body.segments.iter().map(|s| s.mass).sum();
            let com = body
                .segments
                .iter()
                .zip(&poses)
                .map(|(s, p)| (p * nalgebra::Point3::from(s.center_of_mass)).coords * s.mass);
            let com = com.sum::<Vector3<f64>>() / mass;
            assert!((com - Vector3::from_vec(numbers(&case["com"]))).amax() < 1e-9);
        }
        for coordinate in &body.coordinates {
            assert_eq!(vec![coordinate.range.0, coordinate.range.1], numbers(&vectors["range"][&coordinate.name]));
        }
        println!("{file}: poses to {worst:.1e}");
    }
}
