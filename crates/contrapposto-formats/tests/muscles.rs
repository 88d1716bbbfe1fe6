//! Compares lengths, moment arms and forces of muscles with OpenSim's, of published models that are not in this project.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests: helpers outside #[test] functions too")]

#[path = "common/muscle_reference.rs"]
mod muscle_reference;
#[path = "common/shared.rs"]
mod shared;

use contrapposto::muscle::PathRule;
use muscle_reference::{Reference, model_bytes};
use shared::shared;

/// Largest errors that are allowed.
#[derive(Clone, Copy)]
struct Limits {
    length: f64,
    arm: f64,
    force: f64,
}

/// Compares all muscles without surfaces, or all of which the surfaces are of these kinds.
fn check(name: &str, bytes: &[u8], wraps: &[&str], limits: &Limits) {
    let reference = Reference::read(name, bytes, &shared(&format!("vectors/muscles/{name}.json.gz")));
    let errors = reference.errors(PathRule::OpenSim, wraps);
    println!("{name} {wraps:?}: {errors:#?}");
    assert!(errors.muscles > 0, "{name}: no muscle has surfaces {wraps:?}");
    assert!(errors.length.size <= limits.length, "{name}: {:?}", errors.length);
    assert!(errors.arm.size <= limits.arm, "{name}: {:?}", errors.arm);
    for error in [&errors.tendon, &errors.active, &errors.passive] {
        assert!(error.size <= limits.force, "{name}: {error:?}");
    }
    assert!(errors.imbalance.size <= 1e-9, "{name}: {:?}", errors.imbalance);
}

const THELEN: Limits = Limits { length: 1e-10, arm: 1e-9, force: 1e-7 };
const MILLARD: Limits = Limits { length: 1e-10, arm: 1e-9, force: 1e-6 };

#[test]
#[ignore = "needs ../shared: a published OpenSim model and OpenSim's numbers of its muscles"]
fn muscles_of_gait2392_thelen_are_opensims() {
    let bytes = std::fs::read(shared("models/opensim/gait2392_thelen2003muscle.osim")).unwrap();
    check("gait2392_thelen", &bytes, &[], &THELEN);
}

#[test]
#[ignore = "needs ../shared: a published OpenSim model and OpenSim's numbers of its muscles"]
fn muscles_of_arm26_without_surfaces_are_opensims() {
    let bytes = std::fs::read(shared("models/opensim/arm26.osim")).unwrap();
    check("arm26", &bytes, &[], &THELEN);
}

#[test]
#[ignore = "needs CONTRAPPOSTO_OPENSIM_MODELS: a folder of published full bodies and arms"]
fn muscles_of_fetched_bodies_are_opensims() {
    let (cylinder, cylinders) = (["WrapCylinder"], ["WrapCylinder"; 2]);
    let several = Limits { length: 1e-6, arm: 1e-6, force: 1e-6 };
    for (name, file, wraps, limits) in [
        ("gait2392_millard", "gait2392_millard2012muscle.osim", [].as_slice(), MILLARD),
        ("rajagopal2016", "Rajagopal2016.osim", &[], MILLARD),
        ("rajagopal2016", "Rajagopal2016.osim", &cylinder, MILLARD),
        ("rajagopal2016", "Rajagopal2016.osim", &cylinders, several),
        ("rajagopal_lai_uhlrich2023", "RajagopalLaiUhlrich2023.osim", &[], MILLARD),
        ("rajagopal_lai_uhlrich2023", "RajagopalLaiUhlrich2023.osim", &cylinder, MILLARD),
        ("rajagopal_lai_uhlrich2023", "RajagopalLaiUhlrich2023.osim", &cylinders, several),
        ("gait1018_dgf", "gait1018.osim", &[], THELEN),
        ("wrist", "wrist.osim", &[], MILLARD),
    ] {
        check(name, &model_bytes(file), wraps, &limits);
    }
}

#[test]
#[ignore = "needs CONTRAPPOSTO_OPENSIM_MODELS: published arms with all kinds of surfaces"]
fn muscles_of_arms_over_all_kinds_of_surfaces_are_opensims() {
    for (name, file) in
        [("arm26", "arm26.osim"), ("mobl2016_v04", "mobl2016_v04.osim"), ("mobl2016_v01", "mobl2016_v01.osim")]
    {
        let bytes = model_bytes(file);
        let reference = Reference::read(name, &bytes, &shared(&format!("vectors/muscles/{name}.json.gz")));
        for wraps in reference.wraps() {
            let wraps: Vec<&str> = wraps.iter().map(String::as_str).collect();
            check(name, &bytes, &wraps, &MILLARD);
        }
    }
}
