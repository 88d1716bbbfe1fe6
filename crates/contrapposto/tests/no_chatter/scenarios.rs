//! Random standing bodies with tired muscles.

use contrapposto::contact::{Place, Support};
use contrapposto::fatigue::Hysteresis;
use contrapposto::hybrid::Strategy;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Sex, adult};
use contrapposto::passive::{Coupled, CoupledTerm, DoubleExponential, End, PassiveCurve, PassiveLaw, RienerEdrich1999};
use contrapposto::posture::Posture;
use contrapposto::simulation::{Event, ReliefSettings, RunSettings, Scenario, StrategySettings, Tables, TaskSettings};
use contrapposto::statics::Load;
use contrapposto::tasks::{CenterOfMass, CenterOfMassGoal, Effort, Orientation, Point, PriorityLevel, Task};
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg as Random;

/// Time from sample to sample, s.
const STEP: f64 = 0.2;

fn chance(random: &mut Random, share: f64) -> bool {
    random.random::<f64>() < share
}

fn either(random: &mut Random) -> Strategy {
    if chance(random, 0.5) { Strategy::Active } else { Strategy::Passive }
}

/// An adult on two feet, one of which may rest; tasks, loads, strategies, hip curves and fatigue at random.
pub(crate) fn random(random: &mut Random) -> Scenario {
    let sex = if chance(random, 0.5) { Sex::Female } else { Sex::Male };
    let (stature, mass) = (random.random_range(1.5..1.95), random.random_range(50.0..100.0));
    let mut model = adult(&Adult { sex, stature, mass, ..Adult::default() }).unwrap();
    for side in ["r", "l"] {
        model = with_hip(model, side, random);
    }
    let start = start(&model, random);
    let n = model.coordinates().len();
    let strategies = match random.random_range(0..3) {
        0 => (0..n).map(|_| either(random)).collect(),
        _ => vec![],
    };
    let (critical_level, recovery_level) = [(0.6, 0.3), (0.3, 0.15), (0.1, 0.05)][random.random_range(0..3)];
    let mut tired = || if chance(random, 0.15) { random.random_range(critical_level..0.95) } else { 0.0 };
    let start_fatigue = (0..n).map(|_| [tired(), tired()]).collect();
    let duration = random.random_range(20.0..60.0);
    Scenario {
        title: "random".into(),
        supports: supports(&model, random),
        rests: vec![],
        tasks: tasks(&model, &start, random),
        loads: loads(&model, random),
        events: events(&model, duration, random),
        free: vec![true; n],
        limits: vec![],
        strategies,
        strategy: StrategySettings { kind: either(random), minimum_decrease_ratio: random.random_range(0.1..0.95) },
        relief: ReliefSettings {
            step_gain: random.random_range(0.1..0.9),
            max_step: random.random_range(0.2..1.5f64).to_radians(),
            torque_tolerance: random.random_range(0.1..1.0),
            effort_factor: random.random_range(1.1..2.5),
            tables: Tables::Total,
        },
        hysteresis: Hysteresis { critical_level, recovery_level },
        muscles: None,
        muscles_tire: false,
        start_fatigue,
        run: RunSettings { duration, step: STEP, stop_when_settled: false, threads: 1 },
        start,
        model,
    }
}

/// Another law of hip adduction: size, rate and, in half of the bodies, coupling to hip flexion.
fn with_hip(model: Model, side: &str, random: &mut Random) -> Model {
    let index = |stem: &str| model.coordinate(&format!("{stem}_{side}")).unwrap();
    let (adduction, flexion) = (index("hip_adduction"), index("hip_flexion"));
    let mut end = |angle: f64| End {
        torque: random.random_range(3.0..40.0),
        rate: random.random_range(1.5..10.0),
        angle: angle.to_radians(),
    };
    let (lower, upper) = (end(-40.0), end(20.0));
    if chance(random, 0.5) {
        let range = model.coordinates()[adduction].range;
        let law = DoubleExponential { lower, upper, stiffness: 0.0, neutral: 0.0 };
        return model.with_passive(adduction, PassiveCurve::new(law.form().unwrap(), range, None).unwrap());
    }
    let mut term = |end: End, sign: f64| CoupledTerm {
        sign,
        c0: libm::log(end.torque) + sign * end.rate * end.angle,
        rates: [-sign * end.rate, random.random_range(-1.0..2.0), 0.0],
    };
    let terms = vec![term(lower, 1.0), term(upper, -1.0)];
    let law = RienerEdrich1999 { joint: 0, terms, constant: 0.0 };
    let neighbours = [Some((adduction, 1.0)), Some((flexion, 1.0)), None];
    model.with_passive_law(adduction, Some(PassiveLaw::Coupled(Coupled { law, neighbours })))
}

