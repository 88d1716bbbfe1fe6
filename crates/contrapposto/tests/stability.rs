//! Tests the stability of postures: pendulums in closed form, stiffness against differences of torque, and the curvature of
//! energy along motions that keep the feet in place. Seeded; `CONTRAPPOSTO_SEED` chooses another seed.

use contrapposto::contact::{Balance, ContactForces, Support};
use contrapposto::equilibria::{Stability, stability, stiffness};
use contrapposto::hybrid::{Carrier, Equilibrium};
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, CoordinateSpec, JointKind, Model, ModelBuilder, Placement, SegmentSpec, adult};
use contrapposto::passive::{PassiveLaw, Term};
use contrapposto::posture::Posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::axes;

use axes::moved_about_axis;

type V = Vector3<f64>;

const NEEDS: Quantities = Quantities::ALL;
const G: f64 = 9.81;

fn random(test: &str) -> Pcg64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_070_711);
    println!("{test}: seed {seed}");
    Pcg64::seed_from_u64(seed)
}

/// A chain of hinges about z, each with a point mass at the end of a link along y (up or down) and a spring that rests at 0.
fn chain(links: &[(f64, f64, f64)], up: f64) -> Model {
    let mut builder = ModelBuilder::new("chain", V::new(0.0, -G, 0.0));
    for (i, &(mass, length, spring)) in links.iter().enumerate() {
        let mut coordinate = CoordinateSpec::new(&format!("q{i}"), (-3.0, 3.0));
        coordinate.passive = Some(PassiveLaw::Sum(vec![Term::Spring { stiffness: spring, rest: 0.0 }]));
        let before = i.checked_sub(1).map_or(0.0, |before| links[before].1);
        builder
            .segment(SegmentSpec {
                name: format!("link{i}"),
                parent: i.checked_sub(1).map(|before| format!("link{before}")),
                mass,
                center_of_mass: V::new(0.0, up * length, 0.0),
                inertia: Matrix3::zeros(),
                joint: format!("joint{i}"),
                kind: JointKind::Hinge(V::z_axis()),
                in_parent: Placement::translation(0.0, up * before, 0.0),
                in_segment: Placement::identity(),
                coordinates: vec![coordinate],
            })
            .unwrap();
    }
    builder.build()
}

/// Of a model at its default posture, without supports.
fn at_rest(model: &Model) -> Stability {
    let mut body = JointTorques::new(model);
    body.update(model, &model.default_posture(), &[], NEEDS).unwrap();
    stability(model, &body, &[], &[], &vec![false; model.rates().len()])
}

#[test]
fn an_inverted_pendulum_needs_a_spring_of_m_g_l() {
    let (mass, length) = (3.0, 0.7);
    let threshold = mass * G * length;
    for (share, verdict) in [
        (0.0, Equilibrium::Unstable),
        (0.5, Equilibrium::Unstable),
        (1.0 - 1e-9, Equilibrium::Unstable),
        (1.0 + 1e-9, Equilibrium::Stable(Carrier::Ligaments)),
        (3.0, Equilibrium::Stable(Carrier::Ligaments)),
    ] {
        let found = at_rest(&chain(&[(mass, length, share * threshold)], 1.0));
        assert_eq!(found.equilibrium, Some(verdict), "spring of {share} m g l");
        let direction = &found.directions[0];
        // Inertia m l^2; a billionth of it is added so that joints without mass stay finite.
        let expected = (share - 1.0) * threshold / (mass * length * length);
        assert!((direction.stiffness - expected).abs() < 2e-9 * G / length, "{} {expected}", direction.stiffness);
        assert!((direction.by_tissue + direction.by_load - direction.stiffness).abs() < 1e-12 * threshold);
        assert_eq!(direction.joints, [(0, 1.0)]);
        assert_eq!(found.without_energy, 0.0);
        let growth = direction.growth_time();
        assert_eq!(growth.is_some(), share < 1.0);
        if let (Some(time), true) = (growth, share < 0.9) {
            assert!((time - (length / (G * (1.0 - share))).sqrt()).abs() < 1e-8);
        }
    }
}

#[test]
fn a_hanging_pendulum_is_held_by_gravity_until_the_spring_is_stiffer() {
    let (mass, length) = (3.0, 0.7);
    let threshold = mass * G * length;
    for (share, carrier) in [(0.0, Carrier::Gravity), (0.99, Carrier::Gravity), (1.01, Carrier::Ligaments)] {
        let found = at_rest(&chain(&[(mass, length, share * threshold)], -1.0));
        assert_eq!(found.equilibrium, Some(Equilibrium::Stable(carrier)));
        assert!((found.directions[0].stiffness - (1.0 + share) * G / length).abs() < 1e-7);
    }
}

