//! Tests drawn lines of muscles against their surfaces and lengths, and the work of muscles at one elbow, where it has a closed form.

use contrapposto::joint_torques::{JointMuscles, MuscleWork};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Placement, Side, adult};
use contrapposto::muscle::{
    FiberLaw, Location, Muscle, MuscleSpec, Musculature, Path, PathGeometry, PathPoint, PathRule, PathWrap, Paths,
    Quadrant, Tendon, TendonPart, Thelen2003, WrapMethod, WrapObject, WrapShape,
};
use nalgebra::{Translation3, UnitQuaternion, Vector3};

type V = Vector3<f64>;

fn point(segment: Option<usize>, x: f64, y: f64, z: f64) -> PathPoint {
    PathPoint { segment, location: Location::Fixed(V::new(x, y, z)) }
}

/// A path in ground past a surface that lies askew, from above it to below it.
fn past(shape: WrapShape, quadrant: Quadrant, [from, to]: [V; 2]) -> Paths {
    let pose =
        Placement::from_parts(Translation3::new(0.3, 1.0, -0.2), UnitQuaternion::from_euler_angles(0.4, -0.3, 0.8));
    let place = |local: V| {
        let at = (pose * nalgebra::Point3::from(local)).coords;
        point(None, at.x, at.y, at.z)
    };
    let object = WrapObject { name: "surface".to_owned(), segment: None, pose, quadrant, active: true, shape };
    let wraps = vec![PathWrap { object: 0, method: WrapMethod::Hybrid, range: (None, None) }];
    let path = Path { points: vec![place(from), place(to)], wraps, ..Path::default() };
    Paths { paths: vec![path], wrap_objects: vec![object], ..Paths::default() }
}

/// Distance from the surface, m: exact but for the ellipsoid, of which it is the first order.
fn distance(shape: &WrapShape, place: &V) -> f64 {
    match shape {
        WrapShape::Cylinder { radius, .. } => place.xy().norm() - radius,
        WrapShape::Sphere { radius } => place.norm() - radius,
        WrapShape::Ellipsoid { half_axes } => {
            let scaled = place.component_div(half_axes);
            (scaled.norm_squared() - 1.0) / (2.0 * scaled.component_div(half_axes).norm())
        }
        WrapShape::Torus { tube, circle } => libm::hypot(place.xy().norm() - circle, place.z) - tube,
    }
}

#[test]
fn drawn_arcs_lie_on_their_surfaces_and_are_as_long_as_the_line() {
    let model = adult(&Adult::default()).unwrap();
    let half = Quadrant::Half { axis: 0, positive: true };
    let across = [V::new(0.004, 0.0405, 0.01), V::new(0.006, -0.042, -0.015)];
    let cases = [
        (WrapShape::Cylinder { radius: 0.03, length: 1.0 }, Quadrant::All, across),
        // More than half a turn.
        (
            WrapShape::Cylinder { radius: 0.03, length: 1.0 },
            half,
            [V::new(-0.06, 0.05, 0.03), V::new(-0.06, -0.05, -0.04)],
        ),
        (WrapShape::Sphere { radius: 0.04 }, Quadrant::All, across),
        (WrapShape::Ellipsoid { half_axes: V::new(0.03, 0.035, 0.04) }, Quadrant::All, across),
        (
            WrapShape::Torus { tube: 0.01, circle: 0.05 },
            Quadrant::All,
            [V::new(0.1, 0.0, 0.05), V::new(0.12, 0.01, -0.06)],
        ),
    ];
    let kinematics = Kinematics::new(&model);
    for (shape, quadrant, ends) in cases {
        let paths = past(shape, quadrant, ends);
        let mut geometry = PathGeometry::new(&model, &paths);
        geometry.update(&model, &kinematics, &paths, PathRule::Geodesic);
        let drawn = geometry.drawn(&paths, 0);
        assert!(drawn.len() > 6 && drawn.iter().all(|point| point.segment.is_none() && !point.begins), "{shape:?}");
        let pose = &paths.wrap_objects[0].pose;
        let local: Vec<V> = drawn.iter().map(|p| (pose.inverse() * nalgebra::Point3::from(p.place)).coords).collect();
        for (at, end) in [(0, ends[0]), (local.len() - 1, ends[1])] {
            assert!((local[at] - end).norm() < 1e-12);
        }
        let off = local[1..local.len() - 1].iter().map(|place| distance(&shape, place).abs()).fold(0.0, f64::max);
        // Chords are shorter than arcs, by the square of their angle over 24.
        let chords: f64 = local.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let share = chords / geometry.lengths()[0];
        println!("{shape:?}: off by {off:.1e} m, chords {share:.4} of the length, {:.3} m", geometry.lengths()[0]);
        assert!(off < 1e-6 && (0.97..=0.9995).contains(&share), "{shape:?}: {off:e} {share}");
        // Numbers tell the points apart.
        let mut numbers: Vec<usize> = drawn.iter().map(|point| point.number).collect();
        assert!(numbers.iter().all(|number| *number < paths.paths[0].drawn_points()));
        numbers.sort_unstable();
        numbers.dedup();
        assert_eq!(numbers.len(), drawn.len());
    }
}

