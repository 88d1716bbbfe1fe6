//! Compares lines over single surfaces with OpenSim's (`scripts/opensim_wraps.py`).

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests: helpers outside #[test] functions too")]

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Placement, adult};
use contrapposto::muscle::{
    Location, Path, PathGeometry, PathPoint, PathRule, PathWrap, Paths, Quadrant, WrapMethod, WrapObject, WrapShape,
};
use nalgebra::Vector3;
use serde_json::Value;

type V = Vector3<f64>;

fn vector(value: &Value) -> V {
    V::from_fn(|i, _| value[i].as_f64().unwrap())
}

fn quadrant(word: &str) -> Quadrant {
    let half = |axis| Quadrant::Half { axis, positive: !word.starts_with('-') };
    match word.trim_start_matches('-') {
        "x" => half(0),
        "y" => half(1),
        "z" => half(2),
        _ => Quadrant::All,
    }
}

/// A path in ground from a point to another over a surface about ground's origin.
fn paths(shape: WrapShape, quadrant: Quadrant, method: WrapMethod, ends: [V; 2]) -> Paths {
    let points = ends.map(|end| PathPoint { segment: None, location: Location::Fixed(end) }).to_vec();
    let pose = Placement::identity();
    let wrap_objects =
        vec![WrapObject { name: "surface".to_owned(), segment: None, pose, quadrant, active: true, shape }];
    let wraps = vec![PathWrap { object: 0, method, range: (None, None) }];
    Paths { paths: vec![Path { points, wraps }], wrap_objects }
}

fn length(model: &Model, kinematics: &Kinematics, paths: &Paths, rule: PathRule) -> f64 {
    let mut geometry = PathGeometry::new(model, paths);
    geometry.update(model, kinematics, paths, rule);
    geometry.lengths()[0]
}

/// A shape of the file, by its kind and sizes.
fn shape(row: &Value) -> Option<WrapShape> {
    let size = |i: usize| row[1][i].as_f64().unwrap();
    match row[0].as_str().unwrap() {
        "sphere" => Some(WrapShape::Sphere { radius: size(0) }),
        _ => None,
    }
}

/// Largest difference of the lengths from OpenSim's by OpenSim's rule, over the surfaces of one kind; and the number of lines that wrap.
fn worst(kind: &str) -> (f64, usize) {
    let data: Value = serde_json::from_str(include_str!("data/opensim_wraps.json")).unwrap();
    let model = adult(&Adult::default()).unwrap();
    let mut kinematics = Kinematics::new(&model);
    kinematics.update(&model, &model.default_posture()).unwrap();
    let (mut worst, mut wrapped) = (0f64, 0);
    for row in data["rows"].as_array().unwrap().iter().filter(|row| row[0] == kind) {
        let (Some(shape), Some(theirs)) = (shape(row), row[6].as_f64()) else { continue };
        let method = match row[3].as_str().unwrap() {
            "midpoint" => WrapMethod::Midpoint,
            "axial" => WrapMethod::Axial,
            _ => WrapMethod::Hybrid,
        };
        let ends = [vector(&row[4]), vector(&row[5])];
        let paths = paths(shape, quadrant(row[2].as_str().unwrap()), method, ends);
        let ours = length(&model, &kinematics, &paths, PathRule::OpenSim);
        wrapped += usize::from((theirs - (ends[1] - ends[0]).norm()).abs() > 1e-9);
        let error = (ours - theirs).abs();
        if error.is_nan() || error > 1e-7 {
            println!("{row}: {ours}");
        }
        worst = if error.is_nan() { error } else { worst.max(error) };
    }
    println!("{kind}: {worst:e} m, {wrapped} lines wrap");
    (worst, wrapped)
}

#[test]
fn lines_over_spheres_are_opensims() {
    let (worst, wrapped) = worst("sphere");
    assert!(worst < 1e-9 && wrapped > 10, "{worst:e} m, {wrapped} lines");
}
