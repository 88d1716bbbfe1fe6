//! Every kind of verdict against numbers that are computed here in another way: levers, polygons, distances, Euler's method.

use contrapposto::contact::Slip;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Model, Side};
use contrapposto::posture::Posture;
use contrapposto::simulation::{Run, Scenario, ScenarioError, StopReason, Summary};
use contrapposto::verdict::{HeldPosture, Verdict, VerdictKind, how_long};
use contrapposto_formats::{VerdictText, read_scenario};
use nalgebra::Vector3;

const GRAVITY: f64 = 9.81;

/// A right arm that cannot move, its forearm level, with a weight on the forearm straight below the shoulder: no lever there.
fn arm(kilograms: f64, seconds: f64) -> Scenario {
    let text = format!(
        r#"
format = 1
title = "a weight on the forearm"
[model]
adult = {{ sex = "male", stature_m = 1.75, mass_kg = 75, part = "right_arm" }}
[posture]
arm_flex_r_deg = -20
elbow_flex_r_deg = 110
[coordinates]
free = []
[[load]]
segment = "radius_r"
mass_kg = {kilograms}
[strategy]
kind = "active"
[run]
duration_s = {seconds}
step_s = 0.1
"#
    );
    read_scenario("arm.toml", text.as_bytes(), None).unwrap()
}

/// A man on both feet with more tables.
fn standing(tables: &str) -> Scenario {
    let text = format!(
        r#"
format = 1
title = "standing"
[model]
adult = {{ sex = "male", stature_m = 1.75, mass_kg = 75 }}
[[support]]
segment = "calcn_r"
[[support]]
segment = "calcn_l"
{tables}
[[task]]
kind = "effort"
[strategy]
kind = "active"
[run]
duration_s = 1
step_s = 0.1
"#
    );
    read_scenario("standing.toml", text.as_bytes(), None).unwrap()
}

fn run(scenario: &Scenario) -> (Summary, Verdict, Posture) {
    let mut run = Run::new(scenario).unwrap();
    let mut last = vec![];
    while let Some(sample) = run.next_sample().unwrap() {
        last = sample.posture.to_vec();
    }
    let summary = run.summary();
    let verdict = Verdict::of_run(scenario, &summary);
    (summary, verdict, Posture::new(last))
}

/// Torque about the elbow that weight, load and ligaments leave to muscles, N m, from masses and levers, and the flexors' strength.
fn elbow(scenario: &Scenario, kilograms: f64) -> (f64, f64) {
    let model = &scenario.model;
    let i = model.coordinate("elbow_flex_r").unwrap();
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &scenario.start).unwrap();
    let elbow = kinematics.station(model, model.segment("ulna_r").unwrap(), Vector3::zeros());
    let lever =
        |segment: &str, at: Vector3<f64>| (kinematics.station(model, model.segment(segment).unwrap(), at) - elbow).x;
    let mut torque = 0.0;
    for name in ["ulna_r", "radius_r", "hand_r"] {
        let Some(s) = model.segment(name) else { continue };
        let segment = &model.segments()[s];
        torque += segment.mass * GRAVITY * lever(name, segment.center_of_mass);
    }
    let forearm = &model.segments()[model.segment("radius_r").unwrap()];
    torque += kilograms * GRAVITY * lever("radius_r", forearm.center_of_mass);
    let passive = model.coordinates()[i].passive.as_ref().unwrap().torque(i, scenario.start.values());
    let groups = model.coordinates()[i].groups.as_ref().unwrap();
    (torque - passive, groups[Side::Positive.index()].strength.torque(scenario.start.values()[i]))
}

