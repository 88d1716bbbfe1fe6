//! Hands that a run puts down to rest when a muscle group is tired, and takes up again.

use crate::common;

use common::complaint;
use contrapposto::contact::{Place, Slip};
use contrapposto::kinematics::Kinematics;
use contrapposto::posture::Posture;
use contrapposto::simulation::{Run, Scenario, Snapshot, StepKind, Summary};
use contrapposto::suggestions::{Change, Job, RestingHand, changes};
use contrapposto_formats::{read_run, read_scenario};

/// Height of the table, m.
const HEIGHT: f64 = 0.72;

/// The job of `scenarios/low-table.toml`: the right hand at work over a low table, the trunk bent forward.
fn text(table: &str, run: &str) -> String {
    format!(
        r#"format = 1
[model]
adult = {{ sex = "female", stature_m = 1.65, mass_kg = 62 }}
[posture]
lumbar_extension_deg = -30
arm_flex_r_deg = 60
elbow_flex_r_deg = 30
[[table]]
height_m = {HEIGHT}
edge_m = 0.14
{table}
[[task]]
kind = "point"
segment = "hand_r"
target_m = [0.62, 0.76, 0.00]
above_relief = true
[[task]]
kind = "look_at"
target_m = [0.62, 0.76, 0.00]
[[task]]
kind = "effort"
[strategy]
kind = "active"
[run]
step_s = 0.1
{run}"#
    )
}

fn scenario(run: &str) -> Scenario {
    read_scenario("bench.toml", text("may_carry = [\"left_hand\"]", run).as_bytes(), None).unwrap()
}

/// The left palm: least height of a corner above the table, m; the depth of the deepest corner in the table, m; and the cosine between its outer
/// normal and straight down.
fn palm(scenario: &Scenario, values: &[f64]) -> (f64, f64, f64) {
    let model = &scenario.model;
    let hand = model.segment("hand_l").unwrap();
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(values.to_vec())).unwrap();
    let corners: Vec<_> =
        model.segments()[hand].patch.iter().map(|corner| kinematics.station(model, hand, *corner)).collect();
    // The patch lies in front of the frame of the hand, on the side of its palm.
    let back = kinematics.placement(model, hand).translation.vector;
    let outward = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).normalize();
    let outward = if outward.dot(&(corners[0] - back)) < 0.0 { -outward } else { outward };
    let [ahead, aside, thickness] = [0.14, 0.70, 0.03];
    let depth = |c: &nalgebra::Vector3<f64>| {
        let inside = [HEIGHT - c.y, c.y - (HEIGHT - thickness), c.x - ahead, aside - c.z.abs()];
        inside.into_iter().fold(f64::INFINITY, f64::min)
    };
    let deepest = corners.iter().map(depth).fold(f64::NEG_INFINITY, f64::max);
    (corners.iter().map(|corner| corner.y - HEIGHT).fold(f64::INFINITY, f64::min), deepest, -outward.y)
}

/// Cosine between the line from left shoulder to left elbow and straight down.
fn arm_down(scenario: &Scenario, values: &[f64]) -> f64 {
    let model = &scenario.model;
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(values.to_vec())).unwrap();
    let place = |name| kinematics.placement(model, model.segment(name).unwrap()).translation.vector;
    -(place("ulna_l") - place("humerus_l")).normalize().y
}

