//! Tests activations of the least sum of squares at one elbow with two muscles, where they have closed forms.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::muscle::{
    FiberLaw, Location, Muscle, MuscleSpec, Musculature, Path, PathGeometry, PathPoint, PathRule, Paths, Recruitment,
    Sharing, StaticOptimisation, Thelen2003, coupled_strength,
};
use hierarchical_least_squares::Status;
use nalgebra::Vector3;

/// Two flexors and one extensor of the elbow, all straight lines, at an elbow of 20 degrees.
fn elbow() -> (Model, Musculature, PathGeometry, usize) {
    let model = adult(&Adult::default()).unwrap();
    let [upper, lower] = ["humerus_r", "ulna_r"].map(|name| model.segment(name));
    let end = model.segments()[lower.unwrap()].in_parent.translation.vector;
    let point = |segment, x: f64, y: f64| PathPoint { segment, location: Location::Fixed(Vector3::new(x, y, 0.0)) };
    let path = |x, y| Path { points: vec![point(upper, x, end.y + 0.2), point(lower, x, y)], ..Path::default() };
    let paths = Paths { paths: vec![path(0.03, -0.1), path(0.02, -0.05), path(-0.03, 0.02)], ..Paths::default() };
    let muscle = |path, force| MuscleSpec {
        name: format!("m{path}"),
        path,
        max_isometric_force: force,
        optimal_fiber_length: 0.1,
        tendon_slack_length: 0.15,
        pennation: 0.0,
        max_pennation: 1.4,
        least_activation: 0.01,
        rigid_tendon: false,
        law: FiberLaw::Thelen2003(Thelen2003::default()),
    };
    let muscles = [(0, 400.0), (1, 900.0), (2, 500.0)].map(|(path, force)| Muscle::new(muscle(path, force)).unwrap());
    let muscles = Musculature { paths, muscles: muscles.to_vec(), ..Musculature::default() };
    let elbow = model.coordinates()[model.coordinate("elbow_flex_r").unwrap()].rate.unwrap();
    let mut posture = model.default_posture();
    posture.values_mut()[model.coordinate("elbow_flex_r").unwrap()] = 20f64.to_radians();
    let mut kinematics = Kinematics::new(&model);
    kinematics.update(&model, &posture).unwrap();
    let mut geometry = PathGeometry::new(&model, &muscles.paths);
    geometry.update(&model, &kinematics, &muscles.paths, PathRule::Geodesic);
    (model, muscles, geometry, elbow)
}

const FORCES: [f64; 3] = [400.0, 900.0, 500.0];

#[test]
fn muscles_share_a_torque_by_their_own_torques() {
    let (_, muscles, geometry, elbow) = elbow();
    let arms = [0, 1, 2].map(|path| geometry.moment_arms(path)[elbow]);
    assert!(arms[0] > 0.01 && arms[1] > 0.01 && arms[2] < -0.01, "{arms:?}");
    let own = [0, 1, 2].map(|m| arms[m] * FORCES[m]);
    let mut optimisation = StaticOptimisation::default();
    let mut solve = |torque: f64, bounds: [(f64, f64); 3]| {
        let asked =
            Recruitment { rates: &[elbow], torques: &[torque], reserves: &[0.0], forces: &FORCES, bounds: &bounds };
        let status = optimisation.solve(&muscles, &geometry, &asked).unwrap();
        assert!(status != Status::Solved || optimisation.optimality() < 1e-8, "{}", optimisation.optimality());
        (status, optimisation.activations().to_vec(), optimisation.residual()[0])
    };
    // All above the least activation but the antagonist: a_m = t_m y.
    let rest = 0.01 * own[2];
    let (status, found, _) = solve(10.0, [(0.01, 1.0); 3]);
    let multiplier = (10.0 - rest) / (own[0] * own[0] + own[1] * own[1]);
    assert_eq!(status, Status::Solved);
    assert!((found[0] - own[0] * multiplier).abs() < 1e-10 && (found[1] - own[1] * multiplier).abs() < 1e-10);
    assert!((found[2] - 0.01).abs() < 1e-15);
    // The second is tired: the first takes over.
    let (status, found, _) = solve(10.0, [(0.01, 1.0), (0.01, 0.2), (0.01, 1.0)]);
    assert_eq!(status, Status::Solved);
    assert!((found[1] - 0.2).abs() < 1e-15);
    assert!((found[0] - (10.0 - rest - 0.2 * own[1]) / own[0]).abs() < 1e-10, "{found:?}");
    // Both are: the torque is out of reach by the rest.
    let (status, found, residual) = solve(10.0, [(0.01, 0.2), (0.01, 0.2), (0.01, 1.0)]);
    assert_eq!(status, Status::Infeasible { level: 0 });
    assert!((residual - (0.2 * (own[0] + own[1]) + rest - 10.0)).abs() < 1e-9, "{found:?} {residual}");
}

