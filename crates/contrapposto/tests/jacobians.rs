//! Compares the Jacobians of points, segments and the centre of mass with central differences on random bodies of every
//! joint kind, driven joints and chains of couplings included. Seeded; `CONTRAPPOSTO_SEED` chooses another seed.

use crate::trees;

use contrapposto::kinematics::{CenterOfMass, Kinematics};
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::ExternalTorque;
use nalgebra::{Quaternion, UnitQuaternion};
use rand::RngExt;
use trees::{V, largest, moved, norm, posture, random, step, tree, vector};

/// Everything that is differentiated.
struct Seen {
    point: V,
    rotation: UnitQuaternion<f64>,
    center: Option<V>,
}

fn see(model: &Model, posture: &Posture, segment: usize, point: V) -> (Seen, Kinematics, CenterOfMass) {
    let (mut kinematics, mut center) = (Kinematics::new(model), CenterOfMass::new(model));
    kinematics.update(model, posture).unwrap();
    center.update(model, &kinematics);
    let seen = Seen {
        point: kinematics.station(model, segment, point),
        rotation: kinematics.placement(model, segment).rotation,
        center: center.position(),
    };
    (seen, kinematics, center)
}

/// Jacobians of point, rotation and centre of mass, nine rows.
fn jacobians(model: &Model, posture: &Posture, segment: usize, point: V) -> Vec<f64> {
    let n = model.rates().len();
    let (_, kinematics, center) = see(model, posture, segment, point);
    // Old numbers must not shine through.
    let mut rows = vec![f64::NAN; 9 * n];
    kinematics.point_jacobian(model, segment, point, &mut rows[..3 * n]);
    kinematics.rotation_jacobian(model, segment, &mut rows[3 * n..6 * n]);
    center.jacobian(model, &kinematics, &mut rows[6 * n..]);
    rows
}

/// The same by central differences with step `h`.
fn differences(model: &Model, posture: &Posture, segment: usize, point: V, h: f64) -> Vec<f64> {
    let n = model.rates().len();
    let mut rows = vec![0.0; 9 * n];
    for rate in 0..n {
        let [up, down] = [h, -h].map(|h| see(model, &moved(model, posture, rate, h), segment, point).0);
        let center = up.center.zip(down.center).map_or(V::zeros(), |(a, b)| a - b);
        let turn = (up.rotation * down.rotation.inverse()).scaled_axis();
        for (block, change) in [up.point - down.point, turn, center].into_iter().enumerate() {
            for axis in 0..3 {
                rows[(3 * block + axis) * n + rate] = change[axis] / (2.0 * h);
            }
        }
    }
    rows
}