/// Two links on end: `K = [k1 - (m1+m2) g l1 - m2 g l2, -m2 g l2; -m2 g l2, k2 - m2 g l2]`, and the mass matrix of two points.
#[test]
fn two_links_on_end_in_closed_form() {
    let mut rng = random("two links");
    for _ in 0..200 {
        let [m1, m2, l1, l2] = std::array::from_fn(|_| rng.random_range(0.3..2.0));
        let [k1, k2] = std::array::from_fn(|_| rng.random_range(0.0..60.0));
        let found = at_rest(&chain(&[(m1, l1, k1), (m2, l2, k2)], 1.0));
        let k = [k1 - (m1 + m2) * G * l1 - m2 * G * l2, -m2 * G * l2, k2 - m2 * G * l2];
        let m = [m1 * l1 * l1 + m2 * (l1 + l2).powi(2), m2 * l2 * (l1 + l2), m2 * l2 * l2];
        // det(K - s M) = 0
        let a = m[0] * m[2] - m[1] * m[1];
        let b = -(k[0] * m[2] + k[2] * m[0] - 2.0 * k[1] * m[1]);
        let c = k[0] * k[2] - k[1] * k[1];
        let root = (b * b - 4.0 * a * c).sqrt();
        let expected = [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)];
        for (direction, expected) in found.directions.iter().zip(expected) {
            let size = expected.abs().max(root / (2.0 * a));
            assert!((direction.stiffness - expected).abs() < 1e-6 * size, "{} {expected}", direction.stiffness);
        }
        // As many negative ones as K has, whatever the metric.
        let negative = if c < 0.0 {
            1
        } else if k[0] < 0.0 {
            2
        } else {
            0
        };
        assert_eq!(found.unstable, negative);
        let shares: f64 = found.directions[0].joints.iter().map(|(_, share)| share).sum();
        assert!(shares <= 1.0 + 1e-12 && shares > 0.97);
    }
}

fn anywhere(rng: &mut Pcg64, model: &Model) -> Posture {
    let values = model.coordinates().iter().map(|c| {
        let (low, high) = (c.range.0.max(c.default - 0.6), c.range.1.min(c.default + 0.6));
        low + rng.random_range(0.02..0.98) * (high - low)
    });
    Posture::new(values.collect())
}

/// Between rates of different joints; within a three-axis joint the symmetric part, which the order of rotations does not change.
#[test]
fn stiffness_is_the_central_difference_of_torque() {
    let mut rng = random("stiffness");
    let model = adult(&Adult::default()).unwrap();
    let n = model.rates().len();
    let foot = model.segment("calcn_r").unwrap();
    let loads = [
        Load::weight(&model, model.segment("hand_r").unwrap(), 4.0),
        Load {
            segment: foot,
            point: V::new(0.1, -0.03, 0.02),
            kind: LoadKind::Force(V::new(60.0, 500.0, -40.0), FixedIn::World),
        },
    ];
    let mut body = JointTorques::new(&model);
    let joint_of = |rate: usize| model.rates()[rate].coordinate.and_then(|c| model.three_axis_joint_of(c)).map(|j| j.0);
    let mut worst = [0f64; 2];
    for _ in 0..30 {
        let posture = anywhere(&mut rng, &model);
        body.update(&model, &posture, &loads, NEEDS).unwrap();
        let exact = stiffness(&model, &body);
        let h = 1e-5;
        let mut numeric = [vec![0.0; n * n], vec![0.0; n * n]];
        for j in 0..n {
            for sign in [1.0, -1.0] {
                body.update(&model, &moved_about_axis(&model, &posture, j, sign * h), &loads, NEEDS).unwrap();
                for (part, torques) in
                    numeric.iter_mut().zip([body.passive_torque().about_axes(), body.external_about_axes()])
                {
                    (0..n).for_each(|i| part[i * n + j] -= sign * torques[i] / (2.0 * h));
                }
            }
        }
        for (part, (exact, numeric)) in exact.iter().zip(&numeric).enumerate() {
            let size = exact.iter().fold(1.0, |size: f64, e| size.max(e.abs()));
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let same_joint = joint_of(i).is_some() && joint_of(i) == joint_of(j);
                let of = |m: &[f64]| if same_joint { 0.5 * (m[i * n + j] + m[j * n + i]) } else { m[i * n + j] };
                worst[part] = worst[part].max((of(exact) - of(numeric)).abs() / size);
            }
        }
    }
    println!("stiffness against differences: tissue {:.1e}, load {:.1e}", worst[0], worst[1]);
    assert!(worst[0] < 1e-7 && worst[1] < 1e-7, "{worst:?}");
}

