//! Batches give each posture what it is given alone: to the bit beside any others and in any number of threads, and to rounding by the
//! code that computes one posture.

use crate::trees;

use contrapposto::batch::{self, BatchError, Statics, Table, Wanted};
use contrapposto::equilibria::{Aim, Search, equilibria};
use contrapposto::fatigue::Hysteresis;
use contrapposto::hybrid::Strategy;
use contrapposto::joint_torques::{JointTorques, JointTorquesError, Quantities, effort, relative_load};
use contrapposto::model::{Adult, CoordinateKind, LARGEST, Model, adult};
use contrapposto::posture::{Posture, PostureError};
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::simulation::{ReliefSettings, RunSettings, Scenario, StrategySettings, Tables, run};
use contrapposto::statics::{FixedIn, Load, LoadError, LoadKind};
use contrapposto::tasks::{Effort, Point, PriorityLevel, Task};
use contrapposto::verdict::Verdict;
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;

/// Largest difference from one posture at a time, by the largest number of its kind.
const ROUNDING: f64 = 1e-12;

fn table(model: &Model, postures: &[Posture]) -> Table {
    let mut table = Table::of_postures(model, postures.len());
    postures.iter().enumerate().for_each(|(i, posture)| table.set_posture(i, posture.values()));
    table
}

fn everything(model: &Model) -> Wanted {
    Wanted { placements: (0..model.segments().len()).collect(), active_torque: true, gradient: true }
}

/// One of every kind, on random segments.
fn loads(rng: &mut Pcg64, model: &Model) -> Vec<Load> {
    let mut on =
        |kind| Load { segment: rng.random_range(0..model.segments().len()), point: trees::vector(rng, 0.2), kind };
    let v = Vector3::new(3.0, -20.0, 7.0);
    vec![
        on(LoadKind::Weight(2.5)),
        on(LoadKind::Force(v, FixedIn::World)),
        on(LoadKind::Force(2.0 * v, FixedIn::Segment)),
        on(LoadKind::Couple(0.1 * v, FixedIn::World)),
        on(LoadKind::Couple(-0.2 * v, FixedIn::Segment)),
    ]
}

/// All results of a posture as bits.
fn bits(statics: &Statics, model: &Model, wanted: &Wanted, posture: usize) -> Vec<u64> {
    let (n, mut numbers) = (model.rates().len(), vec![]);
    let at = |mut row: Box<dyn Iterator<Item = f64> + '_>| row.nth(posture).unwrap();
    for rate in 0..n {
        numbers.push(at(Box::new(statics.external_torque(rate))));
        if wanted.active_torque {
            numbers.push(at(Box::new(statics.external_about_axis(rate))));
            numbers.push(at(Box::new(statics.passive_about_axis(rate))));
            numbers.push(at(Box::new(statics.active_torque(rate))));
        }
        if wanted.gradient {
            numbers.extend((0..n).map(|column| at(Box::new(statics.gradient(rate, column)))));
        }
    }
    if wanted.active_torque {
        numbers.push(at(Box::new(statics.effort())));
        numbers.extend((0..model.coordinates().len()).map(|c| at(Box::new(statics.relative_load(c)))));
    }
    numbers.extend(statics.center_of_mass(posture).iter().flat_map(|center| center.iter().copied()));
    for which in 0..wanted.placements.len() {
        let (rotation, origin) = statics.placement(which, posture);
        numbers.extend(rotation.iter().chain(origin.iter()));
    }
    numbers.into_iter().map(f64::to_bits).collect()
}

fn assert_near(what: &str, found: &[f64], expected: &[f64]) {
    let size = trees::largest(expected.iter().copied()).max(1.0);
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= ROUNDING * size, "{what} {i}: {a} in a batch, {b} alone, the largest {size}");
    }
    assert_eq!(found.len(), expected.len(), "{what}");
}

