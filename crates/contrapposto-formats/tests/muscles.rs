//! Compares lengths, moment arms and forces of muscles with OpenSim's, of published models that are not in this project.

use crate::common::muscle_reference;
use crate::common::shared;

use std::io::Read;

use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Side;
use contrapposto::muscle::{
    CoupledStrength, FiberState, PathGeometry, PathRule, Recruitment, StaticOptimisation, Tension, coupled_strength,
    passive_fiber_torque, passive_tensions, strength,
};
use contrapposto::statics::{ExternalTorque, PathTension};
use contrapposto_formats::osim;
use contrapposto_formats::tissue::{MuscleUse, Person, SourcedModel};
use muscle_reference::{Reference, model_bytes};

/// Largest errors that are allowed.
#[derive(Clone, Copy)]
struct Limits {
    length: f64,
    arm: f64,
    force: f64,
}

/// Compares all muscles without surfaces, or all of which the surfaces are of these kinds.
fn check(name: &str, bytes: &[u8], wraps: &[&str], limits: &Limits) {
    let reference = Reference::read(name, bytes, &shared(&format!("vectors/muscles/{name}.json.gz")));
    let errors = reference.errors(PathRule::OpenSim, wraps);
    println!("{name} {wraps:?}: {errors:#?}");
    assert!(errors.muscles > 0, "{name}: no muscle has surfaces {wraps:?}");
    assert!(errors.length.size <= limits.length, "{name}: {:?}", errors.length);
    assert!(errors.arm.size <= limits.arm, "{name}: {:?}", errors.arm);
    for error in [&errors.tendon, &errors.active, &errors.passive] {
        assert!(error.size <= limits.force, "{name}: {error:?}");
    }
    assert!(errors.imbalance.size <= 1e-9, "{name}: {:?}", errors.imbalance);
}

const THELEN: Limits = Limits { length: 1e-10, arm: 1e-9, force: 1e-7 };
const MILLARD: Limits = Limits { length: 1e-10, arm: 1e-9, force: 1e-6 };

#[test]
#[ignore = "needs ../shared: a published OpenSim model and OpenSim's numbers of its muscles"]
fn muscles_of_gait2392_thelen_are_opensims() {
    let bytes = std::fs::read(shared("models/opensim/gait2392_thelen2003muscle.osim")).unwrap();
    check("gait2392_thelen", &bytes, &[], &THELEN);
}

#[test]
#[ignore = "needs ../shared: a published OpenSim model and OpenSim's numbers of its muscles"]
fn muscles_of_arm26_without_surfaces_are_opensims() {
    let bytes = std::fs::read(shared("models/opensim/arm26.osim")).unwrap();
    check("arm26", &bytes, &[], &THELEN);
}

#[test]
#[ignore = "needs CONTRAPPOSTO_OPENSIM_MODELS: a folder of published full bodies and arms"]
fn muscles_of_fetched_bodies_are_opensims() {
    let (cylinder, cylinders) = (["WrapCylinder"], ["WrapCylinder"; 2]);
    let several = Limits { length: 1e-6, arm: 1e-6, force: 1e-6 };
    for (name, file, wraps, limits) in [
        ("gait2392_millard", "gait2392_millard2012muscle.osim", [].as_slice(), MILLARD),
        ("rajagopal2016", "Rajagopal2016.osim", &[], MILLARD),
        ("rajagopal2016", "Rajagopal2016.osim", &cylinder, MILLARD),
        ("rajagopal2016", "Rajagopal2016.osim", &cylinders, several),
        ("rajagopal_lai_uhlrich2023", "RajagopalLaiUhlrich2023.osim", &[], MILLARD),
        ("rajagopal_lai_uhlrich2023", "RajagopalLaiUhlrich2023.osim", &cylinder, MILLARD),
        ("rajagopal_lai_uhlrich2023", "RajagopalLaiUhlrich2023.osim", &cylinders, several),
        ("gait1018_dgf", "gait1018.osim", &[], THELEN),
        ("wrist", "wrist.osim", &[], MILLARD),
    ] {
        check(name, &model_bytes(file), wraps, &limits);
    }
}

