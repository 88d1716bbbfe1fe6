//! Tests forces of bodies whose muscles share the torques of joints, against the closed form of a zonotope.

use crate::common::muscled_arm;

use std::fmt::Write as _;

use contrapposto::capacity::{Capacity, Demand, Limiter, People, Situation, Station};
use contrapposto::fatigue::FatigueLaw;
use contrapposto::joint_torques::{JointMuscles, JointTorques, Quantities};
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use contrapposto_formats::tissue::MuscleUse;
use muscled_arm::{arm, opened};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A point of a hand-like segment.
const POINT: [f64; 3] = [0.02, -0.3, 0.01];

/// Three segments on joints about three axes, with muscles between random points of random segments.
fn random_arm(rng: &mut Pcg64) -> String {
    let parents = ["/ground", "/bodyset/a", "/bodyset/b", "/bodyset/c"];
    let ends = [(0, 1), (0, 1), (1, 2), (1, 2), (2, 3), (2, 3), (0, 2), (1, 3), (0, 3)];
    let mut muscles = String::new();
    // Each with another one about opposite to it, so that every joint has strength on both sides.
    for (m, (from, to)) in ends.into_iter().flat_map(|ends| [ends; 2]).enumerate() {
        let sense = if m.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut point = |segment: usize| {
            let [x, y, z] = std::array::from_fn(|_| rng.random_range(0.02..0.08));
            let y = if segment == 0 { y } else { -2.0 * y };
            let parent = parents[segment];
            format!(
                "<PathPoint name=\"p{segment}\"><socket_parent_frame>{parent}</socket_parent_frame>
                 <location>{} {y} {}</location></PathPoint>",
                sense * x,
                sense * z * if m % 4 < 2 { 1.0 } else { -1.0 }
            )
        };
        let path = point(from) + &point(to);
        write!(
            muscles,
            "<Thelen2003Muscle name=\"m{m}\"><GeometryPath><PathPointSet><objects>{path}</objects></PathPointSet></GeometryPath>
             <max_isometric_force>{}</max_isometric_force><optimal_fiber_length>0.2</optimal_fiber_length>
             <tendon_slack_length>{}</tendon_slack_length></Thelen2003Muscle>",
            900 + 50 * m,
            0.05 + 0.3 * f64::from(u8::try_from(to - from).unwrap() - 1)
        )
        .unwrap();
    }
    let (mut bodies, mut joints) = (String::new(), String::new());
    let axes = [("first", "0 0 0"), ("second", "1.3 0 0.2"), ("third", "0.2 0.9 0")];
    for (k, (coordinate, turned)) in axes.into_iter().enumerate() {
        let name = ["a", "b", "c"][k];
        write!(bodies, "<Body name=\"{name}\"><mass>0.5</mass><mass_center>0 -0.15 0</mass_center></Body>").unwrap();
        let place = if k == 0 { "0 0 0" } else { "0 -0.3 0" };
        write!(
            joints,
            "<PinJoint name=\"j{k}\"><socket_parent_frame>p{k}</socket_parent_frame><socket_child_frame>c{k}</socket_child_frame>
             <coordinates><Coordinate name=\"{coordinate}\"><range>-2 2</range></Coordinate></coordinates>
             <frames><PhysicalOffsetFrame name=\"p{k}\"><socket_parent>{}</socket_parent><translation>{place}</translation>
             <orientation>{turned}</orientation></PhysicalOffsetFrame>
             <PhysicalOffsetFrame name=\"c{k}\"><socket_parent>/bodyset/{name}</socket_parent><translation>0 0 0</translation>
             <orientation>{turned}</orientation></PhysicalOffsetFrame></frames></PinJoint>",
            parents[k]
        )
        .unwrap();
    }
    format!(
        "<OpenSimDocument Version=\"40500\"><Model name=\"m\"><BodySet><objects>{bodies}</objects></BodySet>
         <JointSet><objects>{joints}</objects></JointSet><ForceSet><objects>{muscles}</objects></ForceSet></Model></OpenSimDocument>"
    )
}

/// A body with its muscles in a posture.
struct Body {
    model: Model,
    muscles: JointMuscles,
    posture: Posture,
    station: Station,
}

impl Body {
    fn new(bytes: &str, angles: &[f64]) -> Self {
        let [mut opened, library] = opened(bytes.as_bytes(), MuscleUse::Strength);
        let mut muscles = opened.joint_muscles(&library).0.unwrap();
        let mut model = opened.model;
        let posture = Posture::new(angles.to_vec());
        muscles.pose(&mut model, &posture).unwrap();
        let station = Station { segment: model.segments().len() - 1, point: POINT.into() };
        Self { model, muscles, posture, station }
    }

    fn capacity(&self, by_muscles: bool, demand: Demand) -> Option<Capacity> {
        let Self { model, muscles, posture, station } = self;
        let muscles = by_muscles.then_some(muscles);
        let situation = Situation { model, posture, loads: &[], supports: &[], muscles };
        Capacity::new(&situation, *station, demand).unwrap()
    }

    /// Active torque of every rate while the body exerts a force.
    fn active(&self, force: Vector3<f64>) -> Vec<f64> {
        let mut torques = JointTorques::new(&self.model).with_muscles(Some(self.muscles.clone()));
        let Station { segment, point } = self.station;
        let load = Load { segment, point, kind: LoadKind::Force(-force, FixedIn::World) };
        torques.update(&self.model, &self.posture, &[load], Quantities::TORQUES).unwrap();
        torques.active_torque().to_vec()
    }
}

