//! Compares lines over single surfaces with OpenSim's (`scripts/opensim_wraps.py`).

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Placement, adult};
use contrapposto::muscle::{
    Location, Path, PathGeometry, PathPoint, PathRule, PathWrap, Paths, Quadrant, WrapMethod, WrapObject, WrapShape,
};
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;
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
    Paths { paths: vec![Path { points, wraps, ..Path::default() }], wrap_objects, ..Paths::default() }
}

fn length(model: &Model, kinematics: &Kinematics, paths: &Paths, rule: PathRule) -> f64 {
    let mut geometry = PathGeometry::new(model, paths);
    geometry.update(model, kinematics, paths, rule);
    geometry.lengths()[0]
}

/// A shape of the file, by its kind and sizes.
fn shape(row: &Value) -> WrapShape {
    let size = |i: usize| row[1][i].as_f64().unwrap();
    match row[0].as_str().unwrap() {
        "sphere" => WrapShape::Sphere { radius: size(0) },
        "ellipsoid" => WrapShape::Ellipsoid { half_axes: vector(&row[1]) },
        "torus" => WrapShape::Torus { tube: size(0), circle: size(1) },
        other => panic!("{other}"),
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
        let Some(theirs) = row[6].as_f64() else { continue };
        let method = match row[3].as_str().unwrap() {
            "midpoint" => WrapMethod::Midpoint,
            "axial" => WrapMethod::Axial,
            _ => WrapMethod::Hybrid,
        };
        let ends = [vector(&row[4]), vector(&row[5])];
        let paths = paths(shape(row), quadrant(row[2].as_str().unwrap()), method, ends);
        let ours = length(&model, &kinematics, &paths, PathRule::OpenSim);
        wrapped += usize::from((theirs - (ends[1] - ends[0]).norm()).abs() > 1e-9);
        let error = (ours - theirs).abs();
        assert!(error.is_finite(), "{row}: {ours}");
        if error > 1e-7 {
            println!("{row}: {ours}");
        }
        worst = worst.max(error);
    }
    println!("{kind}: {worst:e} m, {wrapped} lines wrap");
    (worst, wrapped)
}

#[test]
fn lines_over_spheres_are_opensims() {
    let (worst, wrapped) = worst("sphere");
    assert!(worst < 1e-9 && wrapped > 10, "{worst:e} m, {wrapped} lines");
}

#[test]
fn lines_over_ellipsoids_are_opensims() {
    let (worst, wrapped) = worst("ellipsoid");
    assert!(worst < 1e-6 && wrapped > 100, "{worst:e} m, {wrapped} lines");
}

#[test]
fn lines_over_tori_are_opensims() {
    let (worst, wrapped) = worst("torus");
    assert!(worst < 1e-9 && wrapped > 20, "{worst:e} m, {wrapped} lines");
}

/// A length over one surface by a rule.
struct Over {
    model: Model,
    kinematics: Kinematics,
}

impl Over {
    fn new() -> Self {
        let model = adult(&Adult::default()).unwrap();
        let mut kinematics = Kinematics::new(&model);
        kinematics.update(&model, &model.default_posture()).unwrap();
        Self { model, kinematics }
    }

    fn length(&self, shape: WrapShape, quadrant: Quadrant, ends: [V; 2], rule: PathRule) -> f64 {
        length(&self.model, &self.kinematics, &paths(shape, quadrant, WrapMethod::Hybrid, ends), rule)
    }
}

fn direction(rng: &mut Pcg64) -> V {
    loop {
        let v = V::from_fn(|_, _| rng.random_range(-1.0..1.0));
        if (0.1..1.0).contains(&v.norm()) {
            return v.normalize();
        }
    }
}

