//! Tests joints of three hinges: no load of muscles depends on the angles that describe an orientation. Seeded;
//! `CONTRAPPOSTO_SEED` chooses another seed.

use std::f64::consts::{FRAC_PI_2, PI};

use contrapposto::joint_torques::{JointTorques, Quantities, effort, relative_load};
use contrapposto::math::SwingTwist;
use contrapposto::model::{
    Adult, CoordinateSpec, JointKind, Model, ModelBuilder, Placement, SegmentSpec, Sex, Side, ThreeAxisJoint, adult,
};
use contrapposto::posture::Posture;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

type V = Vector3<f64>;

fn random(test: &str) -> Pcg64 {
    let seed = std::env::var("CONTRAPPOSTO_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_070_711);
    println!("{test}: seed {seed}");
    Pcg64::seed_from_u64(seed)
}

fn whole_adult() -> Model {
    adult(&Adult::default()).unwrap()
}

/// Within a third of all ranges.
fn anywhere(rng: &mut Pcg64, model: &Model) -> Posture {
    let values = model.coordinates().iter().map(|c| {
        let third = (c.range.1 - c.range.0) / 3.0;
        rng.random_range(c.range.0 + third..c.range.1 - third)
    });
    Posture::new(values.collect())
}

fn loads(model: &Model) -> [Load; 2] {
    let hand = model.segment("hand_r").unwrap();
    let kind = LoadKind::Force(V::new(12.0, -30.0, 7.0), FixedIn::World);
    let foot = model.segment("calcn_l").unwrap();
    [Load { segment: hand, point: V::new(0.01, -0.1, 0.02), kind }, Load::weight(model, foot, 1.5)]
}

/// Per group: relative load, and fatigue after a minute of it; and the effort.
fn felt(model: &Model, body: &mut JointTorques, posture: &Posture) -> Vec<f64> {
    body.update(model, posture, &loads(model), Quantities::TORQUES).unwrap();
    let (mut felt, mut all) = (vec![], vec![]);
    for (i, coordinate) in model.coordinates().iter().enumerate() {
        let (Some(rate), Some(groups)) = (coordinate.rate, &coordinate.groups) else { continue };
        let active = body.active_torque()[rate];
        let load = relative_load(coordinate, body.angles()[i], active);
        let law = &groups[Side::of(active).index()].fatigue;
        felt.extend([load, law.advance(law.start(0.1, load), load, 60.0).level(load)]);
        all.push(load);
    }
    felt.push(effort(&all));
    felt
}

fn compare(worst: &mut f64, a: &[f64], b: &[f64]) {
    for (a, b) in a.iter().zip(b) {
        assert!(a.is_finite() && b.is_finite());
        *worst = worst.max((a - b).abs() / (1.0 + a.abs()));
    }
}

#[test]
fn both_triples_of_an_orientation_have_the_same_load_effort_and_fatigue() {
    let (model, mut rng) = (whole_adult(), random("triples"));
    let mut body = JointTorques::new(&model);
    let mut worst = 0f64;
    for joint in model.three_axis_joints() {
        for _ in 0..1000 {
            let mut posture = anywhere(&mut rng, &model);
            let triple = [0, 1, 2].map(|_| rng.random_range(-PI..PI));
            let other = [triple[0] + PI, PI - triple[1], triple[2] + PI];
            let [a, b] = [triple, other].map(|triple| {
                joint.coordinates.iter().zip(triple).for_each(|(i, q)| posture.values_mut()[*i] = q);
                felt(&model, &mut body, &posture)
            });
            compare(&mut worst, &a, &b);
        }
    }
    println!("off by {worst:.1e} at most");
    assert!(worst < 1e-9, "{worst}");
}

#[test]
fn ten_triples_of_an_orientation_in_gimbal_lock_have_the_same_load_effort_and_fatigue() {
    let (model, mut rng) = (whole_adult(), random("gimbal lock"));
    let mut body = JointTorques::new(&model);
    let mut worst = 0f64;
    for joint in model.three_axis_joints() {
        for k in 0..100 {
            let mut posture = anywhere(&mut rng, &model);
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let (first, third) = (rng.random_range(-PI..PI), rng.random_range(-PI..PI));
            let mut of = |turn: f64| {
                let triple = [first + turn, sign * FRAC_PI_2, third - sign * turn];
                joint.coordinates.iter().zip(triple).for_each(|(i, q)| posture.values_mut()[*i] = q);
                felt(&model, &mut body, &posture)
            };
            let one = of(0.0);
            (0..9).for_each(|_| compare(&mut worst, &one, &of(rng.random_range(-PI..PI))));
        }
    }
    println!("off by {worst:.1e} at most");
    assert!(worst < 1e-9, "{worst}");
}

/// Orientation and centre of a joint's moved frame in ground.
fn frame(model: &Model, body: &JointTorques, joint: &ThreeAxisJoint) -> Placement {
    let segment = &model.segments()[joint.segment];
    body.kinematics().placement(model, joint.segment) * segment.in_segment
}

/// The moment about the joint's centre of weights and loads of all that the joint carries, summed up anew.
fn moment(model: &Model, body: &JointTorques, joint: &ThreeAxisJoint, loads: &[Load]) -> V {
    let frame = frame(model, body, joint);
    let carried = |mut segment: usize| loop {
        if segment == joint.segment {
            return true;
        }
        match model.segments()[segment].parent {
            Some(parent) => segment = parent,
            None => return false,
        }
    };
    let about = |segment: usize, point: V, force: V| {
        (body.kinematics().station(model, segment, point) - frame.translation.vector).cross(&force)
    };
    let mut sum = V::zeros();
    for (i, segment) in model.segments().iter().enumerate().filter(|(i, _)| carried(*i)) {
        sum += about(i, segment.center_of_mass, segment.mass * model.gravity());
    }
    for load in loads.iter().filter(|load| carried(load.segment)) {
        sum += match load.kind {
            LoadKind::Force(force, FixedIn::World) => about(load.segment, load.point, force),
            LoadKind::Weight(mass) => about(load.segment, load.point, mass * model.gravity()),
            _ => panic!("another kind of load"),
        };
    }
    frame.rotation.inverse() * sum
}

fn of_joint(model: &Model, joint: &ThreeAxisJoint, by_rate: &[f64]) -> V {
    V::from(joint.coordinates.map(|i| by_rate[model.coordinates()[i].rate.unwrap()]))
}

#[test]
fn external_torque_about_axes_is_the_moment_of_weights_and_loads() {
    let (model, mut rng) = (whole_adult(), random("moment"));
    let mut body = JointTorques::new(&model);
    let mut worst = 0f64;
    for _ in 0..100 {
        let posture = anywhere(&mut rng, &model);
        body.update(&model, &posture, &loads(&model), Quantities::TORQUES).unwrap();
        for (joint, orientation) in model.three_axis_joints().iter().zip(body.passive_torque().orientations()) {
            let moment = moment(&model, &body, joint, &loads(&model));
            let found = of_joint(&model, joint, body.external_about_axes());
            let along = V::from(joint.axes.map(|axis| axis.dot(&moment)));
            worst = worst.max((found - along).norm() / (1.0 + moment.norm()));
            // Torques of the coordinates are A^T m.
            let by_coordinate = of_joint(&model, joint, body.external_torque().torques());
            worst = worst.max((orientation.hinges.tr_mul(&found) - by_coordinate).norm() / (1.0 + moment.norm()));
        }
    }
    println!("off by {worst:.1e} at most");
    assert!(worst < 1e-12, "{worst}");
}

#[test]
fn moments_turn_with_the_body() {
    let (model, mut rng) = (whole_adult(), random("turned body"));
    let yaw = model.coordinate("pelvis_rotation").unwrap();
    let still = ["pelvis_tilt", "pelvis_list"].map(|name| model.coordinate(name).unwrap());
    let mut bodies = [JointTorques::new(&model), JointTorques::new(&model)];
    let mut worst = 0f64;
    for _ in 0..100 {
        let mut posture = anywhere(&mut rng, &model);
        still.iter().for_each(|i| posture.values_mut()[*i] = 0.0);
        let angle = rng.random_range(-1.5..1.5);
        let mut turned = posture.clone();
        turned.values_mut()[yaw] += angle;
        let turn = UnitQuaternion::from_axis_angle(&V::y_axis(), angle);
        let turned_loads = loads(&model).map(|load| match load.kind {
            LoadKind::Force(force, frame) => Load { kind: LoadKind::Force(turn * force, frame), ..load },
            _ => load,
        });
        bodies[0].update(&model, &posture, &loads(&model), Quantities::TORQUES).unwrap();
        bodies[1].update(&model, &turned, &turned_loads, Quantities::TORQUES).unwrap();
        for joint in model.three_axis_joints() {
            let [a, b] = [0, 1].map(|k| of_joint(&model, joint, bodies[k].external_about_axes()));
            worst = worst.max((a - b).norm() / (1.0 + a.norm()));
        }
    }
    println!("off by {worst:.1e} at most");
    assert!(worst < 1e-12, "{worst}");
}

/// A woman of 1.65 m and 60 kg holds her arm out sideways: the published gimbal-lock example of three hinges at the shoulder.
#[test]
fn an_arm_held_out_sideways_weighs_the_same_by_any_angles() {
    let model = adult(&Adult { sex: Sex::Female, stature: 1.65, mass: 60.0, ..Adult::default() }).unwrap();
    let [flexion, adduction] = ["arm_flex_r", "arm_add_r"].map(|name| model.coordinate(name).unwrap());
    let (joint, _) = model.three_axis_joint_of(flexion).unwrap();
    let joint = &model.three_axis_joints()[joint];
    let mut body = JointTorques::new(&model);
    for angle in [0.0f64, 90.0] {
        let mut posture = model.default_posture();
        (posture.values_mut()[flexion], posture.values_mut()[adduction]) = (angle.to_radians(), -FRAC_PI_2);
        body.update(&model, &posture, &[], Quantities::TORQUES).unwrap();
        let moment = of_joint(&model, joint, body.external_about_axes()).norm();
        let by_coordinates = of_joint(&model, joint, body.external_torque().torques()).norm();
        println!("flexion {angle}: moment {moment:.3} N m, by coordinates {by_coordinates:.3} N m");
        assert!((moment - 7.19).abs() < 0.005, "{moment}");
    }
}

/// A uniform rod on three hinges: its weight has the moment `m g l/2 sin(swing)` in every orientation.
#[test]
fn a_rod_has_the_moment_of_its_swing() {
    let mut rng = random("rod");
    let (mass, length) = (2.0, 0.8);
    let mut builder = ModelBuilder::new("rod", V::new(0.0, -9.81, 0.0));
    let coordinates = ["a", "b", "c"].map(|name| CoordinateSpec::new(name, (-3.0, 3.0))).to_vec();
    builder
        .segment(SegmentSpec {
            name: "rod".to_owned(),
            parent: None,
            mass,
            center_of_mass: V::new(0.0, -0.5 * length, 0.0),
            inertia: Matrix3::identity(),
            joint: "ball".to_owned(),
            kind: JointKind::Gimbal([V::z_axis(), V::x_axis(), V::y_axis()]),
            coordinates,
            in_parent: Placement::identity(),
            in_segment: Placement::identity(),
        })
        .unwrap();
    let model = builder.build();
    let joint = &model.three_axis_joints()[0];
    assert_eq!((joint.name.as_str(), joint.swing_twist.twist()), ("ball", 2));
    let mut body = JointTorques::new(&model);
    for _ in 0..200 {
        let posture = Posture::new((0..3).map(|_| rng.random_range(-PI..PI)).collect());
        body.update(&model, &posture, &[], Quantities::TORQUES).unwrap();
        let along = body.kinematics().direction(&model, 0, V::new(0.0, -1.0, 0.0));
        let expected = mass * 9.81 * 0.5 * length * along.cross(&-V::y()).norm();
        let found = of_joint(&model, joint, body.external_about_axes());
        assert!((found.norm() - expected).abs() < 1e-12 * mass * 9.81 * length);
        assert!(found[2].abs() < 1e-12 * mass * 9.81 * length, "weight twists no rod");
    }
}

#[test]
fn angles_of_one_coordinate_alone_are_the_coordinate() {
    let model = whole_adult();
    let names: Vec<&str> = model.three_axis_joints().iter().map(|joint| joint.name.as_str()).collect();
    println!("{names:?}");
    assert_eq!(names.len(), 7, "{names:?}");
    for joint in model.three_axis_joints() {
        assert_eq!(joint.swing_twist.twist(), 2, "{}: the long axis is that of the last hinge", joint.name);
        let shoulder = joint.swing_twist.reference() != [0.0; 3];
        assert_eq!(shoulder, model.coordinates()[joint.coordinates[0]].name.starts_with("arm"), "{}", joint.name);
        for (k, &i) in joint.coordinates.iter().enumerate() {
            let mut values = vec![0.0; model.coordinates().len()];
            let (low, high) = model.coordinates()[i].range;
            for step in 0..=10 {
                values[i] = low + (high - low) * f64::from(step) / 10.0;
                let angles = joint.orientation(&values).angles.values;
                if !shoulder {
                    assert!(
                        (angles[k] - values[i]).abs() < 1e-12 && (angles.iter().sum::<f64>() - values[i]).abs() < 1e-12
                    );
                }
                // Half a turn of swing lies outside all ranges.
                let swing = |k: usize| angles[k] - joint.swing_twist.reference()[k];
                assert!(libm::hypot(swing(0), swing(1)) < 175f64.to_radians(), "{}: {angles:?}", joint.name);
            }
        }
    }
}

#[test]
fn derivatives_of_swing_and_twist_are_central_differences() {
    let mut rng = random("swing and twist");
    let axes = [V::z(), V::x(), V::y()];
    let mirrored = [V::z(), -V::x(), -V::y()];
    let left_handed = [V::z(), V::x(), -V::y()];
    let (mut worst, mut back) = ([0f64; 2], 0f64);
    for (axes, twist, reference) in
        [(axes, 2, [0.0; 3]), (mirrored, 2, [0.5, -0.7, 0.0]), (left_handed, 0, [0.0, 0.3, -0.2]), (axes, 1, [0.0; 3])]
    {
        let of = SwingTwist::new(axes, twist, reference);
        for k in 0..200 {
            // Small turns too, where the formulas are series.
            let size = [1.0, 1e-2, 1e-5][k % 3];
            let around = V::new(rng.random_range(-1.2..1.2), rng.random_range(-1.2..1.2), rng.random_range(-1.2..1.2));
            let rotation = UnitQuaternion::from_scaled_axis(size * around);
            let exact = of.angles(&rotation);
            back = back.max(of.orientation(exact.values).angle_to(&rotation));
            let h = 1e-5;
            for (m, axis) in axes.iter().enumerate() {
                let [up, down] = [h, -h].map(|h| of.angles(&(rotation * UnitQuaternion::from_scaled_axis(h * axis))));
                for j in 0..3 {
                    let slope = (up.values[j] - down.values[j]) / (2.0 * h);
                    worst[0] = worst[0].max((slope - exact.first[(j, m)]).abs());
                    for l in 0..3 {
                        let slope = (up.first[(j, l)] - down.first[(j, l)]) / (2.0 * h);
                        worst[1] = worst[1].max((slope - exact.second[j][(m, l)]).abs());
                    }
                }
            }
        }
    }
    println!("first derivatives off by {:.1e}, second by {:.1e}, orientations by {back:.1e}", worst[0], worst[1]);
    assert!(worst[0] < 1e-8 && worst[1] < 1e-7 && back < 1e-7, "{worst:?} {back}");
}

/// The table along an axis holds the passive torque at every turn about it, where that falls.
#[test]
fn table_along_an_axis_is_the_passive_torque_of_the_turned_joint() {
    let (model, mut rng) = (whole_adult(), random("arc"));
    let mut body = JointTorques::new(&model);
    let (mut compared, mut level, mut worst) = (0, 0, 0f64);
    for _ in 0..20 {
        let posture = anywhere(&mut rng, &model);
        body.update(&model, &posture, &[], Quantities::TORQUES).unwrap();
        for joint in model.three_axis_joints() {
            for (k, &i) in joint.coordinates.iter().enumerate() {
                let coordinate = &model.coordinates()[i];
                let rate = coordinate.rate.unwrap();
                let passive = body.passive_torque();
                let curve = passive.curve_about_axis(&model, body.kinematics(), i, coordinate.range).unwrap();
                let now = passive.angles()[i];
                assert!(
                    (curve.torque(now) - passive.about_axes()[rate]).abs() < 1e-12 * (1.0 + curve.torque(now).abs())
                );
                let (low, high) = curve.range();
                let mut moved = JointTorques::new(&model);
                for _ in 0..5 {
                    let turn = rng.random_range(0.9 * (low - now)..0.9 * (high - now));
                    // A few degrees: the coordinates follow by Newton steps.
                    let turn = turn.clamp(-0.3, 0.3);
                    let Some(there) = turned(&model, &posture, joint, k, turn) else { continue };
                    moved.update(&model, &there, &[], Quantities::TORQUES).unwrap();
                    let exact = moved.passive_torque().about_axes()[rate];
                    // Bending a flexed trunk against the torque of its flexion rises: there the table stays level.
                    if (1..=8).any(|part| curve.slope(now + turn * f64::from(part) / 8.0) == 0.0) {
                        level += 1;
                        continue;
                    }
                    worst = worst.max((curve.torque(now + turn) - exact).abs() / (1.0 + exact.abs()));
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} turns, off by {worst:.1e} at most; {level} level");
    assert!(compared > 1900 && worst < 0.02, "{compared} {worst}");
}

/// The posture after a turn about an axis, by Newton steps of the coordinates.
fn turned(model: &Model, posture: &Posture, joint: &ThreeAxisJoint, axis: usize, turn: f64) -> Option<Posture> {
    let mut moved = posture.clone();
    let goal = joint.rotation(posture.values()) * UnitQuaternion::from_scaled_axis(turn * joint.axes[axis]);
    for _ in 0..20 {
        let left = (joint.rotation(moved.values()).inverse() * goal).scaled_axis();
        let left = V::from(joint.axes.map(|axis| axis.dot(&left)));
        let step = joint.orientation(moved.values()).hinges.lu().solve(&left)?;
        joint.coordinates.iter().zip(step.iter()).for_each(|(i, step)| moved.values_mut()[*i] += step);
    }
    assert_eq!(moved.values().len(), model.coordinates().len());
    (joint.rotation(moved.values()).angle_to(&goal) < 1e-9).then_some(moved)
}
