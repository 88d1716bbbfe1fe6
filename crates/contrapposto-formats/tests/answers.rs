//! The answer names the weights that are too heavy for a hand, hips at their passive end, and a group that failed before an overload.

use contrapposto::model::{Adult, Sex, adult};
use contrapposto::simulation::{Scenario, run as simulate};
use contrapposto::verdict::{HandLoad, Line, Verdict, VerdictKind};
use contrapposto_formats::{VerdictText, read_scenario};

const GRAVITY: f64 = 9.81;

fn answer(text: &str) -> (Scenario, Verdict) {
    let scenario = read_scenario("job.toml", text.as_bytes(), None).unwrap();
    let summary = simulate(&scenario, |_| {}).unwrap();
    let verdict = Verdict::of_run(&scenario, &summary);
    (scenario, verdict)
}

/// An adult who stands still, arms down, with a weight in the right hand; the root is held, so that nothing but the hand is in question.
fn carrying(sex: &str, kilograms: f64) -> (Scenario, Verdict) {
    answer(&format!(
        "format = 1\n[model]\nadult = {{ sex = \"{sex}\", stature_m = 1.7, mass_kg = 70 }}\n[posture]\npelvis_ty_m = 0.95\n\
         elbow_flex_r_deg = 12\nelbow_flex_l_deg = 12\n[coordinates]\nfree = []\n[[load]]\nsegment = \"hand_r\"\n\
         mass_kg = {kilograms}\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 0.2\nstep_s = 0.1\n"
    ))
}

/// Mathiowetz et al. 1985, a second time, by hand: means of the nine age groups of both hands are 107.1 lb (men) and 63.1 lb (women).
#[test]
fn a_weight_is_judged_by_the_grip_of_the_sex_told_from_half_of_it_on_and_too_heavy_beyond_a_handle() {
    let pound = 4.448_221_615;
    for (sex, grip) in [("male", 107.122 * pound), ("female", 63.106 * pound)] {
        let named = |kilograms: f64| {
            let (scenario, verdict) = carrying(sex, kilograms);
            let hands = verdict.hands.clone();
            if let Some(hand) = hands.first() {
                assert!((hand.grip() - grip).abs() < 0.1, "{} and {grip}", hand.grip());
                assert!((hand.weight - GRAVITY * kilograms).abs() < 0.01 * hand.weight, "{hand:?}");
                let text = VerdictText::new(&scenario.model, &verdict);
                assert_eq!((text.hands[0].segment.as_str(), text.hands[0].weight_n), ("hand_r", hand.weight));
                assert!(!verdict.has_reserve());
            }
            (verdict, hands.len())
        };
        assert_eq!(named(0.49 * grip / GRAVITY).1, 0);
        let (verdict, hands) = named(0.51 * grip / GRAVITY);
        assert_eq!(hands, 1);
        let whose = if sex == "male" { "a man's" } else { "a woman's" };
        let words = format!("51\u{a0}% of the mean strength of {whose} grip");
        assert!(verdict.in_words().contains(&words), "{words}: {}", verdict.in_words());
        let (verdict, _) = named(1.57 * grip / GRAVITY);
        assert!(!verdict.hands[0].is_too_heavy(), "{}", verdict.sentence);
        let (verdict, _) = named(1.6 * grip / GRAVITY);
        assert!(verdict.hands[0].is_too_heavy());
        assert_eq!(verdict.kind, VerdictKind::CannotBeDone, "{}", verdict.sentence);
    }
}

#[test]
fn a_hundred_and_fifty_kilograms_in_one_hand_cannot_be_done_and_the_hand_is_named() {
    let (_, verdict) = carrying("male", 150.0);
    assert_eq!(verdict.kind, VerdictKind::CannotBeDone, "{}", verdict.sentence);
    let model = adult(&Adult { sex: Sex::Female, ..Adult::default() }).unwrap();
    let hand = |name: &str| contrapposto::statics::Load {
        segment: model.segment(name).unwrap(),
        point: nalgebra::Vector3::zeros(),
        kind: contrapposto::statics::LoadKind::Weight(20.0),
    };
    // Weights on one hand add up; a weight on the back needs no grip.
    let hands = HandLoad::all(&model, &[hand("hand_r"), hand("hand_r"), hand("torso"), hand("hand_l")]);
    let weights: Vec<f64> = hands.iter().map(|hand| (hand.weight / model.gravity().norm()).round()).collect();
    assert_eq!(weights, [40.0, 20.0]);
    assert_eq!(hands[0].sex, Some(Sex::Female));
}

