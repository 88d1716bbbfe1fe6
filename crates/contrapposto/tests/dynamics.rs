//! Inertia of moving bodies: against virtual work of point masses moved by central differences, the energy balance, and formulas by hand.

use crate::trees;

use contrapposto::dynamics::{Inertia, InertiaError, MotionError, Smoothing, SpeedError, differentiate};
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, CoordinateSpec, JointKind, Model, ModelBuilder, Placement, SegmentSpec, adult};
use contrapposto::posture::Posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use rand::RngExt;

type V = Vector3<f64>;

/// A posture with speeds and accelerations of its rates.
struct Moving {
    posture: Posture,
    speeds: Vec<f64>,
    accelerations: Vec<f64>,
}

impl Moving {
    /// The posture `t` seconds later under constant accelerations of the rates. The step of a ball from 0 on has the derivatives
    /// of its generalised speeds there.
    fn at(&self, model: &Model, t: f64) -> Posture {
        let step = self.speeds.iter().zip(&self.accelerations).map(|(v, a)| v * t + 0.5 * a * t * t);
        let mut posture = self.posture.clone();
        posture.displace(model, &step.collect::<Vec<_>>());
        posture
    }
}

fn moving(rng: &mut rand_pcg::Pcg64, model: &Model) -> Moving {
    let mut posture = trees::posture(rng, model);
    posture.displace(model, &vec![0.0; model.rates().len()]);
    let (speeds, accelerations) = (trees::step(rng, model, 2.0), trees::step(rng, model, 5.0));
    Moving { posture, speeds, accelerations }
}

/// Points of the body, each with its mass: of each segment its centre and three pairs of points along the principal axes, whose
/// inertia is that of the segment. Masses may be negative.
fn masses(model: &Model) -> Vec<(usize, V, f64)> {
    let mut points = vec![];
    for (i, segment) in model.segments().iter().enumerate() {
        let moments = segment.inertia.diagonal();
        let half_trace = 0.5 * moments.sum();
        points.push((i, segment.center_of_mass, segment.mass - 6.0));
        for k in 0..3 {
            // Two masses of 1 kg at +-d on axis k: the sum of m x_k^2 is half the trace less the moment about that axis.
            let d = (0.5 * (half_trace - moments[k])).sqrt();
            let axis = V::from_fn(|j, _| if j == k { d } else { 0.0 });
            points.push((i, segment.center_of_mass + axis, 1.0));
            points.push((i, segment.center_of_mass - axis, 1.0));
        }
    }
    points
}

fn positions(model: &Model, posture: &Posture, points: &[(usize, V, f64)]) -> Vec<V> {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture).unwrap();
    points.iter().map(|(segment, point, _)| kinematics.station(model, *segment, *point)).collect()
}

/// `- sum m a . dx/dq` of every rate, by central differences in time and in the coordinates.
fn virtual_work(model: &Model, moving: &Moving, points: &[(usize, V, f64)]) -> Vec<f64> {
    let h = 1e-3;
    let at = |t: f64| positions(model, &moving.at(model, t), points);
    // Fourth-order second difference.
    let [a, b, c, d, e] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| at(k * h));
    let second = |i: usize| (16.0 * (b[i] + d[i]) - a[i] - e[i] - 30.0 * c[i]) / (12.0 * h * h);
    let accelerations: Vec<V> = (0..points.len()).map(second).collect();
    let torque = |rate: usize| {
        let s = 1e-5;
        let there = positions(model, &trees::moved(model, &moving.posture, rate, s), points);
        let back = positions(model, &trees::moved(model, &moving.posture, rate, -s), points);
        let work = |i: usize| points[i].2 * accelerations[i].dot(&((there[i] - back[i]) / (2.0 * s)));
        -(0..points.len()).map(work).sum::<f64>()
    };
    (0..model.rates().len()).map(torque).collect()
}

fn inertia(model: &Model, moving: &Moving, held: &[Load]) -> Inertia {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &moving.posture).unwrap();
    let mut inertia = Inertia::new(model);
    inertia.update(model, &kinematics, (&moving.speeds, &moving.accelerations), held).unwrap();
    inertia
}