/// Share of the strength of every muscle that a demand leaves, by the group for which it works.
fn capacities(body: &Body, demand: Demand) -> Vec<f64> {
    let mut torques = JointTorques::new(&body.model).with_muscles(Some(body.muscles.clone()));
    torques.update(&body.model, &body.posture, &[], Quantities::TORQUES).unwrap();
    let share = torques.muscle_share(&body.model).unwrap();
    let laws = share.laws.iter().map(|law| FatigueLaw::ThreeCompartment(law.clone()));
    laws.map(|law| demand.hold.map_or(1.0, |seconds| law.load_held_for(seconds))).collect()
}

#[test]
fn forces_of_shared_muscles_are_the_support_function_of_their_zonotope() {
    let (mut worst, mut arms, mut narrower, mut directions) = (0f64, 0, 0, 0);
    for seed in 0..12 {
        let rng = &mut Pcg64::seed_from_u64(4700 + seed);
        let angles: Vec<f64> = (0..3).map(|_| rng.random_range(-0.6..0.6)).collect();
        let body = Body::new(&random_arm(rng), &angles);
        let n = body.model.rates().len();
        assert_eq!((n, body.muscles.strong()), (3, &[0, 1, 2][..]));
        let at_rest = body.active(Vector3::zeros());
        let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| {
            let with = body.active(axis);
            Vector3::from_fn(|rate, _| with[rate] - at_rest[rate])
        });
        let transposed = Matrix3::from_columns(&columns);
        let Some(inverse) = transposed.transpose().try_inverse().filter(|_| transposed.determinant().abs() > 1e-3)
        else {
            continue;
        };
        for demand in [Demand::default(), Demand { hold: Some(120.0), people: People::Mean }] {
            let Some(mut capacity) = body.capacity(true, demand) else { continue };
            let (solid, shares) = (capacity.solid(), capacities(&body, demand));
            let pulls: Vec<(Vector3<f64>, f64)> = body
                .muscles
                .musculature()
                .muscles
                .iter()
                .zip(body.muscles.forces())
                .zip(&shares)
                .map(|((muscle, force), share)| {
                    let arms = body.muscles.about_axes().moment_arms(muscle.spec().path);
                    (Vector3::from_fn(|rate, _| arms[rate] * force), *share)
                })
                .collect();
            for found in &solid.forces {
                let along = inverse * found.normal;
                let of_muscles: f64 = pulls.iter().map(|(pull, share)| share * along.dot(pull).max(0.0)).sum();
                let expected = of_muscles - along.dot(&Vector3::from_column_slice(&at_rest));
                worst = worst.max((found.force - expected).abs() / expected.abs().max(1.0));
                // Where no muscle pulls against the force, the weight alone limits it.
                let shares: f64 = found.limits.iter().map(|limit| limit.share).sum();
                let by_strength = found.limits.iter().all(|limit| matches!(limit.by, Limiter::Strength { .. }));
                assert!(by_strength || of_muscles < 1e-9 * found.force, "{found:?} {of_muscles}");
                // One percent more of every strength is one percent more of the torques of muscles.
                worst = worst.max((shares - of_muscles / found.force).abs() / shares.max(1.0));
                // The strengths of all joints at once would be more: muscles that cross several joints cannot give all of them.
                let of_joint =
                    |k: usize| -> f64 { pulls.iter().map(|(pull, share)| share * (along[k] * pull[k]).max(0.0)).sum() };
                let of_joints: f64 = (0..3).map(of_joint).sum();
                assert!(of_muscles <= of_joints * (1.0 + 1e-9), "{of_muscles} {of_joints}");
                narrower += usize::from(of_muscles < 0.95 * of_joints);
                directions += 1;
            }
            arms += 1;
        }
    }
    println!(
        "{arms} arms: {worst:.1e} from the closed form, {narrower} of {directions} planes nearer than by joints alone"
    );
    assert!(arms >= 8 && worst < 1e-9 && 10 * narrower > directions, "{arms} {worst:e} {narrower} {directions}");
}

#[test]
fn one_muscle_on_each_side_of_a_joint_gives_the_share_of_strength_that_the_joint_gives() {
    let body = Body::new(&arm(), &[0.4]);
    let across = Vector3::new(libm::cos(0.4), libm::sin(0.4), 0.0);
    let at_rest = body.active(Vector3::zeros())[0];
    let muscles = body.muscles.musculature().muscles.iter().zip(body.muscles.forces());
    let torques: Vec<f64> =
        muscles.map(|(muscle, force)| force * body.muscles.about_axes().moment_arms(muscle.spec().path)[0]).collect();
    assert!(torques[0] > 10.0 && torques[1] < -0.1, "{torques:?}");
    for direction in [across, -across] {
        let lever = body.active(direction)[0] - at_rest;
        let own = torques.iter().map(|torque| (torque / lever).max(0.0)).sum::<f64>();
        let force = |by_muscles, demand| body.capacity(by_muscles, demand).unwrap().in_direction(&direction);
        let strength = |demand| force(false, demand).force + at_rest / lever;
        for hold in [None, Some(60.0)] {
            for people in [People::Mean, People::Weaker, People::Stronger] {
                let demand = Demand { hold, people };
                let share = strength(demand) / strength(Demand::default());
                let [joint, muscle] = [force(false, demand), force(true, demand)];
                let expected = share * own - at_rest / lever;
                assert!((muscle.force - expected).abs() < 1e-9 * expected, "{demand:?} {share}: {muscle:?} {expected}");
                assert_eq!(joint.limits[0].by, muscle.limits[0].by);
                assert!((muscle.limits[0].share - share * own / expected).abs() < 1e-9, "{muscle:?}");
            }
        }
    }
}