/// The adult without coupled laws, which have no energy, hips, knees and ankles bent so that the soles stay flat.
fn crouched(bend: f64) -> (Model, Posture, Vec<Support>) {
    let mut model = adult(&Adult::default()).unwrap();
    for i in 0..model.coordinates().len() {
        if matches!(model.coordinates()[i].passive, Some(PassiveLaw::Coupled(_))) {
            model = model.with_passive_law(i, None);
        }
    }
    let mut posture = model.default_posture();
    for side in ["r", "l"] {
        for (name, angle) in [("hip_flexion", bend), ("knee_angle", 2.0 * bend), ("ankle_angle", bend)] {
            posture.values_mut()[model.coordinate(&format!("{name}_{side}")).unwrap()] = angle;
        }
    }
    let support = |name: &str| {
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
    };
    let supports = vec![support("calcn_r"), support("calcn_l")];
    (model, posture, supports)
}

/// The body with the contact forces that hold it, and what its muscles do.
fn standing(model: &Model, posture: &Posture, supports: &[Support]) -> (JointTorques, Vec<f64>) {
    let mut body = JointTorques::new(model);
    let mut contact = ContactForces::new(model, supports.to_vec()).unwrap();
    body.update_with_contact(model, posture, &[], &mut contact, NEEDS).unwrap();
    assert_eq!(contact.balance(), Balance::Held);
    let active = body.active_torque().to_vec();
    (body, active)
}

/// Distance (m) and rotation (rad) of the supports' segments from their places, and the derivative of both.
fn off(
    model: &Model,
    supports: &[Support],
    places: &[Placement],
    kinematics: &Kinematics,
) -> (DVector<f64>, DMatrix<f64>) {
    let n = model.rates().len();
    let mut error = DVector::zeros(6 * supports.len());
    let mut rows = DMatrix::zeros(6 * supports.len(), n);
    let mut three = vec![0.0; 3 * n];
    for (i, (support, place)) in supports.iter().zip(places).enumerate() {
        let now = kinematics.placement(model, support.segment);
        let turn = (now.rotation * place.rotation.inverse()).scaled_axis();
        error.fixed_rows_mut::<3>(6 * i).copy_from(&(now.translation.vector - place.translation.vector));
        error.fixed_rows_mut::<3>(6 * i + 3).copy_from(&turn);
        kinematics.point_jacobian(model, support.segment, V::zeros(), &mut three);
        rows.view_mut((6 * i, 0), (3, n)).copy_from(&DMatrix::from_row_slice(3, n, &three));
        kinematics.rotation_jacobian(model, support.segment, &mut three);
        rows.view_mut((6 * i + 3, 0), (3, n)).copy_from(&DMatrix::from_row_slice(3, n, &three));
    }
    (error, rows)
}

/// Along motions that bring the feet back to their places exactly, energy less the muscles' work bends as the stiffness says.
/// Contact forces do no work there: that they count in the stiffness is what is tested.
#[test]
fn energy_bends_as_stiffness_says_on_standing_feet() {
    for bend in [0.15f64, 0.5] {
        let (model, posture, supports) = crouched(bend);
        let n = model.rates().len();
        let (body, active) = standing(&model, &posture, &supports);
        let found = stability(&model, &body, &supports, &[], &vec![false; n]);
        let places: Vec<Placement> = supports.iter().map(|s| body.kinematics().placement(&model, s.segment)).collect();
        let energy = |h: f64, motion: &[f64]| {
            let mut kinematics = Kinematics::new(&model);
            let mut moved = posture.clone();
            moved.displace(&model, &motion.iter().map(|m| h * m).collect::<Vec<_>>());
            for _ in 0..8 {
                kinematics.update(&model, &moved).unwrap();
                let (error, rows) = off(&model, &supports, &places, &kinematics);
                let back = rows.svd(true, true).solve(&error, 1e-10).unwrap();
                moved.displace(&model, (-back).as_slice());
            }
            kinematics.update(&model, &moved).unwrap();
            assert!(off(&model, &supports, &places, &kinematics).0.norm() < 1e-12);
            let mut now = JointTorques::new(&model);
            now.update(&model, &moved, &[], NEEDS).unwrap();
            let mut turned = DVector::from_column_slice(moved.values()) - DVector::from_column_slice(posture.values());
            for joint in model.three_axis_joints() {
                let turn = (joint.rotation(posture.values()).inverse() * joint.rotation(moved.values())).scaled_axis();
                joint.coordinates.iter().zip(&joint.axes).for_each(|(i, axis)| turned[*i] = axis.dot(&turn));
            }
            let mut sum = model.mass() * G * kinematics.center_of_mass(&model).unwrap().y;
            for (i, coordinate) in model.coordinates().iter().enumerate() {
                let law = coordinate.passive.as_ref();
                sum += law.map_or(0.0, |law| law.curve().unwrap().energy(now.angles()[i]));
                if coordinate.groups.is_some() {
                    sum -= active[coordinate.rate.unwrap()] * turned[i];
                }
            }
            sum
        };
        let mut worst = 0f64;
        let weakest = found.directions.iter().take(12).chain(found.directions.last());
        for direction in weakest {
            // The same size of joint motion for all.
            let size = direction.motion.iter().fold(0.0, |size: f64, m| size.max(m.abs()));
            let mut motion: Vec<f64> = direction.motion.iter().map(|m| m / size).collect();
            for joint in model.three_axis_joints() {
                let rates = joint.coordinates.map(|i| model.coordinates()[i].rate.unwrap());
                let by_axes = V::from(rates.map(|rate| motion[rate]));
                let step = joint.orientation(posture.values()).hinges.lu().solve(&by_axes).unwrap();
                rates.iter().zip(step.iter()).for_each(|(rate, step)| motion[*rate] = *step);
            }
            let second = |h: f64| (energy(h, &motion) + energy(-h, &motion) - 2.0 * energy(0.0, &motion)) / (h * h);
            // The error of either is of second order in h, that of this sum of fourth.
            let numeric = (4.0 * second(1e-3) - second(2e-3)) / 3.0;
            let exact = direction.stiffness / (size * size);
            let parts = (direction.by_load.abs() + direction.by_tissue.abs()) / (size * size);
            worst = worst.max((numeric - exact).abs() / parts.max(1.0));
        }
        println!("crouch of {bend}: curvature of energy against stiffness {worst:.1e}");
        assert!(worst < 1e-5, "{worst}");
    }
}