/// Every result of a batch by the code that computes one posture.
fn assert_agrees(model: &Model, postures: &[Posture], loads: &[Load]) {
    let wanted = everything(model);
    let mut statics = Statics::new(model, wanted.clone()).unwrap();
    statics.update(model, &table(model, postures), loads, 2).unwrap();
    let (mut alone, n) = (JointTorques::new(model), model.rates().len());
    for (i, posture) in postures.iter().enumerate() {
        alone.update(model, posture, loads, Quantities::ALL).unwrap();
        let by_rate = |row: &dyn Fn(usize) -> f64| (0..n).map(row).collect::<Vec<_>>();
        let at = |rate| statics.external_torque(rate).nth(i).unwrap();
        assert_near("external torque", &by_rate(&at), alone.external_torque().torques());
        let at = |rate| statics.external_about_axis(rate).nth(i).unwrap();
        assert_near("external torque about axis", &by_rate(&at), alone.external_about_axes());
        let at = |rate| statics.passive_about_axis(rate).nth(i).unwrap();
        assert_eq!(by_rate(&at), alone.passive_torque().about_axes(), "passive torque");
        let at = |rate| statics.active_torque(rate).nth(i).unwrap();
        assert_near("active torque", &by_rate(&at), alone.active_torque());
        let center = statics.center_of_mass(i);
        assert_eq!(center.is_some(), alone.center_of_mass().position().is_some());
        if let (Some(found), Some(expected)) = (center, alone.center_of_mass().position()) {
            assert_near("centre of mass", found.as_slice(), expected.as_slice());
        }
        let of_groups = |(c, coordinate): (usize, &contrapposto::model::Coordinate)| {
            coordinate
                .rate
                .map_or(0.0, |rate| relative_load(coordinate, alone.angles()[c], alone.active_torque()[rate]))
        };
        let expected: Vec<f64> = model.coordinates().iter().enumerate().map(of_groups).collect();
        let found: Vec<f64> = (0..expected.len()).map(|c| statics.relative_load(c).nth(i).unwrap()).collect();
        assert_near("relative load", &found, &expected);
        assert_near("effort", &[statics.effort().nth(i).unwrap()], &[effort(&expected)]);
        for segment in 0..model.segments().len() {
            let (rotation, origin) = statics.placement(segment, i);
            let expected = alone.kinematics().placement(model, segment);
            assert_near("origin", origin.as_slice(), expected.translation.vector.as_slice());
            let expected = expected.rotation.to_rotation_matrix().into_inner();
            assert_near("rotation", rotation.as_slice(), expected.as_slice());
        }
        let (mut gradient, mut expected) = (vec![], vec![]);
        for row in 0..n {
            let found: Vec<f64> = (0..n).map(|column| statics.gradient(row, column).nth(i).unwrap()).collect();
            gradient.extend(found);
            expected.extend_from_slice(alone.gradient().row(row));
        }
        assert_near("gradient", &gradient, &expected);
    }
}

/// Anywhere inside the ranges.
fn inside(rng: &mut Pcg64, model: &Model) -> Posture {
    let values = model.coordinates().iter().map(|c| rng.random_range(c.range.0.max(-3.0)..=c.range.1.min(3.0)));
    Posture::new(values.collect())
}

#[test]
fn the_adult_in_a_batch_agrees_with_one_posture_at_a_time() {
    let mut rng = trees::random("adult in a batch");
    let model = adult(&Adult::default()).unwrap();
    assert_eq!(model.three_axis_joints().len(), 7);
    for _ in 0..10 {
        let postures: Vec<Posture> = (0..21).map(|_| inside(&mut rng, &model)).collect();
        let loads = loads(&mut rng, &model);
        assert_agrees(&model, &postures, &loads);
        assert_agrees(&model, &postures, &loads[..2]);
        assert_agrees(&model, &postures, &[]);
    }
}

#[test]
fn random_bodies_of_every_joint_kind_agree_with_one_posture_at_a_time() {
    let mut rng = trees::random("random bodies in a batch");
    let (mut balls, mut slides, mut coupled) = (0, 0, 0);
    let person = adult(&Adult::default()).unwrap();
    let fatigue = person.coordinates().iter().find_map(|c| c.groups.as_ref()).unwrap()[0].fatigue.clone();
    for i in 0..300 {
        let size = rng.random_range(1..12);
        let model = trees::tree(&mut rng, size, i % 2 == 0);
        balls += usize::from(model.rates().len() < model.coordinates().len());
        slides += usize::from(model.rates().iter().any(|rate| !rate.rotational));
        coupled += usize::from(!model.couplings().is_empty());
        let model = trees::with_muscles(&mut rng, model, &fatigue);
        let postures: Vec<Posture> = (0..9).map(|_| trees::posture(&mut rng, &model)).collect();
        let loads = loads(&mut rng, &model);
        assert_agrees(&model, &postures, &loads);
        assert_agrees(&model, &postures, &loads[..2]);
    }
    assert!(balls > 50 && slides > 50 && coupled > 50, "{balls} with balls, {slides} with slides, {coupled} coupled");
}

