//! Distances of parts of the body from each other and from things, against dense sampling; rows against central differences.

use contrapposto::joint_torques::JointTorques;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Capsule, Model, adult};
use contrapposto::posture::Posture;
use contrapposto::tasks::{Clearance, ClearancePair, Obstacle, Task, Thing};
use hierarchical_least_squares::Level;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

type V = Vector3<f64>;

const SEED: u64 = 16;

fn vector(random: &mut Pcg64Mcg, size: f64) -> V {
    V::from_fn(|_, _| random.random_range(-size..size))
}

/// Inside the ranges, the root near its default.
fn posture(random: &mut Pcg64Mcg, model: &Model) -> Posture {
    let values = model.coordinates().iter().map(|c| {
        let (low, high) = (c.range.0.max(c.default - 1.5), c.range.1.min(c.default + 1.5));
        random.random_range(low..high)
    });
    Posture::new(values.collect())
}

/// A block somewhere about the body, and the floor.
fn things(random: &mut Pcg64Mcg) -> [Thing; 3] {
    let middle = V::new(0.0, 1.0, 0.0) + vector(random, 0.8);
    let turn = UnitQuaternion::from_scaled_axis(vector(random, 2.0));
    let half = vector(random, 0.3).map(|length| length.abs() + 0.02);
    let normal = vector(random, 1.0).normalize();
    [
        Thing::floor(0.4),
        Thing::HalfSpace { normal, offset: normal.y },
        Thing::Block { placement: Isometry3::from_parts(middle.into(), turn), half },
    ]
}

/// Points of a capsule's line in ground.
fn points(model: &Model, kinematics: &Kinematics, capsule: &Capsule, count: usize) -> Vec<V> {
    let ends = capsule.ends.map(|end| kinematics.station(model, capsule.segment, end));
    (0..=count).map(|i| ends[0] + (i as f64 / count as f64) * (ends[1] - ends[0])).collect()
}

/// Distance of a point from a thing; negative inside by the depth below the nearest face.
fn from_thing(thing: &Thing, point: &V) -> f64 {
    match thing {
        Thing::HalfSpace { normal, offset } => normal.dot(point) - offset,
        Thing::Block { placement, half } => {
            let inside = placement.inverse_transform_point(&Point3::from(*point)).coords;
            let beyond = inside.abs() - half;
            let out = beyond.map(|x| x.max(0.0)).norm();
            if out > 0.0 { out } else { beyond.max() }
        }
    }
}

/// Distances of all pairs are those of the nearest of 60 by 60 points, in 40 postures.
#[test]
fn distances_of_all_pairs_are_those_of_dense_sampling() {
    let mut random = Pcg64Mcg::new(SEED.into());
    let model = adult(&Adult::default()).unwrap();
    let mut kinematics = Kinematics::new(&model);
    let (mut worst, mut overlaps, mut pairs) = (0f64, 0, 0);
    for _ in 0..40 {
        kinematics.update(&model, &posture(&mut random, &model)).unwrap();
        for pair in Clearance::of_body(&model, &things(&mut random), &[]).unwrap().pairs {
            let found = pair.distance(&model, &kinematics);
            let part = points(&model, &kinematics, &pair.part, 60);
            let length = |points: &[V]| (points[60] - points[0]).norm();
            let least = |distances: &mut dyn Iterator<Item = f64>| distances.fold(f64::INFINITY, f64::min);
            let (sampled, radii, finer) = match &pair.other {
                Obstacle::Part(other) => {
                    let others = points(&model, &kinematics, other, 60);
                    let mut all = part.iter().flat_map(|p| others.iter().map(move |q| (p - q).norm()));
                    (least(&mut all), pair.part.radius + other.radius, length(&part) + length(&others))
                }
                Obstacle::Thing(thing) => {
                    let mut all = part.iter().map(|p| from_thing(thing, p));
                    (least(&mut all), pair.part.radius, length(&part))
                }
            };
            pairs += 1;
            overlaps += usize::from(found < 0.0);
            // A line that enters a block needs a motion through one face: at least the depth of its deepest point.
            let entered = matches!(pair.other, Obstacle::Thing(Thing::Block { .. })) && sampled < 0.0;
            let off = found + radii - sampled;
            assert!(off <= 1e-9, "{found} {sampled} {radii}");
            assert!(entered || off >= -finer / 60.0 - 1e-9, "{found} {sampled} {radii}");
            worst = worst.max(if entered { 0.0 } else { off.abs() });
        }
    }
    println!("seed {SEED}: {pairs} pairs, {overlaps} overlap, {worst:.1e} m from the nearest sampled points at most");
    assert!(overlaps > 100 && worst > 0.0);
}

/// Values of the rows, `-lower`, and the rows.
fn evaluate(task: &Task, model: &Model, posture: &Posture) -> (Vec<f64>, Vec<f64>) {
    let (mut body, mut level) = (JointTorques::new(model), Level::default());
    body.update(model, posture, &[], task.quantities()).unwrap();
    task.evaluate(model, &body, &mut level);
    assert_eq!((level.rows(), level.matrix.len()), (task.rows(), task.rows() * model.rates().len()));
    assert!(level.upper.iter().all(|upper| *upper == f64::INFINITY));
    (level.lower.iter().map(|lower| -lower).collect(), level.matrix)
}

