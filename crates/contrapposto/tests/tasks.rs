//! Compares the Jacobian of every task with central differences of its error, on the whole adult and on random bodies with
//! every joint kind, driven joints and couplings. Seeded; `CONTRAPPOSTO_SEED` chooses another seed.

use crate::trees;

use std::collections::BTreeMap;

use contrapposto::fatigue::FatigueLaw;
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Side, adult};
use contrapposto::posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto::tasks::{
    Bounds, Carried, CenterOfMass, CenterOfMassGoal, Component, Distance, Effort, HalfPlane, Height, LookAt,
    LookAtGoal, Orientation, Placement, Point, Posture, Task, half_planes,
};
use hierarchical_least_squares::Level;
use nalgebra::{Isometry3, Unit, UnitQuaternion};
use rand::RngExt;
use rand_pcg::Pcg64;
use trees::{V, largest, moved, norm, random, tree, turn, unit, vector, with_muscles};

fn whole_adult() -> Model {
    adult(&Adult::default()).unwrap()
}

fn fatigue() -> FatigueLaw {
    let model = whole_adult();
    let mut groups = model.coordinates().iter().flat_map(|c| c.groups.iter().flatten());
    groups.next().unwrap().fatigue.clone()
}

/// Anywhere inside the ranges; the root about its default.
fn inside(rng: &mut Pcg64, model: &Model) -> posture::Posture {
    let values = model.coordinates().iter().map(|c| {
        let (low, high) = (c.range.0.max(c.default - 2.0), c.range.1.min(c.default + 2.0));
        low + rng.random_range(0.02..0.98) * (high - low)
    });
    posture::Posture::new(values.collect())
}

fn loads(rng: &mut Pcg64, model: &Model) -> Vec<Load> {
    (0..rng.random_range(0..4))
        .map(|_| {
            let kind = match rng.random_range(0..4) {
                0 => LoadKind::Weight(rng.random_range(0.0..10.0)),
                1 => LoadKind::Force(vector(rng, 50.0), FixedIn::World),
                2 => LoadKind::Force(vector(rng, 50.0), FixedIn::Segment),
                _ => LoadKind::Couple(vector(rng, 10.0), FixedIn::Segment),
            };
            Load { segment: rng.random_range(0..model.segments().len()), point: vector(rng, 0.3), kind }
        })
        .collect()
}

/// One of each kind, with random parts.
fn tasks(rng: &mut Pcg64, model: &Model) -> Vec<Task> {
    let count = model.segments().len();
    let segment = |rng: &mut Pcg64| rng.random_range(0..count);
    let some_axes = |rng: &mut Pcg64| {
        let mut axes = [0; 3].map(|_| rng.random_range(0..2) == 0);
        axes[rng.random_range(0..3)] = true;
        axes
    };
    let mut tasks = vec![
        Task::Point(Point {
            segment: segment(rng),
            point: vector(rng, 0.3),
            target: vector(rng, 2.0),
            axes: some_axes(rng),
        }),
        Task::Orientation(Orientation { segment: segment(rng), target: turn(rng) }),
        Task::Placement(Placement {
            segment: segment(rng),
            point: vector(rng, 0.3),
            target: Isometry3::from_parts(vector(rng, 2.0).into(), turn(rng)),
        }),
        Task::LookAt(LookAt {
            segment: segment(rng),
            eye: vector(rng, 0.2),
            direction: unit(rng),
            goal: LookAtGoal::Place(vector(rng, 3.0)),
        }),
        Task::LookAt(LookAt {
            segment: segment(rng),
            eye: vector(rng, 0.2),
            direction: unit(rng),
            goal: LookAtGoal::Direction(unit(rng)),
        }),
    ];
    let distance = |rng: &mut Pcg64, lower: f64, upper: f64| {
        let a = (segment(rng), vector(rng, 0.3));
        Task::Distance(Distance { a, b: (segment(rng), vector(rng, 0.3)), lower, upper })
    };
    tasks.push(distance(rng, 0.3, 0.5));
    tasks.push(distance(rng, 0.4, f64::INFINITY));
    tasks.push(Task::Height(Height {
        segment: segment(rng),
        point: vector(rng, 0.3),
        above: segment(rng),
        along: unit(rng),
        height: 0.2,
    }));
    let mut posture = Posture::whole(model, trees::posture(rng, model));
    for weight in &mut posture.weights {
        *weight *= [0.0, rng.random_range(0.1..3.0)][rng.random_range(0..2)];
    }
    if posture.weights.iter().any(|w| *w > 0.0) {
        tasks.push(Task::Posture(posture));
    }
    let mut component = |of| {
        let along = Unit::new_normalize(vector(rng, 1.0));
        Component {
            of,
            along,
            limits: [(0.2, 0.2), (-0.1, f64::INFINITY), (f64::NEG_INFINITY, 0.3)][rng.random_range(0..3)],
        }
    };
    let components = vec![
        component(Carried::Point(V::new(0.1, -0.2, 0.3))),
        component(Carried::Direction(Unit::new_normalize(V::new(-0.3, 0.2, 0.9)))),
    ];
    tasks.push(Task::Bounds(Bounds { segment: rng.random_range(0..model.segments().len()), components }));
    if model.mass() > 0.0 {
        let goal = CenterOfMassGoal::At { target: vector(rng, 1.0), axes: some_axes(rng) };
        tasks.push(Task::CenterOfMass(CenterOfMass { goal }));
        let feet: Vec<V> = (0..6).map(|_| vector(rng, 0.3)).collect();
        let goal = CenterOfMassGoal::Inside { polygon: half_planes(&feet, vector(rng, 9.8)), margin: 0.02 };
        tasks.push(Task::CenterOfMass(CenterOfMass { goal }));
    }
    let effort = Effort::whole(model);
    if !effort.coordinates.is_empty() {
        tasks.push(Task::Effort(effort));
    }
    tasks
}