/// Time (s) at which a rested group fails under a constant load by the three-compartment controller's equations, by Euler's method;
/// infinite if not within a day.
fn euler(model: &Model, coordinate: &str, load: f64) -> f64 {
    let i = model.coordinate(coordinate).unwrap();
    let group = &model.coordinates()[i].groups.as_ref().unwrap()[0];
    let contrapposto::fatigue::FatigueLaw::ThreeCompartment(law) = &group.fatigue else { panic!("another law") };
    // The active share is the load while it can be carried: MF' = F TL - R MF.
    let (mut fatigued, mut time, h) = (0.0, 0.0, 0.01);
    while fatigued < 1.0 - load && time < 86_400.0 {
        fatigued += h * (law.fatigue_rate * load - law.recovery_rate * fatigued);
        time += h;
    }
    if time < 86_400.0 { time } else { f64::INFINITY }
}

#[test]
fn a_weight_beyond_the_strength_of_the_elbow_cannot_be_done_by_the_share_that_levers_give() {
    let kilograms = 90.0;
    let scenario = arm(kilograms, 10.0);
    let (torque, strength) = elbow(&scenario, kilograms);
    assert!(torque > 1.2 * strength, "{torque} of {strength}");
    let (_, verdict, _) = run(&scenario);
    assert_eq!(verdict.kind, VerdictKind::CannotBeDone);
    let who = verdict.who.unwrap();
    assert!((who.load - torque / strength).abs() < 1e-3 * who.load, "{} of {}", who.load, torque / strength);
    let words = format!(
        "Cannot be done: right elbow flexion would need {:.0}\u{a0}% of its strength ({torque:.0} of {strength:.0} N m).",
        100.0 * torque / strength
    );
    assert_eq!(verdict.sentence, words);
}

#[test]
fn a_weight_that_tires_the_elbow_is_held_until_the_time_of_eulers_method_and_the_range_holds_it() {
    let kilograms = 25.0;
    let scenario = arm(kilograms, 900.0);
    let (torque, strength) = elbow(&scenario, kilograms);
    let time = euler(&scenario.model, "elbow_flex_r", torque / strength);
    assert!(time > 20.0 && time < 800.0, "{time}");
    let (_, verdict, _) = run(&scenario);
    assert_eq!(verdict.kind, VerdictKind::HeldUntil, "{}", verdict.sentence);
    let seconds = verdict.seconds.unwrap();
    // The controller takes half a second to reach the load.
    assert!((seconds - time).abs() < 1.0 + 0.01 * time, "{seconds} s, by Euler {time} s");
    let (least, greatest) = verdict.range.unwrap();
    assert!(least < 0.8 * seconds && greatest > 1.2 * seconds, "{least} to {greatest}");
    let start = format!("Can be held {} of the 15\u{a0}min asked (", how_long(seconds));
    assert!(verdict.sentence.starts_with(&start), "{}", verdict.sentence);
    assert!(verdict.sentence.ends_with("then right elbow flexion fails first."), "{}", verdict.sentence);
    // A failure in the last second is said in seconds.
    let (_, barely, _) = run(&arm(kilograms, seconds.ceil() + 1.0));
    let start = format!("Can be held {:.0}\u{a0}s of the {:.0}\u{a0}s asked (", seconds.floor(), seconds.ceil() + 1.0);
    assert!(barely.sentence.starts_with(&start), "{}", barely.sentence);
    let text = VerdictText::new(&scenario.model, &verdict);
    assert_eq!((text.kind, text.who.as_deref()), ("held_until", Some("right elbow flexion")));
    assert!((text.minutes.unwrap() - seconds / 60.0).abs() < 1e-12);
}

#[test]
fn the_same_weight_for_a_minute_holds_and_names_the_hardest_worked_group() {
    let kilograms = 2.0;
    let scenario = arm(kilograms, 60.0);
    let (torque, strength) = elbow(&scenario, kilograms);
    assert!(euler(&scenario.model, "elbow_flex_r", torque / strength) > 60.0);
    let (summary, verdict, _) = run(&scenario);
    assert_eq!(verdict.kind, VerdictKind::Holds, "{}", verdict.sentence);
    let greatest = summary.coordinates.iter().map(|coordinate| coordinate.peak_load).fold(0.0, f64::max);
    let hardest = verdict.hardest.unwrap();
    assert_eq!(hardest.load, greatest);
    let (who, share) = (hardest.name(&scenario.model), 100.0 * greatest);
    let words = format!(
        "Can be held for all of the 60\u{a0}s asked, also for weaker people (the weakest sixth); hardest worked: {who} at {share:.0}\u{a0}% of its strength."
    );
    assert_eq!(verdict.sentence, words);
    assert!(verdict.has_reserve(), "{}", verdict.sentence);
}