#[test]
#[ignore = "needs CONTRAPPOSTO_OPENSIM_MODELS: published arms with all kinds of surfaces"]
fn muscles_of_arms_over_all_kinds_of_surfaces_are_opensims() {
    for (name, file) in
        [("arm26", "arm26.osim"), ("mobl2016_v04", "mobl2016_v04.osim"), ("mobl2016_v01", "mobl2016_v01.osim")]
    {
        let bytes = model_bytes(file);
        let reference = Reference::read(name, &bytes, &shared(&format!("vectors/muscles/{name}.json.gz")));
        for wraps in reference.wraps() {
            let wraps: Vec<&str> = wraps.iter().map(String::as_str).collect();
            check(name, &bytes, &wraps, &MILLARD);
        }
    }
}

/// Sum and coupled strength in the first posture of the vectors, by rate: activations between 0.01 and 1, no torque at other joints.
fn strengths(reference: &Reference) -> (Vec<[f64; 2]>, Vec<CoupledStrength>) {
    let Reference { model, muscles, .. } = reference;
    let mut kinematics = Kinematics::new(model);
    let mut geometry = PathGeometry::new(model, &muscles.paths);
    kinematics.update(model, &reference.postures()[0]).unwrap();
    geometry.update(model, &kinematics, &muscles.paths, PathRule::OpenSim);
    let states = |activation: f64| -> Vec<FiberState> {
        let lengths = geometry.lengths();
        muscles.muscles.iter().map(|muscle| muscle.at_rest(lengths[muscle.spec().path], activation)).collect()
    };
    let (rest, full) = (states(0.01), states(1.0));
    let n = model.rates().len();
    let mut sum = vec![[0.0; 2]; n];
    strength(muscles, &geometry, &rest, &full, &mut sum);
    let crossed = geometry.crossed(model);
    let coupled = coupled_strength(muscles, &geometry, &rest, &full, &crossed, &vec![0.0; n]);
    for found in &coupled {
        let name = &model.rates()[found.rate].name;
        println!("{name}: sum {:?}, {found:?}", sum[found.rate]);
        assert!(found.gap.abs() < 1e-9, "{name}: {found:?}");
        if found.missing < 1e-9 {
            let [positive, negative] = sum[found.rate];
            assert!(found.torque[0] <= positive + 1e-9 && found.torque[1] >= negative - 1e-9, "{name}: {found:?}");
        }
    }
    (sum, coupled)
}

/// Positive and negative sum, then coupled strength, N m, as SciPy's linear programs find them from OpenSim's moment arms and forces.
fn assert_strength(reference: &Reference, expected: &[(&str, [f64; 4])]) {
    let (sum, coupled) = strengths(reference);
    for (rate, theirs) in expected {
        let found = coupled.iter().find(|found| reference.model.rates()[found.rate].name == *rate).unwrap();
        let own = [sum[found.rate], found.torque].concat();
        assert!(
            own.iter().zip(theirs).all(|(own, theirs)| (own - theirs).abs() < 0.1),
            "{rate}: {own:?} for {theirs:?}"
        );
    }
}

#[test]
#[ignore = "needs CONTRAPPOSTO_OPENSIM_MODELS: a folder of published full bodies and arms"]
fn strength_of_rajagopal2016_is_that_of_another_linear_program_over_opensims_forces() {
    let bytes = model_bytes("Rajagopal2016.osim");
    let reference = Reference::read("rajagopal2016", &bytes, &shared("vectors/muscles/rajagopal2016.json.gz"));
    let expected = [
        ("hip_flexion_r", [208.8, -451.7, 165.5, -246.3]),
        ("hip_adduction_r", [311.0, -255.8, 259.8, -172.1]),
        ("hip_rotation_l", [37.1, -142.0, 33.6, -106.7]),
        ("knee_angle_r", [207.6, -380.3, 126.0, -380.3]),
        ("ankle_angle_r", [60.2, -433.4, 60.2, -433.4]),
    ];
    assert_strength(&reference, &expected);
}