fn needs() -> Quantities {
    Quantities { center_of_mass: true, gradient: true, passive_torque: true, ..Quantities::default() }
}

/// Rows and what they are derivatives of: `-upper`, or `-lower` where there is no upper limit.
fn evaluate(task: &Task, model: &Model, posture: &posture::Posture, loads: &[Load]) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let (mut body, mut level, mut residual) = (JointTorques::new(model), Level::default(), vec![]);
    body.update(model, posture, loads, task.quantities()).unwrap();
    task.evaluate(model, &body, &mut level);
    task.residual(model, &body, &mut residual);
    assert_eq!((level.rows(), level.matrix.len()), (task.rows(), task.rows() * model.rates().len()));
    assert_eq!(residual.len(), task.rows());
    let values = level.upper.iter().zip(&level.lower).map(|(u, l)| if u.is_finite() { -u } else { -l });
    (level.matrix.clone(), values.collect(), residual)
}

/// Central differences of the values, in the layout of the rows.
fn differences(task: &Task, model: &Model, posture: &posture::Posture, loads: &[Load], h: f64) -> Vec<f64> {
    let n = model.rates().len();
    let mut rows = vec![0.0; task.rows() * n];
    for rate in 0..n {
        let [up, down] = [h, -h].map(|h| evaluate(task, model, &moved(model, posture, rate, h), loads).1);
        for row in 0..task.rows() {
            rows[row * n + rate] = (up[row] - down[row]) / (2.0 * h);
        }
    }
    rows
}

/// An effort row has a kink where the other group takes over, where the floor of strength begins, and where a passive law of a
/// three-axis joint goes on along its tangent: at the end of the range of an angle.
fn kinks(task: &Task, model: &Model, posture: &posture::Posture, values: &[f64], row: usize) -> bool {
    let Task::Effort(effort) = task else { return false };
    let i = effort.coordinates[row];
    let strength = &model.coordinates()[i].groups.as_ref().unwrap()[Side::of(values[row]).index()].strength;
    let mut body = JointTorques::new(model);
    body.update(model, posture, &[], Quantities::TORQUES).unwrap();
    let q = body.angles()[i];
    let [a, b] = [q - 2e-3, q + 2e-3].map(|q| strength.torque_and_slope(q).1 == 0.0);
    let at_an_end = |c: &usize| {
        let (low, high) = model.coordinates()[*c].range;
        [low, high].iter().any(|end| (body.angles()[*c] - end).abs() < 5e-3)
    };
    let joint = model.three_axis_joint_of(i).map(|(joint, _)| &model.three_axis_joints()[joint]);
    values[row].abs() < 0.05 || a != b || joint.is_some_and(|joint| joint.coordinates.iter().any(at_an_end))
}