#[test]
fn a_weight_that_holds_for_a_while_fails_in_a_longer_run_at_the_time_and_in_the_range_that_were_foretold() {
    let kilograms = 25.0;
    let scenario = arm(kilograms, 900.0);
    let (_, longer, _) = run(&scenario);
    assert_eq!(longer.kind, VerdictKind::HeldUntil, "{}", longer.sentence);
    let fails = longer.seconds.unwrap();
    let rows: Vec<&str> = longer.lines.iter().map(|line| line.name).collect();
    assert_eq!(rows[..3], ["Fails first", "Hardest worked", "Most tired"]);
    let first = format!(" of its strength), after {} (between ", how_long(fails));
    assert!(longer.lines[0].text.starts_with("right elbow flexion (") && longer.lines[0].text.contains(&first));
    // The weaker fail before the end of the longest of these runs, and only the middle and the long one end tired.
    for (share, tired) in [(0.1, false), (0.6, true), (0.95, true)] {
        let seconds = (share * fails).round();
        let shorter = arm(kilograms, seconds);
        let (_, verdict, _) = run(&shorter);
        assert_eq!(verdict.kind, VerdictKind::Holds, "{}", verdict.sentence);
        println!("{seconds} s of {fails}: {}", verdict.sentence);
        assert_eq!(verdict.asked, Some(seconds));
        assert_eq!(verdict.who.unwrap().name(&shorter.model), "right elbow flexion");
        assert!((verdict.seconds.unwrap() - fails).abs() < 0.2 + 1e-3 * fails, "{:?} and {fails}", verdict.seconds);
        let ((least, greatest), (lower, upper)) = (verdict.range.unwrap(), longer.range.unwrap());
        assert!(
            (least - lower).abs() < 0.02 * lower && (greatest - upper).abs() < 0.02 * upper,
            "{least} to {greatest}"
        );
        assert!(least < fails && fails < greatest);
        assert_eq!(verdict.fails_weaker.is_some(), least < seconds, "{}", verdict.sentence);
        let weaker =
            format!(", but in weaker people (the weakest sixth) right elbow flexion fails within {}.", how_long(least));
        assert_eq!(verdict.sentence.contains(&weaker), least < seconds, "{}", verdict.sentence);
        let end = verdict.tired.unwrap();
        assert_eq!(end.fatigue > 0.5, tired);
        assert!(verdict.in_words().contains("\nMost tired: right elbow flexion, "), "{}", verdict.in_words());
        assert!(verdict.in_words().contains("\nHardest worked: right elbow flexion, "), "{}", verdict.in_words());
        let beyond = format!(
            "; in weaker people (the weakest sixth) right elbow flexion only after {}, beyond the {} asked.",
            how_long(least),
            how_long(seconds)
        );
        assert_eq!(verdict.in_words().contains(&beyond), least >= seconds, "{}", verdict.in_words());
        let first = format!(
            " of its strength), after about {}, counted from the start, if the last posture is kept",
            how_long(fails)
        );
        assert!(
            verdict.in_words().contains("\nFails first: right elbow flexion (") && verdict.in_words().contains(&first)
        );
        assert_eq!(verdict.has_reserve(), !tired && least >= seconds);
        let text = VerdictText::new(&shorter.model, &verdict);
        assert!((text.minutes.unwrap() - verdict.seconds.unwrap() / 60.0).abs() < 1e-12);
        assert_eq!(text.tired.unwrap().fatigue, end.fatigue);
    }
}