#[test]
#[ignore = "needs CONTRAPPOSTO_OPENSIM_MODELS: a folder of published full bodies and arms"]
fn the_gradient_of_passive_torque_of_published_bodies_is_symmetric_and_their_central_difference() {
    let fetched = ["rajagopal2016 Rajagopal2016.osim", "rajagopal_lai_uhlrich2023 RajagopalLaiUhlrich2023.osim"];
    let mut bodies: Vec<(&str, Vec<u8>)> = fetched
        .iter()
        .map(|pair| pair.split_once(' ').unwrap())
        .map(|(name, file)| (name, model_bytes(file)))
        .collect();
    bodies.push(("gait2392_thelen", std::fs::read(shared("models/opensim/gait2392_thelen2003muscle.osim")).unwrap()));
    for (name, bytes) in bodies {
        let reference = Reference::read(name, &bytes, &shared(&format!("vectors/muscles/{name}.json.gz")));
        let Reference { model, muscles, .. } = &reference;
        let mut kinematics = Kinematics::new(model);
        let mut geometry = PathGeometry::new(model, &muscles.paths);
        let mut passive = PathTension::new(model, &muscles.paths);
        let mut tensions = vec![Tension::default(); muscles.paths.paths.len()];
        let mut at = |posture: &contrapposto::posture::Posture| {
            kinematics.update(model, posture).unwrap();
            geometry.update(model, &kinematics, &muscles.paths, PathRule::Geodesic);
            let states = muscles.muscles.iter().map(|m| m.at_rest(geometry.lengths()[m.spec().path], 0.01));
            passive_tensions(muscles, &geometry, &states.collect::<Vec<_>>(), &mut tensions);
            passive.update(model, &kinematics, &muscles.paths, &geometry, &tensions).unwrap();
            let n = model.rates().len();
            let rows: Vec<Vec<f64>> = (0..n).map(|row| passive.gradient_row(row).to_vec()).collect();
            (passive.torques().to_vec(), rows)
        };
        let (mut symmetry, mut worst, mut compared, mut jumps) = (0f64, 0f64, 0, 0);
        for mut posture in reference.postures() {
            // Off the ends of the models' splines, where second derivatives jump.
            posture.values_mut().iter_mut().for_each(|value| *value += 1.3e-3);
            let (_, rows) = at(&posture);
            for (column, rate) in model.rates().iter().enumerate() {
                let coordinate = rate.coordinate.unwrap();
                if model.is_dependent(coordinate) {
                    continue;
                }
                let mut moved = |step: f64| {
                    let mut moved = posture.clone();
                    moved.values_mut()[coordinate] += step;
                    at(&moved).0
                };
                let h = 1e-5;
                let sides = [moved(h), moved(-h), moved(2.0 * h), moved(-2.0 * h)];
                for (row, entries) in rows.iter().enumerate() {
                    assert!(entries[column].is_finite() && sides.iter().all(|side| side[row].is_finite()), "{name}");
                    symmetry = symmetry.max((entries[column] - rows[column][row]).abs());
                    let near = (sides[0][row] - sides[1][row]) / (2.0 * h);
                    let far = (sides[2][row] - sides[3][row]) / (4.0 * h);
                    // Most rates share no muscle: zeros say nothing of jumps.
                    compared += usize::from(near.abs() > 1e-9 || entries[column].abs() > 1e-9);
                    // A muscle that leaves a surface or a point within the step has no derivative there.
                    if (near - far).abs() > 1e-4 * (1.0 + near.abs()) {
                        jumps += 1;
                        continue;
                    }
                    let slope = near + (near - far) / 3.0;
                    worst = worst.max((entries[column] - slope).abs() / (1.0 + slope.abs()));
                }
            }
        }
        println!("{name}: symmetric to {symmetry:.1e}, differences {worst:.1e}, {jumps} jumps of {compared}");
        assert!(symmetry < 1e-9 && worst < 1e-6 && jumps * 200 < compared, "{name}");
    }
}

#[test]
#[ignore = "needs ../shared: a published OpenSim model and OpenSim's numbers of its muscles"]
fn strength_of_gait2392_is_that_of_another_linear_program_over_opensims_forces() {
    let bytes = std::fs::read(shared("models/opensim/gait2392_thelen2003muscle.osim")).unwrap();
    let reference = Reference::read("gait2392_thelen", &bytes, &shared("vectors/muscles/gait2392_thelen.json.gz"));
    let expected = [
        ("hip_flexion_r", [174.2, -253.0, 146.6, -201.7]),
        ("hip_rotation_r", [37.5, -91.1, 34.3, -81.7]),
        ("knee_angle_l", [175.3, -126.5, 175.3, -95.8]),
        ("subtalar_angle_r", [68.5, -43.7, 47.8, -36.7]),
        ("lumbar_bending", [232.0, -232.0, 196.9, -196.9]),
    ];
    assert_strength(&reference, &expected);
}

