//! Tests paths of muscles on the built-in adult: moment arms against differences of lengths, and lines over surfaces.

use contrapposto::kinematics::Kinematics;
use contrapposto::math::{Function, Spline};
use contrapposto::model::{Adult, Model, Placement, adult};
use contrapposto::muscle::{
    Location, MovingPoint, Path, PathGeometry, PathPoint, PathRule, PathWrap, Paths, Quadrant, WrapMethod, WrapObject,
    WrapShape,
};
use contrapposto::posture::Posture;
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64;

type V = Vector3<f64>;

fn random() -> Pcg64 {
    Pcg64::new(20_261_122, 0)
}

fn within(rng: &mut Pcg64, size: f64) -> V {
    V::from_fn(|_, _| rng.random_range(-size..size))
}

/// Anywhere inside the ranges; the root about its default.
fn inside(rng: &mut Pcg64, model: &Model) -> Posture {
    let values = model.coordinates().iter().map(|c| {
        let (low, high) = (c.range.0.max(c.default - 1.0), c.range.1.min(c.default + 1.0));
        low + rng.random_range(0.02..0.98) * (high - low)
    });
    Posture::new(values.collect())
}

fn segments(model: &Model, names: &[&str]) -> Vec<Option<usize>> {
    names.iter().map(|name| Some(model.segment(name).unwrap_or_else(|| panic!("no segment {name}")))).collect()
}

/// A path from ground over the trunk to a hand, with points of all kinds.
fn paths(model: &Model, rng: &mut Pcg64) -> Paths {
    let carriers = [vec![None], segments(model, &["pelvis", "torso", "humerus_r", "hand_r"])].concat();
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    let spline = Function::Spline(Spline::simm(&[-1.0, 0.0, 1.0, 2.0, 3.0], &[0.0, 0.02, -0.01, 0.03, 0.01]).unwrap());
    let moving = MovingPoint {
        frame: Placement::from_parts(
            Translation3::new(0.1, 0.0, 0.2),
            UnitQuaternion::from_euler_angles(0.3, 0.2, 0.1),
        ),
        coordinate: Some(elbow),
        range: (0.3, 2.0),
        place: [spline, Function::Constant(0.01), Function::Linear { slope: 0.02, intercept: 0.1 }],
    };
    let range = (1.0, 2.5);
    let mut points: Vec<PathPoint> =
        carriers.iter().map(|&segment| PathPoint { segment, location: Location::Fixed(within(rng, 0.2)) }).collect();
    let place = within(rng, 0.2);
    points[2].location = Location::Conditional { place, coordinate: elbow, range };
    points[3].location = Location::Moving(Box::new(moving));
    Paths { paths: vec![Path { points, ..Path::default() }], ..Paths::default() }
}

/// A path past a cylinder on the forearm's elbow, from the upper arm to the forearm.
fn past_cylinder(model: &Model, quadrant: Quadrant, x: f64) -> Paths {
    past(model, WrapShape::Cylinder { radius: 0.03, length: 1.0 }, quadrant, x)
}

/// A path past a surface on the forearm's elbow, from the upper arm to the forearm.
fn past(model: &Model, shape: WrapShape, quadrant: Quadrant, x: f64) -> Paths {
    let [upper, lower] = segments(model, &["humerus_r", "ulna_r"])[..] else { panic!("two segments") };
    let point = |segment, y, z| PathPoint { segment, location: Location::Fixed(V::new(x, y, z)) };
    let object = WrapObject {
        name: "elbow".to_owned(),
        segment: lower,
        pose: Placement::from_parts(
            Translation3::new(0.0, 0.0, 0.01),
            UnitQuaternion::from_euler_angles(0.1, 0.2, 0.0),
        ),
        quadrant,
        active: true,
        shape,
    };
    let upper_end = model.segments()[lower.unwrap()].in_parent.translation.vector;
    let points = vec![point(upper, upper_end.y + 0.15, 0.0), point(lower, -0.15, 0.02)];
    let wraps = vec![PathWrap { object: 0, method: WrapMethod::Hybrid, range: (None, None) }];
    Paths { paths: vec![Path { points, wraps, ..Path::default() }], wrap_objects: vec![object], ..Paths::default() }
}

/// Largest difference of the moment arms from minus the central differences of the length, over postures of an open set; the number of
/// postures in which the length is above the least by the points alone, so that the path wraps.
fn worst_difference(model: &Model, paths: &Paths, postures: &[Posture]) -> (f64, usize) {
    let mut kinematics = Kinematics::new(model);
    let mut geometry = PathGeometry::new(model, paths);
    let mut bare = paths.clone();
    bare.paths.iter_mut().for_each(|path| path.wraps.clear());
    let mut straight = PathGeometry::new(model, &bare);
    let (mut worst, mut wrapped) = (0f64, 0);
    for posture in postures {
        let mut length = |posture: &Posture| {
            kinematics.update(model, posture).unwrap();
            geometry.update(model, &kinematics, paths, PathRule::Geodesic);
            straight.update(model, &kinematics, &bare, PathRule::Geodesic);
            (geometry.lengths()[0], straight.lengths()[0], geometry.moment_arms(0).to_vec())
        };
        let (own, shortest, arms) = length(posture);
        wrapped += usize::from(own > shortest + 1e-6);
        for (rate, arm) in model.rates().iter().zip(arms) {
            let coordinate = rate.coordinate.unwrap();
            let mut at = |step: f64| {
                let mut moved = posture.clone();
                moved.values_mut()[coordinate] += step;
                length(&moved).0
            };
            let h = 1e-5;
            let slope = (at(h) - at(-h)) / (2.0 * h);
            worst = worst.max((arm + slope).abs());
        }
    }
    (worst, wrapped)
}

