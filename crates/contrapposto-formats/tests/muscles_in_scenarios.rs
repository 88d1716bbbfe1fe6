//! Runs scenarios of a model whose muscles give strength, and compares every sample with the muscles in its posture.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests: helpers outside #[test] functions too")]

#[path = "common/shared.rs"]
mod shared;

use std::time::Instant;

use contrapposto::joint_torques::{JointMuscles, JointTorques, Quantities, active_torque, relative_load};
use contrapposto::model::{Model, Side};
use contrapposto::posture::Posture;
use contrapposto::simulation::{Run, Scenario};
use contrapposto_formats::read_run;
use contrapposto_formats::tissue::{MuscleUse, Person, SourcedModel};
use shared::shared;

/// A muscle `arm` metres in front of the elbow.
fn muscle(name: &str, arm: f64) -> String {
    format!(
        "<Thelen2003Muscle name=\"{name}\"><GeometryPath><PathPointSet><objects>
         <PathPoint name=\"p\"><socket_parent_frame>/ground</socket_parent_frame><location>{arm} 0.2 0</location></PathPoint>
         <PathPoint name=\"o\"><socket_parent_frame>/bodyset/b</socket_parent_frame><location>{arm} -0.3 0</location></PathPoint>
         </objects></PathPointSet></GeometryPath><max_isometric_force>900</max_isometric_force>
         <optimal_fiber_length>0.2</optimal_fiber_length><tendon_slack_length>0.28</tendon_slack_length></Thelen2003Muscle>"
    )
}

/// A forearm on the adult's elbow, with a muscle on each side of it.
fn arm() -> String {
    format!(
        "<OpenSimDocument Version=\"40500\"><Model name=\"m\">
         <BodySet><objects><Body name=\"b\"><mass>1.5</mass><mass_center>0 -0.2 0</mass_center></Body></objects></BodySet>
         <JointSet><objects><PinJoint name=\"j\"><socket_parent_frame>/ground</socket_parent_frame>
           <socket_child_frame>/bodyset/b</socket_child_frame>
           <coordinates><Coordinate name=\"elbow_flex_r\"><range>0 2.4</range></Coordinate></coordinates></PinJoint></objects></JointSet>
         <ForceSet><objects>{}{}</objects></ForceSet></Model></OpenSimDocument>",
        muscle("front", 0.05),
        muscle("back", -0.05),
    )
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

/// The body of a file with the strength of its muscles, and these.
fn opened(bytes: &[u8]) -> (Model, JointMuscles) {
    let no_includes = &mut |_: &str| Err("none".to_owned());
    let mut opened = SourcedModel::read("arm.osim", bytes, None, no_includes).unwrap();
    let library = opened.clone().fill(&Person::default()).unwrap();
    assert!(opened.use_muscles(MuscleUse::Strength));
    let mut opened = opened.fill(&Person::default()).unwrap();
    let (muscles, _) = opened.joint_muscles(&library);
    (opened.model, muscles.unwrap())
}

fn scenario(bytes: &[u8], text: &str) -> Scenario {
    let (model, muscles) = opened(bytes);
    let mut scenario = read_run("tired.toml", text.as_bytes(), Some(model)).unwrap().scenario;
    scenario.muscles = Some(muscles);
    scenario
}

/// Carries out a run and compares each sample with the muscles in its posture, as `torques --muscles strength` takes them. Gives the
/// number of samples, the largest difference of a relative load, and by how much the strength of a group that works changes in the run.
fn compare(scenario: &Scenario) -> (usize, f64, f64) {
    let mut posed = scenario.model.clone();
    let mut body = JointTorques::new(&posed).with_muscles(scenario.muscles.clone());
    let (mut samples, mut worst) = (0, 0f64);
    let mut spans = vec![(f64::INFINITY, 0f64); 2 * posed.coordinates().len()];
    let mut run = Run::new(scenario).unwrap();
    while let Some(sample) = run.next_sample().unwrap() {
        body.update(&posed, &Posture::new(sample.posture.to_vec()), &[], Quantities::TORQUES).unwrap();
        body.muscles().unwrap().write_strength(&mut posed);
        for (i, coordinate) in posed.coordinates().iter().enumerate() {
            let active = active_torque(sample.external[i], sample.passive[i]);
            assert!((active - sample.active[i]).abs() < 1e-9, "{}", coordinate.name);
            if coordinate.rate.is_none() {
                continue;
            }
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
    let scenario = scenario(arm().as_bytes(), TIRED);
    let (samples, worst, change) = compare(&scenario);
    println!("{samples} samples, loads differ by {worst:.1e}, strength changes by {:.0} %", 100.0 * change);
    assert!(samples > 100 && worst < 1e-9, "{worst}");
    assert!(change > 0.05, "the elbow moves, so that the strength changes: {change}");
}

#[test]
fn a_run_with_muscles_that_is_resumed_gives_the_same_samples() {
    let text = TIRED.replace("duration_s = 20", "duration_s = 45");
    let scenario = scenario(arm().as_bytes(), &text);
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
    let scenario = scenario(&bytes, CROUCH);
    // The body is at rest at once, in a posture whose strength is not that of the default one in the model.
    let (samples, worst, _) = compare(&scenario);
    assert!(samples > 100 && worst < 1e-9, "{samples} {worst}");
    let start = Instant::now();
    let mut run = Run::new(&scenario).unwrap();
    while run.next_sample().unwrap().is_some() {}
    let (took, lasts) = (start.elapsed().as_secs_f64(), run.summary().end_time);
    println!("{samples} samples, loads differ by {worst:.1e}; {lasts} s in {took:.2} s");
    assert!(took < 0.1 * lasts, "{lasts} s took {took} s");
}
