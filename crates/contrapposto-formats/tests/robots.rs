//! Compares torques, springs, gradients, centres of mass and Jacobians of robots with Pinocchio (URDF) and MuJoCo (MJCF).
//!
//! The small humanoid of the project is compared everywhere; published robots in the folder that `CONTRAPPOSTO_ROBOT_MODELS`
//! names, after `scripts/pinocchio_reference.py FOLDER` and `scripts/mujoco_reference.py FOLDER` wrote their numbers beside them.

use crate::common;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use common::{here, shared};
use contrapposto::kinematics::{CenterOfMass, Kinematics};
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::{ExternalTorque, Gradient};
use contrapposto_formats::model_ir::RootAttachment;
use contrapposto_formats::{mjcf, urdf};
use nalgebra::Vector3;
use serde_json::Value;

/// Greatest difference, and greatest size of what it is compared with.
#[derive(Clone, Copy, Default)]
struct Difference {
    worst: f64,
    size: f64,
}

impl Difference {
    fn add(&mut self, ours: &[f64], theirs: &Value) {
        if theirs.is_null() {
            return;
        }
        let theirs = numbers(theirs);
        assert_eq!(ours.len(), theirs.len());
        for (a, b) in ours.iter().zip(&theirs) {
            self.worst = if (a - b).is_nan() { f64::INFINITY } else { self.worst.max((a - b).abs()) };
            self.size = self.size.max(b.abs());
        }
    }

    /// Of a quantity whose numbers are all about zero (N m, m, m/rad) the difference itself.
    fn relative(self) -> f64 {
        self.worst / if self.size < 1e-6 { 1.0 } else { self.size }
    }
}

const KINDS: [&str; 7] = ["torque", "folded torque", "gradient", "centre of mass", "links", "Jacobians", "springs"];
const MOST: f64 = 1e-9;

/// All numbers of nested lists.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap()],
    }
}

/// Compares all cases of one root, and says how far they are apart.
fn compare(model: &Model, reference: &Value) -> (String, bool) {
    let n = model.rates().len();
    let named = |name: &Value| {
        let found = model.rates().iter().position(|rate| rate.name == name.as_str().unwrap());
        found.unwrap_or_else(|| panic!("no rate {name}"))
    };
    // Where the reference names no rates it has ours in order.
    let rates: Vec<usize> = reference["rates"].as_array().map_or((0..n).collect(), |r| r.iter().map(named).collect());
    assert_eq!(rates.len(), n, "as many rates as the reference has");
    let pick = |row: &[f64]| -> Vec<f64> { rates.iter().map(|&rate| row[rate]).collect() };
    let (mut kinematics, mut external) = (Kinematics::new(model), ExternalTorque::new(model));
    let (mut gradient, mut center) = (Gradient::new(model), CenterOfMass::new(model));
    let mut found = [Difference::default(); KINDS.len()];
    for case in reference["cases"].as_array().unwrap() {
        let mut values = model.default_posture().values().to_vec();
        match &case["values"] {
            Value::Object(named) => {
                named.iter().for_each(|(name, value)| values[model.coordinate(name).unwrap()] = value.as_f64().unwrap())
            }
            ordered => values.copy_from_slice(&numbers(ordered)),
        }
        // Followers find their own place.
        model.couplings().iter().for_each(|coupling| values[coupling.dependent] = 0.123);
        kinematics.update(model, &Posture::new(values)).unwrap();
        external.update(model, &kinematics, &[]).unwrap();
        external.gradient(model, &kinematics, &mut gradient);
        center.update(model, &kinematics);
        found[0].add(&pick(external.uncoupled_torques(model)), &case["raw"]);
        found[1].add(&pick(external.torques()), &case["torque"]);
        let rows: Vec<f64> = rates.iter().flat_map(|&row| pick(gradient.row(row))).collect();
        found[2].add(&rows, &case["gradient"]);
        let springs = model.rates().iter().map(|rate| {
            let law = rate.coordinate.and_then(|i| Some((i, model.coordinates()[i].passive.as_ref()?)));
            law.map_or(0.0, |(i, law)| law.torque(i, kinematics.values()))
        });
        found[6].add(&pick(&springs.collect::<Vec<_>>()), &case["passive"]);
        let mut rows = vec![0.0; 3 * n];
        let picked = |rows: &[f64]| -> Vec<f64> { rows.chunks(n.max(1)).flat_map(pick).collect() };
        if let Some(center_of_mass) = center.position().filter(|_| !case["center"].is_null()) {
            found[3].add(center_of_mass.as_slice(), &case["center"]);
            center.jacobian(model, &kinematics, &mut rows);
            found[5].add(&picked(&rows), &case["center_jacobian"]);
        }
        for (name, link) in case["links"].as_object().unwrap() {
            let segment = model.segment(name).unwrap();
            let placement = kinematics.placement(model, segment);
            found[4].add(placement.translation.vector.as_slice(), &link["position"]);
            let rotation = placement.rotation.to_rotation_matrix();
            found[4].add(rotation.matrix().transpose().as_slice(), &link["rotation"]);
            kinematics.point_jacobian(model, segment, Vector3::zeros(), &mut rows);
            let mut both = picked(&rows);
            kinematics.rotation_jacobian(model, segment, &mut rows);
            both.extend(picked(&rows));
            found[5].add(&both, &link["jacobian"]);
        }
    }
    let mut line = String::new();
    for (kind, difference) in KINDS.iter().zip(found) {
        write!(line, ", {kind} {:.0e}", difference.relative()).unwrap();
    }
    (line, found.iter().all(|difference| difference.relative() < MOST))
}