/// Rows along random motions are central differences of the distances, but at a kink, where one-sided differences disagree.
#[test]
fn rows_along_random_motions_are_central_differences_of_the_distances() {
    let mut random = Pcg64Mcg::new(SEED.into());
    let model = adult(&Adult::default()).unwrap();
    let (n, h) = (model.rates().len(), 1e-6);
    let (mut worst, mut compared, mut kinks) = (0f64, 0, 0);
    for _ in 0..40 {
        let start = posture(&mut random, &model);
        let clearance = Clearance::of_body(&model, &things(&mut random), &[]).unwrap();
        let task = Task::Clearance(Clearance { activation: 10.0, ..clearance });
        task.check(&model).unwrap();
        let direction: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
        let (now, rows) = evaluate(&task, &model, &start);
        let [before, after] = [-h, h].map(|h| {
            let mut moved = start.clone();
            moved.displace(&model, &direction.iter().map(|d| h * d).collect::<Vec<_>>());
            evaluate(&task, &model, &moved).0
        });
        for (i, row) in rows.chunks_exact(n).enumerate() {
            let exact: f64 = row.iter().zip(&direction).map(|(a, d)| a * d).sum();
            let (left, right) = ((now[i] - before[i]) / h, (after[i] - now[i]) / h);
            assert!(exact.is_finite());
            if (left - right).abs() > 1e-3 * (1.0 + exact.abs()) {
                kinks += 1;
                continue;
            }
            compared += 1;
            worst = worst.max((0.5 * (left + right) - exact).abs() / (1.0 + exact.abs()));
        }
    }
    println!("seed {SEED}: {compared} rows, off by {worst:.1e} at most; {kinks} at a kink");
    assert!(worst < 1e-6 && compared > 4000 && kinks < compared / 100, "{worst} {compared} {kinks}");
}

/// Lines that cross, coincide, are parallel or have no length, in a block, on its faces, and a block without size.
#[test]
fn degenerate_pairs_have_finite_rows_that_move_them_apart() {
    let model = adult(&Adult::default()).unwrap();
    let (hand, head) = (model.segment("hand_r").unwrap(), model.segment("head").unwrap());
    let mut kinematics = Kinematics::new(&model);
    let start = model.default_posture();
    kinematics.update(&model, &start).unwrap();
    let (x, y, o) = (V::x(), V::y(), V::zeros());
    let lines = [[o, o], [-x, x], [-y, y], [o, x], [2.0 * x, x], [V::new(1.0, 1e-9, 0.0), -x]];
    let at = |segment: usize, ends: [V; 2]| {
        let back = kinematics.placement(&model, segment).inverse();
        Capsule { segment, ends: ends.map(|end| back.transform_point(&Point3::from(end)).coords), radius: 0.1 }
    };
    let mut pairs = vec![];
    for part in lines.map(|ends| at(hand, ends)) {
        pairs.extend(lines.map(|ends| ClearancePair { part, other: Obstacle::Part(at(head, ends)) }));
        for half in [o, V::new(0.5, 0.5, 0.5), V::new(0.0, 0.5, 0.5)] {
            let thing = Thing::Block { placement: Isometry3::identity(), half };
            pairs.push(ClearancePair { part, other: Obstacle::Thing(thing) });
        }
        pairs.push(ClearancePair { part, other: Obstacle::Thing(Thing::floor(0.0)) });
    }
    let task = Task::Clearance(Clearance { pairs, margin: 0.0, activation: 1.0 });
    let (values, rows) = evaluate(&task, &model, &start);
    let n = model.rates().len();
    let finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
    assert!(finite(&rows) && finite(&values), "{values:?}");
    for (value, row) in values.iter().zip(rows.chunks_exact(n)).filter(|(value, _)| **value < -1e-6) {
        assert!(row.iter().any(|entry| entry.abs() > 1e-3), "{value}");
    }
}

/// A pair beyond the activation distance has a row of zeros without limits; the residual counts what overlaps.
#[test]
fn far_pairs_have_rows_of_zeros_without_limits() {
    let model = adult(&Adult::default()).unwrap();
    let start = model.default_posture();
    let clearance = Clearance::of_body(&model, &[Thing::floor(0.0)], &[]).unwrap();
    let (near, far) =
        (Task::Clearance(clearance.clone()), Task::Clearance(Clearance { activation: 1e-3, ..clearance }));
    let (values, _) = evaluate(&near, &model, &start);
    let active = values.iter().filter(|value| value.is_finite()).count();
    println!("{active} of {} rows in the default posture", values.len());
    assert!(active > 5 && active < values.len() / 2);
    let (values, rows) = evaluate(&far, &model, &start);
    assert!(values.iter().all(|value| *value == f64::INFINITY) && rows.iter().all(|entry| *entry == 0.0));
}