/// Results of every posture computed alone, in the place 0 of a batch of one.
fn alone(model: &Model, wanted: &Wanted, postures: &[Posture], loads: &[Load]) -> Vec<Vec<u64>> {
    let mut statics = Statics::new(model, wanted.clone()).unwrap();
    let one = |posture: &Posture| {
        statics.update(model, &table(model, std::slice::from_ref(posture)), loads, 1).unwrap();
        bits(&statics, model, wanted, 0)
    };
    postures.iter().map(one).collect()
}

fn assert_bits_stay(model: &Model, wanted: &Wanted, postures: &[Posture], loads: &[Load], counts: &[usize]) {
    let expected = alone(model, wanted, postures, loads);
    let mut statics = Statics::new(model, wanted.clone()).unwrap();
    for &count in counts {
        for first in [0, 1, 3, 7] {
            let chosen = &postures[first..first + count];
            for threads in [0, 1, 2, 3, 8] {
                statics.update(model, &table(model, chosen), loads, threads).unwrap();
                assert_eq!(statics.postures(), count);
                for i in 0..count {
                    let same = bits(&statics, model, wanted, i) == expected[first + i];
                    assert!(same, "posture {i} of {count} in {threads} threads, taken from {first}");
                }
            }
        }
    }
}

#[test]
fn one_to_twenty_postures_of_the_adult_have_the_bits_of_each_alone_in_any_place_and_number_of_threads() {
    let mut rng = trees::random("bits of the adult");
    let model = adult(&Adult::default()).unwrap();
    let postures: Vec<Posture> = (0..30).map(|_| inside(&mut rng, &model)).collect();
    let loads = loads(&mut rng, &model);
    let wanted = Wanted { placements: vec![model.segment("hand_r").unwrap()], active_torque: true, gradient: false };
    assert_bits_stay(&model, &wanted, &postures, &loads, &(1..=20).collect::<Vec<_>>());
    assert_bits_stay(&model, &everything(&model), &postures, &loads, &[19]);
    assert_bits_stay(&model, &everything(&model), &postures, &loads[..2], &[19]);
}

#[test]
fn postures_of_random_bodies_have_the_bits_of_each_alone_in_any_place_and_number_of_threads() {
    let mut rng = trees::random("bits of random bodies");
    for i in 0..20 {
        let model = trees::tree(&mut rng, 6, i % 2 == 0);
        let postures: Vec<Posture> = (0..34).map(|_| trees::posture(&mut rng, &model)).collect();
        let loads = loads(&mut rng, &model);
        assert_bits_stay(&model, &everything(&model), &postures, &loads, &[1, 8, 13, 27]);
    }
}

#[test]
fn an_angle_of_ten_million_radians_is_computed_and_leaves_its_neighbours_alone() {
    let mut rng = trees::random("huge angles");
    let model = trees::tree(&mut rng, 9, false);
    let mut postures: Vec<Posture> = (0..12).map(|_| trees::posture(&mut rng, &model)).collect();
    let neighbours = alone(&model, &Wanted::default(), &postures, &[]);
    let hinges = (0..model.coordinates().len()).filter(|&c| model.coordinates()[c].kind == CoordinateKind::Rotation);
    let hinges: Vec<usize> = hinges.collect();
    assert!(hinges.len() > 3, "{hinges:?}");
    hinges.iter().for_each(|&hinge| postures[4].values_mut()[hinge] = rng.random_range(1e7..1e9));
    assert_agrees(&model, &postures, &[]);
    let mut statics = Statics::new(&model, Wanted::default()).unwrap();
    statics.update(&model, &table(&model, &postures), &[], 2).unwrap();
    for i in (0..12).filter(|&i| i != 4) {
        assert_eq!(bits(&statics, &model, &Wanted::default(), i), neighbours[i]);
    }
    assert_ne!(bits(&statics, &model, &Wanted::default(), 4), neighbours[4]);
}