#[test]
fn inertia_of_random_coupled_bodies_is_the_virtual_work_of_their_point_masses() {
    let mut rng = trees::random("virtual work of inertia");
    let mut worst: f64 = 0.0;
    for i in 0..120 {
        let model = trees::tree(&mut rng, 1 + i % 7, i % 2 == 0);
        if model.rates().is_empty() {
            continue;
        }
        let moving = moving(&mut rng, &model);
        let weight = Load {
            segment: rng.random_range(0..model.segments().len()),
            point: trees::vector(&mut rng, 0.3),
            kind: LoadKind::Weight(3.0),
        };
        let rope = Load { kind: LoadKind::Force(V::new(1.0, 2.0, 3.0), FixedIn::World), ..weight };
        let mut points = masses(&model);
        points.push((weight.segment, weight.point, 3.0));
        let expected = virtual_work(&model, &moving, &points);
        let found = inertia(&model, &moving, &[weight, rope]);
        let size = trees::largest(expected.iter().copied()).max(1.0);
        let error = trees::largest(found.torques().iter().zip(&expected).map(|(a, b)| a - b)) / size;
        assert!(error < 3e-6, "body {i}: {error:.1e} of {size:.1} N m");
        worst = worst.max(error);
    }
    assert!(worst > 0.0);
}

/// `sum tau_i q_i' = -dT/dt`, with the kinetic energy of point masses by central differences.
#[test]
fn power_of_inertia_is_the_loss_of_kinetic_energy() {
    let mut rng = trees::random("energy of inertia");
    for i in 0..40 {
        let model = trees::tree(&mut rng, 1 + i % 6, i % 2 == 0);
        if model.rates().is_empty() {
            continue;
        }
        let moving = moving(&mut rng, &model);
        let points = masses(&model);
        let at = |t: f64| positions(&model, &moving.at(&model, t), &points);
        let energy = |t: f64| {
            let h = 1e-4;
            let (after, before) = (at(t + h), at(t - h));
            let square = |k: usize| points[k].2 * ((after[k] - before[k]) / (2.0 * h)).norm_squared();
            0.5 * (0..points.len()).map(square).sum::<f64>()
        };
        let h = 1e-3;
        let loss = -(energy(h) - energy(-h)) / (2.0 * h);
        let found = inertia(&model, &moving, &[]);
        let power: f64 = found.torques().iter().zip(&moving.speeds).map(|(torque, speed)| torque * speed).sum();
        assert!((power - loss).abs() < 1e-4 * loss.abs().max(100.0), "body {i}: {power} and {loss} W");
    }
}

#[test]
fn a_body_at_rest_has_no_inertia_and_twice_the_speed_four_times_as_much() {
    let mut rng = trees::random("speeds of inertia");
    let model = trees::tree(&mut rng, 6, true);
    let mut moving = moving(&mut rng, &model);
    moving.accelerations.fill(0.0);
    let once = inertia(&model, &moving, &[]).torques().to_vec();
    moving.speeds.iter_mut().for_each(|speed| *speed *= 2.0);
    let twice = inertia(&model, &moving, &[]).torques().to_vec();
    let size = trees::largest(once.iter().copied());
    assert!(size > 0.1);
    once.iter().zip(&twice).for_each(|(once, twice)| assert!((4.0 * once - twice).abs() < 1e-12 * size));
    moving.speeds.fill(0.0);
    assert_eq!(trees::largest(inertia(&model, &moving, &[]).torques().iter().copied()), 0.0);
}

