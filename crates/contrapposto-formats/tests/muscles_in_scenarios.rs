//! Runs scenarios of a model whose muscles give strength and passive torque, and compares every sample with the muscles in its posture.

use crate::common::muscled_arm;
use crate::common::shared;

use std::time::Instant;

use contrapposto::joint_torques::{JointMuscles, JointTorques, Quantities, active_torque, relative_load};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Model, Side};
use contrapposto::passive::PassiveLaw;
use contrapposto::posture::Posture;
use contrapposto::simulation::{Run, Scenario};
use contrapposto_formats::read_pose;
use contrapposto_formats::tissue::MuscleUse;
use muscled_arm::{arm, opened, scenario};

/// The same with a bushing about the elbow, so that its passive torque falls with the angle.
fn sprung_arm() -> String {
    let bushing = "<BushingForce name=\"capsule\"><socket_frame1>/ground</socket_frame1><socket_frame2>/bodyset/b</socket_frame2>
        <rotational_stiffness>0 0 3</rotational_stiffness><translational_stiffness>0 0 0</translational_stiffness></BushingForce>";
    arm().replace("<ForceSet><objects>", &format!("<ForceSet><objects>{bushing}"))
}

const TIRED: &str = r#"
format = 1
[model]
file = "arm.osim"
muscles = "strength"
[posture]
elbow_flex_r_deg = 100
[[load]]
segment = "b"
mass_kg = 4
[strategy]
kind = "passive"
[fatigue]
start = { elbow_flex_r = { positive = 0.7 } }
[run]
duration_s = 20
"#;

/// The body as `torques --muscles` takes it: the muscles are no laws of it. Joints that the scenario leaves to a curve have that here, too.
fn body_of_torques(scenario: &Scenario, bytes: &[u8], uses: MuscleUse) -> (Model, JointMuscles) {
    let [mut opened, library] = opened(bytes, uses);
    let mut muscles = opened.joint_muscles(&library).0.unwrap();
    let mut model = opened.model;
    let laws = scenario.model.coordinates().iter().map(|coordinate| coordinate.passive.clone()).enumerate();
    let left = |(i, law): &(usize, Option<PassiveLaw>)| {
        model.coordinates()[*i].passive.is_none() && !matches!(law, Some(PassiveLaw::Slice(_)))
    };
    let laws = laws.filter(left).collect();
    muscles.leave_passive(&mut model, laws);
    (model, muscles)
}

/// Carries out a run and compares each sample with the muscles in its posture, as `torques --muscles` takes them. Gives the number of
/// samples, the largest difference of a relative load or a passive torque, and by how much the strength of a group that works changes.
fn compare(scenario: &Scenario, bytes: &[u8], uses: MuscleUse) -> (usize, f64, f64) {
    let (mut posed, muscles) = body_of_torques(scenario, bytes, uses);
    let mut body = JointTorques::new(&posed).with_muscles(Some(muscles));
    let (mut samples, mut worst) = (0, 0f64);
    let mut spans = vec![(f64::INFINITY, 0f64); 2 * posed.coordinates().len()];
    let mut run = Run::new(scenario).unwrap();
    while let Some(sample) = run.next_sample().unwrap() {
        body.update(&posed, &Posture::new(sample.posture.to_vec()), &[], Quantities::TORQUES).unwrap();
        body.muscles().unwrap().write_strength(&mut posed);
        for (i, coordinate) in posed.coordinates().iter().enumerate() {
            let active = active_torque(sample.external[i], sample.passive[i]);
            assert!((active - sample.active[i]).abs() < 1e-9, "{}", coordinate.name);
            let Some(rate) = coordinate.rate else { continue };
            worst = worst.max((body.passive_torque().about_axes()[rate] - sample.passive[i]).abs());
            let load = relative_load(coordinate, body.angles()[i], active);
            worst = worst.max((load - sample.load[i]).abs() / (1.0 + load));
            if let (Some(groups), true) = (&coordinate.groups, load > 0.05) {
                let side = Side::of(active).index();
                let (least, greatest) = &mut spans[2 * i + side];
                (*least, *greatest) = (least.min(groups[side].strength.peak), greatest.max(groups[side].strength.peak));
            }
        }
        samples += 1;
    }
    let change = spans.iter().fold(0.0, |most: f64, (least, greatest)| most.max(greatest / least - 1.0));
    (samples, worst, change)
}

