//! Random scenarios as their authors write them.

use std::fmt::Write;

use rand::RngExt;
use rand_pcg::Pcg64Mcg as Random;

/// Segments that take loads and tasks.
const SEGMENTS: [&str; 7] = ["hand_r", "hand_l", "radius_r", "torso", "head", "pelvis", "humerus_l"];

/// Coordinates with a tired group.
const TIRED: [&str; 6] =
    ["hip_adduction_r", "hip_flexion_l", "knee_angle_r", "lumbar_extension", "arm_flex_r", "elbow_flex_l"];

fn chance(random: &mut Random, share: f64) -> bool {
    random.random::<f64>() < share
}

fn one_of<'a>(random: &mut Random, all: &[&'a str]) -> &'a str {
    all[random.random_range(0..all.len())]
}

/// The text of a scenario: an adult of any size on two feet or on a seat.
pub(crate) fn random(random: &mut Random) -> String {
    let mut text = String::from("format = 1\ntitle = \"random\"\n[model]\n");
    let sex = one_of(random, &["male", "female"]);
    let (stature, mass) = (random.random_range(1.5..1.95), random.random_range(48.0..110.0));
    writeln!(text, "adult = {{ sex = \"{sex}\", stature_m = {stature:.3}, mass_kg = {mass:.1} }}").unwrap();
    let sits = chance(random, 0.2);
    posture(&mut text, sits, random);
    supports(&mut text, sits, random);
    for _ in 0..random.random_range(0..3) {
        load(&mut text, random);
    }
    for _ in 0..random.random_range(0..4) {
        task(&mut text, random);
    }
    text += "[[task]]\nkind = \"effort\"\n";
    let strategies = ["active", "passive"];
    writeln!(text, "[strategy]\nkind = \"{}\"", one_of(random, &strategies)).unwrap();
    writeln!(text, "minimum_decrease_ratio = {:.2}", random.random_range(0.1..0.9)).unwrap();
    fatigue(&mut text, random);
    let duration = random.random_range(3.0..8.0);
    // Short steps reach the first snapshot.
    let step = if chance(random, 0.3) { 0.003 } else { 0.1 };
    writeln!(text, "[run]\nduration_s = {duration:.1}\nstep_s = {step}").unwrap();
    let mut at = 0.0;
    for _ in 0..random.random_range(0..3) {
        at += random.random_range(0.5..2.0);
        // An event past the last step, whose time is rounded to a tenth of a second, is refused.
        if at < duration - 0.1 {
            event(&mut text, at, random);
        }
    }
    text
}

/// Levels of hysteresis, and a tired group that asks for relief from the start.
fn fatigue(text: &mut String, random: &mut Random) {
    let critical = random.random_range(0.1..0.6);
    writeln!(text, "[fatigue]\ncritical_level = {critical:.3}\nrecovery_level = {:.3}", 0.5 * critical).unwrap();
    if chance(random, 0.5) {
        let coordinate = one_of(random, &TIRED);
        let side = one_of(random, &["positive", "negative"]);
        let level = random.random_range(critical..0.95);
        writeln!(text, "start = {{ {coordinate} = {{ {side} = {level:.3} }} }}").unwrap();
    }
}

/// Angles in which the feet lie level under the body, arms anywhere before it.
fn posture(text: &mut String, sits: bool, random: &mut Random) {
    text.push_str("[posture]\n");
    let (hip, knee) = match sits {
        true => (90.0, 90.0),
        false => {
            let flexion = random.random_range(0.0..19.0);
            (flexion, 2.0 * flexion)
        }
    };
    for side in ["r", "l"] {
        writeln!(text, "hip_flexion_{side}_deg = {hip:.2}\nknee_angle_{side}_deg = {knee:.2}").unwrap();
        writeln!(text, "ankle_angle_{side}_deg = {:.2}", knee - hip).unwrap();
        let (arm, elbow) = (random.random_range(-10.0..80.0), random.random_range(5.0..120.0));
        writeln!(text, "arm_flex_{side}_deg = {arm:.1}\nelbow_flex_{side}_deg = {elbow:.1}").unwrap();
    }
}

fn supports(text: &mut String, sits: bool, random: &mut Random) {
    for side in ["r", "l"] {
        writeln!(text, "[[support]]\nsegment = \"calcn_{side}\"").unwrap();
        if chance(random, 0.3) {
            writeln!(text, "friction = {:.2}", random.random_range(0.3..1.2)).unwrap();
        }
    }
    if sits {
        text.push_str("[[support]]\nsegment = \"pelvis\"\n");
    }
}

/// A weight, or a force in any direction.
fn load(text: &mut String, random: &mut Random) {
    let segment = one_of(random, &SEGMENTS);
    if chance(random, 0.6) {
        let mass = random.random_range(0.1..15.0);
        writeln!(text, "[[load]]\nsegment = \"{segment}\"\nmass_kg = {mass:.2}").unwrap();
    } else {
        let mut part = || random.random_range(-40.0..40.0);
        let (x, y, z) = (part(), part(), part());
        writeln!(text, "[[load]]\nsegment = \"{segment}\"\nforce_n = [{x:.1}, {y:.1}, {z:.1}]").unwrap();
    }
}

/// A point, an orientation as at the start, or an upright head.
fn task(text: &mut String, random: &mut Random) {
    match random.random_range(0..3) {
        0 => {
            let (x, y, z) =
                (random.random_range(0.1..0.6), random.random_range(0.7..1.7), random.random_range(-0.4..0.4));
            let hand = one_of(random, &["hand_r", "hand_l"]);
            writeln!(text, "[[task]]\nkind = \"point\"\nsegment = \"{hand}\"\ntarget_m = [{x:.3}, {y:.3}, {z:.3}]")
                .unwrap();
        }
        1 => {
            let segment = one_of(random, &SEGMENTS);
            writeln!(text, "[[task]]\nkind = \"orientation\"\nsegment = \"{segment}\"\ntarget = \"start\"").unwrap();
        }
        _ => text.push_str("[[task]]\nkind = \"center_of_mass\"\n"),
    }
}

/// Another load, or another strategy.
fn event(text: &mut String, at: f64, random: &mut Random) {
    writeln!(text, "[[event]]\nat_s = {at:.2}").unwrap();
    if chance(random, 0.5) {
        writeln!(text, "load = [{{ segment = \"hand_r\", mass_kg = {:.1} }}]", random.random_range(0.0..20.0)).unwrap();
    } else {
        writeln!(text, "strategy = \"{}\"", one_of(random, &["active", "passive"])).unwrap();
    }
}
