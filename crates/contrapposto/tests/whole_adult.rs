//! The whole built-in adult is complete, symmetric and upright, and every leg and spine coordinate turns the way its name says.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, AdultError, CoordinateKind, Model, Sex, adult, data::library};
use contrapposto::passive::PassiveLaw;
use contrapposto::posture::Posture;
use contrapposto::statics::{ExternalTorque, Gradient};
use nalgebra::Vector3;

fn woman() -> Adult {
    Adult { sex: Sex::Female, stature: 1.65, mass: 60.0, ..Adult::default() }
}

/// Position of a segment's centre of mass with the named angles in degrees.
fn center(model: &Model, segment: &str, degrees: &[(&str, f64)]) -> Vector3<f64> {
    let mut posture = model.default_posture();
    for (name, value) in degrees {
        posture.values_mut()[model.coordinate(name).unwrap()] = value.to_radians();
    }
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &posture).unwrap();
    let index = model.segment(segment).unwrap();
    kinematics.station(model, index, model.segments()[index].center_of_mass)
}

#[test]
fn masses_add_up_and_the_soles_stand_on_the_ground() {
    for size in [Adult::default(), woman()] {
        let model = adult(&size).unwrap();
        assert!((model.mass() - size.mass).abs() < 2e-3 * size.mass, "{} of {}", model.mass(), size.mass);
        let kinematics = Kinematics::new(&model);
        for toes in ["toes_r", "toes_l"] {
            let height = kinematics.placement(&model, model.segment(toes).unwrap()).translation.y;
            assert!(height.abs() < 1e-3, "{toes} at {height} m");
        }
        let head = model.segment("head").unwrap();
        let crown =
            kinematics.placement(&model, head).translation.y + 2.0 * model.segments()[head].center_of_mass.y.abs();
        // De Leva's segment lengths, stacked upright, exceed stature by a few percent.
        println!("{:?}: crown {crown:.3} m of {}", size.sex, size.stature);
        assert!((0.98..1.05).contains(&(crown / size.stature)));
    }
}

#[test]
fn every_coordinate_is_sourced() {
    let model = adult(&Adult::default()).unwrap();
    for coordinate in model.coordinates() {
        let sources = library().sources(&coordinate.name).unwrap_or_else(|| panic!("{}", coordinate.name));
        assert_eq!(sources.curve.is_some(), coordinate.passive.is_some(), "{}", coordinate.name);
        assert_eq!(sources.strength.is_some(), coordinate.groups.is_some(), "{}", coordinate.name);
        let root = coordinate.name.starts_with("pelvis_");
        // Neither muscles nor tissue of the girdle are known.
        let unknown = root || coordinate.name.starts_with("shoulder_rise");
        assert_eq!(coordinate.passive.is_none(), unknown, "{}", coordinate.name);
        assert!(coordinate.groups.iter().flatten().all(|g| g.strength.torque(coordinate.default) > 0.0));
        if root || coordinate.kind != CoordinateKind::Rotation {
            continue;
        }
        // Falls over the whole range with the neighbours at their defaults.
        let law = coordinate.passive.as_ref().unwrap();
        let i = model.coordinate(&coordinate.name).unwrap();
        let curve = law.curve_at(i, model.default_posture().values(), coordinate.range).unwrap();
        for k in 0..=1000 {
            let q = coordinate.range.0 + (coordinate.range.1 - coordinate.range.0) * f64::from(k) / 1000.0;
            assert!(curve.slope(q) <= 0.0, "{} at {}", coordinate.name, q.to_degrees());
        }
    }
    assert_eq!(model.coordinates().len(), 6 + 9 + 2 * 15);
}

#[test]
fn leg_laws_are_riener_and_edrich_in_our_signs() {
    let model = adult(&Adult::default()).unwrap();
    // Data sheet A2: (hip, knee, ankle plantarflexion in deg) -> torque on each in its own direction.
    for (h, k, a, name, sign, torque) in [
        (0.0, 0.0, 0.0, "hip_flexion_r", 1.0, 8.58),
        (30.0, 0.0, 0.0, "hip_flexion_l", 1.0, -1.01),
        (0.0, -5.0, 0.0, "knee_angle_r", 1.0, 21.87),
        (90.0, 90.0, 0.0, "knee_angle_l", 1.0, -3.54),
        (0.0, 0.0, -20.0, "ankle_angle_r", -1.0, 42.36),
        (0.0, 90.0, 0.0, "ankle_angle_l", -1.0, -0.11),
    ] {
        let side = &name[name.len() - 2..];
        let mut posture = model.default_posture();
        for (stem, value) in [("hip_flexion", h), ("knee_angle", k), ("ankle_angle", -a)] {
            posture.values_mut()[model.coordinate(&format!("{stem}{side}")).unwrap()] = f64::to_radians(value);
        }
        let i = model.coordinate(name).unwrap();
        let law = model.coordinates()[i].passive.as_ref().unwrap();
        assert!(matches!(law, PassiveLaw::Coupled(_)));
        let ours = law.torque(i, posture.values());
        assert!((ours - sign * torque).abs() < 0.01, "{name}: {ours}");
        let held = law.curve_at(i, posture.values(), model.coordinates()[i].range).unwrap();
        assert!((held.torque(posture.values()[i]) - ours).abs() < 1e-12, "{name}");
    }
}

