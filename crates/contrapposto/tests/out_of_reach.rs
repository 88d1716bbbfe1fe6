//! Moves hand targets of the built-in adult out of reach and back.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::tasks::{CenterOfMass, CenterOfMassGoal, Height, Placement, Point, Posture, PriorityLevel, Task};
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

const SEED: u128 = 5;
const TARGETS_DRAWN: usize = 20;

/// Feet where they are, the centre of mass over them, the right hand on the target, the rhythm of the shoulders, the default posture.
fn levels(model: &Model, target: Vector3<f64>) -> Vec<PriorityLevel> {
    let start = model.default_posture();
    let mut at = Kinematics::new(model);
    at.update(model, &start).unwrap();
    let foot = |name: &str| {
        let segment = model.segment(name).unwrap();
        let target = at.placement(model, segment);
        Task::Placement(Placement { segment, point: Vector3::zeros(), target })
    };
    let goal = CenterOfMassGoal::At { target: at.center_of_mass(model).unwrap(), axes: [true, false, true] };
    let hand = model.segment("hand_r").unwrap();
    let rises = Height::shoulder_rhythm(model).into_iter().map(|(_, task)| Task::Height(task));
    vec![
        PriorityLevel { tasks: vec![foot("calcn_r"), foot("calcn_l")], hard: true, ..PriorityLevel::default() },
        Task::CenterOfMass(CenterOfMass { goal }).into(),
        Task::Point(Point { segment: hand, point: Vector3::zeros(), target, axes: [true; 3] }).into(),
        PriorityLevel { tasks: rises.collect(), ..PriorityLevel::default() },
        Task::Posture(Posture::whole(model, start.clone())).into(),
    ]
}

const TARGETS: [[f64; 3]; 4] = [[2.0, 1.2, 0.3], [0.2, 2.9, 0.4], [1.6, 0.8, -0.6], [-0.1, 2.5, 0.1]];

#[test]
fn a_target_that_comes_back_within_reach_is_reached_by_plain_steps() {
    let model = adult(&Adult::default()).unwrap();
    let start = model.default_posture();
    let hand = model.segment("hand_r").unwrap();
    let mut at = Kinematics::new(&model);
    at.update(&model, &start).unwrap();
    for target in TARGETS {
        for by in [Vector3::new(0.1, 0.1, 0.0), Vector3::new(0.3, 0.2, 0.1), Vector3::new(0.0, 0.3, -0.1)] {
            let near = at.station(&model, hand, Vector3::zeros()) + by;
            let far = levels(&model, Vector3::from(target));
            let mut engine = Engine::new(&model, far, &[], Options::inverse_kinematics()).unwrap();
            let mut posture = start.clone();
            for _ in 0..200 {
                engine.step(&mut posture).unwrap();
            }
            assert!(engine.levels_mut()[2].tasks[0].retarget(near));
            // Once there, steps of the levels below move the hand by up to some millimetres for single steps.
            let mut nearest = f64::INFINITY;
            for _ in 0..60 {
                engine.step(&mut posture).unwrap();
                nearest = nearest.min(engine.report(&posture).unwrap()[2].length);
            }
            assert!(nearest < 1e-5, "from {target:?} by {by:?}: {nearest} m are left");
        }
    }
}

/// Plain steps are those of the first start.
#[test]
fn a_solve_out_of_reach_ends_no_farther_than_its_first_start() {
    let model = adult(&Adult::default()).unwrap();
    let start = model.default_posture();
    let mut random = Pcg64Mcg::new(SEED);
    for _ in 0..TARGETS_DRAWN {
        let (distance, angle) = (random.random_range(1.5..2.5), random.random_range(-0.6..0.6_f64));
        let target =
            Vector3::new(distance * libm::cos(angle), random.random_range(0.4..2.6), distance * libm::sin(angle));
        let mut engine = Engine::new(&model, levels(&model, target), &[], Options::inverse_kinematics()).unwrap();
        let mut posture = start.clone();
        for _ in 0..Options::inverse_kinematics().max_steps {
            engine.step(&mut posture).unwrap();
        }
        let plain = engine.report(&posture).unwrap();
        let solved = engine.solve(&start).unwrap();
        assert!(solved.levels[..2].iter().all(|level| level.length < 1e-6), "seed {SEED}, {target:?}");
        let gain = plain[2].length - solved.levels[2].length;
        assert!(gain > -1e-4, "seed {SEED}, {target:?}: {gain} m");
    }
}

/// Nothing but the hand's distance: steps that take the error as straight overshoot for ever, by the longest step that is allowed.
#[test]
fn steps_toward_a_target_out_of_reach_become_short_where_it_is_the_only_level() {
    let model = adult(&Adult::default()).unwrap();
    let hand = model.segment("hand_r").unwrap();
    for target in TARGETS {
        let task = Point { segment: hand, point: Vector3::zeros(), target: target.into(), axes: [true; 3] };
        let options = Options::inverse_kinematics();
        let mut engine = Engine::new(&model, vec![Task::Point(task).into()], &[], options).unwrap();
        let root = ["pelvis_tx", "pelvis_ty", "pelvis_tz", "pelvis_tilt", "pelvis_list", "pelvis_rotation"];
        root.iter().for_each(|name| engine.lock(model.coordinates()[model.coordinate(name).unwrap()].rate.unwrap()));
        let mut posture = model.default_posture();
        let steps: Vec<f64> = (0..120).map(|_| engine.step(&mut posture).unwrap().largest).collect();
        let longest = steps[60..].iter().copied().fold(0.0, f64::max);
        println!("{target:?}: {:.3} rad at first, {longest:.1e} at most in the end", steps[0]);
        assert!(steps[0] > 0.5 && longest < 0.02, "{target:?}: {longest}");
    }
}