/// A man bent double, his pelvis level and the ground pushing up under his feet: hips at 115 degrees hang on their passive tissue and are
/// named; at 95 degrees they are not, nor where muscles carry them.
#[test]
fn hips_bent_beyond_a_hundred_degrees_on_passive_tissue_are_a_hazard() {
    let bent = |degrees: f64, newtons: f64| {
        let tilt = 25.0 - degrees;
        let push = |side: &str| {
            format!("[[load]]\nsegment = \"calcn_{side}\"\nforce_n = [0, {newtons}, 0]\nfixed_in = \"world\"\n")
        };
        answer(&format!(
            "format = 1\n[posture]\npelvis_ty_m = 0.95\npelvis_tilt_deg = {tilt}\nhip_flexion_r_deg = {degrees}\n\
             hip_flexion_l_deg = {degrees}\nknee_angle_r_deg = 25\nknee_angle_l_deg = 25\n[coordinates]\nfree = []\n{}{}\
             [strategy]\nkind = \"active\"\n[run]\nduration_s = 0.2\nstep_s = 0.1\n",
            push("r"),
            push("l")
        ))
        .1
    };
    let verdict = bent(115.0, 300.0);
    assert_eq!(verdict.kind, VerdictKind::Holds, "{}", verdict.sentence);
    assert!(verdict.sentence.contains("right and left hip bent by 115\u{b0}"), "{}", verdict.sentence);
    assert_eq!(verdict.hazards.len(), 2, "{:?}", verdict.hazards);
    assert!(verdict.hazards.iter().all(|hazard| hazard.carried() >= 0.5 && hazard.row.finding.contains("21 people")));
    assert!(bent(95.0, 300.0).hazards.is_empty(), "{}", bent(95.0, 300.0).sentence);
    assert!(bent(115.0, 900.0).hazards.is_empty(), "{}", bent(115.0, 900.0).sentence);
}

/// A forearm tires under a weight until it fails; two minutes later a weight comes that is more than its strength. The job ended before.
#[test]
fn an_overload_after_a_failure_does_not_make_the_job_one_that_cannot_be_done() {
    let text = |first: f64| {
        format!(
            "format = 1\n[model]\nadult = {{ sex = \"male\", stature_m = 1.75, mass_kg = 73 }}\n[posture]\npelvis_ty_m = 0.95\n\
             elbow_flex_r_deg = 90\nelbow_flex_l_deg = 12\n[coordinates]\nfree = []\n[[load]]\nsegment = \"radius_r\"\nforce_n = [0, {first}, 0]\n\
             fixed_in = \"world\"\n[[event]]\nat_s = 300\n[[event.load]]\nsegment = \"radius_r\"\nforce_n = [0, -900, 0]\n\
             fixed_in = \"world\"\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 400\nstep_s = 0.5\n"
        )
    };
    let (_, failed) = answer(&text(-200.0));
    assert_eq!(failed.kind, VerdictKind::HeldUntil, "{}", failed.sentence);
    assert!(failed.seconds.unwrap() < 300.0);
    assert!(failed.in_words().contains("\nLater: at 5.0"), "{}", failed.in_words());
    let (_, rested) = answer(&text(0.0));
    assert_eq!(rested.kind, VerdictKind::CannotBeDone, "{}", rested.sentence);
}