#[test]
fn cubes_share_a_torque_by_the_roots_of_the_muscles_own_torques() {
    let (_, squares, geometry, elbow) = elbow();
    let muscles = Musculature { sharing: Sharing::Cubes, ..squares };
    let own = [0, 1, 2].map(|m| geometry.moment_arms(m)[elbow] * FORCES[m]);
    let mut optimisation = StaticOptimisation::default();
    let mut solve = |torque: f64, reserve: f64, bounds: [(f64, f64); 3]| {
        let asked =
            Recruitment { rates: &[elbow], torques: &[torque], reserves: &[reserve], forces: &FORCES, bounds: &bounds };
        assert_eq!(optimisation.solve(&muscles, &geometry, &asked).unwrap(), Status::Solved);
        assert!(optimisation.optimality() < 1e-8, "{}", optimisation.optimality());
        assert!(optimisation.residual()[0].abs() < 1e-9, "{:?}", optimisation.residual());
        (optimisation.activations().to_vec(), optimisation.reserves().to_vec())
    };
    // 3 a^2 = y t of both flexors, and sum a t is the torque.
    for torque in [0.05, 1.0, 10.0] {
        let (found, _) = solve(torque, 0.0, [(0.0, 1.0); 3]);
        let scale = torque / (libm::pow(own[0], 1.5) + libm::pow(own[1], 1.5));
        for m in 0..2 {
            assert!((found[m] - scale * own[m].sqrt()).abs() < 1e-8, "{torque}: {found:?} {scale} {own:?}");
        }
        assert!(found[2] == 0.0, "{found:?}");
    }
    // The second is tired, the first takes over; then a reserve helps as a muscle of its torque would.
    let (found, _) = solve(10.0, 0.0, [(0.0, 1.0), (0.0, 0.2), (0.0, 1.0)]);
    assert!((found[1] - 0.2).abs() < 1e-15 && (found[0] - (10.0 - 0.2 * own[1]) / own[0]).abs() < 1e-9, "{found:?}");
    let (_, reserves) = solve(10.0, 7.0, [(0.0, 1.0); 3]);
    let scale = 10.0 / (libm::pow(own[0], 1.5) + libm::pow(own[1], 1.5) + libm::pow(7.0, 1.5));
    assert!((reserves[0] - scale * 7f64.sqrt()).abs() < 1e-8, "{reserves:?}");
}

#[test]
fn a_reserve_helps_as_a_muscle_of_its_torque_would() {
    let (_, muscles, geometry, elbow) = elbow();
    let own = [0, 1, 2].map(|m| geometry.moment_arms(m)[elbow] * FORCES[m]);
    let asked =
        Recruitment { rates: &[elbow], torques: &[10.0], reserves: &[7.0], forces: &FORCES, bounds: &[(0.0, 1.0); 3] };
    let mut optimisation = StaticOptimisation::default();
    optimisation.solve(&muscles, &geometry, &asked).unwrap();
    let multiplier = 10.0 / (own[0] * own[0] + own[1] * own[1] + 49.0);
    assert!((optimisation.reserves()[0] - 7.0 * multiplier).abs() < 1e-10, "{:?}", optimisation.reserves());
}

#[test]
fn the_coupled_strength_of_a_single_joint_is_the_sum() {
    let (model, muscles, geometry, elbow) = elbow();
    let states = |activation: f64| -> Vec<_> {
        let all = muscles.muscles.iter();
        all.map(|muscle| muscle.at_rest(geometry.lengths()[muscle.spec().path], activation)).collect()
    };
    let (rest, full) = (states(0.01), states(1.0));
    assert_eq!(geometry.crossed(&model), [elbow]);
    let found = coupled_strength(&muscles, &geometry, &rest, &full, &[elbow], &vec![0.0; model.rates().len()]);
    let mut sum = vec![[0.0; 2]; model.rates().len()];
    contrapposto::muscle::strength(&muscles, &geometry, &rest, &full, &mut sum);
    for k in 0..2 {
        assert!((found[0].torque[k] - sum[elbow][k]).abs() < 1e-9, "{found:?} {:?}", sum[elbow]);
    }
    assert!(found[0].missing == 0.0 && found[0].gap.abs() < 1e-9);
}