/// OpenSim's line over an ellipsoid has pieces of 1 mm below the surface: that much is allowed.
#[test]
fn the_shortest_line_over_an_ellipsoid_is_not_longer_than_opensims_and_is_straight_over_a_sphere_like_one() {
    let (over, mut rng) = (Over::new(), Pcg64::new(19, 1));
    let mut wrapped = 0;
    for _ in 0..300 {
        let half_axes = V::from_fn(|_, _| rng.random_range(0.015..0.05));
        let shape = WrapShape::Ellipsoid { half_axes };
        let (a, b) = (direction(&mut rng), direction(&mut rng));
        let ends = [a * rng.random_range(0.05..0.2), (0.5 * b - a).normalize() * rng.random_range(0.05..0.2)];
        let [theirs, ours] =
            [PathRule::OpenSim, PathRule::Geodesic].map(|rule| over.length(shape, Quadrant::All, ends, rule));
        assert!(ours <= theirs + 5e-6 * theirs / 0.1, "{half_axes:?} {ends:?}: {ours} {theirs}");
        assert!(ours >= (ends[1] - ends[0]).norm() - 1e-12, "{half_axes:?} {ends:?}: {ours}");
        wrapped += usize::from(ours > (ends[1] - ends[0]).norm() + 1e-9);
        // Of equal half axes: the sphere's closed form.
        let radius = half_axes.x;
        let ball = WrapShape::Ellipsoid { half_axes: V::repeat(radius) };
        let [sphere, ball] = [WrapShape::Sphere { radius }, ball]
            .map(|shape| over.length(shape, Quadrant::All, ends, PathRule::Geodesic));
        assert!((sphere - ball).abs() < 1e-10, "{radius} {ends:?}: {sphere} {ball}");
    }
    assert!(wrapped > 100, "{wrapped} of 300 lines wrap");
}

/// Points moved from midway between their neighbours out to the surface shorten a chain to the shortest line: another derivation.
#[test]
fn the_shortest_line_over_an_ellipsoid_is_that_of_a_taut_chain() {
    let (over, mut rng) = (Over::new(), Pcg64::new(19, 2));
    let mut compared = 0;
    for _ in 0..20 {
        let half_axes = V::from_fn(|_, _| rng.random_range(0.02..0.05));
        let a = direction(&mut rng);
        let ends = [a * 0.09, (0.6 * direction(&mut rng) - a).normalize() * 0.08];
        let chain = |links: usize| {
            let mut points: Vec<V> =
                (0..=links).map(|i| ends[0] + (ends[1] - ends[0]) * (i as f64 / links as f64)).collect();
            for _ in 0..8_000 {
                for i in 1..links {
                    let mut point = 0.5 * (points[i - 1] + points[i + 1]);
                    for _ in 0..3 {
                        let outside = point.component_div(&half_axes).norm_squared() - 1.0;
                        let gradient = 2.0 * point.component_div(&half_axes).component_div(&half_axes);
                        point -= (outside.min(0.0) / gradient.norm_squared()) * gradient;
                    }
                    points[i] = point;
                }
            }
            points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>()
        };
        let ours = over.length(WrapShape::Ellipsoid { half_axes }, Quadrant::All, ends, PathRule::Geodesic);
        let (coarse, fine) = (chain(24), chain(48));
        // Errors fall with the square of the link.
        let theirs = fine + (fine - coarse) / 3.0;
        compared += usize::from(theirs > (ends[1] - ends[0]).norm() + 1e-5);
        assert!((ours - theirs).abs() < 2e-5, "{half_axes:?} {ends:?}: {ours} {theirs}");
    }
    assert!(compared > 8, "{compared} of 20 lines wrap");
}

#[test]
fn lines_with_ends_inside_on_and_far_from_surfaces_have_lengths() {
    let (over, mut rng) = (Over::new(), Pcg64::new(19, 3));
    let shapes = [
        WrapShape::Sphere { radius: 0.03 },
        WrapShape::Sphere { radius: 1e-9 },
        WrapShape::Ellipsoid { half_axes: V::new(0.03, 0.02, 0.05) },
        WrapShape::Ellipsoid { half_axes: V::new(1e-6, 0.02, 0.3) },
        WrapShape::Torus { tube: 0.01, circle: 0.03 },
        WrapShape::Torus { tube: 1e-9, circle: 0.03 },
        WrapShape::Cylinder { radius: 0.03, length: 0.1 },
    ];
    let quadrants = ["all", "x", "-x", "y", "-y", "z", "-z"].map(quadrant);
    for shape in shapes {
        for number in 0..400 {
            let a = direction(&mut rng);
            let sizes: [f64; 2] = std::array::from_fn(|_| [0.0, 0.01, 0.03, 0.05, 1.0, 1e6][rng.random_range(0..6)]);
            let other = if number % 3 == 0 { -a } else { direction(&mut rng) };
            let ends = [a * sizes[0], other * sizes[1]];
            for rule in [PathRule::Geodesic, PathRule::OpenSim] {
                let length = over.length(shape, quadrants[number % 7], ends, rule);
                assert!(length.is_finite(), "{shape:?} {rule:?} {ends:?}: {length}");
            }
        }
    }
}
