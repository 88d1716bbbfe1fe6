//! Tests that a group which works against the passive torque of its own joint is judged within the error of the recorded angle.

use contrapposto::assessment::{ANGLE_ERROR, AssessSettings, Assessment, GroupAssessment, Instant, assess};
use contrapposto::model::{Adult, Model, adult};
use contrapposto::posture::Posture;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn body() -> Model {
    adult(&Adult::default()).unwrap()
}

fn assessed(model: &Model, posture: &Posture, seconds: f64, angle_error: f64) -> Assessment {
    let settings = AssessSettings { root_held: true, angle_error, ..AssessSettings::default() };
    assess(model, &[(0.0, posture.clone()), (seconds, posture.clone())], |_, _, _| {}, &settings, |_| {}).unwrap()
}

/// The angles by which the passive laws go: those of three-axis joints are about their axes.
fn angles_of_laws(model: &Model, posture: &Posture) -> Vec<f64> {
    let (settings, mut angles) = (AssessSettings { root_held: true, ..AssessSettings::default() }, vec![]);
    let record = |instant: &Instant<'_>| angles = instant.torques.angles().to_vec();
    assess(model, &[(0.0, posture.clone())], |_, _, _| {}, &settings, record).unwrap();
    angles
}

/// Recorded at 0 deg, the extensors of a hanging arm fail against the end of the elbow's range; with the error of a measurement they do not.
#[test]
fn a_straight_elbow_tires_nobody_unless_its_angle_is_exact() {
    let model = body();
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    let posture = model.default_posture();
    assert_eq!(posture.values()[elbow], 0.0);
    let [exact, measured] = [0.0, ANGLE_ERROR].map(|error| assessed(&model, &posture, 600.0, error));
    let fails = |found: &Assessment| {
        found.groups.iter().filter(|group| group.coordinate == elbow).any(|group| group.exhausted_at.is_some())
    };
    assert!(fails(&exact) && !fails(&measured));
    let doubt = measured.groups.iter().find(|group| group.coordinate == elbow).unwrap().in_doubt.unwrap();
    println!("{doubt:?}");
    assert!(doubt.recorded_load > 0.2 && doubt.judged_load < 0.1, "{doubt:?}");
    assert!(exact.groups.iter().all(|group| group.in_doubt.is_none()));
}

/// The judged load of a hinge is the least that any angle within the error gives, where its passive torque still opposes the group: by 2,001
/// angles, against both ends of the interval in the code.
#[test]
fn the_judged_load_is_the_least_within_the_error_by_brute_force() {
    const SEED: u64 = 20_261_124;
    const ANGLES: i32 = 1000;
    println!("seed {SEED}");
    let model = body();
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    let mut eased = 0;
    for _ in 0..60 {
        let mut posture = model.default_posture();
        for (coordinate, value) in model.coordinates().iter().zip(posture.values_mut()) {
            if coordinate.groups.is_some() && coordinate.range.0.is_finite() {
                *value = random.random_range(coordinate.range.0..coordinate.range.1);
            }
        }
        let angles = angles_of_laws(&model, &posture);
        let [exact, judged] = [0.0, ANGLE_ERROR].map(|error| assessed(&model, &posture, 0.0, error));
        for group in &judged.groups {
            let same = |one: &&GroupAssessment| (group.coordinate, group.side) == (one.coordinate, one.side);
            let recorded = exact.groups.iter().find(same).unwrap();
            let [load, most] = [group.load, recorded.load];
            assert!((0.0..=most).contains(&load), "{load} of {most}");
            if model.three_axis_joint_of(group.coordinate).is_some() || most == 0.0 {
                continue;
            }
            let (active, passive) = (recorded.peak_torque, recorded.at_peak.passive);
            let opposes = active * passive < 0.0;
            let law = model.coordinates()[group.coordinate].passive.as_ref();
            let at = |k: i32| {
                let mut turned = angles.clone();
                turned[group.coordinate] += ANGLE_ERROR * f64::from(k) / f64::from(ANGLES);
                law.map_or(0.0, |law| law.torque(group.coordinate, &turned))
            };
            let least = (-ANGLES..=ANGLES).filter(|_| opposes).fold(active.abs(), |least, k| {
                let helps = (passive + at(k) - at(0)) * passive <= 0.0;
                let other = if helps { -passive } else { at(k) - at(0) };
                least.min(((active - other) * active.signum()).max(0.0))
            });
            // All of it where passive torque is at least twice the external one, nothing where it is the smaller one.
            let share = (passive.abs() / recorded.at_peak.external.abs() - 1.0).clamp(0.0, 1.0);
            let expected = most * (1.0 - share * (1.0 - least / active.abs()));
            assert!((load - expected).abs() < 1e-9 * (1.0 + most), "{load}, by brute force {expected}: {group:?}");
            eased += usize::from(load < most);
        }
    }
    println!("{eased} loads eased");
    assert!(eased > 100);
}

/// The judged load has no step where the group begins to work against its joint, nor where the passive torque vanishes.
#[test]
fn the_judged_load_is_continuous_over_the_range_of_the_elbow() {
    const STEP: f64 = 1e-3;
    let model = body();
    let elbow = model.coordinate("elbow_flex_r").unwrap();
    let (low, high) = model.coordinates()[elbow].range;
    let mut before: Option<Vec<f64>> = None;
    let mut largest = 0.0_f64;
    for k in 0..=((high - low) / STEP) as usize {
        let mut posture = model.default_posture();
        posture.values_mut()[elbow] = low + STEP * k as f64;
        let found = assessed(&model, &posture, 0.0, ANGLE_ERROR);
        let mut loads: Vec<_> = found.groups.iter().filter(|group| group.coordinate == elbow).collect();
        loads.sort_by_key(|group| group.side.index());
        let loads: Vec<f64> = loads.iter().map(|group| group.load).collect();
        let steps = before.iter().flatten().zip(&loads).map(|(a, b)| (a - b).abs());
        largest = steps.fold(largest, f64::max);
        before = Some(loads);
    }
    println!("largest change of the load in {STEP} rad: {largest}");
    // The passive torque changes by at most 260 N m/rad there, over a strength of at least 10 N m.
    assert!(largest < 26.0 * STEP, "{largest}");
}