#[test]
fn a_target_195_metres_up_is_not_reached_by_its_distance_from_the_hand() {
    let target = Vector3::new(0.4, 195.0, 0.2);
    let scenario = standing(
        "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\nat_m = [0, -0.07, 0]\ntarget_m = [0.4, 195.0, 0.2]\nabove_relief = true",
    );
    let (_, verdict, last) = run(&scenario);
    assert_eq!(verdict.kind, VerdictKind::NotReached, "{}", verdict.sentence);
    let mut kinematics = Kinematics::new(&scenario.model);
    kinematics.update(&scenario.model, &last).unwrap();
    let hand = scenario.model.segment("hand_r").unwrap();
    let away = (kinematics.station(&scenario.model, hand, Vector3::new(0.0, -0.07, 0.0)) - target).norm();
    assert!((verdict.missed[0].distance - away).abs() < 0.02 * away, "{} and {away}", verdict.missed[0].distance);
    assert!(verdict.sentence.starts_with("Not reached: point right hand is missed by 19"), "{}", verdict.sentence);
    // Where the hand gets, and what is left from there.
    let at = kinematics.station(&scenario.model, hand, Vector3::new(0.0, -0.07, 0.0));
    let nearest = verdict.missed[0].nearest.unwrap();
    assert!((nearest.at - at).norm() < 1e-9 && (nearest.to_target - (target - at)).norm() < 1e-9, "{nearest:?}");
    let words = format!("It ends at {:.2}, {:.2}, {:.2} m", at.x, at.y, at.z).replace('-', "\u{2212}");
    let end = format!("from there the target lies {:.2} m higher.", target.y - at.y);
    assert!(verdict.sentence.contains(&words) && verdict.sentence.ends_with(&end), "{}", verdict.sentence);
}

#[test]
fn a_run_whose_nearest_posture_falls_begins_in_one_that_stands_and_says_who_is_too_weak() {
    // Both hands hold 25 kg at shin height with a bent back; the posture nearest to the start falls forward.
    let text = r#"
format = 1
title = "50 kg at shin height"
[model]
adult = { sex = "male", stature_m = 1.75, mass_kg = 75 }
[posture]
pelvis_ty_m = 0.905
pelvis_tx_m = -0.12
pelvis_tilt_deg = -50
hip_flexion_r_deg = 60
hip_flexion_l_deg = 60
knee_angle_r_deg = 15
knee_angle_l_deg = 15
ankle_angle_r_deg = 5
ankle_angle_l_deg = 5
lumbar_extension_deg = -30
arm_flex_r_deg = 90
arm_flex_l_deg = 90
[[support]]
segment = "calcn_r"
[[support]]
segment = "calcn_l"
[[load]]
segment = "hand_r"
mass_kg = 25
[[load]]
segment = "hand_l"
mass_kg = 25
[[task]]
kind = "point"
segment = "hand_r"
at_m = [0, -0.07, 0]
target_m = [0.35, 0.35, 0.20]
above_relief = true
[[task]]
kind = "point"
segment = "hand_l"
at_m = [0, -0.07, 0]
target_m = [0.35, 0.35, -0.20]
above_relief = true
same_priority = true
[[task]]
kind = "effort"
[strategy]
kind = "active"
[run]
duration_s = 1
"#;
    let scenario = read_scenario("lift.toml", text.as_bytes(), None).unwrap();
    let (_, verdict, end) = run(&scenario);
    assert_eq!(verdict.kind, VerdictKind::CannotBeDone, "{}", verdict.sentence);
    // The weight of body and loads together acts between heels and toes.
    let model = &scenario.model;
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &end).unwrap();
    let hand = |name: &str| {
        let hand = model.segment(name).unwrap();
        kinematics.station(model, hand, model.segments()[hand].center_of_mass)
    };
    let held = 25.0 * (hand("hand_r") + hand("hand_l"));
    let together = (model.mass() * kinematics.center_of_mass(model).unwrap() + held) / (model.mass() + 50.0);
    let corners = scenario.supports.iter().flat_map(|support| support.corners.iter().map(|c| (support.segment, *c)));
    let xs: Vec<f64> = corners.map(|(segment, corner)| kinematics.station(model, segment, corner).x).collect();
    let (back, front) = xs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
    assert!(back - 1e-3 < together.x && together.x < front + 1e-3, "{} of {back}..{front}", together.x);
}