#[test]
fn a_branch_behind_a_pulley_begins_anew() {
    let model = adult(&Adult::default()).unwrap();
    let points = [0.0, 0.1, 0.2, 0.3].map(|x| point(None, x, 1.0, 0.0)).to_vec();
    let parts = [0.5, 0.0, 0.5].map(|weight| TendonPart { weight, around: None }).to_vec();
    let path = Path { points, tendon: Some(Tendon { parts, coordinates: vec![] }), ..Path::default() };
    let paths = Paths { paths: vec![path], ..Paths::default() };
    let mut geometry = PathGeometry::new(&model, &paths);
    geometry.update(&model, &Kinematics::new(&model), &paths, PathRule::Geodesic);
    let begins: Vec<bool> = geometry.drawn(&paths, 0).iter().map(|point| point.begins).collect();
    assert_eq!(begins, [false, false, true, false]);
}

const FORCES: [f64; 3] = [400.0, 900.0, 500.0];

/// Two flexors and one extensor of the elbow, all straight lines; the index of its coordinate.
fn elbow(model: &Model) -> (JointMuscles, usize) {
    let [upper, lower] = ["humerus_r", "ulna_r"].map(|name| model.segment(name));
    let end = model.segments()[lower.unwrap()].in_parent.translation.vector;
    let path = |x, y| {
        let points = vec![point(upper, x, end.y + 0.2, 0.0), point(lower, x, y, 0.0)];
        Path { points, ..Path::default() }
    };
    let paths = Paths { paths: vec![path(0.03, -0.1), path(0.02, -0.05), path(-0.03, 0.02)], ..Paths::default() };
    let muscle = |path| MuscleSpec {
        name: format!("m{path}"),
        path,
        max_isometric_force: FORCES[path],
        optimal_fiber_length: 0.1,
        tendon_slack_length: 0.15,
        pennation: 0.0,
        max_pennation: 1.4,
        least_activation: 0.01,
        rigid_tendon: false,
        law: FiberLaw::Thelen2003(Thelen2003::default()),
    };
    let muscles = [0, 1, 2].map(|path| Muscle::new(muscle(path)).unwrap()).to_vec();
    let muscles = Musculature { paths, muscles, ..Musculature::default() };
    let coordinate = model.coordinate("elbow_flex_r").unwrap();
    let rate = model.coordinates()[coordinate].rate.unwrap();
    (JointMuscles::new(model, muscles, &[rate], &[rate]), coordinate)
}

#[test]
fn muscles_of_an_elbow_work_by_their_own_torques_and_what_they_lack_is_named() {
    let model = adult(&Adult::default()).unwrap();
    let (muscles, coordinate) = elbow(&model);
    let rate = model.coordinates()[coordinate].rate.unwrap();
    let mut posture = model.default_posture();
    posture.values_mut()[coordinate] = 0.6;
    let mut work = MuscleWork::new(&model, &muscles).unwrap();
    assert!(MuscleWork::new(&model, &JointMuscles::new(&model, Musculature::default(), &[], &[])).is_none());
    let mut active = vec![0.0; model.coordinates().len()];
    active[coordinate] = 10.0;
    work.update(&model, &posture, &active).unwrap();
    // By hand: a_m = t_m tau / (t_0^2 + t_1^2) with the torques t of full activation beyond passive fibres; the antagonist rests.
    let arms = [0, 1, 2].map(|path| work.muscles().about_axes().moment_arms(path)[rate]);
    let forces: Vec<f64> = work.muscles().forces().collect();
    let own: Vec<f64> = arms.iter().zip(&forces).map(|(arm, force)| arm * force).collect();
    assert!(own[0] > 5.0 && own[1] > 5.0 && own[2] < 0.0, "{own:?}");
    let squares = own[0] * own[0] + own[1] * own[1];
    let found = work.activations().to_vec();
    for m in [0, 1] {
        assert!((found[m] - own[m] * 10.0 / squares).abs() < 1e-10, "{found:?}");
    }
    assert!(found[2].abs() < 1e-12 && work.missing(&model).is_none());
    let passive: Vec<f64> = work.muscles().passive_forces().collect();
    let torque: f64 = (0..3).map(|m| arms[m] * (work.tensions()[m] - passive[m])).sum();
    assert!((torque - 10.0).abs() < 1e-9, "tensions beyond passive ones give the torque: {torque}");
    assert_eq!(work.works_for()[0], Some((coordinate, Side::Positive)));
    assert_eq!(work.works_for()[2], Some((coordinate, Side::Negative)));
    // More than both flexors have.
    active[coordinate] = own[0] + own[1] + 3.0;
    work.update(&model, &posture, &active).unwrap();
    let missing = work.missing(&model).unwrap();
    assert!(missing.coordinate == coordinate && (missing.torque - 3.0).abs() < 1e-6, "{missing:?}");
    assert!(work.activations()[..2].iter().all(|activation| (activation - 1.0).abs() < 1e-9));
    // The line of a straight muscle is its two points.
    assert_eq!(work.line(0).len(), 2);
}