/// Errors bend sharply toward half a turn, where they jump; `turns_of_any_size` goes there.
fn near_half_a_turn(task: &Task, model: &Model, posture: &posture::Posture, residual: &[f64]) -> bool {
    match task {
        Task::Orientation(_) | Task::LookAt(_) => norm(residual) > 2.9,
        Task::Placement(_) => norm(&residual[3..]) > 2.9,
        Task::Posture(task) => {
            let mut step = vec![0.0; model.rates().len()];
            task.target.difference(model, posture, &mut step);
            let balls: Vec<usize> = (0..step.len()).filter(|&i| model.rates()[i].coordinate.is_none()).collect();
            balls.chunks(3).any(|ball| norm(&step[ball[0]..ball[0] + 3]) > 2.9)
        }
        _ => false,
    }
}

/// Worst difference over the size of the row, by kind, over one posture.
fn compare(
    rng: &mut Pcg64,
    model: &Model,
    posture: &posture::Posture,
    worst: &mut BTreeMap<&'static str, (f64, f64, f64)>,
) {
    let (n, loads) = (model.rates().len(), loads(rng, model));
    for task in tasks(rng, model) {
        task.check(model).unwrap();
        let (exact, values, residual) = evaluate(&task, model, posture, &loads);
        let by_unit = |row: usize| ["m", "rad", "1"].contains(&task.unit(model, row).symbol());
        assert!((0..task.rows()).all(by_unit) && !task.label(model).is_empty());
        let [fine, half, whole] = [1e-5, 5e-4, 1e-3].map(|h| differences(&task, model, posture, &loads, h));
        let entry = worst.entry(task.kind()).or_insert((0.0, f64::MAX, 0.0));
        for row in 0..task.rows() {
            assert!(values[row].is_finite() && residual[row].is_finite());
            let part = row * n..(row + 1) * n;
            if kinks(&task, model, posture, &values, row) || near_half_a_turn(&task, model, posture, &residual) {
                continue;
            }
            let against = |rows: &[f64]| norm(&[&exact[part.clone()], &rows[part.clone()]].difference());
            let scale = largest(exact[part.clone()].iter().copied()).max(1.0);
            entry.0 = entry.0.max(against(&fine) / scale);
            if against(&half) > 1e-8 * scale {
                let ratio = against(&whole) / against(&half);
                (entry.1, entry.2) = (entry.1.min(ratio), entry.2.max(ratio));
            }
        }
    }
}

trait Difference {
    fn difference(&self) -> Vec<f64>;
}

impl Difference for [&[f64]; 2] {
    fn difference(&self) -> Vec<f64> {
        self[0].iter().zip(self[1]).map(|(a, b)| a - b).collect()
    }
}

fn report(worst: &BTreeMap<&'static str, (f64, f64, f64)>) {
    assert_eq!(worst.len(), 10, "{worst:?}");
    for (kind, (error, low, high)) in worst {
        println!("{kind}: worst relative difference {error:.1e}; halved step: error falls by {low:.3}..{high:.3}");
    }
    for (kind, (error, low, high)) in worst {
        assert!(*error < 1e-6, "{kind}: {error:e}");
        // Posture rows of hinges and slides are exact.
        assert!(*high == 0.0 && *kind == "posture" || *low > 3.9 && *high < 4.1, "{kind}: {low} {high}");
    }
}

#[test]
fn derivatives_on_the_adult() {
    let mut rng = random("derivatives_on_the_adult");
    let model = whole_adult();
    let mut worst = BTreeMap::new();
    for _ in 0..12 {
        let posture = inside(&mut rng, &model);
        compare(&mut rng, &model, &posture, &mut worst);
    }
    report(&worst);
}

#[test]
fn derivatives_on_random_trees() {
    let mut rng = random("derivatives_on_random_trees");
    let law = fatigue();
    let (mut worst, mut couplings) = (BTreeMap::new(), 0);
    for round in 0..120 {
        let segments = rng.random_range(2..12);
        let model = tree(&mut rng, segments, round % 3 > 0);
        let model = with_muscles(&mut rng, model, &law);
        couplings += model.couplings().len();
        let posture = trees::posture(&mut rng, &model);
        compare(&mut rng, &model, &posture, &mut worst);
    }
    println!("{couplings} couplings");
    assert!(couplings > 50);
    report(&worst);
}