#[test]
fn a_weight_before_the_body_with_every_joint_locked_cannot_stand_where_the_line_of_weight_leaves_the_feet() {
    let kilograms = 60.0;
    let load = format!(
        "[posture]\narm_flex_r_deg = 90\narm_flex_l_deg = 90\n[coordinates]\nfree = []\n[[load]]\nsegment = \"hand_r\"\nmass_kg = {kilograms}"
    );
    let scenario = standing(&load);
    let model = &scenario.model;
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &scenario.start).unwrap();
    let hand = model.segment("hand_r").unwrap();
    let held = kinematics.station(model, hand, model.segments()[hand].center_of_mass);
    let body = kinematics.center_of_mass(model).unwrap();
    let together = (model.mass() * body + kilograms * held) / (model.mass() + kilograms);
    let toes = scenario.supports.iter().flat_map(|support| {
        support.corners.iter().map(|corner| kinematics.station(model, support.segment, *corner).x).collect::<Vec<_>>()
    });
    let front = toes.fold(f64::NEG_INFINITY, f64::max);
    assert!(together.x > front + 0.01, "{} of {front}", together.x);
    let missing = match Run::new(&scenario).map(|_| ()) {
        Err(ScenarioError::CannotStand(missing)) => missing,
        other => panic!("{other:?}"),
    };
    let verdict = Verdict::of_fall(model, missing, &scenario.loads);
    assert_eq!(verdict.kind, VerdictKind::CannotStand);
    let under = format!("Cannot stand: the supports do not hold the body under its load of {kilograms}\u{a0}kg; ");
    assert!(verdict.sentence.starts_with(&under), "{}", verdict.sentence);
    let beyond = together.x - front;
    assert!(verdict.sentence.contains("beyond the supports"), "{}", verdict.sentence);
    let said: f64 = verdict.sentence.split(" act ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((said - beyond).abs() < 0.01, "{said} and {beyond}");
}