/// Two rods in a plane, about z: the textbook's equations of the double pendulum.
#[test]
fn inertia_of_a_planar_double_pendulum_is_the_textbooks() {
    let (m, l, c, i) = ([2.0, 1.5], 0.6, [0.25, 0.2], [0.04, 0.03]);
    let mut builder = ModelBuilder::new("pendulum", V::zeros());
    for (k, parent) in [(0, None), (1, Some("rod0".to_owned()))] {
        let at = if k == 0 { V::zeros() } else { V::new(l, 0.0, 0.0) };
        builder
            .segment(SegmentSpec {
                name: format!("rod{k}"),
                parent,
                mass: m[k],
                center_of_mass: V::new(c[k], 0.0, 0.0),
                inertia: Matrix3::from_diagonal(&V::new(0.0, i[k], i[k])),
                joint: format!("joint{k}"),
                kind: JointKind::Hinge(V::z_axis()),
                in_parent: Placement::translation(at.x, at.y, at.z),
                in_segment: Placement::identity(),
                coordinates: vec![CoordinateSpec::new(&format!("q{k}"), (-9.0, 9.0))],
            })
            .unwrap();
    }
    let model = builder.build();
    let (q, v, a) = ([0.4, 0.9], [1.5, -2.5], [3.0, 4.0]);
    let moving = Moving { posture: Posture::new(q.to_vec()), speeds: v.to_vec(), accelerations: a.to_vec() };
    let (sin, cos) = libm::sincos(q[1]);
    let both = l * c[1] * m[1];
    let m11 = i[0] + m[0] * c[0] * c[0] + i[1] + m[1] * (l * l + c[1] * c[1]) + 2.0 * both * cos;
    let m12 = i[1] + m[1] * c[1] * c[1] + both * cos;
    let m22 = i[1] + m[1] * c[1] * c[1];
    let first = m11 * a[0] + m12 * a[1] - both * sin * (2.0 * v[0] * v[1] + v[1] * v[1]);
    let second = m12 * a[0] + m22 * a[1] + both * sin * v[0] * v[0];
    let found = inertia(&model, &moving, &[]);
    assert!((found.torques()[0] + first).abs() < 1e-14 && (found.torques()[1] + second).abs() < 1e-14);
}

/// Eq. 1 with inertia among the loads: external torque is that at rest plus the torque of inertia, about axes, too.
#[test]
fn external_torque_with_the_loads_of_inertia_is_that_at_rest_plus_inertia() {
    let model = adult(&Adult::default()).unwrap();
    let mut rng = trees::random("inertia as loads");
    let moving = Moving {
        posture: model.default_posture(),
        speeds: trees::step(&mut rng, &model, 1.0),
        accelerations: trees::step(&mut rng, &model, 3.0),
    };
    let held = [Load::weight(&model, model.segment("hand_r").unwrap(), 5.0)];
    let inertia = inertia(&model, &moving, &held);
    let mut torques = JointTorques::new(&model);
    torques.update(&model, &moving.posture, &held, Quantities::TORQUES).unwrap();
    let rest = torques.external_torque().torques().to_vec();
    let mut loads = held.to_vec();
    inertia.add_loads(&model, torques.kinematics(), &mut loads);
    torques.update(&model, &moving.posture, &loads, Quantities::TORQUES).unwrap();
    for (rate, ((rest, inertia), both)) in
        rest.iter().zip(inertia.torques()).zip(torques.external_torque().torques()).enumerate()
    {
        assert!((rest + inertia - both).abs() < 1e-10 * (1.0 + both.abs()), "rate {rate}");
    }
    assert!(trees::largest(inertia.torques().iter().copied()) > 10.0);
}

/// The loads of a moving body, which the forces in its joints come from, carry its momentum: their sum is `-m a` of the centre of mass, whichever
/// way the torques of inertia are added.
#[test]
fn loads_of_a_moving_body_change_its_momentum() {
    let mut rng = trees::random("loads of a moving body");
    let bodies = (1..8).map(|size| trees::tree(&mut rng, size, false)).chain([adult(&Adult::default()).unwrap()]);
    for (i, model) in bodies.collect::<Vec<_>>().iter().enumerate().filter(|(_, model)| !model.rates().is_empty()) {
        let moving = moving(&mut rng, model);
        let held = [Load::weight(model, model.segments().len() - 1, 2.0)];
        let points: Vec<_> = masses(model).into_iter().chain([(held[0].segment, held[0].point, 2.0)]).collect();
        let h = 1e-3;
        let momentum = |t: f64| -> V {
            positions(model, &moving.at(model, t), &points).iter().zip(&points).map(|(place, of)| of.2 * place).sum()
        };
        let expected = -(momentum(h) - 2.0 * momentum(0.0) + momentum(-h)) / (h * h);
        let inertia = inertia(model, &moving, &held);
        let mut torques = JointTorques::new(model);
        for gradient in [false, true] {
            torques.place(model, &moving.posture).unwrap();
            let quantities = Quantities { gradient, ..Quantities::TORQUES };
            torques.apply_moving(model, &held, &inertia, quantities).unwrap();
            let forces = torques.loads().iter().filter_map(|load| match load.kind {
                LoadKind::Force(force, _) => Some(force),
                _ => None,
            });
            let found: V = forces.sum();
            assert!((found - expected).norm() < 1e-4 * (1.0 + expected.norm()), "body {i}: {found} {expected}");
        }
    }
}