/// Feet level, one before the other, arms anywhere in front.
fn start(model: &Model, random: &mut Random) -> Posture {
    let mut start = model.default_posture();
    for side in ["_r", "_l"] {
        let mut set = |stem: &str, degrees: f64| {
            start.values_mut()[model.coordinate(&format!("{stem}{side}")).unwrap()] = degrees.to_radians();
        };
        let (hip, knee) = (random.random_range(-8.0..15.0), random.random_range(0.0..12.0));
        set("hip_flexion", hip);
        set("knee_angle", knee);
        set("ankle_angle", knee - hip);
        set("arm_flex", random.random_range(0.0..80.0));
        set("elbow_flex", random.random_range(5.0..110.0));
    }
    start
}

fn supports(model: &Model, random: &mut Random) -> Vec<Support> {
    let resting = random.random_range(0..4);
    let mut foot = |name: &str, rests: bool| {
        let segment = model.segment(name).unwrap();
        let share_max = if rests { random.random_range(0.05..0.6) } else { 1.0 };
        let corners = model.segments()[segment].patch.clone();
        Support {
            segment,
            corners,
            normal: Vector3::y(),
            friction: random.random_range(0.4..1.0),
            share_max,
            place: Place::Fixed,
        }
    };
    vec![foot("calcn_r", resting == 0), foot("calcn_l", resting <= 1 && resting != 0)]
}

/// Some of: balance over a foot, a hand that stays, chest and head as they are; then effort.
fn tasks(model: &Model, start: &Posture, random: &mut Random) -> Vec<TaskSettings> {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, start).unwrap();
    let mut tasks = vec![];
    let mut push = |task: Task, above_relief: bool| {
        tasks.push(TaskSettings { goal: PriorityLevel::from(task), above_relief });
    };
    if chance(random, 0.5) {
        let foot = ["calcn_r", "calcn_l"][random.random_range(0..2)];
        let foot = kinematics.station(model, model.segment(foot).unwrap(), Vector3::zeros());
        let target = foot + Vector3::new(random.random_range(0.0..0.08), 0.0, -0.4 * foot.z);
        let goal = CenterOfMassGoal::At { target, axes: [true, false, true] };
        push(Task::CenterOfMass(CenterOfMass { goal }), chance(random, 0.7));
    }
    if chance(random, 0.4) {
        let segment = model.segment(["hand_r", "hand_l"][random.random_range(0..2)]).unwrap();
        let target = kinematics.station(model, segment, Vector3::zeros());
        push(Task::Point(Point { segment, point: Vector3::zeros(), target, axes: [true; 3] }), chance(random, 0.7));
    }
    for segment in ["torso", "head"] {
        if chance(random, 0.6) {
            let segment = model.segment(segment).unwrap();
            let target = kinematics.placement(model, segment).rotation;
            push(Task::Orientation(Orientation { segment, target }), false);
        }
    }
    push(Task::Effort(Effort::whole(model)), false);
    tasks
}

/// Something in each hand of half of the bodies.
fn loads(model: &Model, random: &mut Random) -> Vec<Load> {
    if chance(random, 0.5) {
        return vec![];
    }
    let hands = ["hand_r", "hand_l"].map(|name| model.segment(name).unwrap());
    hands.into_iter().map(|hand| Load::weight(model, hand, random.random_range(0.0..6.0))).collect()
}

/// Another strategy, or other loads, in a third of the runs.
fn events(model: &Model, duration: f64, random: &mut Random) -> Vec<Event> {
    let time = random.random_range(0.2..0.8) * duration;
    match random.random_range(0..6) {
        0 => vec![Event { time, loads: Some(loads(model, random)), ..Event::default() }],
        1 => {
            let strategies = Some(vec![either(random); model.coordinates().len()]);
            vec![Event { time, strategies, ..Event::default() }]
        }
        _ => vec![],
    }
}