#[test]
fn a_body_on_its_hands_that_slide_cannot_stand_by_the_distance_and_angle_of_its_segments_and_the_run_ends_there() {
    // Hands on the floor, bent legs in the air: balance, which is above places, drags the hands along.
    let text = r#"
format = 1
title = "on the hands"
least_effort = false
[model]
adult = { sex = "male", stature_m = 1.85, mass_kg = 73 }
[coordinates]
locked = ["shoulder_rise_r", "shoulder_rise_l"]
[posture]
ankle_angle_r_deg = 10
ankle_angle_l_deg = 10
elbow_flex_l_deg = 12.97
hip_flexion_r_deg = 20
hip_flexion_l_deg = 20
knee_angle_r_deg = 30
knee_angle_l_deg = 30
[[support]]
segment = "hand_r"
[[support]]
segment = "hand_l"
friction = 0.483
[[task]]
kind = "orientation"
segment = "abdomen"
target = "start"
[strategy]
kind = "passive"
[relief]
max_step_deg = 5.594
[run]
duration_s = 5
step_s = 0.5
"#;
    let scenario = read_scenario("hands.toml", text.as_bytes(), None).unwrap();
    let model = &scenario.model;
    let mut samples = vec![];
    let mut every = Run::new(&scenario).unwrap();
    while let Some(sample) = every.next_sample().unwrap() {
        samples.push((sample.time, Posture::new(sample.posture.to_vec())));
    }
    let (summary, verdict, _) = run(&scenario);
    let (slip, time) = summary.slip.unwrap();
    let since = summary.sliding_since.unwrap();
    assert_eq!(summary.reason, StopReason::Slid);
    assert!(time >= since && since > 0.0 && (summary.end_time - since - 1.0).abs() < 1e-9, "{since} s: {summary:?}");
    assert!(slip.exceeds(Slip::GREATEST) && slip.exceeds(Slip::NOTICED), "{slip:?}");
    let greatest = samples.iter().find(|(at, _)| (at - time).abs() < 1e-9).unwrap();
    // Supports keep the places that they have in the start of the file. Distance and angle of both hands at a sample.
    let slid = |posture: &Posture| {
        let [start, end] = [&scenario.start, posture].map(|posture| {
            let mut kinematics = Kinematics::new(model);
            kinematics.update(model, posture).unwrap();
            kinematics
        });
        let hands = ["hand_r", "hand_l"].map(|name| model.segment(name).unwrap());
        hands.iter().fold((0.0_f64, 0.0_f64), |(distance, angle), &segment| {
            let (from, to) = (start.placement(model, segment), end.placement(model, segment));
            let moved = (to.translation.vector - from.translation.vector).norm();
            (libm::hypot(distance, moved), libm::hypot(angle, from.rotation.angle_to(&to.rotation)))
        })
    };
    let (distance, angle) = slid(&greatest.1);
    assert!(
        (slip.distance - distance).abs() < 1e-9 && (slip.angle - angle).abs() < 1e-7,
        "{slip:?} {distance} {angle}"
    );
    assert_eq!(verdict.kind, VerdictKind::CannotStand);
    // The sentence says the slip with which the run ends.
    let (distance, angle) = slid(&samples.last().unwrap().1);
    let said = format!("Cannot stand: supports slide by {:.1} cm and {:.1}°", 100.0 * distance, angle.to_degrees());
    assert!(verdict.sentence.starts_with(&said), "{} and {said}", verdict.sentence);
    assert_eq!(verdict.slip, Some((slip, Some(time))));
}

#[test]
fn slip_is_noticed_from_a_millimetre_or_a_tenth_of_a_degree_and_ends_a_job_from_five_millimetres_or_a_degree() {
    let slip = |millimetres: f64, degrees: f64| Slip { distance: 1e-3 * millimetres, angle: degrees.to_radians() };
    let model = &arm(1.0, 1.0).model;
    for (slip, noticed, ends) in [
        (slip(0.9, 0.09), false, false),
        (slip(1.1, 0.0), true, false),
        (slip(0.0, 0.11), true, false),
        (slip(4.9, 0.9), true, false),
        (slip(5.1, 0.0), true, true),
        (slip(0.0, 1.1), true, true),
    ] {
        assert_eq!(
            (slip.share_of(Slip::NOTICED) > 1.0, slip.share_of(Slip::GREATEST) > 1.0),
            (noticed, ends),
            "{slip:?}"
        );
        let verdict = Verdict::of_posture(model, &HeldPosture { slip, ..HeldPosture::default() });
        assert_eq!(verdict.slip.is_some(), noticed, "{slip:?}");
        assert_eq!(verdict.kind == VerdictKind::CannotStand, ends, "{slip:?}: {}", verdict.sentence);
    }
}

#[test]
fn words_of_kinds_are_those_of_the_files_and_only_two_are_done() {
    let words: Vec<&str> = VerdictKind::ALL.iter().map(|kind| kind.word()).collect();
    assert_eq!(words, ["cannot_be_done", "cannot_stand", "not_reached", "held_until", "holds"]);
    let done: Vec<bool> = VerdictKind::ALL.iter().map(|kind| kind.is_done()).collect();
    assert_eq!(done, [false, false, false, true, true]);
}