/// The adult with a task's segment somewhere, its kinematics and the derivative's greatest error at step `h`.
fn error_of(task: &Task, model: &Model, posture: &posture::Posture, h: f64) -> f64 {
    let (exact, ..) = evaluate(task, model, posture, &[]);
    let differences = differences(task, model, posture, &[], h);
    largest([&exact[..], &differences[..]].difference()) / largest(exact).max(1.0)
}

#[test]
fn turns_of_any_size() {
    let mut rng = random("turns_of_any_size");
    let model = whole_adult();
    let hand = model.segment("hand_r").unwrap();
    let pi = std::f64::consts::PI;
    for (away, h, bound) in [
        (0.0, 1e-4, 1e-7),
        (1e-12, 1e-4, 1e-7),
        (1e-6, 1e-4, 1e-7),
        (0.0199, 1e-4, 1e-7),
        (0.0201, 1e-4, 1e-7),
        (0.0999, 1e-4, 1e-7),
        (0.1001, 1e-4, 1e-7),
        (pi / 2.0, 1e-4, 1e-7),
        (pi - 0.1, 1e-5, 1e-6),
        (pi - 1e-2, 1e-6, 1e-6),
        (pi - 1e-3, 1e-7, 1e-6),
    ] {
        let mut errors = [0.0f64; 3];
        for _ in 0..10 {
            let posture = inside(&mut rng, &model);
            let mut kinematics = Kinematics::new(&model);
            kinematics.update(&model, &posture).unwrap();
            let present = kinematics.placement(&model, hand).rotation;
            let axis = unit(&mut rng);
            let back = UnitQuaternion::from_axis_angle(&axis, -away);
            let task = Task::Orientation(Orientation { segment: hand, target: back * present });
            let residual = V::from_column_slice(&evaluate(&task, &model, &posture, &[]).2);
            assert!((residual - away * axis.into_inner()).norm() < 1e-12 + 1e-15 / (pi - away));
            errors[0] = errors[0].max(error_of(&task, &model, &posture, h));

            // A place as far from the gaze.
            let (eye, direction) = (vector(&mut rng, 0.1), unit(&mut rng));
            let gaze = kinematics.direction(&model, hand, direction.into_inner());
            let across = Unit::new_normalize(gaze.cross(&unit(&mut rng).into_inner()));
            let line = UnitQuaternion::from_axis_angle(&across, away) * gaze;
            let target = kinematics.station(&model, hand, eye) + rng.random_range(0.3..3.0) * line;
            let task = Task::LookAt(LookAt { segment: hand, eye, direction, goal: LookAtGoal::Place(target) });
            let residual = evaluate(&task, &model, &posture, &[]).2;
            assert!((norm(&residual) - away).abs() < 1e-12, "{away}: {residual:?}");
            errors[1] = errors[1].max(error_of(&task, &model, &posture, h));
        }
        // A ball, for posture tasks.
        let model = loop {
            let model = tree(&mut rng, 1, false);
            if (model.rates().len(), model.coordinates().len()) == (3, 4) {
                break model;
            }
        };
        for _ in 0..10 {
            let posture = trees::posture(&mut rng, &model);
            let mut target = posture.clone();
            target.displace(&model, (away * unit(&mut rng).into_inner()).as_slice());
            let task = Task::Posture(Posture { target, weights: vec![1.0, 2.0, 3.0] });
            let residual = evaluate(&task, &model, &posture, &[]).2;
            assert!((norm(&residual) - away).abs() < 1e-12);
            errors[2] = errors[2].max(error_of(&task, &model, &posture, h));
        }
        let text = errors.map(|e| format!("{e:.1e}")).join(", ");
        println!("{away:.6} rad, step {h:.0e}: orientation, look_at, ball {text}");
        assert!(largest(errors) < bound, "{text}");
    }
}