#[test]
fn every_sample_of_a_run_is_judged_by_the_strength_of_the_muscles_in_its_posture() {
    let (scenario, _) = scenario(arm().as_bytes(), TIRED, MuscleUse::Strength);
    let (samples, worst, change) = compare(&scenario, arm().as_bytes(), MuscleUse::Strength);
    println!("{samples} samples, loads differ by {worst:.1e}, strength changes by {:.0} %", 100.0 * change);
    assert!(samples > 100 && worst < 1e-9, "{worst}");
    assert!(change > 0.05, "the elbow moves, so that the strength changes: {change}");
}

#[test]
fn a_joint_finds_relief_on_the_passive_torque_of_its_muscles() {
    for uses in [MuscleUse::Passive, MuscleUse::Both] {
        let (scenario, notes) = scenario(sprung_arm().as_bytes(), TIRED, uses);
        assert!(notes.iter().all(|note| note.contains("are levelled")), "{notes:?}");
        let elbow = &scenario.model.coordinates()[0];
        assert!(matches!(elbow.passive, Some(PassiveLaw::Slice(_))), "{:?}", elbow.passive);
        let (samples, worst, _) = compare(&scenario, sprung_arm().as_bytes(), uses);
        println!("{uses:?}: {samples} samples, torques and loads differ by {worst:.1e}");
        assert!(samples > 100 && worst < 1e-9, "{worst}");
        let mut run = Run::new(&scenario).unwrap();
        let (mut first, mut last) = (None, (0.0, 0.0));
        while let Some(sample) = run.next_sample().unwrap() {
            last = (sample.posture[0], sample.active[0].abs());
            first.get_or_insert(last);
        }
        let first = first.unwrap();
        assert!(
            (last.0 - first.0).abs() > 0.1 && last.1 < 0.5 * first.1,
            "the elbow goes where its muscles carry: {first:?} {last:?}"
        );
    }
}

#[test]
fn a_curve_that_the_scenario_gives_a_joint_is_not_added_to_its_muscles() {
    let curve = "\n[passive]\nelbow_flex_r = { table_deg_nm = [[0, 13], [60, 0.5], [138, -10]] }\n";
    let (scenario, notes) = scenario(sprung_arm().as_bytes(), &format!("{TIRED}{curve}"), MuscleUse::Both);
    assert!(matches!(scenario.model.coordinates()[0].passive, Some(PassiveLaw::Curve(_))));
    assert!(
        notes[0].contains("muscles are not added to the passive torque that the scenario gives `elbow_flex_r`"),
        "{notes:?}"
    );
    assert!(compare(&scenario, sprung_arm().as_bytes(), MuscleUse::Both).1 < 1e-9);
}

#[test]
fn where_the_passive_torque_of_muscles_rises_the_built_in_one_stands_for_it_and_a_note_says_so() {
    // A muscle of short fibres that the elbow stretches and lets go of again.
    let rising = arm().replace("900", "9000").replace("0.28<", "0.2<").replace("0.2</opt", "0.12</opt");
    let (scenario, notes) = scenario(rising.as_bytes(), TIRED, MuscleUse::Both);
    assert!(matches!(scenario.model.coordinates()[0].passive, Some(PassiveLaw::Curve(_))), "{notes:?}");
    assert!(notes[0].contains("that of the muscles rises about `elbow_flex_r` by"), "{notes:?}");
    assert!(notes[0].contains("`elbow_flex_r` have the built-in passive torque"), "{notes:?}");
    assert!(compare(&scenario, rising.as_bytes(), MuscleUse::Both).1 < 1e-9);
}