/// A group that rests at the end may have failed before in weaker people: an arm and a trunk hold until four fifths of the time that a person of mean
/// strength can, then a force turns round and they rest.
#[test]
fn a_group_that_rests_at_the_end_has_failed_before_in_weaker_people() {
    let text = |turns: f64, seconds: f64| {
        format!(
            "format = 1\n[model]\nadult = {{ sex = \"male\", stature_m = 1.75, mass_kg = 73 }}\n[posture]\npelvis_ty_m = 0.95\n\
             elbow_flex_r_deg = 90\nelbow_flex_l_deg = 12\n[coordinates]\nfree = []\n[[load]]\nsegment = \"radius_r\"\nforce_n = [0, -200, 0]\n\
             fixed_in = \"world\"\n[[event]]\nat_s = {turns}\n[[event.load]]\nsegment = \"radius_r\"\nforce_n = [0, 60, 0]\n\
             fixed_in = \"world\"\n[strategy]\nkind = \"active\"\n[run]\nduration_s = {seconds}\nstep_s = 0.5\n"
        )
    };
    let (_, failed) = answer(&text(300.0, 310.0));
    let held = (0.8 * failed.seconds.unwrap()).floor();
    let (scenario, verdict) = answer(&text(held, held + 5.0));
    assert_eq!(verdict.kind, VerdictKind::Holds, "{}", verdict.in_words());
    let weaker = verdict.fails_weaker.unwrap();
    assert_eq!(weaker.load, 0.0, "{}", verdict.in_words());
    assert!(verdict.least.unwrap() < held && !verdict.has_reserve(), "{:?}", verdict.least);
    let words = format!(", but in weaker people (the weakest sixth) {} fails within ", weaker.name(&scenario.model));
    assert!(verdict.sentence.contains(&words), "{}", verdict.sentence);
}

/// Hazards that nobody judges are not said to be none: only of parts whose coordinates have a known sense and passive torque.
#[test]
fn no_known_hazard_is_said_of_the_parts_that_are_judged_only() {
    let text = |part: &str| {
        format!(
            "format = 1\n[model]\nadult = {{ sex = \"male\", stature_m = 1.75, mass_kg = 73{part} }}\n[coordinates]\nfree = []\n\
             [strategy]\nkind = \"active\"\n[run]\nduration_s = 0.2\nstep_s = 0.1\n"
        )
    };
    let hazard = |part: &str| {
        let lines = answer(&text(part)).1.lines;
        lines.into_iter().find(|line| line.name == Line::HAZARD).map(|line| line.text)
    };
    let whole = "none is known for the ligaments of low back, knees and hips at these angles; discs and discomfort are not judged";
    assert_eq!(hazard("").as_deref(), Some(whole));
    assert_eq!(hazard(", part = \"right_arm\""), None);
}

/// An elbow that is tired from before holds so little that it does not become more tired: beside its fatigue stands why no muscle fails.
#[test]
fn a_tired_group_without_a_limit_is_told_to_become_no_more_tired() {
    let arm = |kilograms: f64| {
        let (_, verdict) = answer(&format!(
            "format = 1\n[model]\nadult = {{ sex = \"male\", stature_m = 1.75, mass_kg = 73 }}\n[posture]\npelvis_ty_m = 0.95\n\
             elbow_flex_r_deg = 90\nelbow_flex_l_deg = 12\n[coordinates]\nfree = []\n[fatigue.start]\n\
             elbow_flex_r = {{ positive = 0.6 }}\n[[load]]\nsegment = \"radius_r\"\nmass_kg = {kilograms}\n[strategy]\n\
             kind = \"active\"\n[run]\nduration_s = 2\nstep_s = 0.5\n"
        ));
        assert_eq!(verdict.kind, VerdictKind::Holds, "{}", verdict.sentence);
        let tired = verdict.tired.unwrap();
        assert!(tired.fatigue > 0.5, "{}", verdict.sentence);
        assert_eq!(tired.lasts, verdict.in_words().contains("; under this load it tires no further"));
        (tired.lasts, verdict.in_words())
    };
    let (lasts, sentence) = arm(0.0);
    assert!(lasts, "{sentence}");
    let (lasts, sentence) = arm(12.0);
    assert!(!lasts && sentence.contains("Most tired: right elbow flexion, 6"), "{sentence}");
}