#[test]
fn look_at_turns_the_gaze_onto_the_target() {
    // The error is the rotation vector itself, so the turn that it names must end the search at once.
    let mut rng = random("look_at_turns_the_gaze_onto_the_target");
    let model = loop {
        let model = tree(&mut rng, 1, false);
        if (model.rates().len(), model.coordinates().len()) == (3, 4) {
            break model;
        }
    };
    for _ in 0..200 {
        let posture = trees::posture(&mut rng, &model);
        // The ball turns about the eye: the joint's moved frame lies in the segment's.
        let eye = model.segments()[0].in_segment.translation.vector;
        let direction = unit(&mut rng);
        let mut kinematics = Kinematics::new(&model);
        kinematics.update(&model, &posture).unwrap();
        let target = kinematics.station(&model, 0, eye) + vector(&mut rng, 2.0);
        let task = Task::LookAt(LookAt { segment: 0, eye, direction, goal: LookAtGoal::Place(target) });
        let (rows, values, residual) = evaluate(&task, &model, &posture, &[]);
        if norm(&residual) > 3.1 {
            continue;
        }
        // The shortest step that solves both rows.
        let j = nalgebra::Matrix2x3::from_row_slice(&rows);
        let step =
            j.transpose() * (j * j.transpose()).try_inverse().unwrap() * -nalgebra::Vector2::from_column_slice(&values);
        let mut there = posture.clone();
        there.displace(&model, step.as_slice());
        assert!(norm(&evaluate(&task, &model, &there, &[]).2) < 1e-12);
    }
    // Straight behind and at the eye: finite, and behind is not taken for a success.
    let posture = model.default_posture();
    let kinematics = Kinematics::new(&model);
    let direction = unit(&mut rng);
    let eye = V::new(0.1, 0.2, 0.3);
    let gaze = kinematics.direction(&model, 0, direction.into_inner());
    for (along, expected) in [(-1.0, std::f64::consts::PI), (0.0, 0.0), (1.0, 0.0)] {
        let target = kinematics.station(&model, 0, eye) + along * gaze;
        let task = Task::LookAt(LookAt { segment: 0, eye, direction, goal: LookAtGoal::Place(target) });
        let (rows, values, residual) = evaluate(&task, &model, &posture, &[]);
        assert!(rows.iter().chain(&values).all(|x| x.is_finite()) && largest(rows) < 1e7);
        assert!((norm(&residual) - expected).abs() < 1e-5, "{residual:?}");
    }
}

#[test]
fn effort_is_active_torque_over_strength() {
    let mut rng = random("effort_is_active_torque_over_strength");
    let model = whole_adult();
    let effort = Effort::whole(&model);
    println!("{} coordinates", effort.coordinates.len());
    let task = Task::Effort(effort.clone());
    let mut body = JointTorques::new(&model);
    for _ in 0..50 {
        let (posture, loads) = (inside(&mut rng, &model), loads(&mut rng, &model));
        body.update(&model, &posture, &loads, task.quantities()).unwrap();
        let mut residual = vec![];
        task.residual(&model, &body, &mut residual);
        for (&i, share) in effort.coordinates.iter().zip(&residual) {
            let coordinate = &model.coordinates()[i];
            let rate = coordinate.rate.unwrap();
            let active = -(body.passive_torque().about_axes()[rate] + body.external_about_axes()[rate]);
            let group = &coordinate.groups.as_ref().unwrap()[Side::of(active).index()];
            assert_eq!(*share, active / group.strength.torque(body.angles()[i]));
        }
    }
}

#[test]
fn rows_are_added_and_space_is_kept() {
    let mut rng = random("rows_are_added_and_space_is_kept");
    let model = whole_adult();
    let (tasks, mut body) = (tasks(&mut rng, &model), JointTorques::new(&model));
    let (mut level, mut space) = (Level::default(), None);
    let all = tasks.iter().fold(Quantities::default(), |needs, task| needs.with(task.quantities()));
    assert_eq!(all, needs());
    for _ in 0..5 {
        let posture = inside(&mut rng, &model);
        body.update(&model, &posture, &[], all).unwrap();
        level.clear();
        tasks.iter().for_each(|task| task.evaluate(&model, &body, &mut level));
        assert_eq!(level.rows(), tasks.iter().map(Task::rows).sum::<usize>());
        let now = (level.matrix.capacity(), level.lower.capacity(), level.matrix.as_ptr() as usize);
        assert_eq!(*space.get_or_insert(now), now, "the level grew again");
        // Each alone gives the same rows.
        let mut alone = vec![];
        for task in &tasks {
            alone.extend(evaluate(task, &model, &posture, &[]).0);
        }
        let same = alone.iter().zip(&level.matrix).all(|(a, b)| (a - b).abs() <= 1e-15 * a.abs().max(1.0));
        assert!(alone.len() == level.matrix.len() && same);
    }
}

