//! Random scenarios as their authors write them.

use std::fmt::Write;

use contrapposto::simulation::{RunSettings, Scenario};
use contrapposto_formats::read_run;
use rand::RngExt;
use rand_pcg::Pcg64Mcg as Random;

use super::body::Body;

/// Segments that take loads and tasks.
const SEGMENTS: [&str; 7] = ["hand_r", "hand_l", "radius_r", "torso", "head", "pelvis", "humerus_l"];

/// Coordinates with a tired group.
const TIRED: [&str; 6] =
    ["hip_adduction_r", "hip_flexion_l", "knee_angle_r", "lumbar_extension", "arm_flex_r", "elbow_flex_l"];

/// Corners of the soles of files, in shares of stature; docs/scenario.md gives them of the built-in adult.
const SOLE: [[f64; 3]; 4] =
    [[-0.0271, -0.0157, -0.0165], [-0.0271, -0.0157, 0.0165], [0.0722, -0.0157, 0.0275], [0.0722, -0.0157, -0.0275]];

pub(crate) fn chance(random: &mut Random, share: f64) -> bool {
    random.random::<f64>() < share
}

pub(crate) fn one_of<'a>(random: &mut Random, all: &[&'a str]) -> &'a str {
    all[random.random_range(0..all.len())]
}

/// A scenario as its author writes it, and its body.
#[derive(Debug)]
pub(crate) struct World {
    pub(crate) text: String,
    pub(crate) body: Body,
    /// Threads of the search in a second run.
    threads: usize,
}

impl World {
    /// An adult of any size, built-in or in a file, on two feet or on a seat.
    pub(crate) fn random(random: &mut Random) -> Self {
        let body = Body::random(random);
        let mut text = format!("format = 1\ntitle = \"random\"\n[model]\n{}", body.text());
        let sits = chance(random, 0.2);
        posture(&mut text, sits, random);
        supports(&mut text, sits, &body, random);
        let has_thing = !body.is_file() && chance(random, 0.3);
        let rests = if has_thing { thing(&mut text, sits, random) } else { None };
        for _ in 0..random.random_range(0..3) {
            load(&mut text, random);
        }
        let tasks = random.random_range(0..4);
        let points: Vec<usize> = (1..=tasks).filter(|_| task(&mut text, rests, random)).collect();
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
                event(&mut text, at, &points, random);
            }
        }
        Self { text, body, threads: [1, 2, 3, 8][random.random_range(0..4)] }
    }

    /// The scenario as `simulate` reads it.
    pub(crate) fn scenario(&self) -> Result<Scenario, String> {
        let (model, muscles) = self.body.model().unzip();
        let run = read_run("world.toml", self.text.as_bytes(), model);
        let mut run = run.map_err(|error| format!("{:?}", miette::Report::new(error)))?;
        run.take_muscles(muscles.flatten())?;
        Ok(run.scenario)
    }

    /// The same scenario, whose searches have other threads.
    pub(crate) fn with_threads(&self, scenario: &Scenario) -> Scenario {
        Scenario { run: RunSettings { threads: self.threads, ..scenario.run }, ..scenario.clone() }
    }
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

/// The feet, of which one may be put elsewhere or rise its heel, and the seat.
fn supports(text: &mut String, sits: bool, body: &Body, random: &mut Random) {
    for side in ["r", "l"] {
        writeln!(text, "[[support]]\nsegment = \"calcn_{side}\"").unwrap();
        if chance(random, 0.3) {
            writeln!(text, "friction = {:.2}", random.random_range(0.3..1.2)).unwrap();
        }
        if body.is_file() {
            let corner = |[x, y, z]: [f64; 3]| {
                format!("[{:.4}, {:.4}, {:.4}]", x * body.stature, y * body.stature, z * body.stature)
            };
            writeln!(text, "corners_m = [{}]", SOLE.map(corner).join(", ")).unwrap();
        } else if side == "l" && !sits {
            match random.random_range(0..10) {
                0 => text.push_str("share_max = 0.2\n"),
                1 => text.push_str("heel = \"free\"\n"),
                2 | 3 => text.push_str("place = \"free\"\n"),
                _ => {}
            }
        }
    }
    if sits {
        text.push_str("[[support]]\nsegment = \"pelvis\"\n");
        if body.is_file() {
            let at = |x: f64, z: f64| {
                format!("[{:.4}, {:.4}, {:.4}]", x * body.stature, -0.05 * body.stature, z * body.stature)
            };
            let corners = [at(-0.02, -0.035), at(-0.02, 0.035), at(0.02, 0.035), at(0.02, -0.035)];
            writeln!(text, "corners_m = [{}]", corners.join(", ")).unwrap();
        }
    }
}

