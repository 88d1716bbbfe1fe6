//! Pinocchio, MuJoCo and OpenSim load the written files and give our torques; `scripts/compare_adult.py` asks them.

use contrapposto::model::{Coordinate, CoordinateKind, Model, adult};
use serde_json::{Value, json};

use super::common::here;
use super::{Mjcf, Osim, Urdf, adults, build, hinges_and_slides, random, torques, write};

/// Seed of the postures that other programs are asked about.
const SEED: u64 = 20_070_707;

/// Random postures in the ranges (slides half a metre about their default), and our external and passive torques there.
fn answers(name: &str, model: &Model, count: usize) -> Value {
    let mut state = SEED;
    let mut cases = vec![];
    for _ in 0..count {
        let value = |c: &Coordinate| match c.kind {
            CoordinateKind::Translation => c.default + random(&mut state) - 0.5,
            _ => c.range.0 + (c.range.1 - c.range.0) * random(&mut state),
        };
        let values: Vec<f64> = model.coordinates().iter().map(value).collect();
        let (external, passive) = external_and_passive(model, &values);
        cases.push(json!({ "posture": values, "external": external, "passive": passive }));
    }
    let names = |wanted: fn(&Coordinate) -> bool| -> Vec<String> {
        model.coordinates().iter().filter(|c| wanted(c)).map(|c| c.name.clone()).collect()
    };
    json!({ "name": name, "coordinates": names(|_| true), "passive_curves": names(|c| c.curve().is_some()), "cases": cases })
}

fn external_and_passive(model: &Model, values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let by_name = model.coordinates().iter().map(|c| c.name.clone()).zip(values.iter().copied()).collect();
    let found = torques(model, &by_name);
    model.coordinates().iter().map(|c| (found[&c.name].0, found[&c.name].1)).unzip()
}

/// Models that other programs are asked about.
pub(crate) fn asked() -> Vec<(&'static str, Model)> {
    let names = ["adult:male", "adult:female,stature=1.52,mass=50", "adult:right_arm"];
    let adults = names.into_iter().zip(adults().into_iter().map(|size| adult(&size).unwrap()));
    adults.chain([("every joint of hinges and slides", build(hinges_and_slides()))]).collect()
}

/// For `scripts/compare_adult.py`: files and answers into the folder that `CONTRAPPOSTO_EXCHANGE` names.
#[test]
#[ignore = "needs CONTRAPPOSTO_EXCHANGE: a folder for scripts/compare_adult.py"]
fn exchange() {
    let folder = std::env::var("CONTRAPPOSTO_EXCHANGE").expect("CONTRAPPOSTO_EXCHANGE: a folder to write to");
    let folder = std::path::Path::new(&folder);
    let mut all = vec![];
    for (i, (name, model)) in asked().iter().enumerate() {
        for (format, ending) in [(Osim, "osim"), (Urdf, "urdf"), (Mjcf, "xml")] {
            let written = write(model, format).unwrap();
            std::fs::write(folder.join(format!("model_{i}.{ending}")), written.text).unwrap();
            println!("{name}, {format:?}:\n  {}", written.lost.join("\n  "));
        }
        all.push(answers(name, model, 100));
    }
    let answers = json!({ "seed": SEED, "models": all });
    std::fs::write(folder.join("answers.json"), answers.to_string()).unwrap();
}

#[test]
fn other_programs_agree() {
    let text = std::fs::read_to_string(here().join("tests/data/adult_peers.json")).unwrap();
    let kept: Value = serde_json::from_str(&text).unwrap();
    let numbers = |v: &Value| v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<_>>();
    let (asked, kept) = (asked(), kept["models"].as_array().unwrap());
    assert_eq!(asked.len(), kept.len());
    for ((name, model), kept) in asked.iter().zip(kept) {
        let names: Vec<&str> = model.coordinates().iter().map(|c| c.name.as_str()).collect();
        let again = "has changed: run scripts/compare_adult.py again";
        assert_eq!((json!(name), json!(names)), (kept["name"].clone(), kept["coordinates"].clone()), "{name} {again}");
        for (tool, most) in [("pinocchio", 1e-9), ("mujoco", 1e-9), ("opensim", 1e-6)] {
            let theirs = &kept["tools"][tool];
            assert!(theirs["worst_external"].as_f64().unwrap() < most, "{name} {tool}");
            let cases = kept["postures"].as_array().unwrap().iter().zip(theirs["external"].as_array().unwrap());
            for (posture, external) in cases {
                let (ours, _) = external_and_passive(model, &numbers(posture));
                let worst = ours.iter().zip(numbers(external)).fold(0.0_f64, |w, (a, b)| w.max((a - b).abs()));
                assert!(worst < most, "{name} differs from {tool} by {worst:e} and perhaps {again}");
            }
        }
    }
}