#[test]
fn a_run_with_muscles_that_is_resumed_gives_the_same_samples() {
    [MuscleUse::Strength, MuscleUse::Both].into_iter().for_each(resumes);
}

fn resumes(uses: MuscleUse) {
    let text = TIRED.replace("duration_s = 20", "duration_s = 45");
    let (scenario, _) = scenario(sprung_arm().as_bytes(), &text, uses);
    let samples = |run: &mut Run<'_>| {
        let mut all = vec![];
        while let Some(sample) = run.next_sample().unwrap() {
            all.push((sample.posture.to_vec(), sample.load.to_vec(), sample.fatigue.to_vec()));
        }
        all
    };
    let mut whole = Run::new(&scenario).unwrap();
    let all = samples(&mut whole);
    let snapshot = whole.snapshot().clone();
    let first = usize::try_from(snapshot.samples).unwrap();
    assert!(first > 0 && first < all.len(), "a snapshot under way: {first} of {}", all.len());
    let rest = samples(&mut Run::resume(&scenario, snapshot).unwrap());
    assert_eq!(rest, all[first..]);
}

/// A scenario whose model is not in the repository.
const CROUCH: &str = include_str!("../../../scenarios/published/crouch-gait2392.toml");

#[test]
#[ignore = "needs ../shared: a published OpenSim model, to crouch on its muscles"]
fn a_crouch_on_the_muscles_of_gait2392_is_judged_by_them_ten_times_faster_than_it_lasts() {
    let bytes = std::fs::read(shared("models/opensim/gait2392_thelen2003muscle.osim")).unwrap();
    let (scenario, notes) = scenario(&bytes, CROUCH, MuscleUse::Both);
    let hip = scenario.model.coordinate("hip_flexion_r").unwrap();
    assert!(matches!(scenario.model.coordinates()[hip].passive, Some(PassiveLaw::Slice(_))), "{notes:?}");
    let (samples, worst, _) = compare(&scenario, &bytes, MuscleUse::Both);
    assert!(samples > 100 && worst < 1e-9, "{samples} {worst}");
    let start = Instant::now();
    let mut run = Run::new(&scenario).unwrap();
    while run.next_sample().unwrap().is_some() {}
    let (took, lasts) = (start.elapsed().as_secs_f64(), run.summary().end_time);
    println!("{samples} samples, loads differ by {worst:.1e}; {lasts} s in {took:.2} s");
    assert!(took < 0.1 * lasts, "{lasts} s took {took} s");
}

#[test]
fn a_pose_has_the_strength_that_its_muscles_have_where_it_starts() {
    let bytes = arm();
    let [mut body, library] = opened(bytes.as_bytes(), MuscleUse::Strength);
    let (muscles, _) = body.scenario_muscles(&library).unwrap();
    let mut posed = body.model.clone();
    let elbow = posed.coordinate("elbow_flex_r").unwrap();
    let text = "format = 1\n[model]\nfile = \"arm.osim\"\nmuscles = \"strength\"\n[posture]\nelbow_flex_r_deg = 100\n[[task]]\nkind = \"posture\"\n";
    let mut pose = read_pose("pose.toml", text.as_bytes(), Some(body.model)).unwrap();
    let peaks =
        |model: &Model| model.coordinates()[elbow].groups.as_ref().unwrap().each_ref().map(|group| group.strength.peak);
    let before = peaks(&pose.model);
    pose.take_muscles(muscles);
    let [mut body, library] = opened(bytes.as_bytes(), MuscleUse::Strength);
    let mut alone = body.joint_muscles(&library).0.unwrap();
    let mut kinematics = Kinematics::new(&posed);
    kinematics.update(&posed, &pose.start).unwrap();
    alone.update(&posed, &pose.start, &kinematics).unwrap();
    alone.write_strength(&mut posed);
    assert!(pose.muscles.is_some());
    for ((peak, expected), before) in peaks(&pose.model).into_iter().zip(peaks(&posed)).zip(before) {
        assert!((peak - expected).abs() < 1e-9 * expected && (peak - before).abs() > 1.0, "{peak} {expected} {before}");
    }
}