/// A table or counter before the body, on which a hand may rest; a wall; or a block beside the body. The hand that may rest: it has no task.
fn thing(text: &mut String, sits: bool, random: &mut Random) -> Option<&'static str> {
    match random.random_range(0..4) {
        0 | 1 => {
            let (name, low, high) = if sits { ("table", 0.68, 0.8) } else { ("counter", 0.75, 1.05) };
            let (height, edge) = (random.random_range(low..high), random.random_range(0.2..0.4));
            writeln!(text, "[[{name}]]\nheight_m = {height:.3}\nedge_m = {edge:.3}").unwrap();
            if chance(random, 0.7) {
                let left = chance(random, 0.5);
                writeln!(text, "may_carry = [\"{}_hand\"]", if left { "left" } else { "right" }).unwrap();
                return Some(if left { "hand_l" } else { "hand_r" });
            }
        }
        2 => {
            let side = one_of(random, &["ahead", "behind", "right", "left"]);
            writeln!(text, "[[wall]]\n{side}_m = {:.2}", random.random_range(0.5..0.9)).unwrap();
        }
        _ => {
            let (x, y, z) =
                (random.random_range(0.3..0.6), random.random_range(0.6..1.6), random.random_range(-0.5..0.5));
            writeln!(
                text,
                "[[obstacle]]\nname = \"block\"\nmiddle_m = [{x:.3}, {y:.3}, {z:.3}]\nsize_m = [0.2, 0.1, 0.3]"
            )
            .unwrap();
        }
    }
    None
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

/// A point, an orientation as at the start, or the centre of mass over the feet. Whether it is a point, whose target an event may move.
fn task(text: &mut String, rests: Option<&str>, random: &mut Random) -> bool {
    let kind = random.random_range(0..3);
    match kind {
        0 => {
            let (x, y, z) =
                (random.random_range(0.1..0.6), random.random_range(0.7..1.7), random.random_range(-0.4..0.4));
            let hand = one_of(random, &["hand_r", "hand_l"]);
            let hand = if rests == Some(hand) { if hand == "hand_r" { "hand_l" } else { "hand_r" } } else { hand };
            writeln!(text, "[[task]]\nkind = \"point\"\nsegment = \"{hand}\"\ntarget_m = [{x:.3}, {y:.3}, {z:.3}]")
                .unwrap();
        }
        1 => {
            let segment = one_of(random, &SEGMENTS);
            let segment = if rests == Some(segment) { "head" } else { segment };
            writeln!(text, "[[task]]\nkind = \"orientation\"\nsegment = \"{segment}\"\ntarget = \"start\"").unwrap();
        }
        _ => text.push_str("[[task]]\nkind = \"center_of_mass\"\n"),
    }
    if chance(random, 0.3) {
        text.push_str("above_relief = true\n");
    }
    kind == 0
}

/// Another load, another strategy, or another target of one of the `points`.
fn event(text: &mut String, at: f64, points: &[usize], random: &mut Random) {
    writeln!(text, "[[event]]\nat_s = {at:.2}").unwrap();
    match random.random_range(0..5) {
        0 | 1 => {
            let mass = random.random_range(0.0..20.0);
            writeln!(text, "load = [{{ segment = \"hand_r\", mass_kg = {mass:.1} }}]").unwrap();
        }
        2 if !points.is_empty() => {
            let task = points[random.random_range(0..points.len())];
            let (x, y, z) =
                (random.random_range(0.1..0.6), random.random_range(0.7..1.7), random.random_range(-0.4..0.4));
            writeln!(text, "task = {task}\ntarget_m = [{x:.3}, {y:.3}, {z:.3}]").unwrap();
        }
        _ => writeln!(text, "strategy = \"{}\"", one_of(random, &["active", "passive"])).unwrap(),
    }
}