/// The rise of the shoulder that the task asks for, in random postures of trunk and arm, beside the elevation that an independent
/// formula gives: between the long axes, by the angles of the shoulder alone.
#[test]
fn shoulders_rise_by_half_the_cosine_of_elevation() {
    let mut rng = random("shoulders_rise_by_half_the_cosine_of_elevation");
    let model = whole_adult();
    let shoulders = Height::shoulder_rhythm(&model);
    assert_eq!(shoulders.len(), 2);
    for side in ["r", "l"] {
        let index = |stem: &str| model.coordinate(&format!("{stem}_{side}")).unwrap();
        let rise = index("shoulder_rise");
        let (_, task) = shoulders.iter().find(|(coordinate, _)| *coordinate == rise).unwrap();
        let most = 0.314 * model.coordinates()[rise].range.1;
        for _ in 0..100 {
            let mut posture = inside(&mut rng, &model);
            let [flex, add] = ["arm_flex", "arm_add"].map(|stem| posture.values()[index(stem)]);
            posture.values_mut()[rise] = 0.5 * most * (1.0 - libm::cos(flex) * libm::cos(add));
            let residual = evaluate(&Task::Height(*task), &model, &posture, &[]).2[0];
            assert!(residual.abs() < 1e-12, "{side}: {residual}");
        }
    }
    let arm = adult(&Adult { part: contrapposto::model::Part::RightArm, ..Adult::default() }).unwrap();
    assert!(Height::shoulder_rhythm(&arm).is_empty());
}

#[test]
fn inequalities_hold_where_they_should() {
    let model = whole_adult();
    let posture = model.default_posture();
    let (hand, head) = (model.segment("hand_r").unwrap(), model.segment("head").unwrap());
    let distance =
        |lower, upper| Task::Distance(Distance { a: (hand, V::zeros()), b: (head, V::zeros()), lower, upper });
    let length = -evaluate(&distance(0.0, 0.0), &model, &posture, &[]).1[0];
    assert!(length < 0.0);
    let length = -length;
    let residual = |task: &Task| evaluate(task, &model, &posture, &[]).2[0];
    assert_eq!(residual(&distance(0.0, length + 0.1)), 0.0);
    assert!((residual(&distance(0.0, length - 0.1)) - 0.1).abs() < 1e-15);
    assert!((residual(&distance(length + 0.1, f64::INFINITY)) + 0.1).abs() < 1e-15);

    let mut body = JointTorques::new(&model);
    body.update(&model, &posture, &[], needs()).unwrap();
    let center = body.center_of_mass().position().unwrap();
    let square: Vec<V> =
        [(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)].map(|(x, z)| center + V::new(x, -1.0, z)).to_vec();
    let over = |margin| {
        let goal = CenterOfMassGoal::Inside { polygon: half_planes(&square, model.gravity()), margin };
        evaluate(&Task::CenterOfMass(CenterOfMass { goal }), &model, &posture, &[])
    };
    assert!(over(0.05).2.iter().all(|&r| r == 0.0));
    assert!(over(0.05).1.iter().all(|&v| (v + 0.05).abs() < 1e-12), "5 cm to spare on each side");
    assert!(over(0.15).2.iter().all(|&r| (r - 0.05).abs() < 1e-12));
}

/// Whether `x` is inside all half-planes, to within `slack`.
fn within(planes: &[HalfPlane], x: &V, slack: f64) -> bool {
    planes.iter().all(|plane| plane.excess(x) <= slack)
}

