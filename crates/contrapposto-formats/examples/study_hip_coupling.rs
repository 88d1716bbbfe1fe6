//! Couples the passive curve of hip adduction to hip flexion and prints the postures of least effort, the table of docs/contrapposto.md:
//! `cargo run --release -p contrapposto-formats --example study_hip_coupling`.
//!
//! `tau = size * tau_built_in(adduction) * exp(rate * flexion)`: by the own angle the curve of the built-in adult, and as much more as the hip is
//! flexed. The torque of flexion itself stays as it is.

#![allow(clippy::print_stdout, reason = "the output")]

use contrapposto::equilibria::equilibria;
use contrapposto::model::Model;
use contrapposto::passive::{Coupled, CoupledTerm, PassiveLaw, RienerEdrich1999};
use contrapposto_formats::{RelaxScenario, read_relax};

/// Ends of the built-in curve of a woman of 60 kg (crates/contrapposto/data/passive.toml): torque, N m, rate, 1/rad, and angle, deg.
const TORQUE: f64 = 30.0 * 60.0 / 73.0;
const RATE: f64 = 8.0;
const ENDS: [f64; 2] = [-45.0, 20.0];
/// Sizes of the torque against the built-in curve, and rates by hip flexion, 1/rad: muscles of published models have 1.0 to 1.9.
const SIZES: [f64; 3] = [0.25, 0.51, 1.0];
const COUPLINGS: [f64; 3] = [0.0, 1.0, 2.0];
/// A pelvis that hangs by less is level, deg, as in scripts/study_hip_adduction.py.
const LEVEL: f64 = 7.0;

fn main() {
    println!(
        "| size | rate by flexion, 1/rad | foot free: least effort | list, deg | adduction, deg | flexion, deg | level posture | feet fixed: slouch | level posture |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (size, coupling) in SIZES.iter().flat_map(|size| COUPLINGS.map(|coupling| (*size, coupling))) {
        let [free, fixed] = ["stand-relaxed", "stand-relaxed-feet-fixed"].map(|name| answers(name, size, coupling));
        let first = |found: &[[f64; 4]], wanted: &dyn Fn(f64) -> bool| {
            found.iter().find(|one| wanted(one[1])).map_or("none".to_owned(), |one| format!("{:.4}", one[0]))
        };
        let [effort, list, adduction, flexion] = free[0];
        println!(
            "| {size} | {coupling} | {effort:.4} | {list:.1} | {adduction:.1} | {flexion:.1} | {} | {} | {} |",
            first(&free, &|list| list.abs() < LEVEL),
            first(&fixed, &|list| list <= -LEVEL),
            first(&fixed, &|list| list.abs() < LEVEL),
        );
    }
}

/// Effort, pelvis list, right hip adduction and flexion, deg, of each posture that `relax` answers with.
fn answers(name: &str, size: f64, coupling: f64) -> Vec<[f64; 4]> {
    let path = format!("{}/../../scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let bytes = std::fs::read(path).expect("a scenario of the repository");
    let mut scenario = read_relax(name, &bytes, None).expect("a scenario of the repository");
    for side in ["r", "l"] {
        scenario.model = coupled(scenario.model, side, size, coupling);
    }
    let found = equilibria(&scenario.search(), RelaxScenario::OPTIONS).expect("the body stands");
    let angle = |name: &str, values: &[f64]| {
        values[scenario.model.coordinate(name).expect("a coordinate of the adult")].to_degrees()
    };
    let names = ["pelvis_list", "hip_adduction_r", "hip_flexion_r"];
    let postures = found.postures.iter().map(|found| &found.relaxed);
    postures
        .map(|one| {
            let [list, adduction, flexion] = names.map(|name| angle(name, one.posture.values()));
            [one.effort, list, adduction, flexion]
        })
        .collect()
}

/// The body with the coupled law at one hip.
fn coupled(model: Model, side: &str, size: f64, coupling: f64) -> Model {
    let index = |stem: &str| model.coordinate(&format!("{stem}_{side}")).expect("a coordinate of the adult");
    let (adduction, flexion) = (index("hip_adduction"), index("hip_flexion"));
    let term = |sign: f64, angle: f64| CoupledTerm {
        sign,
        c0: libm::log(TORQUE * size) + sign * RATE * angle.to_radians(),
        rates: [-sign * RATE, coupling, 0.0],
    };
    let law = RienerEdrich1999 { joint: 0, terms: vec![term(1.0, ENDS[0]), term(-1.0, ENDS[1])], constant: 0.0 };
    let neighbours = [Some((adduction, 1.0)), Some((flexion, 1.0)), None];
    model.with_passive_law(adduction, Some(PassiveLaw::Coupled(Coupled { law, neighbours })))
}