/// The model with each root that the reference has.
fn check(model: &Path, reference: &Value) -> Result<String, String> {
    let bytes = std::fs::read(model).map_err(|e| e.to_string())?;
    let mut said = String::new();
    for rooted in reference["roots"].as_array().unwrap() {
        let body = if model.extension().is_some_and(|ending| ending == "urdf") {
            let root = if rooted["root"] == "free" { RootAttachment::Free } else { RootAttachment::Fixed };
            urdf::read(&bytes, "robot", &urdf::Options { root, ..Default::default() }).map_err(|e| e.to_string())?
        } else {
            let folder = model.parent().unwrap();
            let mut include = |name: &str| std::fs::read(folder.join(name)).map_err(|e| e.to_string());
            mjcf::read(&bytes, "robot", &mut include, &Default::default()).map_err(|e| e.to_string())?
        };
        let model = body.model().map_err(|e| e.to_string())?.model;
        let (line, agrees) = compare(&model, rooted);
        write!(said, "{} {} rates{line}; ", rooted["root"].as_str().unwrap(), model.rates().len()).unwrap();
        if !agrees {
            return Err(said);
        }
    }
    Ok(said)
}

#[test]
fn our_humanoid_is_pinocchios() {
    let reference: Value = serde_json::from_str(include_str!("data/pinocchio_reference.json")).unwrap();
    println!("{}", check(&here().join("tests/models/humanoid.urdf"), &reference).unwrap());
}

#[test]
#[ignore = "needs ../shared: a published human model"]
fn human66_with_its_root_fixed_is_pinocchios() {
    let model = shared("models/human-gazebo/humanSubject01_66dof.urdf");
    let reference: Value = serde_json::from_str(include_str!("data/pinocchio_human66_fixed.json")).unwrap();
    println!("{}", check(&model, &reference).unwrap());
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut inside: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    inside.sort();
    for path in inside {
        if path.is_dir() {
            files(&path, found);
        } else if path.to_str().is_some_and(|name| name.ends_with(".reference.json")) {
            found.push(path);
        }
    }
}

#[test]
#[ignore = "needs CONTRAPPOSTO_ROBOT_MODELS: a folder of published robots with reference numbers"]
fn published_robots() {
    let folder = PathBuf::from(
        std::env::var_os("CONTRAPPOSTO_ROBOT_MODELS").expect("CONTRAPPOSTO_ROBOT_MODELS: a folder of models"),
    );
    let mut references = vec![];
    files(&folder, &mut references);
    assert!(!references.is_empty(), "no *.reference.json in {}", folder.display());
    let (mut wrong, mut refused) = (0, 0);
    for path in &references {
        let reference: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
        let model = path.with_file_name(path.file_name().unwrap().to_str().unwrap().replace(".reference.json", ""));
        let said = check(&model, &reference);
        let name = model.strip_prefix(&folder).unwrap().display();
        match said {
            Ok(said) => println!("{name}: {said}"),
            // docs/formats.md says what is not: tendons that pull, wind.
            Err(said) if said.contains(" supported") => {
                refused += 1;
                println!("{name}: refused, {said}");
            }
            Err(said) => {
                wrong += 1;
                println!("{name}: WRONG {said}");
            }
        }
    }
    println!("{} models, {refused} refused", references.len());
    assert_eq!(wrong, 0, "of {} models", references.len());
}