/// A man whose root is held, bent in the lumbar spine alone.
fn bent(degrees: f64) -> Scenario {
    let text = format!(
        "format = 1\n[posture]\npelvis_ty_m = 0.95\nlumbar_extension_deg = {degrees}\n[coordinates]\nfree = []\n\
         [strategy]\nkind = \"active\"\n[run]\nduration_s = 1\nstep_s = 0.1\n"
    );
    read_scenario("bent.toml", text.as_bytes(), None).unwrap()
}

#[test]
fn a_lumbar_spine_that_hangs_on_its_ligaments_holds_but_is_named_with_the_torque_that_levers_give() {
    let scenario = bent(-60.0);
    let (_, verdict, _) = run(&scenario);
    let model = &scenario.model;
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &scenario.start).unwrap();
    let i = model.coordinate("lumbar_extension").unwrap();
    let joint = kinematics.station(model, model.segment("abdomen").unwrap(), Vector3::zeros());
    let legs = ["pelvis", "femur", "tibia", "talus", "calcn", "toes"];
    let above =
        model.segments().iter().enumerate().filter(|(_, part)| !legs.iter().any(|leg| part.name.starts_with(leg)));
    let torque: f64 = above
        .map(|(s, part)| part.mass * GRAVITY * (kinematics.station(model, s, part.center_of_mass) - joint).x)
        .sum();
    let passive = model.coordinates()[i].passive.as_ref().unwrap().torque(i, scenario.start.values());
    let share = (passive / torque).min(1.0);
    assert!(share > 0.5, "{passive} of {torque}");
    assert_eq!(verdict.kind, VerdictKind::Holds, "{}", verdict.sentence);
    let part = if share > 0.995 { "its whole".to_owned() } else { format!("{:.0}\u{a0}% of its", 100.0 * share) };
    let posture = "low back bent forward by 60°";
    let words = format!("{posture}: ligaments carry {part} torque of {torque:.0}\u{a0}N\u{a0}m");
    assert!(verdict.sentence.ends_with(&format!(" Hazard for ligaments: {posture}.")), "{}", verdict.sentence);
    let line = format!("\nHazard: {words} for ");
    assert!(verdict.in_words().contains(&line), "{line}: {}", verdict.in_words());
    assert!(!verdict.has_reserve());
    let text = VerdictText::new(model, &verdict);
    let hazard = &text.hazards[0];
    assert_eq!((hazard.coordinate.as_str(), text.hazards.len()), ("lumbar_extension", 1));
    assert!((hazard.angle_deg + 60.0).abs() < 1e-9 && (hazard.carried - share).abs() < 1e-9);
    assert!(hazard.sentence.starts_with(&words), "{}", hazard.sentence);
}

#[test]
fn a_lumbar_spine_bent_within_three_quarters_of_its_range_is_in_no_hazard() {
    let (_, verdict, _) = run(&bent(-40.0));
    assert!(verdict.hazards.is_empty() && !verdict.sentence.contains("ligaments"), "{}", verdict.sentence);
}