#[test]
fn directions_leave_the_feet_in_place_and_are_square_by_mass() {
    let (model, posture, supports) = crouched(0.4);
    let n = model.rates().len();
    let (body, _) = standing(&model, &posture, &supports);
    let mut locked = vec![false; n];
    let neck = model.coordinates()[model.coordinate("neck_bending").unwrap()].rate.unwrap();
    let all = stability(&model, &body, &supports, &[], &locked);
    // Two feet, and the rises of two shoulders.
    assert_eq!(all.directions.len(), n - 14);
    locked[neck] = true;
    let less = stability(&model, &body, &supports, &[], &locked);
    assert_eq!(less.directions.len(), n - 15);
    assert!(less.directions.iter().all(|direction| direction.motion[neck] == 0.0));
    let places: Vec<Placement> = supports.iter().map(|s| body.kinematics().placement(&model, s.segment)).collect();
    for direction in &all.directions {
        let (error, rows) = off(&model, &supports, &places, body.kinematics());
        assert!(error.norm() < 1e-12);
        let motion = DVector::from_column_slice(&direction.motion);
        assert!((rows * &motion).norm() < 1e-9 * motion.norm());
        assert!(
            (direction.by_tissue + direction.by_load - direction.stiffness).abs()
                < 1e-6 * direction.by_load.abs().max(1.0)
        );
    }
    let rising = all.directions.windows(2).all(|pair| pair[0].stiffness <= pair[1].stiffness);
    assert!(rising);
    // Nothing free: nothing to say.
    let none = stability(&model, &body, &supports, &[], &vec![true; n]);
    assert_eq!((none.equilibrium, none.directions.len()), (None, 0));
}

/// Without muscle a crouched body sinks, knees among the joints that give way; more load makes it worse.
#[test]
fn a_crouched_body_must_be_attended_to() {
    let (model, posture, supports) = crouched(0.5);
    let (body, _) = standing(&model, &posture, &supports);
    let n = model.rates().len();
    let found = stability(&model, &body, &supports, &[], &vec![false; n]);
    assert_eq!(found.equilibrium, Some(Equilibrium::Unstable));
    assert!(found.unstable >= 1);
    let sinks = found.unstable().iter().any(|direction| {
        let knees = direction.joints.iter().filter(|(i, _)| model.coordinates()[*i].name.starts_with("knee"));
        knees.map(|(_, share)| share).sum::<f64>() > 0.2
    });
    assert!(sinks, "no unstable direction bends the knees");
    for direction in found.unstable() {
        assert!(direction.growth_time().unwrap() > 0.0 && direction.by_load < 0.0);
    }
}

#[test]
fn a_hanging_arm_comes_back() {
    let model = adult(&Adult::right_arm()).unwrap();
    let found = at_rest(&model);
    println!("hanging arm: {:?}, weakest {:.2} 1/s2", found.equilibrium, found.directions[0].stiffness);
    assert!(matches!(found.equilibrium, Some(Equilibrium::Stable(_))));
    // Twice the same, to the bit.
    assert_eq!(found, at_rest(&model));
}