#[test]
fn a_batch_of_no_postures_and_a_body_without_coordinates_are_computed() {
    let model = adult(&Adult::default()).unwrap();
    let mut statics = Statics::new(&model, everything(&model)).unwrap();
    statics.update(&model, &Table::of_postures(&model, 0), &[], 4).unwrap();
    assert_eq!((statics.postures(), statics.external_torque(0).count()), (0, 0));

    let model = contrapposto::model::ModelBuilder::new("nothing", Vector3::zeros()).build();
    let mut statics = Statics::new(&model, everything(&model)).unwrap();
    statics.update(&model, &Table::of_postures(&model, 9), &[], 4).unwrap();
    assert_eq!((statics.center_of_mass(8), statics.effort().collect::<Vec<_>>()), (None, vec![0.0; 9]));
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let model = adult(&Adult::default()).unwrap();
    let (coordinates, segments) = (model.coordinates().len(), model.segments().len());
    let wanted = Wanted { placements: vec![segments], ..Wanted::default() };
    assert_eq!(Statics::new(&model, wanted).unwrap_err(), BatchError::Segment { segment: segments, count: segments });
    let mut statics = Statics::new(&model, Wanted::default()).unwrap();
    let arm = adult(&Adult::right_arm()).unwrap();
    let given = arm.coordinates().len();
    let refused = statics.update(&model, &Table::of_postures(&arm, 1), &[], 1);
    assert_eq!(refused, Err(BatchError::Rows { given, needed: coordinates }));
    let load = Load { segment: segments, point: Vector3::zeros(), kind: LoadKind::Weight(1.0) };
    let refused = statics.update(&model, &Table::of_postures(&model, 1), &[load], 1);
    assert_eq!(refused, Err(BatchError::Load(LoadError::Segment { segment: segments, count: segments })));

    for value in [f64::NAN, f64::INFINITY, -2.0 * LARGEST] {
        let mut postures = Table::of_postures(&model, 50);
        postures.set(3, 21, value);
        postures.set(3, 40, value);
        for threads in [1, 2, 8] {
            let refused = statics.update(&model, &postures, &[], threads).unwrap_err();
            let BatchError::Posture { posture: 21, problem } = &refused else { panic!("{refused}") };
            let named = matches!(problem, JointTorquesError::Posture(PostureError::NotFinite { .. }));
            assert!(named && refused.to_string().contains(&model.coordinates()[3].name), "{refused}");
        }
    }
}

#[test]
fn a_quaternion_of_no_length_is_refused_and_a_short_one_is_not() {
    let mut rng = trees::random("quaternions in a batch");
    let model = loop {
        let model = trees::tree(&mut rng, 4, false);
        if model.rates().len() < model.coordinates().len() {
            break model;
        }
    };
    let first = model.coordinates().iter().position(|c| c.name.ends_with("_qw")).unwrap();
    let mut statics = Statics::new(&model, Wanted::default()).unwrap();
    let mut postures = Table::of_postures(&model, 3);
    (0..4).for_each(|k| postures.set(first + k, 1, 0.0));
    postures.set(first, 1, 1.1e-6);
    assert_eq!(statics.update(&model, &postures, &[], 1), Ok(()));
    assert!(statics.external_torque(0).all(f64::is_finite));
    postures.set(first, 1, 0.9e-6);
    let refused = statics.update(&model, &postures, &[], 1).unwrap_err();
    assert!(matches!(refused, BatchError::Posture { posture: 1, .. }), "{refused}");
}