#[test]
fn moment_arms_of_fixed_conditional_and_moving_points_are_minus_the_slopes_of_the_length() {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = random();
    let paths = paths(&model, &mut rng);
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    // Not where the conditional point appears, or the moving one stops.
    let far = |p: &Posture| [0.3, 1.0, 2.0, 2.5].iter().all(|end| (p.values()[elbow] - end).abs() > 1e-3);
    let postures: Vec<Posture> = (0..30).map(|_| inside(&mut rng, &model)).filter(far).collect();
    let (worst, _) = worst_difference(&model, &paths, &postures);
    assert!(worst < 1e-9, "{worst}");
}

#[test]
fn moment_arms_over_a_cylinder_are_minus_the_slopes_of_the_length() {
    let model = adult(&Adult::default()).unwrap();
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    let quadrants = [(Quadrant::All, 0.01), (Quadrant::Half { axis: 0, positive: false }, -0.01)];
    for (quadrant, x) in quadrants {
        let mut rng = random();
        let paths = past_cylinder(&model, quadrant, x);
        let postures: Vec<Posture> = (0..60)
            .map(|_| {
                let mut posture = inside(&mut rng, &model);
                posture.values_mut()[elbow] = rng.random_range(0.05..1.5);
                posture
            })
            .collect();
        let (worst, wrapped) = worst_difference(&model, &paths, &postures);
        assert!(wrapped > 5, "{quadrant:?}: {wrapped} of 60 postures wrap");
        assert!(worst < 1e-7, "{quadrant:?}: {worst}");
    }
}

#[test]
fn moment_arms_over_spheres_ellipsoids_and_tori_are_minus_the_slopes_of_the_length() {
    let model = adult(&Adult::default()).unwrap();
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    let half = Quadrant::Half { axis: 0, positive: false };
    let shapes = [
        (WrapShape::Sphere { radius: 0.03 }, Quadrant::All, 0.005),
        (WrapShape::Sphere { radius: 0.03 }, half, -0.005),
        (WrapShape::Ellipsoid { half_axes: V::new(0.02, 0.03, 0.05) }, Quadrant::All, 0.005),
        (WrapShape::Ellipsoid { half_axes: V::new(0.05, 0.02, 0.03) }, half, -0.005),
        (WrapShape::Torus { tube: 0.01, circle: 0.04 }, Quadrant::All, 0.03),
    ];
    for (shape, quadrant, x) in shapes {
        let mut rng = random();
        let mut paths = past(&model, shape, quadrant, x);
        if let WrapShape::Torus { .. } = shape {
            // Its axis along the forearm.
            paths.wrap_objects[0].pose.rotation = UnitQuaternion::from_euler_angles(1.4, 0.1, 0.0);
        }
        let postures: Vec<Posture> = (0..60)
            .map(|_| {
                let mut posture = inside(&mut rng, &model);
                posture.values_mut()[elbow] = rng.random_range(0.05..1.2);
                posture
            })
            .collect();
        let (worst, wrapped) = worst_difference(&model, &paths, &postures);
        println!("{shape:?} {quadrant:?}: {worst:e}, {wrapped} of 60 postures wrap");
        assert!(wrapped > 5, "{shape:?} {quadrant:?}: {wrapped} of 60 postures wrap");
        assert!(worst < 1e-7, "{shape:?} {quadrant:?}: {worst}");
    }
}

#[test]
fn the_shortest_line_over_a_cylinder_is_not_longer_than_opensims() {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = random();
    let paths = past_cylinder(&model, Quadrant::All, 0.01);
    let (mut kinematics, mut geometry) = (Kinematics::new(&model), PathGeometry::new(&model, &paths));
    let mut differ = 0;
    for _ in 0..200 {
        kinematics.update(&model, &inside(&mut rng, &model)).unwrap();
        geometry.update(&model, &kinematics, &paths, PathRule::OpenSim);
        let theirs = geometry.lengths()[0];
        geometry.update(&model, &kinematics, &paths, PathRule::Geodesic);
        let ours = geometry.lengths()[0];
        assert!(ours <= theirs + 1e-12 && ours > theirs - 1e-3, "{ours} {theirs}");
        differ += usize::from(ours < theirs - 1e-9);
    }
    assert!(differ > 5, "{differ} of 200 lines differ");
}

#[test]
fn laying_paths_anew_allocates_nothing() {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = random();
    let shapes = [
        WrapShape::Cylinder { radius: 0.03, length: 1.0 },
        WrapShape::Sphere { radius: 0.03 },
        WrapShape::Ellipsoid { half_axes: V::new(0.02, 0.03, 0.05) },
        WrapShape::Torus { tube: 0.01, circle: 0.04 },
    ];
    for shape in shapes {
        let paths = past(&model, shape, Quadrant::All, 0.01);
        let (mut kinematics, mut geometry) = (Kinematics::new(&model), PathGeometry::new(&model, &paths));
        for _ in 0..20 {
            kinematics.update(&model, &inside(&mut rng, &model)).unwrap();
            for rule in [PathRule::Geodesic, PathRule::OpenSim] {
                let update = || geometry.update(&model, &kinematics, &paths, rule);
                assert_eq!(allocation_counter::measure(update).count_total, 0, "{shape:?} {rule:?}");
            }
        }
    }
}
