//! Functions that are called for every frame and step allocate nothing once their workspace is as large as the problem asks. Allocations of
//! this thread are counted.

use contrapposto::batch::{Statics, Table, Wanted};
use contrapposto::contact::{ContactForces, Support};
use contrapposto::dynamics::Inertia;
use contrapposto::hybrid::{self, Strategy, minimise, minimise_literal};
use contrapposto::joint_torques::{JointReactions, JointTorques, PathForces, Quantities};
use contrapposto::kinematics::{self, Kinematics};
use contrapposto::model::{Adult, Model, adult};
use contrapposto::muscle::{
    FiberLaw, Location, Muscle, MuscleSpec, Musculature, Path, PathGeometry, PathPoint, PathRule, Paths, Thelen2003,
};
use contrapposto::posture;
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadKind};
use contrapposto::tasks::PriorityLevel;
use contrapposto::tasks::{
    CenterOfMass, CenterOfMassGoal as Place, Clearance, Distance, Effort, LookAt, LookAtGoal, Placement, Point,
    Posture, Task, Thing,
};
use contrapposto::tracking::{Goals, MarkerGoal, Tracker};
use hierarchical_least_squares::Level;
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;

type V = Vector3<f64>;

fn random() -> Pcg64 {
    Pcg64::new(20_070_902, 0)
}

const CALLS: usize = 50;

/// `work` is given the numbers 0..CALLS twice over; from call number `warm` on it must not allocate.
fn assert_silent(what: &str, warm: usize, mut work: impl FnMut(usize)) {
    for call in 0..2 * CALLS {
        let made = allocation_counter::measure(|| work(call % CALLS)).count_total;
        assert!(made == 0 || call < warm, "{what}: call {call} allocates {made} times");
    }
}

/// Anywhere inside the ranges; the root about its default.
fn inside(rng: &mut Pcg64, model: &Model) -> posture::Posture {
    let values = model.coordinates().iter().map(|c| {
        let (low, high) = (c.range.0.max(c.default - 1.0), c.range.1.min(c.default + 1.0));
        low + rng.random_range(0.02..0.98) * (high - low)
    });
    posture::Posture::new(values.collect())
}

/// The whole adult, whose six root coordinates are free, and postures of it.
fn body() -> (Model, Vec<posture::Posture>) {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = random();
    let postures = (0..CALLS).map(|_| inside(&mut rng, &model)).collect();
    (model, postures)
}

/// Loads of the hands: a weight, and a force that turns with the segment.
fn loads(model: &Model) -> [Load; 2] {
    let hand = |name| model.segment(name).unwrap();
    [
        Load::weight(model, hand("hand_r"), 3.0),
        Load {
            segment: hand("hand_l"),
            point: V::new(0.0, -0.08, 0.0),
            kind: LoadKind::Force(V::new(5.0, -20.0, 3.0), FixedIn::Segment),
        },
    ]
}

#[test]
fn the_counter_counts() {
    let made = allocation_counter::measure(|| drop(std::hint::black_box(vec![1.0; 10]))).count_total;
    assert_eq!(made, 1);
}

#[test]
fn marker_tracking_allocates_nothing() {
    let (model, postures) = body();
    let place = |segment| MarkerGoal { segment, point: V::new(0.03, -0.1, 0.05), weight: 2.0 };
    let markers: Vec<MarkerGoal> = (0..model.segments().len()).map(place).collect();
    let limits = (6..model.coordinates().len()).map(|c| (c, model.coordinates()[c].range)).collect();
    let goals = Goals { markers, limits, ..Goals::default() };
    let mut kinematics = Kinematics::new(&model);
    let frames: Vec<Vec<Option<V>>> = postures
        .iter()
        .map(|posture| {
            kinematics.update(&model, posture).unwrap();
            let station =
                |m: &MarkerGoal| Some(kinematics.station(&model, m.segment, m.point) + V::new(0.01, 0.0, 0.0));
            goals.markers.iter().map(station).collect()
        })
        .collect();
    let (mut tracker, mut posture) = (Tracker::new(&model, goals).unwrap(), model.default_posture());
    assert_silent("marker tracking", 0, |call| {
        assert!(tracker.solve(&model, &mut posture, &frames[call]).unwrap().steps > 0);
    });
}

#[test]
fn statics_allocate_nothing() {
    let (model, postures) = body();
    let loads = loads(&model);
    let (mut kinematics, mut external) = (Kinematics::new(&model), ExternalTorque::new(&model));
    let mut gradient = Gradient::new(&model);
    let mut folded = vec![0.0; model.rates().len()];
    assert_silent("torque and gradient", 1, |i| {
        kinematics.update(&model, &postures[i]).unwrap();
        external.update(&model, &kinematics, &loads).unwrap();
        external.gradient(&model, &kinematics, &mut gradient);
        folded.copy_from_slice(external.torques());
    });
    assert!(folded.iter().any(|&torque| torque != 0.0) && gradient.row(0).len() == folded.len());
}