#[test]
fn postures_for_many_targets_have_the_same_bits_in_any_number_of_threads() {
    let model = adult(&Adult::default()).unwrap();
    let hand = model.segment("hand_r").unwrap();
    let targets: Vec<Vector3<f64>> = (0..12)
        .map(|i| Vector3::new(0.25 + 0.05 * f64::from(i % 4), 0.9 + 0.1 * f64::from(i / 4), 0.2 + 0.03 * f64::from(i)))
        .collect();
    let reach = Point { segment: hand, point: Vector3::zeros(), target: targets[0], axes: [true; 3] };
    let levels = vec![Task::Point(reach).into()];
    let engine = Engine::new(&model, levels, &[], Options::inverse_kinematics()).unwrap();
    let start = model.default_posture();
    let solved = |threads| {
        let solver = || engine.clone();
        let posture = |engine: &mut Engine<'_>, target: &Vector3<f64>| {
            assert!(engine.levels_mut()[0].tasks[0].retarget(*target));
            engine.solve(&start).unwrap().posture
        };
        batch::over(&targets, threads, solver, posture)
    };
    let expected = solved(1);
    assert_ne!(expected[0], expected[1]);
    for threads in [2, 3, 8] {
        assert_eq!(solved(threads), expected, "{threads} threads");
    }
}

/// Masses in the hand of the right arm, kg.
const MASSES: [f64; 5] = [0.0, 0.5, 1.0, 2.0, 4.0];

#[test]
fn relaxed_arms_with_many_loads_have_the_same_bits_in_any_number_of_threads() {
    let model = adult(&Adult::right_arm()).unwrap();
    let hand = model.segment("hand_r").unwrap();
    let start = model.default_posture();
    let target = Vector3::new(0.35, -0.25, 0.2);
    let reach = Task::Point(Point { segment: hand, point: Vector3::zeros(), target, axes: [true; 3] });
    let goals = [PriorityLevel::from(reach), Task::Effort(Effort::whole(&model)).into()];
    let relaxed = |threads| {
        let solve = |(): &mut (), mass: &f64| {
            let loads = [Load::weight(&model, hand, *mass)];
            let search = Search {
                model: &model,
                start: &start,
                supports: &[],
                goals: &goals,
                limits: &[],
                loads: &loads,
                locked: &[],
                most_work: usize::MAX,
                scattered: contrapposto::equilibria::SCATTERED_STARTS,
                aim: Aim::Ways,
                threads: 1,
            };
            equilibria(&search, Options { local_minima: 0, ..Options::least_effort() })
        };
        format!("{:?}", batch::over(&MASSES, threads, || (), solve))
    };
    let expected = relaxed(1);
    assert!(expected.contains("effort"), "{expected}");
    for threads in [2, 3, 8] {
        assert!(relaxed(threads) == expected, "{threads} threads");
    }
}

#[test]
fn verdicts_on_an_arm_with_many_loads_have_the_same_bits_in_any_number_of_threads() {
    let verdicts = |threads| {
        let judge = |(): &mut (), mass: &f64| {
            let scenario = held_arm(*mass);
            Verdict::of_run(&scenario, &run(&scenario, |_| {}).unwrap())
        };
        batch::over(&MASSES, threads, || (), judge)
    };
    let expected = verdicts(1);
    assert!(expected[0].kind.word() != expected[4].kind.word(), "{expected:?}");
    for threads in [2, 3, 8] {
        assert_eq!(verdicts(threads), expected, "{threads} threads");
    }
}

/// A forearm held level for ten minutes with a mass in the hand, nothing free to relieve it.
fn held_arm(mass: f64) -> Scenario {
    let model = adult(&Adult::right_arm()).unwrap();
    let mut start = model.default_posture();
    start.values_mut()[model.coordinate("elbow_flex_r").unwrap()] = 90f64.to_radians();
    let n = model.coordinates().len();
    Scenario {
        title: "held arm".into(),
        loads: vec![Load::weight(&model, model.segment("hand_r").unwrap(), mass)],
        model,
        start,
        free: vec![false; n],
        supports: vec![],
        rests: vec![],
        limits: vec![],
        tasks: vec![],
        events: vec![],
        strategies: vec![],
        strategy: StrategySettings { kind: Strategy::Passive, minimum_decrease_ratio: 0.9 },
        relief: ReliefSettings {
            step_gain: 0.3,
            max_step: 2f64.to_radians(),
            torque_tolerance: 0.05,
            effort_factor: 1.25,
            tables: Tables::Total,
        },
        hysteresis: Hysteresis { critical_level: 0.6, recovery_level: 0.3 },
        muscles: None,
        muscles_tire: false,
        start_fatigue: vec![[0.0; 2]; n],
        run: RunSettings { duration: 600.0, step: 0.5, stop_when_settled: false, threads: 1 },
    }
}