/// A man whose root is held and whose foot a force pulls forward, so that his right knee is hyperextended, until the force turns round.
#[test]
fn a_hazard_that_an_event_ends_is_told_with_its_seconds_and_not_as_one_of_the_end() {
    let text = |event: Option<f64>, sides: &[&str]| {
        let pull = |table: &str, newtons: f64| -> String {
            let at = |side: &&str| {
                format!("[[{table}]]\nsegment = \"calcn_{side}\"\nforce_n = [{newtons}, 0, 0]\nfixed_in = \"world\"\n")
            };
            sides.iter().map(at).collect()
        };
        let bent: String = sides.iter().map(|side| format!("knee_angle_{side}_deg = -5\n")).collect();
        let turned = event.map(|at| format!("[[event]]\nat_s = {at}\n{}", pull("event.load", -20.0)));
        format!(
            "format = 1\n[posture]\npelvis_ty_m = 0.95\n{bent}elbow_flex_r_deg = 20\nelbow_flex_l_deg = 20\n\
             [coordinates]\nfree = []\n{}[strategy]\nkind = \"active\"\n{}[run]\nduration_s = 20\nstep_s = 0.1\n",
            pull("load", 80.0),
            turned.unwrap_or_default()
        )
    };
    let of_sides = |event: Option<f64>, sides: &[&str]| {
        run(&read_scenario("pulled.toml", text(event, sides).as_bytes(), None).unwrap()).1
    };
    let judged = |event: Option<f64>| of_sides(event, &["r"]);
    let (verdict, held) = (judged(Some(12.0)), judged(None));
    assert!(verdict.hazards.is_empty() && !verdict.has_reserve(), "{}", verdict.sentence);
    let [passed] = verdict.passed.as_slice() else { panic!("{:?}", verdict.passed) };
    assert!((passed.seconds - 12.0).abs() < 0.15 && passed.time < 12.0, "{passed:?}");
    // Torque and share are those of the same posture without the event.
    assert_eq!((held.hazards.len(), held.hazards[0].external), (1, passed.hazard.external));
    let said = verdict.in_words();
    assert!(
        verdict.sentence.ends_with("Hazard for ligaments: right knee hyperextended by 5° for 12\u{a0}s."),
        "{said}"
    );
    let both = of_sides(Some(12.0), &["r", "l"]).sentence;
    assert!(both.ends_with("Hazard for ligaments: right and left knee hyperextended by 5° for 12\u{a0}s."), "{both}");
    assert!(said.contains(" for 12\u{a0}s, over at the end; knees that are hyperextended"), "{said}");
    // One that lasts less than 5 s is a motion.
    assert!(judged(Some(3.0)).passed.is_empty());
}

/// The torque of ligaments at full flexion, the strength of the muscles, and what more weight in the hands makes of the share.
#[test]
fn no_load_that_muscles_can_hold_takes_the_hazard_of_a_fully_bent_spine_away() {
    let mut named = 0;
    for kilograms in (0..=120).step_by(10) {
        let text = format!(
            "format = 1\n[posture]\npelvis_ty_m = 0.95\nlumbar_extension_deg = -60\n[coordinates]\nfree = []\n[[load]]\n\
             segment = \"torso\"\nforce_n = [0, {}, 0]\nfixed_in = \"world\"\n[strategy]\nkind = \"active\"\n\
             [run]\nduration_s = 0.1\nstep_s = 0.1\n",
            -GRAVITY * f64::from(kilograms)
        );
        let (_, verdict, _) = run(&read_scenario("loaded.toml", text.as_bytes(), None).unwrap());
        if verdict.kind != VerdictKind::CannotBeDone {
            assert_eq!(verdict.hazards.len(), 1, "{kilograms} kg: {}", verdict.sentence);
            named += 1;
        }
    }
    assert!(named >= 8, "{named}");
}

/// The hand of a standing man asked to two heights, the first of them above relief.
fn two_heights(second_above_relief: bool) -> Scenario {
    let task = |height: f64, above: bool| {
        format!(
            "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.4, {height}, 0.2]\nabove_relief = {above}\n"
        )
    };
    standing(&(task(1.2, true) + &task(0.8, second_above_relief)))
}

#[test]
fn of_two_heights_of_one_hand_that_are_both_demanded_the_second_is_not_reached_by_their_distance() {
    let (_, verdict, _) = run(&two_heights(true));
    assert_eq!(verdict.kind, VerdictKind::NotReached, "{}", verdict.sentence);
    assert!((verdict.missed[0].distance - 0.4).abs() < 1e-3 && verdict.missed[0].contradicts, "{:?}", verdict.missed);
    let words =
        "Not reached: point right hand is missed by 40.0 cm; a more important target of the same part is elsewhere.";
    assert_eq!(verdict.sentence, words);
    let (_, verdict, _) = run(&two_heights(false));
    assert!(verdict.kind.is_done(), "{}", verdict.sentence);
    assert!(!verdict.missed[0].decides && (verdict.missed[0].distance - 0.4).abs() < 1e-3, "{:?}", verdict.missed);
}
