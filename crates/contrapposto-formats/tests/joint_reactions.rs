//! Compares forces and moments of joints with OpenSim's JointReaction analysis, of published models that are not in this project: five random
//! postures at rest under random tensions of all muscles (`scripts/opensim_reactions.py`).

use crate::common::shared;

use std::path::{Path, PathBuf};

use contrapposto::joint_torques::{JointReactions, PathForces};
use contrapposto::kinematics::Kinematics;
use contrapposto::muscle::{PathGeometry, PathRule};
use contrapposto_formats::osim;
use nalgebra::Vector3;
use serde_json::Value;

fn names(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// Largest difference of a force, N, and of a moment, N m; and the largest force.
fn differences(bytes: &[u8], file: &str, folder: &Path, rule: PathRule) -> [f64; 3] {
    let imported = osim::read(bytes, file).unwrap().model().unwrap();
    let (model, muscles) = (&imported.model, &imported.muscles);
    let theirs = std::fs::read(folder.join(format!("reactions_{file}.json"))).unwrap();
    let theirs: Value = serde_json::from_slice(&theirs).unwrap();
    let order = &theirs["order"];
    let mut kinematics = Kinematics::new(model);
    let mut geometry = PathGeometry::new(model, &muscles.paths);
    let mut reactions = JointReactions::new(model, muscles);
    let mut worst = [0.0_f64; 3];
    let mut compared = 0;
    for of in theirs["postures"].as_array().unwrap() {
        let mut posture = model.default_posture();
        for (name, value) in names(&order["q"]).into_iter().zip(numbers(&of["q"])) {
            posture.values_mut()[model.coordinate(name).unwrap()] = value;
        }
        let given: Vec<(&str, f64)> = names(&order["tensions"]).into_iter().zip(numbers(&of["tensions"])).collect();
        let tension = |name: &str| given.iter().find(|(of, _)| *of == name).unwrap().1;
        let tensions: Vec<f64> = muscles.muscles.iter().map(|muscle| tension(&muscle.spec().name)).collect();
        kinematics.update(model, &posture).unwrap();
        geometry.update(model, &kinematics, &muscles.paths, rule);
        let paths = PathForces { muscles, geometry: &geometry, tensions: &tensions };
        reactions.update(model, &kinematics, &[], paths).unwrap();
        for (name, expected) in names(&order["reactions"]).into_iter().zip(of["reactions"].as_array().unwrap()) {
            let Some(segment) = model.segments().iter().position(|segment| segment.joint == name) else { continue };
            let expected = numbers(expected);
            let to_segment = kinematics.placement(model, segment).rotation.inverse();
            let found = reactions.all()[segment];
            for (kind, (found, at)) in [(found.force, 0), (found.moment, 3)].into_iter().enumerate() {
                let expected = Vector3::new(expected[at], expected[at + 1], expected[at + 2]);
                worst[kind] = worst[kind].max((to_segment * found - expected).amax());
            }
            worst[2] = worst[2].max(found.force.norm());
            compared += 1;
        }
    }
    println!("{file}, {rule:?}: {compared} reactions, largest differences {worst:?}");
    assert!(compared >= 50 && worst[2] > 1000.0, "{compared} reactions, largest {}", worst[2]);
    worst
}

#[test]
#[ignore = "needs ../shared: a published OpenSim model"]
fn reactions_of_gait2392_are_opensims() {
    let file = "gait2392_thelen2003muscle";
    let bytes = std::fs::read(shared(&format!("models/opensim/{file}.osim"))).unwrap();
    let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    for rule in [PathRule::OpenSim, PathRule::Geodesic] {
        let [force, moment, _] = differences(&bytes, file, &data, rule);
        assert!(force < 1e-6 && moment < 1e-6, "{rule:?}: {force} N, {moment} N m");
    }
}

#[test]
#[ignore = "needs CONTRAPPOSTO_OPENSIM_MODELS: a published body, and the file that scripts/opensim_reactions.py writes beside it"]
fn reactions_of_rajagopal2016_are_opensims() {
    let folder = std::env::var_os("CONTRAPPOSTO_OPENSIM_MODELS").expect("CONTRAPPOSTO_OPENSIM_MODELS names a folder");
    let folder = PathBuf::from(folder);
    let bytes = std::fs::read(folder.join("Rajagopal2016.osim")).unwrap();
    let [force, moment, _] = differences(&bytes, "Rajagopal2016", &folder, PathRule::OpenSim);
    assert!(force < 1e-6 && moment < 1e-6, "{force} N, {moment} N m");
    // Shortest lines over cylinders pull elsewhere by less than a hundredth.
    let [force, _, largest] = differences(&bytes, "Rajagopal2016", &folder, PathRule::Geodesic);
    assert!(force < 0.01 * largest, "{force} of {largest} N");
}
