//! Derives the load of the shoulders anew, in every posture that the search for least effort finds in the scenarios of the
//! repository: the moment of weights, loads and contact forces summed up in ground, passive torque from differences of energy.

use contrapposto::contact::ContactForces;
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::model::{Model, Side, ThreeAxisJoint};
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto_formats::RelaxScenario;
use nalgebra::{UnitQuaternion, Vector3};

use crate::common::runs::searches;

type V = Vector3<f64>;

/// Step of the differences of energy, rad.
const STEP: f64 = 1e-5;

/// Moment about the centre of a joint of all that acts on the segments that it carries, in the distal frame, N m.
fn moment(model: &Model, body: &JointTorques, joint: &ThreeAxisJoint, loads: &[Load]) -> V {
    let kinematics = body.kinematics();
    let frame = kinematics.placement(model, joint.segment) * model.segments()[joint.segment].in_segment;
    let carried = |segment: usize| {
        std::iter::successors(Some(segment), |s| model.segments()[*s].parent).any(|s| s == joint.segment)
    };
    let about = |segment: usize, point: V, force: V| {
        (kinematics.station(model, segment, point) - frame.translation.vector).cross(&force)
    };
    let weights = model.segments().iter().enumerate().filter(|(i, _)| carried(*i));
    let mut sum: V = weights.map(|(i, s)| about(i, s.center_of_mass, s.mass * model.gravity())).sum();
    for load in loads.iter().filter(|load| carried(load.segment)) {
        sum += match load.kind {
            LoadKind::Force(force, FixedIn::World) => about(load.segment, load.point, force),
            LoadKind::Weight(mass) => about(load.segment, load.point, mass * model.gravity()),
            _ => panic!("no scenario has another kind of load"),
        };
    }
    frame.rotation.inverse() * sum
}

/// Passive torque about an axis, N m, as minus the slope of the energy of the joint's curves along a turn about it.
fn passive(model: &Model, joint: &ThreeAxisJoint, values: &[f64], axis: V) -> f64 {
    let energy = |turn: f64| -> f64 {
        let rotation = joint.rotation(values) * UnitQuaternion::from_scaled_axis(turn * axis);
        let angles = joint.swing_twist.angles(&rotation).values;
        let of = |(i, angle): (usize, f64)| {
            let coordinate = &model.coordinates()[i];
            assert!((coordinate.range.0..coordinate.range.1).contains(&angle), "{} at {angle}", coordinate.name);
            coordinate.curve().map_or(0.0, |curve| curve.energy(angle))
        };
        joint.coordinates.into_iter().zip(angles).map(of).sum()
    };
    (energy(-STEP) - energy(STEP)) / (2.0 * STEP)
}

#[test]
fn load_of_the_shoulders_is_that_of_their_moment_in_every_posture_found() {
    let (mut compared, mut worst) = (0, 0f64);
    for name in [
        "bus-stop.toml",
        "counter.toml",
        "crouch.toml",
        "hold-tool.toml",
        "lean-on-table.toml",
        "lift-box.toml",
        "overhead.toml",
        "push.toml",
        "reach-floor.toml",
        "screw-overhead.toml",
        "sit-and-type.toml",
        "sit-slumped.toml",
        "stand-ready.toml",
        "stand-relaxed.toml",
        "stand-shifting.toml",
    ] {
        let (_, RelaxScenario { model, supports, loads, .. }, found) =
            searches().iter().find(|(found, ..)| found == name).unwrap();
        let mut body = JointTorques::new(model);
        let mut contact = ContactForces::new(model, supports.clone()).unwrap();
        for posture in &found.postures {
            let values = posture.relaxed.posture.values();
            for (coordinate, value) in model.coordinates().iter().zip(values) {
                let (low, high) = coordinate.range;
                assert!((low..=high).contains(value), "{} at {value} outside {low}..{high}", coordinate.name);
            }
            contact.forget();
            body.update_with_contact(model, &posture.relaxed.posture, loads, &mut contact, Quantities::TORQUES)
                .unwrap();
            for joint in model.three_axis_joints().iter().filter(|joint| joint.name.starts_with("shoulder")) {
                let all: Vec<Load> = loads.iter().chain(contact.loads()).copied().collect();
                let moment = moment(model, &body, joint, &all);
                for (axis, i) in joint.axes.iter().zip(joint.coordinates) {
                    let needed = -(axis.dot(&moment) + passive(model, joint, values, *axis));
                    let group = &model.coordinates()[i].groups.as_ref().unwrap()[Side::of(needed).index()];
                    let expected = needed.abs() / group.strength.torque(body.angles()[i]);
                    let work = posture.work.iter().find(|work| work.coordinate == i).unwrap();
                    worst = worst.max((work.relative_load() - expected).abs());
                    compared += 1;
                }
            }
        }
        println!("{name}: {} postures", found.postures.len());
    }
    println!("{compared} loads, off by {worst:.1e} at most");
    assert!(compared > 100 && worst < 1e-6, "{compared} {worst}");
}