/// A body on a free joint.
fn free_body() -> Model {
    let mut builder = ModelBuilder::new("free", V::zeros());
    builder
        .segment(SegmentSpec {
            name: "body".to_owned(),
            parent: None,
            mass: 2.0,
            center_of_mass: V::zeros(),
            inertia: Matrix3::from_diagonal(&V::new(0.1, 0.2, 0.25)),
            joint: "root".to_owned(),
            kind: JointKind::Free,
            in_parent: Placement::identity(),
            in_segment: Placement::identity(),
            coordinates: ["x", "y", "z"].map(|name| CoordinateSpec::new(name, (-9.0, 9.0))).to_vec(),
        })
        .unwrap();
    builder.build()
}

/// A body that turns about two axes and moves, and its quaternion of either sign: speeds are central differences of the postures, and so
/// are accelerations of the speeds.
#[test]
fn rates_of_a_turning_free_body_are_central_differences_of_its_postures() {
    let model = free_body();
    let at = |t: f64| {
        let turn = UnitQuaternion::from_axis_angle(&V::z_axis(), 1.3 * t + 0.4 * libm::sin(3.0 * t))
            * UnitQuaternion::from_axis_angle(&V::x_axis(), 0.8 * libm::cos(2.0 * t));
        let mut posture = model.default_posture();
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            posture.values_mut()[i] = match coordinate.name.as_str() {
                "x" => libm::sin(t),
                "y" => 0.5 * t * t,
                "z" => 0.3,
                name if name.ends_with("qw") => turn.w,
                name if name.ends_with("qx") => turn.i,
                name if name.ends_with("qy") => turn.j,
                _ => turn.k,
            };
        }
        posture
    };
    let mut motion: Vec<(f64, Posture)> = (0..201).map(|i| 0.02 * f64::from(i)).map(|t| (t, at(t))).collect();
    // The other sign is the same rotation.
    let first = (0..model.coordinates().len()).find(|&i| model.coordinates()[i].name.ends_with("qw")).unwrap();
    for (_, posture) in motion.iter_mut().skip(70).step_by(3) {
        posture.values_mut()[first..first + 4].iter_mut().for_each(|v| *v = -*v);
    }
    let moving = differentiate(&model, &motion, Smoothing::None).unwrap();
    let speed = |t: f64| {
        let (h, n) = (1e-4, model.rates().len());
        let (mut on, mut back) = (vec![0.0; n], vec![0.0; n]);
        at(t).difference(&model, &at(t + h), &mut on);
        at(t).difference(&model, &at(t - h), &mut back);
        on.iter().zip(&back).map(|(on, back)| (on - back) / (2.0 * h)).collect::<Vec<f64>>()
    };
    let mut largest: f64 = 0.0;
    for i in (20..181).step_by(7) {
        let (time, rates) = (moving.motion[i].0, &moving.rates[i]);
        let (before, after) = (speed(time - 1e-3), speed(time + 1e-3));
        for (k, expected) in speed(time).into_iter().enumerate() {
            assert!((rates.speeds[k] - expected).abs() < 1e-6, "{k} at {time} s: {} and {expected}", rates.speeds[k]);
            let expected = (after[k] - before[k]) / 2e-3;
            let found = rates.accelerations[k];
            assert!((found - expected).abs() < 1e-4, "{k} at {time} s: {found} and {expected}");
            largest = largest.max(found.abs());
        }
    }
    assert!(largest > 2.0);
    let flips: Vec<(f64, Posture)> = (0..200)
        .map(|i| {
            let mut posture = model.default_posture();
            // Half a turn about another axis from frame to frame.
            posture.values_mut()[first..first + 4].fill(0.0);
            posture.values_mut()[first + i % 4] = 1.0;
            (0.01 * i as f64, posture)
        })
        .collect();
    let refused = differentiate(&model, &flips, Smoothing::OpenSim(3.0)).unwrap_err();
    assert!(matches!(refused, MotionError::Turn { .. }), "{refused}");
}