fn subtract(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

#[test]
fn jacobians_by_central_differences() {
    let mut rng = random("jacobians_by_central_differences");
    let (mut worst, mut columns, mut couplings) = ([0.0f64; 3], 0, 0);
    let (mut low, mut high) = ([f64::MAX; 3], [0.0f64; 3]);
    for round in 0..200 {
        let segments = rng.random_range(2..24);
        let model = tree(&mut rng, segments, round % 2 == 0);
        let n = model.rates().len();
        let (posture, point) = (posture(&mut rng, &model), vector(&mut rng, 0.5));
        let segment = rng.random_range(segments / 2..segments);
        let exact = jacobians(&model, &posture, segment, point);
        let [fine, half, whole] = [1e-4, 5e-3, 1e-2].map(|h| {
            let rows = differences(&model, &posture, segment, point, h);
            subtract(&exact, &rows)
        });
        for block in 0..3 {
            let part = 3 * block * n..3 * (block + 1) * n;
            let scale = largest(exact[part.clone()].iter().copied()).max(1.0);
            worst[block] = worst[block].max(largest(fine[part.clone()].iter().copied()) / scale);
            if norm(&half[part.clone()]) > 1e-7 {
                let ratio = norm(&whole[part.clone()]) / norm(&half[part]);
                (low[block], high[block]) = (low[block].min(ratio), high[block].max(ratio));
            }
        }
        columns += n;
        couplings += model.couplings().len();
        for coupling in model.couplings() {
            let rate = model.coordinates()[coupling.dependent].rate.unwrap();
            assert!((0..9).all(|row| exact[row * n + rate] == 0.0), "followers have no column of their own");
        }
    }
    println!("{columns} columns, {couplings} couplings; point, rotation, centre of mass:");
    let worst_text = worst.map(|w| format!("{w:.1e}")).join(", ");
    println!("worst difference {worst_text}; halved step: error falls by {low:.3?}..{high:.3?}");
    assert!(couplings > 200);
    assert!(worst.iter().all(|&w| w < 1e-6), "{worst:?}");
    assert!(low.iter().all(|&r| r > 3.9) && high.iter().all(|&r| r < 4.1), "{low:?} {high:?}");
}

#[test]
fn torque_is_the_transposed_jacobian_times_weight() {
    // Virtual work: the external torque of gravity is J_c^T m g, whatever drives or couples the rates.
    let mut rng = random("torque_is_the_transposed_jacobian_times_weight");
    let mut worst = 0.0;
    for round in 0..300 {
        let segments = rng.random_range(1..30);
        let model = tree(&mut rng, segments, round % 2 == 0);
        let n = model.rates().len();
        let posture = posture(&mut rng, &model);
        let (_, kinematics, center) = see(&model, &posture, 0, V::zeros());
        let mut external = ExternalTorque::new(&model);
        external.update(&model, &kinematics, &[]).unwrap();
        // Both ways to the centre of mass, to the bit; and the plain sum over segments.
        assert_eq!(external.center_of_mass().position(), center.position());
        match (center.position(), kinematics.center_of_mass(&model)) {
            (Some(a), Some(b)) => worst = f64::max(worst, (a - b).norm()),
            (None, None) => {}
            other => panic!("{other:?}"),
        }
        let mut rows = vec![f64::NAN; 3 * n];
        external.center_of_mass().jacobian(&model, &kinematics, &mut rows);
        let weight = model.mass() * model.gravity();
        let scale = largest(external.torques().iter().copied()).max(1.0);
        for (rate, torque) in external.torques().iter().enumerate() {
            let work: f64 = (0..3).map(|axis| rows[axis * n + rate] * weight[axis]).sum();
            worst = f64::max(worst, (work - torque).abs() / scale);
        }
    }
    println!("worst relative difference {worst:.1e}");
    assert!(worst < 1e-13, "{worst:e}");
}

#[test]
fn displace_and_difference_are_inverse() {
    let mut rng = random("displace_and_difference_are_inverse");
    let (mut worst, mut lengths) = (0.0, 0.0);
    for round in 0..300 {
        let segments = rng.random_range(1..20);
        let model = tree(&mut rng, segments, round % 2 == 0);
        let start = posture(&mut rng, &model);
        // A ball goes the shorter way: the step must be shorter than half a turn.
        let size = [1.8, 1e-3, 1e-9, 1e-14, 0.0][round % 5];
        let mut given = if size == 0.0 { vec![0.0; model.rates().len()] } else { step(&mut rng, &model, size) };
        let mut goal = start.clone();
        goal.displace(&model, &given);
        for coupling in model.couplings() {
            let value = coupling.function.value(goal.values()[coupling.independent]);
            assert_eq!(goal.values()[coupling.dependent], value);
            given[model.coordinates()[coupling.dependent].rate.unwrap()] = 0.0;
        }
        let mut found = vec![f64::NAN; given.len()];
        start.difference(&model, &goal, &mut found);
        worst = f64::max(worst, largest(subtract(&found, &given)));
        // The other sign of a quaternion is the same posture.
        let mut again = start.clone();
        for i in (0..model.coordinates().len()).filter(|&i| model.coordinates()[i].name.ends_with("_qw")) {
            let q = &goal.values()[i..i + 4];
            lengths = f64::max(lengths, (norm(q) - 1.0).abs());
            let q = Quaternion::new(-q[0], -q[1], -q[2], -q[3]);
            goal.values_mut()[i..i + 4].copy_from_slice(&[q.w, q.i, q.j, q.k]);
        }
        again.difference(&model, &goal, &mut found);
        worst = f64::max(worst, largest(subtract(&found, &given)));
        again.displace(&model, &found);
        again.difference(&model, &goal, &mut found);
        worst = f64::max(worst, largest(found));
    }
    println!("worst difference {worst:.1e}, length of a quaternion off by {lengths:.1e}");
    assert!(worst < 1e-14 && lengths < 1e-15, "{worst:e} {lengths:e}");
}

#[test]
fn a_million_small_turns_keep_a_quaternion_whole() {
    let mut rng = random("a_million_small_turns_keep_a_quaternion_whole");
    let model = loop {
        let model = tree(&mut rng, 1, false);
        if model.rates().len() == 3 && model.coordinates().len() == 4 {
            break model;
        }
    };
    let mut posture = model.default_posture();
    for _ in 0..1_000_000 {
        posture.displace(&model, &[1e-3, -2e-3, 5e-4]);
    }
    assert!((norm(posture.values()) - 1.0).abs() < 1e-15);
    let mut whole = model.default_posture();
    whole.displace(&model, &[1e3, -2e3, 5e2]);
    let mut off = [0.0; 3];
    whole.difference(&model, &posture, &mut off);
    assert!(largest(off) < 1e-9, "{off:?}");
}
