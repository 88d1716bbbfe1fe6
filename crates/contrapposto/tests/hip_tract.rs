//! Tests the band of a hip against the balance of a leg that hangs in the modified Ober test, computed by statics of the whole body.

use contrapposto::joint_torques::{HipTract, JointTorques, Quantities, hip_tract};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Side, adult};
use contrapposto::muscle::{Musculature, bushing_torque};
use contrapposto::posture::Posture;

/// The adult without passive torque of its own, so that a leg hangs on nothing else.
fn body() -> Model {
    let body = adult(&Adult::default()).unwrap();
    (0..body.coordinates().len()).fold(body, |body, i| body.with_passive_law(i, None))
}

fn tract(body: &Model, name: &str, deviations: f64) -> HipTract {
    let adduction = body.coordinate(name).unwrap();
    hip_tract(body, &Musculature::default(), (adduction, Side::Positive), deviations).unwrap().unwrap()
}

/// The posture of the test: the body lies on the side of the other leg, this leg adducted.
fn lying(body: &Model, name: &str, angle: f64) -> Posture {
    let mut posture = body.default_posture();
    let mut set = |name: &str, value: f64| posture.values_mut()[body.coordinate(name).unwrap()] = value;
    // The right side is up when the pelvis rolls to the left.
    set("pelvis_list", if name.ends_with("_r") { -1.0 } else { 1.0 } * std::f64::consts::FRAC_PI_2);
    set(name, angle);
    posture
}

#[test]
fn a_relaxed_leg_hangs_in_the_test_at_the_published_angle() {
    let body = body();
    for name in ["hip_adduction_r", "hip_adduction_l"] {
        for (deviations, degrees) in [(0.0, 24.6), (-1.0, 17.3), (1.0, 31.9)] {
            let tract = tract(&body, name, deviations);
            assert!((tract.angle.to_degrees() - degrees).abs() < 1e-9);
            let posture = lying(&body, name, tract.angle);
            let mut torques = JointTorques::new(&body);
            torques.update(&body, &posture, &[], Quantities::TORQUES).unwrap();
            let rate = body.coordinates()[body.coordinate(name).unwrap()].rate.unwrap();
            let mut band = vec![0.0; body.rates().len()];
            bushing_torque(std::slice::from_ref(&tract.bushing), &body, torques.kinematics(), &mut band);
            let weight = torques.external_torque().torques()[rate];
            println!("{name} at {degrees}: weight of the leg {weight:.2} N m, band {:.2} N m", band[rate]);
            assert!(weight > 20.0 && (weight + band[rate]).abs() < 1e-9 * weight, "{weight} {}", band[rate]);
            assert!((tract.torque() - weight).abs() < 1e-9 * weight);
        }
    }
}

#[test]
fn the_band_resists_adduction_alone_and_is_the_gradient_of_an_energy() {
    let body = body();
    let tract = tract(&body, "hip_adduction_r", 0.0);
    let names = ["hip_flexion_r", "hip_adduction_r", "hip_rotation_r"];
    let coordinates = names.map(|name| body.coordinate(name).unwrap());
    let mut kinematics = Kinematics::new(&body);
    let mut torque = vec![0.0; body.rates().len()];
    for angles in [[0.0, 0.3, 0.0], [0.4, 0.3, -0.2], [1.2, -0.3, 0.5], [-0.2, 0.5, 0.3]] {
        let mut posture = body.default_posture();
        coordinates.iter().zip(angles).for_each(|(&i, angle)| posture.values_mut()[i] = angle);
        kinematics.update(&body, &posture).unwrap();
        bushing_torque(std::slice::from_ref(&tract.bushing), &body, &kinematics, &mut torque);
        for (place, &i) in coordinates.iter().enumerate() {
            let rate = body.coordinates()[i].rate.unwrap();
            let energy = [1e-6, -1e-6].map(|by| {
                let mut moved = posture.clone();
                moved.values_mut()[i] += by;
                let mut kinematics = Kinematics::new(&body);
                kinematics.update(&body, &moved).unwrap();
                tract.bushing.energy(&body, &kinematics)
            });
            let slope = -(energy[0] - energy[1]) / 2e-6;
            assert!((torque[rate] - slope).abs() < 1e-6 * (1.0 + slope.abs()), "{} {slope}", torque[rate]);
            if angles[0] == 0.0 {
                let expected = if place == 1 { -tract.torque() * libm::exp(8.0 * (0.3 - tract.angle)) } else { 0.0 };
                assert!((torque[rate] - expected).abs() < 1e-9, "{} {expected}", torque[rate]);
            }
        }
        let others = torque
            .iter()
            .enumerate()
            .filter(|(rate, _)| !coordinates.iter().any(|&i| body.coordinates()[i].rate == Some(*rate)));
        assert!(others.into_iter().all(|(_, torque)| torque.abs() < 1e-12));
    }
}

#[test]
fn a_coordinate_that_turns_no_leg_has_no_band() {
    let body = body();
    let root = body.coordinate("pelvis_list").unwrap();
    assert_eq!(hip_tract(&body, &Musculature::default(), (root, Side::Positive), 0.0).unwrap(), None);
}