#[test]
fn polygons_are_convex_hulls() {
    let mut rng = random("polygons_are_convex_hulls");
    let mut edges = 0;
    for round in 0..2000 {
        let gravity = if round % 2 == 0 { V::new(0.0, -9.81, 0.0) } else { vector(&mut rng, 9.81) };
        let down = gravity.normalize();
        let count = rng.random_range(3..30);
        let mut points: Vec<V> = (0..count).map(|_| vector(&mut rng, 1.0)).collect();
        if round % 3 == 0 {
            // On a grid: many on one line, many twice.
            points.iter_mut().for_each(|p| *p = p.map(|x| (x * 2.0).round() / 2.0));
        }
        let planes = half_planes(&points, gravity);
        edges += planes.len();
        for plane in &planes {
            assert!((plane.normal.norm() - 1.0).abs() < 1e-14 && plane.normal.dot(&down).abs() < 1e-14);
            // A supporting line: all points on this side, one at least on it.
            let excess = points.iter().map(|p| plane.excess(p)).fold(f64::MIN, f64::max);
            assert!(excess.abs() < 2e-9, "{excess:e} {points:?} {gravity:?}");
        }
        // By brute force: outside if some line through two points, with all on one side, has it on the other.
        let across = |p: &V| p - down * p.dot(&down);
        let mut supporting = vec![];
        for p in &points {
            for q in &points {
                if let Some(normal) = down.cross(&across(&(q - p))).try_normalize(1e-9) {
                    let plane = HalfPlane { normal, offset: normal.dot(p) };
                    if within(&[plane], p, 1e-12) && points.iter().all(|x| plane.excess(x) < 1e-12) {
                        supporting.push(plane);
                    }
                }
            }
        }
        // This knows no ends of a stretch.
        let solid = supporting.iter().any(|plane| plane.normal.cross(&supporting[0].normal).norm() > 1e-3);
        for _ in 0..50 {
            let x = vector(&mut rng, 1.2);
            let (loose, tight) = (within(&planes, &x, 1e-9), within(&planes, &x, -1e-9));
            if loose == tight && solid {
                assert_eq!(loose, within(&supporting, &x, 0.0), "{points:?} {x}");
            }
            // Height does not matter.
            assert_eq!(tight, within(&planes, &(x + 0.0 * down), -1e-9));
        }
    }
    println!("{edges} edges");
    assert!(edges > 10_000);
}

#[test]
fn thin_polygons_are_closed() {
    let g = V::new(0.0, -9.81, 0.0);
    assert!(half_planes(&[], g).is_empty() && half_planes(&[V::x()], V::zeros()).is_empty());
    let place = V::new(0.3, 1.0, -0.2);
    for points in [vec![place], vec![place, place + V::y(), place]] {
        let planes = half_planes(&points, g);
        assert_eq!(planes.len(), 4);
        assert!(within(&planes, &place, 1e-15) && within(&planes, &(place + 5.0 * V::y()), 1e-15));
        for way in [V::x(), V::z(), -V::x(), -V::z(), V::new(1.0, 0.0, -1.0)] {
            assert!(!within(&planes, &(place + 1e-6 * way), 1e-9));
        }
    }
    // Minus zero is zero: sorted apart, it once lost a corner.
    let points = [(0.5, -0.0), (0.5, 0.0), (-0.5, -0.0), (1.0, 0.0)].map(|(x, z)| V::new(x, 0.0, z));
    let planes = half_planes(&points, g);
    assert!(points.iter().all(|p| within(&planes, p, 1e-15)));
    let points: Vec<V> = (0..5).map(|i| place + 0.1 * f64::from(i) * V::new(1.0, 0.5, 2.0)).collect();
    let planes = half_planes(&points, g);
    assert_eq!(planes.len(), 4);
    assert!(points.iter().all(|p| within(&planes, p, 1e-15)));
    for off in
        [points[0] - 1e-6 * V::z(), points[4] + 1e-6 * V::z(), points[2] + 1e-6 * V::x(), points[2] - 1e-6 * V::x()]
    {
        assert!(!within(&planes, &off, 1e-9));
    }
}

