//! The slope that enters the tables for a body on its feet: the motion by dense projection, torques along it from their parts.
//! Seeded; `CONTRAPPOSTO_SEED` chooses another seed.

use contrapposto::contact::{Balance, ContactForces, Support};
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::posture::Posture;
use contrapposto::posture_solver::{Engine, Options};
use contrapposto::statics::Load;
use contrapposto::tasks::PriorityLevel;
use contrapposto::tasks::{Point, Task};
use nalgebra::{DMatrix, DVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Step of the difference along the motion, rad or m.
use crate::axes;

use axes::moved_about_axis;

const STEP: f64 = 1e-4;

/// Torque of a rate in a posture: weight, loads, contact forces of least effort and ligaments.
struct Scale<'a> {
    model: &'a Model,
    torques: JointTorques,
    contact: ContactForces,
    loads: &'a [Load],
}

impl Scale<'_> {
    fn weigh(&mut self, posture: &Posture, rate: usize) -> Option<f64> {
        self.torques.update(self.model, posture, self.loads, Quantities::TORQUES).unwrap();
        let (body, active) = (&self.torques, self.torques.active_torque());
        let balance = self.contact.update(self.model, body.kinematics_by_axes(), body.angles(), active);
        let torque = self.contact.torques()[rate] - active[rate];
        (balance == Balance::Held).then_some(torque)
    }
}

/// Jacobian of the parts that must not move: both feet, and the hand where it ranks above.
fn rows(model: &Model, kinematics: &Kinematics, feet: &[Support], hand: Option<&Point>) -> DMatrix<f64> {
    let n = model.rates().len();
    let mut all: Vec<f64> = vec![];
    let mut part = vec![0.0; 3 * n];
    for foot in feet {
        kinematics.point_jacobian(model, foot.segment, Vector3::new(0.02, 0.0, 0.01), &mut part);
        all.extend(&part);
        kinematics.rotation_jacobian(model, foot.segment, &mut part);
        all.extend(&part);
    }
    if let Some(hand) = hand {
        kinematics.point_jacobian(model, hand.segment, hand.point, &mut part);
        all.extend(&part);
    }
    DMatrix::from_row_slice(all.len() / n, n, &all)
}

/// Rotation about the axis of a coordinate by each rate.
fn row_of(model: &Model, posture: &Posture, coordinate: usize) -> DVector<f64> {
    let mut row = DVector::zeros(model.rates().len());
    match model.three_axis_joint_of(coordinate) {
        Some((joint, place)) => {
            let joint = &model.three_axis_joints()[joint];
            let hinges = joint.orientation(posture.values()).hinges;
            for (k, i) in joint.coordinates.into_iter().enumerate() {
                row[model.coordinates()[i].rate.unwrap()] = hinges[(place, k)];
            }
        }
        None => row[model.coordinates()[coordinate].rate.unwrap()] = 1.0,
    }
    row
}

#[test]
fn the_slope_is_that_of_the_motion_which_feet_and_goals_allow() {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_070_711);
    println!("closed chains: seed {seed}");
    let mut random = Pcg64::seed_from_u64(seed);
    let model = adult(&Adult::default()).unwrap();
    let n = model.rates().len();
    let hand = model.segment("hand_r").unwrap();
    let loads = [Load::weight(&model, hand, 2.0)];
    let feet: Vec<Support> = ["calcn_r", "calcn_l"]
        .map(|name| {
            let segment = model.segment(name).unwrap();
            let corners = model.segments()[segment].patch.clone();
            Support {
                segment,
                corners,
                normal: Vector3::y(),
                friction: f64::INFINITY,
                share_max: 1.0,
                place: contrapposto::contact::Place::Fixed,
            }
        })
        .to_vec();
    let (mut compared, mut worst, mut alone) = (0, 0f64, 0f64);
    for k in 0..24 {
        let mut posture = model.default_posture();
        for (value, coordinate) in posture.values_mut().iter_mut().zip(model.coordinates()) {
            if coordinate.groups.is_some() {
                *value += random.random_range(-0.06..0.06);
            }
        }
        let mut kinematics = Kinematics::new(&model);
        kinematics.update(&model, &posture).unwrap();
        let point = Vector3::new(0.0, -0.05, 0.02);
        let task = Point { segment: hand, point, target: kinematics.station(&model, hand, point), axes: [true; 3] };
        let above = usize::from(k % 2 == 1);
        let goals: Vec<PriorityLevel> = (0..above).map(|_| Task::Point(task).into()).collect();
        let rows = rows(&model, &kinematics, &feet, goals.first().map(|_| &task));
        let projection = DMatrix::identity(n, n) - rows.clone().pseudo_inverse(1e-10).unwrap() * &rows;
        let mut engine =
            Engine::with_supports(&model, &posture, feet.clone(), goals, &loads, Options::least_effort()).unwrap();
        let mut scale = Scale {
            model: &model,
            torques: JointTorques::new(&model),
            contact: ContactForces::new(&model, feet.clone()).unwrap(),
            loads: &loads,
        };
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            let (Some(rate), true) = (coordinate.rate, coordinate.groups.is_some()) else { continue };
            let slope = engine.slope_along(&posture, rate, above).unwrap().unwrap();
            // The row of the rate: the rotation about the axis of a three-axis joint, else the rate itself.
            let turning = row_of(&model, &posture, i);
            let projected = &projection * &turning;
            let along: DVector<f64> = &projected / turning.dot(&projected);
            let mut at = |by: f64| {
                let mut moved = posture.clone();
                moved.displace(&model, (by * &along).as_slice());
                scale.weigh(&moved, rate)
            };
            let (Some(before), Some(after)) = (at(-STEP), at(STEP)) else { continue };
            let mut alone_at = |by: f64| {
                let moved = moved_about_axis(&model, &posture, rate, by);
                scale.torques.update(&model, &moved, &loads, Quantities::TORQUES).unwrap();
                scale.torques.passive_torque().about_axes()[rate]
            };
            let passive = [STEP, -STEP].map(&mut alone_at);
            let found = (after - before - passive[0] + passive[1]) / (2.0 * STEP);
            let off = (found - slope).abs() / (1.0 + slope.abs());
            worst = worst.max(off);
            compared += 1;
            scale.torques.update(&model, &posture, &loads, Quantities::ALL).unwrap();
            let own_slope = scale.torques.gradient_about_axes().get(rate, rate);
            alone = alone.max((own_slope - slope).abs());
        }
    }
    println!(
        "{compared} slopes off by {worst:.1e} of themselves at most; turned alone they would be up to {alone:.0} \
        N m/rad away"
    );
    assert!(compared > 400 && alone > 10.0, "{compared}");
    assert!(worst < 1e-4, "{worst}");
    // A knee between a foot that stays and a hip that is locked does not move.
    let start = model.default_posture();
    let mut engine = Engine::with_supports(&model, &start, feet, vec![], &loads, Options::least_effort()).unwrap();
    let knee = model.coordinates()[model.coordinate("knee_angle_r").unwrap()].rate.unwrap();
    assert!(engine.slope_along(&start, knee, 0).unwrap().is_some());
    (0..n).filter(|rate| *rate != knee).for_each(|rate| engine.lock(rate));
    assert_eq!(engine.slope_along(&start, knee, 0).unwrap(), None);
}