/// Runs to the end; all samples pass through `see`.
fn run(scenario: &Scenario, mut see: impl FnMut(&contrapposto::simulation::Sample<'_>)) -> Summary {
    let mut run = Run::new(scenario).unwrap();
    while let Some(sample) = run.next_sample().unwrap() {
        see(&sample);
    }
    run.summary()
}

#[test]
fn a_free_hand_is_put_on_the_table_when_the_back_is_tired_and_carries_there() {
    let scenario = scenario("duration_s = 260");
    let (mut before, mut carried, mut deepest) = (None::<Vec<f64>>, vec![], f64::NEG_INFINITY);
    let (mut last, mut steepest) = (None, f64::INFINITY);
    let summary = run(&scenario, |sample| {
        let (height, depth, down) = palm(&scenario, sample.posture);
        let standing = sample.standing.unwrap();
        // Not faster than a deliberate motion while something is put down (a relief alone has smaller steps).
        if let Some(before) = before.replace(sample.posture.to_vec()).filter(|_| sample.stepping) {
            let fastest = before.iter().zip(sample.posture).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(fastest <= 1.2 * 0.6 * 0.1, "{fastest} rad in a tenth of a second at {}", sample.time);
        }
        deepest = deepest.max(depth);
        // The arm hangs until its hand is on its way to the table, also in the search for the start.
        if !sample.stepping && standing.contacts[2].share == 0.0 {
            steepest = steepest.min(arm_down(&scenario, sample.posture));
        }
        carried.push((sample.time, standing.contacts[2].share));
        assert!(!standing.slip.exceeds(Slip::NOTICED), "{:?} at {}", standing.slip, sample.time);
        let feet = standing.contacts[0].share + standing.contacts[1].share;
        let vertical: f64 = standing.contacts.iter().map(|contact| contact.share).sum();
        assert!((vertical - 1.0).abs() < 1e-6 && feet > 0.0, "{vertical} of the weight at {}", sample.time);
        last = Some((height, down));
    });
    let step = summary.foot_steps.first().expect("no hand was put down");
    assert_eq!(step.kind, StepKind::PutDown);
    assert!(step.effort.1 < 0.8 * step.effort.0, "{:?}", step.effort);
    let (height, down) = last.unwrap();
    assert!(height.abs() < 1e-4 && down > 1.0 - 1e-6, "{height} m above the table, {down}");
    assert!(deepest < 1e-3, "the palm was {deepest} m deep in the table");
    println!("{step:?}");
    assert!(
        steepest > libm::cos(20.5_f64.to_radians()),
        "the upper arm was {} degrees off",
        libm::acos(steepest).to_degrees()
    );
    let at = |time: f64| carried.iter().find(|(t, _)| *t >= time).unwrap().1;
    assert_eq!(at(step.time.0), 0.0);
    assert!(at(step.time.1 + 0.2) > 0.02, "carries {}", at(step.time.1 + 0.2));
}

#[test]
fn without_a_place_to_rest_nothing_is_put_down() {
    let alone = read_scenario("bench.toml", text("", "duration_s = 230").as_bytes(), None).unwrap();
    let summary = run(&alone, |_| {});
    let effort = summary.standing.as_ref().unwrap().effort;
    assert!(summary.foot_steps.is_empty() && effort > 0.15, "{effort}");
}

#[test]
fn a_run_resumed_before_the_way_of_the_hand_gives_the_same_bits() {
    let scenario = scenario("duration_s = 240");
    let mut whole = Run::new(&scenario).unwrap();
    let (mut snapshots, mut postures): (Vec<Snapshot>, Vec<Vec<u64>>) = (vec![], vec![]);
    while let Some(sample) = whole.next_sample().unwrap() {
        postures.push(sample.posture.iter().map(|value| value.to_bits()).collect());
        let snapshot = whole.snapshot().clone();
        if snapshots.last().is_none_or(|last| last.samples != snapshot.samples) {
            snapshots.push(snapshot);
        }
    }
    assert_eq!(whole.summary().foot_steps.first().map(|step| step.kind), Some(StepKind::PutDown));
    assert!(snapshots.len() == 3, "{}", snapshots.len());
    for snapshot in snapshots.into_iter().skip(1) {
        let mut at = snapshot.samples as usize;
        let mut resumed = Run::resume(&scenario, snapshot).unwrap();
        while let Some(sample) = resumed.next_sample().unwrap() {
            let bits: Vec<u64> = sample.posture.iter().map(|value| value.to_bits()).collect();
            assert!(bits == postures[at], "sample {at}");
            at += 1;
        }
        assert_eq!(resumed.summary(), whole.summary());
    }
}

/// The error of a scenario whose table has these lines, with others at the end.
fn refused(table: &str, rest: &str) -> String {
    complaint(&read_run("bench.toml", (text(table, "duration_s = 1\n") + rest).as_bytes(), None).unwrap_err())
}

#[test]
fn a_rest_that_makes_no_sense_is_refused_by_name() {
    let at_work = refused("may_carry = [\"right_hand\"]", "");
    assert!(at_work.contains("`hand_r` is at work") && at_work.contains("line 8: [[table]]"), "{at_work}");
    let twice = refused("carries = [\"left_hand\"]\nmay_carry = [\"left_hand\"]", "");
    assert!(twice.contains("`hand_l` is a support already"), "{twice}");
    let rest = |lines: &str| refused("", &format!("[[rest]]\nsegment = \"hand_l\"\n{lines}"));
    let plane = "on = { normal = [0, 1, 0], point_m = [0, 0.72, 0] }\n";
    let few = rest(&format!("{plane}region_m = [[0, 0, 0], [1, 0, 0]]"));
    assert!(few.contains("region_m has 2 corners"), "{few}");
    let corners = "region_m = [[0.3, 0.72, 0], [0.5, 0.72, 0], [0.5, 0.72, -0.4]]";
    let far = rest(&format!("{plane}region_m = [[0.3, 0.72, 0], [0.5, 0.72, 0], [0.5, -2e9, -0.4]]"));
    assert!(far.contains("a corner of the region is at") && far.contains("1e9 at most"), "{far}");
    let point = rest(&format!("on = {{ normal = [0, 1, 0] }}\n{corners}"));
    assert!(point.contains("needs `point_m`"), "{point}");
    let line = rest(&format!("{plane}{corners}\ncorners_m = [[0, 0, 0], [0.1, 0, 0]]"));
    assert!(line.contains("has no area"), "{line}");
    let friction = rest(&format!("{plane}{corners}\nfriction = 11"));
    assert!(friction.contains("friction is 11"), "{friction}");
}

/// At a time when no muscle group seeks relief; it would have the hand taken up itself.
#[test]
fn a_hand_that_rests_is_taken_up_when_the_work_moves_away() {
    let text = text("may_carry = [\"left_hand\"]", "duration_s = 275").replace("0.76, 0.00]", "0.76, 0.05]");
    let event = "[[event]]\nat_s = 260\ntask = 1\ntarget_m = [0.10, 1.20, 0.50]\n[strategy]";
    let scenario = read_scenario("bench.toml", text.replacen("[strategy]", event, 1).as_bytes(), None).unwrap();
    let (mut deepest, mut share) = (f64::NEG_INFINITY, 1.0);
    let mut missing = vec![];
    let summary = run(&scenario, |sample| {
        deepest = deepest.max(palm(&scenario, sample.posture).1);
        let standing = sample.standing.unwrap();
        share = standing.contacts[2].share;
        missing.push((sample.time, standing.errors[0]));
    });
    let kinds: Vec<StepKind> = summary.foot_steps.iter().map(|step| step.kind).collect();
    println!("{:?}", summary.foot_steps);
    assert_eq!(kinds, [StepKind::PutDown, StepKind::TakenOff]);
    let step = summary.foot_steps[1];
    assert!(step.time.0 >= 260.0, "{step:?}");
    assert!(deepest < 1e-3 && share == 0.0, "{deepest} m deep, {share} of the weight");
    let at = |time: f64| missing.iter().rfind(|(t, _)| *t <= time).unwrap().1;
    let (before, after) = (at(step.time.0), at(275.0));
    println!("{before} m off before the hand is taken up, {after} m at the end");
    assert!(
        step.relieves.is_none() && before > 0.02 && after < 1e-3,
        "{before} m off before, {after} m after: {step:?}"
    );
    assert_eq!(summary.in_use, [0, 1]);
}

#[test]
fn a_free_hand_that_reaches_a_table_is_offered_a_rest_there_and_no_other_hand_is() {
    let offered = |scenario: &Scenario| -> Vec<RestingHand> {
        let hand = |change: Change| if let Change::Hand(hand) = change { Some(hand) } else { None };
        changes(&Job::from(scenario), &[]).into_iter().filter_map(hand).collect()
    };
    let alone = read_scenario("bench.toml", text("", "duration_s = 1").as_bytes(), None).unwrap();
    let all = offered(&alone);
    let [hand] = &all[..] else { panic!("{all:?}") };
    assert_eq!(Some(hand.support.segment), alone.model.segment("hand_l"));
    assert!((hand.height - HEIGHT).abs() < 1e-12);
    let Place::Free(region) = &hand.support.place else { panic!("its place is fixed") };
    for corner in &region.corners {
        // On the top of the table, 0.7 m deep from 0.14 m on and 1.4 m wide.
        assert!((corner.y - HEIGHT).abs() < 1e-12 && (0.14..=0.84).contains(&corner.x) && corner.z.abs() <= 0.7);
    }
    // The change is the rest that the file would have.
    let changed = Change::Hand(hand.clone()).apply(&alone);
    let rest = &scenario("duration_s = 1").rests[0];
    assert_eq!((changed.rests[0].support, changed.rests[0].height), (rest.support, rest.height));
    assert!((changed.rests[0].inward - rest.inward).norm() < 1e-12);
    assert!(Run::new(&changed).is_ok());
    assert!(offered(&changed).is_empty(), "a hand that may rest already is offered nothing");
    let far = text("", "duration_s = 1").replace("edge_m = 0.14", "edge_m = 1.5");
    assert!(offered(&read_scenario("far.toml", far.as_bytes(), None).unwrap()).is_empty(), "out of reach");
}
