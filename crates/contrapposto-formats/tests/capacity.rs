//! Compares the forces of fixed arms with the force polytopes of pycapacity, which `scripts/compare_capacity.py` wrote.

use crate::common::hands;

use contrapposto::posture::Posture;
use hands::{Body, arm};
use nalgebra::Vector3;
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn every_vertex_of_pycapacity_is_the_greatest_force_in_its_direction() {
    let text = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/pycapacity.json")).unwrap();
    let peer: Value = serde_json::from_slice(&text).unwrap();
    let (mut vertices, mut worst, mut beyond) = (0, 0f64, 0f64);
    let arms = peer["arms"].as_array().unwrap();
    for theirs in arms {
        let posture = Posture::new(numbers(&theirs["posture"]));
        let body = Body { posture, ..arm(0) };
        let mut capacity = body.capacity().unwrap();
        let theirs: Vec<Vector3<f64>> =
            theirs["vertices_n"].as_array().unwrap().iter().map(|v| Vector3::from_column_slice(&numbers(v))).collect();
        let solid = capacity.solid();
        for vertex in &theirs {
            let found = capacity.in_direction(vertex);
            worst = worst.max((found.force - vertex.norm()).abs() / vertex.norm());
            vertices += 1;
            for plane in &solid.forces {
                beyond = beyond.max((plane.normal.dot(vertex) - plane.force) / plane.force);
            }
        }
        // Each plane of ours touches a vertex of theirs, so that their polytope is not smaller either.
        for plane in &solid.forces {
            let most = theirs.iter().map(|vertex| plane.normal.dot(vertex)).fold(f64::NEG_INFINITY, f64::max);
            worst = worst.max((most - plane.force).abs() / plane.force);
        }
    }
    println!("{vertices} vertices of {} arms: {worst:.1e} apart, {beyond:.1e} beyond", arms.len());
    assert!(vertices > 100 && arms.len() >= 10 && worst < 1e-6 && beyond < 1e-6, "{vertices} {worst:e} {beyond:e}");
}
