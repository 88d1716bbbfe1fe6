//! Passive laws of strangers that are no number somewhere, or too large to calculate with: whatever the body is asked to do, the
//! answer is finite or a complaint that names the joint or the row, and it comes.

use contrapposto::contact::{Balance, ContactForces, Support};
use contrapposto::equilibria::{Aim, Search, equilibria};
use contrapposto::fatigue::Hysteresis;
use contrapposto::hybrid::Strategy;
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::math::expression::Operation::{self, Constant, Coordinate};
use contrapposto::math::expression::{Binary, Expression, Unary};
use contrapposto::model::{Adult, Model, adult};
use contrapposto::passive::{PassiveLaw, Term};
use contrapposto::posture_solver::Options;
use contrapposto::simulation::{
    Event, ReliefSettings, RunSettings, Scenario, ScenarioError, Simulation, StrategySettings, Tables, TaskSettings,
    run,
};
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto::tasks::PriorityLevel;
use contrapposto::tasks::{Effort, Task};
use nalgebra::Vector3;

/// Laws and the operations that they consist of.
fn laws() -> [(&'static str, Vec<Operation>); 8] {
    let unary = |function, a| Operation::Unary(function, a);
    let binary = |function, a, b| Operation::Binary(function, a, b);
    let times_q = |factor| vec![Constant(factor), Coordinate, binary(Binary::Multiply, 0, 1)];
    let shifted = [Coordinate, Constant(0.05), binary(Binary::Subtract, 0, 1), Constant(-1.0)];
    [
        ("1/q", vec![Constant(1.0), Coordinate, binary(Binary::Divide, 0, 1)]),
        ("q^0.5", vec![Coordinate, Constant(0.5), binary(Binary::Power, 0, 1)]),
        ("(q - 0.05)^-1", [shifted.as_slice(), &[binary(Binary::Power, 2, 3)]].concat()),
        ("1e308*q", times_q(1e308)),
        ("1e200*q", times_q(1e200)),
        ("exp(1e6*q)", [times_q(1e6), vec![unary(Unary::Exp, 2)]].concat()),
        ("1e60", vec![Constant(1e60)]),
        ("-log(q)", vec![Coordinate, unary(Unary::Log, 0), unary(Unary::Negate, 1)]),
    ]
}

/// With a law of its own at the joint that bends the trunk sideways, at its default 0.
fn model(law: &str, operations: Vec<Operation>) -> Model {
    let model = adult(&Adult::default()).unwrap();
    let bending = model.coordinate("lumbar_bending").unwrap();
    let law = PassiveLaw::Sum(vec![Term::Expression(Expression::new(law, operations).unwrap())]);
    model.with_passive_law(bending, Some(law))
}

fn feet(model: &Model) -> Vec<Support> {
    let foot = |name: &str| {
        let segment = model.segment(name).unwrap();
        let corners = model.segments()[segment].patch.clone();
        Support {
            segment,
            corners,
            normal: Vector3::y(),
            friction: 0.6,
            share_max: 1.0,
            place: contrapposto::contact::Place::Fixed,
        }
    };
    vec![foot("calcn_r"), foot("calcn_l")]
}

fn effort(model: &Model) -> PriorityLevel {
    PriorityLevel::from(Task::Effort(Effort::whole(model)))
}

/// One second of it, on its feet or as if its root were held.
fn scenario(model: Model, on_its_feet: bool) -> Scenario {
    let n = model.coordinates().len();
    Scenario {
        title: "a law of its own".into(),
        start: model.default_posture(),
        free: vec![on_its_feet; n],
        loads: vec![],
        supports: if on_its_feet { feet(&model) } else { vec![] },
        rests: vec![],
        limits: vec![],
        tasks: if on_its_feet { vec![TaskSettings { goal: effort(&model), above_relief: false }] } else { vec![] },
        events: vec![],
        strategies: vec![],
        strategy: StrategySettings { kind: Strategy::Passive, minimum_decrease_ratio: 0.9 },
        relief: ReliefSettings {
            step_gain: 0.3,
            max_step: 0.01,
            torque_tolerance: 0.5,
            effort_factor: 1.25,
            tables: Tables::Total,
        },
        hysteresis: Hysteresis { critical_level: 0.6, recovery_level: 0.3 },
        muscles: None,
        muscles_tire: false,
        start_fatigue: vec![[0.7; 2]; n],
        run: RunSettings { duration: 1.0, step: 1.0 / 30.0, stop_when_settled: false, threads: 1 },
        model,
    }
}

/// Names what is not a number.
fn names_it(complaint: &str) -> bool {
    println!("    {complaint}");
    complaint.starts_with("the passive torque of `lumbar_bending` at ")
        || complaint.starts_with("the levels have no finite rows in this posture: ")
}

#[test]
fn a_run_is_finite_or_refused_by_name() {
    for (law, operations) in laws() {
        for on_its_feet in [true, false] {
            println!("{law}, on its feet: {on_its_feet}");
            let scenario = scenario(model(law, operations.clone()), on_its_feet);
            let mut samples = 0;
            let ended = run(&scenario, |sample| {
                samples += 1;
                let parts = [sample.posture, sample.external, sample.passive, sample.active, sample.load];
                assert!(parts.into_iter().flatten().chain(sample.fatigue.iter().flatten()).all(|v| v.is_finite()));
            });
            match ended {
                Ok(_) => println!("    {samples} samples"),
                Err(error) => assert!(names_it(&error.to_string()), "{error}"),
            }
        }
    }
}

#[test]
fn a_search_is_finite_or_refused_by_name() {
    for (law, operations) in laws() {
        println!("{law}");
        let model = model(law, operations);
        let (start, supports, goals) = (model.default_posture(), feet(&model), [effort(&model)]);
        let search = Search {
            model: &model,
            start: &start,
            supports: &supports,
            limits: &[],
            goals: &goals,
            loads: &[],
            locked: &[],
            most_work: usize::MAX,
            scattered: contrapposto::equilibria::SCATTERED_STARTS,
            aim: Aim::Ways,
            threads: 1,
        };
        match equilibria(&search, Options { max_steps: 60, ..Options::least_effort() }) {
            Ok(found) => {
                let best = &found.postures[0];
                println!("    effort {:.3}", best.relaxed.effort);
                let numbers = best.torques.iter().flatten().chain(best.relaxed.posture.values());
                assert!(best.relaxed.effort.is_finite() && numbers.into_iter().all(|v| v.is_finite()));
            }
            Err(error) => assert!(names_it(&error.to_string()), "{error}"),
        }
    }
}

#[test]
fn a_law_that_has_a_torque_but_no_slope_gives_its_torque() {
    let [_, (law, operations), ..] = laws();
    let model = model(law, operations); // q^0.5 at q = 0: the torque is 0, its slope infinite
    let mut torques = JointTorques::new(&model);
    torques.update(&model, &model.default_posture(), &[], Quantities::TORQUES).unwrap();
    let bending = model.coordinates()[model.coordinate("lumbar_bending").unwrap()].rate.unwrap();
    assert_eq!(torques.passive_torque().torques()[bending], 0.0);
}

#[test]
fn contact_forces_of_no_torques_hold_nothing() {
    let model = adult(&Adult::default()).unwrap();
    let mut torques = JointTorques::new(&model);
    torques.update(&model, &model.default_posture(), &[], Quantities::TORQUES).unwrap();
    let (kinematics, angles, required) = (torques.kinematics_by_axes(), torques.angles(), torques.active_torque());
    let mut contact = ContactForces::new(&model, feet(&model)).unwrap();
    let good = contact.update(&model, kinematics, angles, required);
    assert_eq!(good, Balance::Held);
    let before = contact.forces().to_vec();
    for bad in [f64::NAN, f64::INFINITY, -1e300] {
        let balance = contact.update(&model, kinematics, angles, &vec![bad; required.len()]);
        assert_eq!(balance, Balance::Short { force: f64::INFINITY, moment: f64::INFINITY }, "{bad}");
        assert!(contact.forces().iter().all(|force| *force == 0.0), "{bad}");
        contact.forget();
        assert_eq!(contact.update(&model, kinematics, angles, required), good);
        assert_eq!(contact.forces(), before, "{bad}");
    }
}

/// On its feet, with a task that bends the trunk from 0.05 rad, where the law `q^0.5` is a number, to -0.2 rad, where it is none.
fn bending_beyond_the_law() -> Scenario {
    let [_, (law, operations), ..] = laws();
    let mut scenario = scenario(model(law, operations), true);
    let bending = scenario.model.coordinate("lumbar_bending").unwrap();
    scenario.start.values_mut()[bending] = 0.05;
    let rate = scenario.model.coordinates()[bending].rate.unwrap();
    let (mut target, mut weights) = (scenario.start.clone(), vec![0.0; scenario.model.rates().len()]);
    target.values_mut()[bending] = 0.04;
    weights[rate] = 1.0;
    let task = |target: &contrapposto::posture::Posture| {
        Task::Posture(contrapposto::tasks::Posture { target: target.clone(), weights: weights.clone() })
    };
    scenario.tasks = vec![TaskSettings { goal: task(&target).into(), above_relief: true }];
    target.values_mut()[bending] = -0.2;
    scenario.events = vec![Event { time: 0.2, tasks: vec![(0, task(&target).into())], ..Event::default() }];
    scenario
}

/// The angle in a complaint about the passive torque of the lumbar spine, rad.
fn angle_of(complaint: &str) -> f64 {
    let rest =
        complaint.strip_prefix("the passive torque of `lumbar_bending` at ").unwrap_or_else(|| panic!("{complaint}"));
    rest.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn after_a_passive_law_gives_no_number_posture_and_supports_stay() {
    let scenario = bending_beyond_the_law();
    let mut simulation = Simulation::new(&scenario).unwrap();
    let mut last = vec![];
    let error = loop {
        match simulation.step() {
            Ok(sample) => {
                assert!(sample.standing.is_some());
                last = sample.posture.to_vec();
            }
            Err(error) => break error,
        }
    };
    assert!(names_it(&error.to_string()) && !last.is_empty());
    // The next steps meet the same law again: on the supports, from the posture of the last sample.
    for _ in 0..3 {
        match simulation.step() {
            Ok(sample) => {
                assert!(sample.standing.is_some_and(|standing| standing.contacts.len() == 2), "the supports are gone");
                let farthest = sample.posture.iter().zip(&last).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(farthest < 0.1, "{farthest} rad from the last sample");
            }
            // Not farther into the law: steps may be shorter after an error.
            Err(again) => {
                let (again, first) = (angle_of(&again.to_string()), angle_of(&error.to_string()));
                assert!(again * first > 0.0 && again.abs() <= first.abs(), "{again} rad, {first} at first");
            }
        }
    }
}

#[test]
fn an_event_that_throws_the_body_over_does_so_in_every_further_step() {
    let mut scenario = scenario(adult(&Adult::default()).unwrap(), true);
    let hand = scenario.model.segment("hand_r").unwrap();
    let push = LoadKind::Force(Vector3::new(3000.0, 0.0, 0.0), FixedIn::World);
    let loads = vec![Load { segment: hand, point: Vector3::zeros(), kind: push }];
    scenario.events = vec![Event { time: 0.1, loads: Some(loads), ..Event::default() }];
    let mut simulation = Simulation::new(&scenario).unwrap();
    let error = loop {
        if let Err(error) = simulation.step() {
            break error;
        }
    };
    assert!(matches!(error, ScenarioError::Falls(_)), "{error}");
    assert_eq!(simulation.step().unwrap_err(), error);
}