#[test]
fn legs_and_spine_turn_the_way_their_names_say() {
    let model = adult(&Adult::default()).unwrap();
    let moved = |segment: &str, name: &str| center(&model, segment, &[(name, 10.0)]) - center(&model, segment, &[]);
    // x forward, y up, z right.
    for (segment, name, axis, sign) in [
        ("tibia_r", "hip_flexion_r", 0, 1.0),
        ("tibia_l", "hip_flexion_l", 0, 1.0),
        ("tibia_r", "hip_adduction_r", 2, -1.0),
        ("tibia_l", "hip_adduction_l", 2, 1.0),
        ("calcn_r", "hip_rotation_r", 2, -1.0), // inward
        ("calcn_l", "hip_rotation_l", 2, 1.0),
        ("tibia_r", "knee_angle_r", 0, -1.0), // flexion: backward
        ("tibia_l", "knee_angle_l", 0, -1.0),
        ("calcn_r", "ankle_angle_r", 1, 1.0), // dorsiflexion: the foot rises
        ("calcn_l", "ankle_angle_l", 1, 1.0),
        ("head", "lumbar_extension", 0, -1.0),
        ("head", "lumbar_bending", 2, 1.0),
        ("hand_r", "lumbar_rotation", 0, 1.0), // to the left: the right hand comes forward
        ("head", "thoracic_extension", 0, -1.0),
        ("head", "neck_bending", 2, 1.0),
        ("head", "pelvis_tilt", 0, -1.0),
        ("hand_l", "arm_flex_l", 0, 1.0),
        ("hand_l", "arm_add_l", 2, 1.0),
        ("hand_l", "elbow_flex_l", 0, 1.0),
    ] {
        let shift = moved(segment, name);
        assert!(sign * shift[axis] > 1e-3, "{name} moves {segment} by {shift:?}");
    }
    // Inversion turns the sole inward: its normal, down at rest, gains a part toward the middle.
    for (side, inward) in [("r", -1.0), ("l", 1.0)] {
        let mut posture = model.default_posture();
        posture.values_mut()[model.coordinate(&format!("subtalar_angle_{side}")).unwrap()] = 0.2;
        let mut kinematics = Kinematics::new(&model);
        kinematics.update(&model, &posture).unwrap();
        let foot = model.segment(&format!("calcn_{side}")).unwrap();
        assert!(inward * kinematics.direction(&model, foot, -Vector3::y()).z > 0.1, "{side}");
    }
}

#[test]
fn left_mirrors_right() {
    let model = adult(&woman()).unwrap();
    let mut posture = model.default_posture();
    for (i, coordinate) in model.coordinates().iter().enumerate() {
        if let Some(stem) = coordinate.name.strip_suffix("_r") {
            let value = coordinate.range.0 + 0.37 * (coordinate.range.1 - coordinate.range.0);
            posture.values_mut()[i] = value;
            posture.values_mut()[model.coordinate(&format!("{stem}_l")).unwrap()] = value;
        }
    }
    let mut kinematics = Kinematics::new(&model);
    kinematics.update(&model, &posture).unwrap();
    let mut external = ExternalTorque::new(&model);
    external.update(&model, &kinematics, &[]).unwrap();
    let torque = |name: &str| external.torques()[model.coordinates()[model.coordinate(name).unwrap()].rate.unwrap()];
    for coordinate in model.coordinates() {
        let Some(stem) = coordinate.name.strip_suffix("_r") else { continue };
        let (right, left) = (torque(&coordinate.name), torque(&format!("{stem}_l")));
        assert!((right - left).abs() < 1e-12, "{stem}: {right} and {left}");
    }
    for name in ["pelvis_list", "pelvis_rotation", "lumbar_bending", "lumbar_rotation"] {
        assert!(torque(name).abs() < 1e-9, "{name}: {}", torque(name));
    }
    assert!((torque("pelvis_ty") + model.mass() * 9.81).abs() < 1e-9);
    let mut gradient = Gradient::new(&model);
    external.gradient(&model, &kinematics, &mut gradient);
    assert!((0..gradient.size()).all(|i| (0..i).all(|j| gradient.get(i, j) == gradient.get(j, i))));
}

#[test]
fn measured_lengths_are_used_and_checked() {
    let long = Adult { lengths: vec![("femur".into(), 0.5), ("radius".into(), 0.3)], ..Adult::default() };
    let model = adult(&long).unwrap();
    let kinematics = Kinematics::new(&model);
    let origin = |name: &str| kinematics.placement(&model, model.segment(name).unwrap()).translation.vector;
    for side in ["r", "l"] {
        let thigh = (origin(&format!("tibia_{side}")) - origin(&format!("femur_{side}"))).norm();
        let forearm = (origin(&format!("hand_{side}")) - origin(&format!("ulna_{side}"))).norm();
        assert!((thigh - 0.5).abs() < 1e-12 && (forearm - 0.3).abs() < 1e-12);
    }
    assert!(origin("toes_r").y.abs() < 1e-3, "still on the ground");
    let unknown = Adult { lengths: vec![("tail".into(), 0.5)], ..Adult::default() };
    assert!(matches!(adult(&unknown), Err(AdultError::Length { .. })));
    for bad in [f64::NAN, 0.0, 5.0] {
        let size = Adult { lengths: vec![("femur".into(), bad)], ..Adult::default() };
        assert!(matches!(adult(&size), Err(AdultError::Size { .. })));
    }
    let zero = Posture::new(vec![0.0; model.coordinates().len()]);
    assert!(zero.check(&model).is_ok());
}