#[test]
fn inertia_allocates_nothing() {
    let (model, postures) = body();
    let loads = loads(&model);
    let (mut kinematics, mut inertia) = (Kinematics::new(&model), Inertia::new(&model));
    let (speeds, accelerations) = (vec![1.0; model.rates().len()], vec![-2.0; model.rates().len()]);
    assert_silent("inertia", 1, |i| {
        kinematics.update(&model, &postures[i]).unwrap();
        inertia.update(&model, &kinematics, (&speeds, &accelerations), &loads).unwrap();
    });
    assert!(inertia.torques().iter().any(|&torque| torque != 0.0));
}

/// In one thread; more threads are started anew in every call.
#[test]
fn batches_allocate_nothing() {
    let (model, postures) = body();
    let loads = loads(&model);
    let mut table = Table::of_postures(&model, CALLS);
    let hand = model.segment("hand_r").unwrap();
    let wanted = Wanted { placements: vec![hand], active_torque: true, gradient: true };
    let mut statics = Statics::new(&model, wanted).unwrap();
    assert_silent("batch", 1, |i| {
        postures.iter().enumerate().for_each(|(k, posture)| table.set_posture((i + k) % CALLS, posture.values()));
        statics.update(&model, &table, &loads, 1).unwrap();
    });
    assert!(statics.effort().all(|effort| effort > 0.0));
}

/// Torques about the axes of three-axis joints, passive ones included, with derivatives, on supports, and the rows of effort.
#[test]
fn torques_about_axes_allocate_nothing() {
    let (model, postures) = body();
    let loads = loads(&model);
    let supports = ["calcn_r", "calcn_l"].map(|name| {
        let segment = model.segment(name).unwrap();
        let corners = model.segments()[segment].patch.clone();
        Support {
            segment,
            corners,
            normal: V::y(),
            friction: 0.6,
            share_max: 1.0,
            place: contrapposto::contact::Place::Fixed,
        }
    });
    let mut contact = ContactForces::new(&model, supports.to_vec()).unwrap();
    let (mut body, mut level) = (JointTorques::new(&model), Level::default());
    let (effort, mut sum) = (Task::Effort(Effort::whole(&model)), 0.0);
    assert_eq!(model.three_axis_joints().len(), 7);
    assert_silent("torques about axes and rows of effort", CALLS, |i| {
        body.update_with_contact(&model, &postures[i], &loads, &mut contact, Quantities::ALL).unwrap();
        level.clear();
        effort.evaluate(&model, &body, &mut level);
        sum += level.lower.iter().sum::<f64>() + body.gradient_about_axes().get(7, 8);
    });
    assert!(sum != 0.0);
}

#[test]
fn joint_reactions_allocate_nothing() {
    let (model, postures) = body();
    let points = ["torso", "femur_r", "tibia_r"]
        .map(|name| PathPoint { segment: model.segment(name), location: Location::Fixed(V::new(0.05, -0.1, 0.0)) });
    let muscle = Muscle::new(MuscleSpec {
        name: "m".to_owned(),
        path: 0,
        max_isometric_force: 1000.0,
        optimal_fiber_length: 0.1,
        tendon_slack_length: 0.2,
        pennation: 0.0,
        max_pennation: 1.4,
        least_activation: 0.01,
        rigid_tendon: false,
        law: FiberLaw::Thelen2003(Thelen2003::default()),
    });
    let muscles = Musculature {
        paths: Paths { paths: vec![Path { points: points.to_vec(), ..Path::default() }], ..Paths::default() },
        muscles: vec![muscle.unwrap()],
        ..Musculature::default()
    };
    let (mut kinematics, mut geometry) = (Kinematics::new(&model), PathGeometry::new(&model, &muscles.paths));
    let mut reactions = JointReactions::new(&model, &muscles);
    let loads = loads(&model);
    assert_silent("joint reactions", 0, |i| {
        kinematics.update(&model, &postures[i]).unwrap();
        geometry.update(&model, &kinematics, &muscles.paths, PathRule::Geodesic);
        let paths = PathForces { muscles: &muscles, geometry: &geometry, tensions: &[500.0] };
        reactions.update(&model, &kinematics, &loads, paths).unwrap();
    });
}

#[test]
fn jacobians_allocate_nothing() {
    let (model, postures) = body();
    let hand = model.segment("hand_r").unwrap();
    let mut kinematics = Kinematics::new(&model);
    let mut center = kinematics::CenterOfMass::new(&model);
    let mut rows = vec![0.0; 3 * model.rates().len()];
    let mut height = 0.0;
    assert_silent("centre of mass and Jacobians", 1, |i| {
        kinematics.update(&model, &postures[i]).unwrap();
        center.update(&model, &kinematics);
        height += center.position().unwrap().y + kinematics.station(&model, hand, V::x()).y;
        height += kinematics.center_of_mass(&model).unwrap().y;
        center.jacobian(&model, &kinematics, &mut rows);
        kinematics.rotation_jacobian(&model, hand, &mut rows);
        kinematics.point_jacobian(&model, hand, V::y(), &mut rows);
        kinematics.fold_columns(&model, &mut rows);
    });
    assert!(height != 0.0 && rows.iter().any(|&entry| entry != 0.0));
}