#[test]
fn wrong_tasks_are_refused_by_name() {
    let model = whole_adult();
    let text = |task: Task| task.check(&model).unwrap_err().to_string();
    let (o, hand) = (V::zeros(), model.segment("hand_r").unwrap());
    let point = Point { segment: hand, point: o, target: o, axes: [true; 3] };
    assert_eq!(Task::Point(point).check(&model), Ok(()));
    assert_eq!(Task::Point(point).label(&model), "point hand_r");
    let count = model.segments().len();
    assert_eq!(
        text(Task::Point(Point { segment: 999, ..point })),
        format!("point task: segment number 999; the model has {count}")
    );
    assert_eq!(
        text(Task::Point(Point { target: V::new(0.0, f64::NAN, 0.0), ..point })),
        "point task: target (m) is NaN; it must be finite and at most 1e9 in size"
    );
    assert!(text(Task::Point(Point { point: V::new(0.0, 0.0, 2e9), ..point })).contains("point (m) is 2000000000;"));
    assert_eq!(
        text(Task::Point(Point { axes: [false; 3], ..point })),
        "point task: it asks for no axis; it must ask for one at least"
    );
    let long = Unit::new_unchecked(nalgebra::Quaternion::new(2.0, 0.0, 0.0, 0.0));
    assert_eq!(
        text(Task::Orientation(Orientation { segment: hand, target: long })),
        "orientation task: length of the target's quaternion is 2; it must be 1"
    );
    let target = Isometry3::from_parts(o.into(), Unit::new_unchecked(nalgebra::Quaternion::identity() * f64::NAN));
    assert!(text(Task::Placement(Placement { segment: hand, point: o, target })).starts_with("placement task: length"));
    let direction = Unit::new_unchecked(o);
    assert_eq!(
        text(Task::LookAt(LookAt { segment: hand, eye: o, direction, goal: LookAtGoal::Place(o) })),
        "look_at task: length of the direction is 0; it must be 1"
    );
    let between = |lower, upper| Task::Distance(Distance { a: (hand, o), b: (0, o), lower, upper });
    assert!(text(between(-1.0, 2.0)).contains("lower limit (m) is -1; it must be between 0 and 1e9"));
    assert!(text(between(1.0, 0.5)).contains("upper limit (m) is 0.5; it must be at or above the lower limit"));
    assert!(text(between(1.0, f64::NAN)).contains("upper limit (m) is NaN"));
    let over =
        |polygon, margin| Task::CenterOfMass(CenterOfMass { goal: CenterOfMassGoal::Inside { polygon, margin } });
    assert!(text(over(vec![], 0.0)).contains("it asks for no edge of a polygon"));
    let edge = HalfPlane { normal: 2.0 * V::x(), offset: 1.0 };
    assert!(text(over(vec![edge], 0.0)).contains("length of an edge's normal is 2; it must be 1"));
    assert!(text(over(vec![edge], f64::INFINITY)).contains("margin (m) is inf"));
    let posture = Posture::whole(&model, model.default_posture());
    assert_eq!(Task::Posture(posture.clone()).check(&model), Ok(()));
    let mut wrong = posture.clone();
    wrong.weights[3] = -1.0;
    assert!(text(Task::Posture(wrong)).contains("weight is -1; it must be between 0 and 1e9"));
    let weights = vec![];
    assert!(
        text(Task::Posture(Posture { weights, ..posture.clone() })).starts_with("posture task: 0 weights; the model")
    );
    let weights = vec![0.0; posture.weights.len()];
    assert!(text(Task::Posture(Posture { weights, ..posture.clone() })).contains("it asks for no coordinate"));
    let mut wrong = posture;
    wrong.target.values_mut()[0] = f64::NAN;
    assert!(text(Task::Posture(wrong)).contains(&format!("`{}` is NaN", model.coordinates()[0].name)));
    let effort = |coordinates| Task::Effort(Effort { coordinates });
    assert!(text(effort(vec![])).contains("it asks for no coordinate"));
    assert!(text(effort(vec![9999])).contains("coordinate number 9999"));
    let root = (0..model.coordinates().len()).find(|&i| model.coordinates()[i].groups.is_none()).unwrap();
    assert!(text(effort(vec![root])).contains("has no known strength"));
    // Followers.
    let mut rng = random("wrong_tasks_are_refused_by_name");
    let law = fatigue();
    let model = loop {
        let model = tree(&mut rng, 8, true);
        if !model.couplings().is_empty() {
            break with_muscles(&mut rng, model, &law);
        }
    };
    let follower = model.couplings()[0].dependent;
    let groups = model.coordinates().iter().find_map(|c| c.groups.clone()).unwrap();
    let model = model.with_groups(follower, groups);
    let text = |task: Task| task.check(&model).unwrap_err().to_string();
    assert!(text(effort(vec![follower])).ends_with("follows another coordinate; ask that one"));
    assert!(!Effort::whole(&model).coordinates.contains(&follower));
    let mut posture = Posture::whole(&model, model.default_posture());
    posture.weights.fill(1.0);
    assert!(text(Task::Posture(posture)).ends_with("follows another coordinate; ask that one"));
}

#[test]
fn a_refused_update_leaves_the_body_as_it_was() {
    let model = whole_adult();
    let mut body = JointTorques::new(&model);
    body.update(&model, &model.default_posture(), &[], needs()).unwrap();
    let before = body.center_of_mass().position();
    let mut wrong = model.default_posture();
    wrong.values_mut()[0] = f64::NAN;
    body.update(&model, &wrong, &[], Quantities::default()).unwrap_err();
    assert_eq!(body.center_of_mass().position(), before);
}