/// Rows of numbers of a table of OpenSim, and the names of its columns.
fn table(text: &str) -> (Vec<&str>, Vec<f64>) {
    let mut lines = text.lines().skip_while(|line| *line != "endheader").skip(1);
    let names = lines.next().unwrap().split('\t').map(str::trim).collect();
    (names, lines.next().unwrap().split('\t').map(|number| number.trim().parse().unwrap()).collect())
}

#[test]
#[ignore = "needs ../shared: a published OpenSim model and OpenSim's static optimisation of it"]
fn static_optimisation_of_gait2392_is_opensims() {
    let folder = |file: &str| shared(&format!("vectors/muscles/static_optimisation/gait2392_thelen_{file}"));
    let mut bytes = vec![];
    let packed = std::fs::File::open(folder("model.osim.gz")).unwrap();
    flate2::read::GzDecoder::new(packed).read_to_end(&mut bytes).unwrap();
    let imported = osim::read(&bytes, "gait2392").unwrap().model().unwrap();
    let (model, muscles) = (&imported.model, &imported.muscles);
    let mut posture = model.default_posture();
    let text = std::fs::read_to_string(folder("q.sto")).unwrap();
    let (names, values) = table(&text);
    for (name, value) in names.iter().zip(values).skip(1) {
        posture.values_mut()[model.coordinate(name).unwrap()] = value;
    }
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &posture).unwrap();
    let mut geometry = PathGeometry::new(model, &muscles.paths);
    geometry.update(model, &kinematics, &muscles.paths, PathRule::OpenSim);
    let mut external = ExternalTorque::new(model);
    external.update(model, &kinematics, &[]).unwrap();
    let free = |rate: usize| {
        let coordinate = model.rates()[rate].coordinate.unwrap();
        !model.coordinates()[coordinate].locked && !model.is_dependent(coordinate)
    };
    let rates: Vec<usize> = (0..model.rates().len()).filter(|&rate| free(rate)).collect();
    let torques: Vec<f64> = rates.iter().map(|&rate| -external.torques()[rate]).collect();
    let strong = |rate: usize| if model.rates()[rate].name.starts_with("pelvis") { 10_000.0 } else { 1.0 };
    let reserves: Vec<f64> = rates.iter().map(|&rate| strong(rate)).collect();
    let forces: Vec<f64> = muscles
        .muscles
        .iter()
        .map(|muscle| muscle.at_rest_on_rigid_tendon(geometry.lengths()[muscle.spec().path], 1.0).active_force)
        .collect();
    let bounds = vec![(0.01, 1.0); forces.len()];
    let asked = Recruitment { rates: &rates, torques: &torques, reserves: &reserves, forces: &forces, bounds: &bounds };
    let mut optimisation = StaticOptimisation::default();
    let status = optimisation.solve(muscles, &geometry, &asked).unwrap();
    assert_eq!(status, hierarchical_least_squares::Status::Solved);
    let text = std::fs::read_to_string(folder("StaticOptimization_activation.sto")).unwrap();
    let (names, theirs) = table(&text);
    let (mut worst, mut compared) = (0f64, 0);
    for (muscle, own) in muscles.muscles.iter().zip(optimisation.activations()) {
        let column = names.iter().position(|name| *name == muscle.spec().name).unwrap();
        worst = worst.max((own - theirs[column]).abs());
        compared += 1;
    }
    println!("{compared} activations within {worst:.1e}; optimality {:.1e}", optimisation.optimality());
    assert!(compared == 92 && worst < 1e-3, "{worst}");
    assert!(optimisation.optimality() < 1e-8, "{}", optimisation.optimality());
    let start = std::time::Instant::now();
    for _ in 0..20 {
        StaticOptimisation::default().solve(muscles, &geometry, &asked).unwrap();
    }
    println!("{:.2} ms a frame from the start", start.elapsed().as_secs_f64() * 50.0);
}

/// Passive torque of hip adduction that OpenSim gives at an angle (deg), N m, all other angles zero.
const ADDUCTION: [(f64, f64); 8] =
    [(-40.0, 4.4), (-30.0, 1.9), (-20.0, 0.7), (-10.0, 0.1), (0.0, -0.2), (10.0, -1.2), (20.0, -3.8), (30.0, -7.7)];