/// Goals of most kinds that `there` fulfils, and what is left as at the start.
fn goals(model: &Model, start: &posture::Posture, there: &posture::Posture) -> Vec<PriorityLevel> {
    let mut at = Kinematics::new(model);
    at.update(model, there).unwrap();
    let segment = |name| model.segment(name).unwrap();
    let [foot, right, left, head] = ["calcn_r", "hand_r", "hand_l", "head"].map(segment);
    let point = V::new(0.0, -0.08, 0.0);
    let (a, b) = (at.station(model, right, point), at.station(model, left, V::zeros()));
    vec![
        PriorityLevel {
            tasks: vec![Task::Placement(Placement {
                segment: foot,
                point: V::zeros(),
                target: at.placement(model, foot),
            })],
            hard: true,
            ..PriorityLevel::default()
        },
        Task::CenterOfMass(CenterOfMass {
            goal: Place::At { target: at.center_of_mass(model).unwrap(), axes: [true, false, true] },
        })
        .into(),
        Task::Point(Point { segment: right, point, target: a, axes: [true; 3] }).into(),
        Task::LookAt(LookAt {
            segment: head,
            eye: V::zeros(),
            direction: V::x_axis(),
            goal: LookAtGoal::Place(at.station(model, head, 3.0 * V::x())),
        })
        .into(),
        Task::Distance(Distance { a: (right, point), b: (left, V::zeros()), lower: 0.0, upper: (a - b).norm() }).into(),
        Task::Clearance(Clearance::of_body(model, &[Thing::floor(0.0)], &[]).unwrap()).into(),
        Task::Posture(Posture::whole(model, start.clone())).into(),
    ]
}

/// Steps from afresh, over and over, of which only the very first may allocate. Gives the rest of the hand's error, and the
/// distance that the body has moved.
fn steps(what: &str, model: &Model, goals: Vec<PriorityLevel>, steps: usize) -> (f64, f64) {
    let start = model.default_posture();
    let mut engine = Engine::new(model, goals, &loads(model), Options::inverse_kinematics()).unwrap();
    let mut posture = start.clone();
    let mut call = 0;
    assert_silent(what, 1, |_| {
        if call % steps == 0 {
            engine.restart();
            posture.values_mut().copy_from_slice(start.values());
        }
        call += 1;
        engine.step(&mut posture).unwrap();
    });
    let moved = posture.values().iter().zip(start.values()).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    (engine.errors()[2], moved)
}

#[test]
fn steps_allocate_nothing() {
    let (model, _) = body();
    let start = model.default_posture();
    let mut there = start.clone();
    for (name, angle) in [("elbow_flex_r", 0.6), ("arm_flex_r", 0.5), ("knee_angle_r", 0.2), ("neck_rotation", 0.1)] {
        there.values_mut()[model.coordinate(name).unwrap()] += angle;
    }
    let near = goals(&model, &start, &there);
    let (left, moved) = steps("step", &model, near.clone(), 25);
    assert!(moved > 0.05 && left < 1e-3, "moved by {moved}, {left} m are left");

    // Out of reach: second derivatives come in.
    let mut far = near;
    assert!(far[2].tasks[0].retarget(V::new(1.0, 3.0, 1.0)));
    let (left, moved) = steps("step out of reach", &model, far, 100);
    assert!(moved > 0.05 && left > 0.1, "moved by {moved}, {left} m are left");
}

#[test]
fn decisions_allocate_nothing() {
    let model = adult(&Adult::default()).unwrap();
    let curves: Vec<_> = model.coordinates().iter().filter_map(|c| c.curve()).collect();
    assert!(curves.len() > 5);
    let mut rng = random();
    let problems: Vec<hybrid::Problem<'_>> = (0..CALLS)
        .flat_map(|_| curves.clone())
        .map(|curve| hybrid::Problem {
            curve,
            angle: rng.random_range(curve.range().0..curve.range().1),
            external_torque: rng.random_range(-40.0..40.0),
            external_slope: rng.random_range(-60.0..60.0),
            strategy: if rng.random_range(0..2) == 0 { Strategy::Active } else { Strategy::Passive },
            minimum_decrease_ratio: 0.9,
            torque_tolerance: 0.05,
            accepted: None,
        })
        .collect();
    let mut decided = 0;
    assert_silent("hybrid minimisation", 1, |i| {
        for problem in &problems[i * curves.len()..(i + 1) * curves.len()] {
            decided += usize::from(minimise(problem).is_ok()) + usize::from(minimise_literal(problem).is_ok());
        }
    });
    assert!(decided > problems.len(), "{decided} of {}", 2 * problems.len());
}