/// Instant, value, speed and acceleration by scipy: `filtfilt` of order 2 at 12 of 100 Hz and a natural quintic spline (scripts/filter_reference.py).
const SCIPY: [(usize, [f64; 3]); 7] = [
    (0, [0.00166911689101096, 56.39048007065468, -985.9675773603158]),
    (4, [0.9927969421694389, -17.54238896468899, -2058.646315529691]),
    (8, [-0.4446696151085576, -28.082635140685305, 1605.855840017817]),
    (12, [-0.03911344236846637, 40.851584803862835, 615.6658764787228]),
    (16, [1.0406273593267878, -5.984864026103911, -2081.0606907605993]),
    (20, [-0.22202699689285904, -34.04738899853346, 1067.6358019338152]),
    (24, [-0.5386582166925502, 10.264023176987962, 455.13704904071346]),
];

#[test]
fn derivatives_of_a_motion_through_filtfilt_are_scipys() {
    let model = free_body();
    let motion: Vec<(f64, Posture)> = (0..25)
        .map(|i| {
            let mut posture = model.default_posture();
            posture.values_mut()[0] = libm::sin(0.5 * f64::from(i)) + f64::from(i % 3) / 5.0;
            (f64::from(i) / 100.0, posture)
        })
        .collect();
    let moving = differentiate(&model, &motion, Smoothing::Filtfilt(12.0)).unwrap();
    let mut worst: f64 = 0.0;
    for (i, expected) in SCIPY {
        let rates = &moving.rates[i];
        let found = [moving.motion[i].1.values()[0], rates.speeds[0], rates.accelerations[0]];
        for ((found, expected), size) in found.iter().zip(expected).zip([1.0, 50.0, 2000.0]) {
            worst = worst.max((found - expected).abs() / size);
        }
    }
    println!("filtfilt and its derivatives: {worst:.1e} of their size");
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn motions_that_have_no_accelerations_are_refused_with_their_numbers() {
    let model = free_body();
    let motion = |times: &[f64]| times.iter().map(|&time| (time, model.default_posture())).collect::<Vec<_>>();
    let refused = |times: &[f64], smoothing| differentiate(&model, &motion(times), smoothing).unwrap_err().to_string();
    let even: Vec<f64> = (0..20).map(|i| 0.1 * f64::from(i)).collect();
    assert!(refused(&even[..5], Smoothing::None).contains("5 instants; accelerations need at least 6"));
    assert!(
        refused(&even, Smoothing::OpenSim(5.0))
            .contains("a cut-off of 5 Hz: it must be above 0 and below half of the 10")
    );
    let mut twice = even.clone();
    twice[7] = twice[6];
    assert!(refused(&twice, Smoothing::None).contains("instant 7 is at 0.6"), "{}", refused(&twice, Smoothing::None));
    twice[7] = twice[6] + 1e-4;
    assert!(refused(&twice, Smoothing::OpenSim(2.0)).contains("two instants are"));
    assert!(differentiate(&model, &motion(&even), Smoothing::Filtfilt(2.0)).is_ok());
}

#[test]
fn speeds_that_do_not_fit_are_refused_by_name() {
    let model = adult(&Adult::default()).unwrap();
    let kinematics = Kinematics::new(&model);
    let mut inertia = Inertia::new(&model);
    let n = model.rates().len();
    let short = inertia.update(&model, &kinematics, (&[0.0], &vec![0.0; n]), &[]);
    assert_eq!(short, Err(SpeedError::Length { quantity: "speed", given: 1, needed: n }.into()));
    let mut wild = vec![0.0; n];
    for value in [f64::NAN, f64::INFINITY, -2e9] {
        wild[3] = value;
        let Err(InertiaError::Speed(error)) = inertia.update(&model, &kinematics, (&vec![0.0; n], &wild), &[]) else {
            panic!("an acceleration of {value} is accepted");
        };
        let text = error.to_string();
        assert!(text.contains(&model.rates()[3].name) && text.contains("acceleration"), "{text}");
    }
}