#[test]
#[ignore = "needs ../shared: a published OpenSim model and OpenSim's numbers of its muscles"]
fn muscles_in_use_give_gait2392_the_passive_torque_of_opensim_and_strength_beyond_it() {
    let bytes = std::fs::read(shared("models/opensim/gait2392_thelen2003muscle.osim")).unwrap();
    let no_includes = &mut |_: &str| Err("none".to_owned());
    let mut opened = SourcedModel::read("gait2392.osim", &bytes, None, no_includes).unwrap();
    assert_eq!(opened.default_muscle_use(), MuscleUse::Both);
    let library = opened.clone().fill(&Person::default()).unwrap();
    assert!(opened.use_muscles(MuscleUse::Both));
    let mut opened = opened.fill(&Person::default()).unwrap();
    let (muscles, warnings) = opened.joint_muscles(&library);
    let muscles = muscles.unwrap();
    // Toe joints have muscles of less than a third of their built-in strength, which they keep.
    assert!(!warnings.is_empty() && warnings.iter().all(|warning| warning.contains("mtp")), "{warnings:?}");
    let mut body =
        JointTorques::with_passive_ranges(&opened.model, &opened.passive_ranges()).with_muscles(Some(muscles));
    let hip = opened.model.coordinate("hip_adduction_r").unwrap();
    let rate = opened.model.coordinates()[hip].rate.unwrap();
    for (angle, expected) in ADDUCTION {
        let mut posture = opened.model.default_posture();
        posture.values_mut()[hip] = f64::to_radians(angle);
        body.update(&opened.model, &posture, &[], Quantities::TORQUES).unwrap();
        let torque = body.passive_torque().torques()[rate];
        assert!((torque - expected).abs() < 0.1, "{angle} deg: {torque} N m for {expected}");
    }
    let reference = Reference::read("gait2392_thelen", &bytes, &shared("vectors/muscles/gait2392_thelen.json.gz"));
    let own = &reference.muscles;
    let mut geometry = PathGeometry::new(&opened.model, &own.paths);
    let mut tension = PathTension::new(&opened.model, &own.paths);
    let mut tensions = vec![Tension::default(); own.paths.paths.len()];
    let n = opened.model.rates().len();
    let (mut sums, mut fibers) = (vec![[0.0; 2]; n], vec![0.0; n]);
    let crossed = geometry.crossed(&opened.model);
    let (mut groups_seen, mut without) = (0, 0);
    for posture in reference.postures() {
        body.update(&opened.model, &posture, &[], Quantities::TORQUES).unwrap();
        body.muscles().unwrap().write_strength(&mut opened.model);
        let model = &opened.model;
        geometry.update(model, body.kinematics(), &own.paths, PathRule::Geodesic);
        let states = |activation: f64| -> Vec<FiberState> {
            let lengths = geometry.lengths();
            own.muscles.iter().map(|muscle| muscle.at_rest(lengths[muscle.spec().path], activation)).collect()
        };
        let (rest, full) = (states(0.01), states(1.0));
        passive_tensions(own, &geometry, &rest, &mut tensions);
        tension.update(model, body.kinematics(), &own.paths, &geometry, &tensions).unwrap();
        strength(own, &geometry, &rest, &full, &mut sums);
        passive_fiber_torque(own, &geometry, &rest, &mut fibers);
        for &rate in &crossed {
            let name = &model.rates()[rate].name;
            let (found, expected) = (body.passive_torque().torques()[rate], tension.torques()[rate]);
            assert!((found - expected).abs() < 1e-9, "{name}: {found} N m for {expected}");
            let coordinate = model.rates()[rate].coordinate.unwrap();
            if model.three_axis_joint_of(coordinate).is_some() || name.starts_with("mtp") {
                continue;
            }
            let groups = model.coordinates()[coordinate].groups.as_ref().unwrap();
            let beyond = [sums[rate][0] - fibers[rate], fibers[rate] - sums[rate][1]];
            for (side, beyond) in Side::BOTH.into_iter().zip(beyond) {
                let found = groups[side.index()].strength.torque(0.0);
                assert!((found - beyond.max(1e-3)).abs() < 1e-9, "{name}: {found} N m for {beyond}");
                (groups_seen, without) = (groups_seen + 1, without + usize::from(beyond < 1e-3));
            }
        }
    }
    println!("{without} of {groups_seen} groups have no strength beyond the tone of the muscles against them");
    assert!(groups_seen >= 60 && without * 20 < groups_seen, "{without} of {groups_seen}");
}
