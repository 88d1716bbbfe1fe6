//! Tests events during a run: strategies, loads, targets.

use std::path::Path;

use contrapposto::contact::Slip;
use contrapposto::hybrid::Strategy;
use contrapposto::model::Model;
use contrapposto::simulation::{Fall, Run, Sample, Scenario, StopReason, Summary};
use contrapposto_formats::read_scenario;

fn scenario(text: &str) -> Scenario {
    read_scenario("scenario.toml", text.as_bytes(), None)
        .unwrap_or_else(|error| panic!("{:?}", miette::Report::new(error)))
}

fn of_the_repository(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name)).unwrap()
}

/// A scenario of the repository with another duration and something that happens.
fn with(name: &str, seconds: f64, events: &str) -> String {
    let text = of_the_repository(name);
    let (head, tail) = text.split_once("duration_s").unwrap();
    let rest = tail.split_once('\n').map_or("", |(_, rest)| rest);
    format!("{head}duration_s = {seconds}\n{rest}\n{events}")
}

fn followed(scenario: &Scenario, mut see: impl FnMut(&Sample)) -> Summary {
    let mut run = Run::new(scenario).unwrap();
    while let Some(sample) = run.next_sample().unwrap() {
        see(&sample);
    }
    run.summary()
}

fn at(model: &Model, name: &str) -> usize {
    model.coordinate(name).unwrap()
}

/// Largest force and moment left on the root, over body weight (times 1.5 m).
fn imbalance(model: &Model, sample: &Sample) -> f64 {
    let weight = model.mass() * model.gravity().norm();
    let roots = ["pelvis_tx", "pelvis_ty", "pelvis_tz", "pelvis_tilt", "pelvis_list", "pelvis_rotation"];
    let left = roots
        .iter()
        .enumerate()
        .map(|(i, name)| sample.external[at(model, name)].abs() / (weight * if i < 3 { 1.0 } else { 1.5 }));
    left.fold(0.0, f64::max)
}

/// Ready until the fifth second, then relaxed, in all of the body, a part of it, or one joint.
#[test]
fn a_strategy_that_changes_leads_elsewhere_from_then_on() {
    for (change, slouches) in [
        ("strategy = \"passive\"", true),
        ("strategy_of = { legs = \"passive\" }", true),
        ("strategy_of = { hip_adduction_r = \"passive\" }", true),
        ("strategy_of = { arms = \"passive\", spine = \"passive\", hip_adduction_l = \"passive\" }", false),
    ] {
        let text = with("stand-relaxed.toml", 15.0, &format!("[[event]]\nat_s = 5\n{change}\n"));
        let scenario = scenario(&text.replace("kind = \"passive\"", "kind = \"active\""));
        let list = at(&scenario.model, "pelvis_list");
        let (mut before, mut after) = (0.0_f64, 0.0);
        followed(&scenario, |sample| {
            if sample.time < 5.0 {
                before = before.max(sample.posture[list].to_degrees().abs());
            }
            after = sample.posture[list].to_degrees();
        });
        println!("{change}: pelvis list {before:.1} deg at most before, {after:.1} deg at the end");
        assert!(before < 10.0, "{change}");
        assert_eq!(after < -10.0, slouches, "{change}");
    }
}

/// A weight at arm's length that pulls the body over its toes unless it leans back at once, then none: every sample is held.
#[test]
fn a_load_is_picked_up_and_put_down() {
    let load = "load = [{ segment = \"hand_r\", mass_kg = 60 }]";
    let events = format!("[[event]]\nat_s = 2\n{load}\n[[event]]\nat_s = 6\nload = []\n");
    let text = with("hold-tool.toml", 8.0, &events);
    let scenario = scenario(&text.replace("mass_kg = 3", "mass_kg = 0"));
    let model = &scenario.model;
    let gravity = model.gravity().norm();
    let mut carried = vec![];
    let summary = followed(&scenario, |sample| {
        assert!(imbalance(model, sample) < 1e-8, "{} s: {}", sample.time, imbalance(model, sample));
        let up: f64 = sample.standing.unwrap().contacts.iter().map(|contact| contact.force.y).sum();
        carried.push((sample.time, up / gravity - model.mass()));
    });
    assert_eq!((summary.reason, summary.fall), (StopReason::Duration, None));
    let (slip, time) = summary.slip.unwrap();
    assert!(!slip.exceeds(Slip::NOTICED), "{slip:?} at {time} s");
    for (time, more) in carried {
        let load = if (2.0..6.0).contains(&(time + 1e-9)) { 60.0 } else { 0.0 };
        assert!((more - load).abs() < 1e-7, "{time} s: {more} kg more than the body weighs");
    }
}

/// Nobody stands against a push of three hundred newtons: the run ends in the last posture that was held, and says why.
#[test]
fn who_is_pushed_over_ends_the_run_and_says_why() {
    let push = "[[event]]\nat_s = 2\nload = [{ segment = \"torso\", force_n = [300, 0, 0] }]\n";
    let scenario = scenario(&with("stand-ready.toml", 5.0, push));
    let mut last = 0.0;
    let summary = followed(&scenario, |sample| {
        assert!(imbalance(&scenario.model, sample) < 1e-8, "{} s", sample.time);
        last = sample.time;
    });
    let Fall { time, missing } = summary.fall.unwrap();
    println!("last held at {last} s; {}", summary.fall.unwrap());
    assert_eq!(summary.reason, StopReason::Fell);
    assert!(last < time && (time - 2.0).abs() < 1e-9 && summary.end_time == last);
    assert!(missing.force > 1.0 && missing.moment > 1.0);
    // At the very start there is nothing before it to show.
    let scenario = Scenario {
        events: scenario
            .events
            .iter()
            .cloned()
            .map(|event| contrapposto::simulation::Event { time: 0.0, ..event })
            .collect(),
        ..scenario
    };
    let error = Run::new(&scenario).unwrap().next_sample().unwrap_err();
    assert!(error.to_string().contains("off balance"), "{error}");
}

/// The tool is wanted elsewhere: the hand is there within two seconds, and left nothing behind.
#[test]
fn a_target_is_moved_and_the_hand_follows() {
    let scenario =
        scenario(&with("hold-tool.toml", 6.0, "[[event]]\nat_s = 2\ntask = 1\ntarget_m = [0.35, 1.2, 0.1]\n"));
    followed(&scenario, |sample| {
        let off = sample.standing.unwrap().errors[0];
        let there = sample.time < 2.0 - 1e-9 || sample.time > 4.0;
        assert!(!there || off < 1e-4, "{} s: {off} m", sample.time);
        assert!(imbalance(&scenario.model, sample) < 1e-8);
    });
}

/// A thing that a hand carries is there until nothing loads the hand; a lighter load is still there, and so is what both hands hold in its place.
#[test]
fn what_is_put_down_is_there_until_its_event() {
    let job = |things: &str, events: &str| {
        let text = format!(
            "format = 1\ntitle = \"a\"\n[model]\nadult = {{ sex = \"male\", stature_m = 1.75, mass_kg = 73 }}\n[strategy]\nkind = \"active\"\n[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n{things}\n\
             [run]\nduration_s = 30\nstep_s = 1\n{events}"
        );
        let read = contrapposto_formats::read_run("scenario.toml", text.as_bytes(), None);
        read.unwrap_or_else(|error| panic!("{:?}", miette::Report::new(error))).things
    };
    let put_down = "[[event]]\nat_s = 20\nload = []\n";
    let lighter = "[[event]]\nat_s = 10\nload = [{ segment = \"hand_r\", mass_kg = 1 }]\n";
    let until = |things: &str, events: &str| -> Vec<Option<f64>> {
        job(things, events).iter().map(|thing| thing.until).collect()
    };
    let bag = "[[bag]]\non = \"right_hand\"\nmass_kg = 3\n";
    assert_eq!(until(bag, ""), [None, None], "bag and strap");
    assert_eq!(until(bag, put_down), [Some(20.0); 2]);
    assert_eq!(until(bag, lighter), [None; 2]);
    assert_eq!(until(bag, &format!("{lighter}{put_down}")), [Some(20.0); 2]);
    let weight = "[[load]]\nsegment = \"hand_l\"\nmass_kg = 3\n";
    assert_eq!(until(weight, lighter), [Some(10.0)], "the load of the other hand is another one");
    let held = "[[box]]\nmass_kg = 4\nsize_m = [0.3, 0.2, 0.3]\nat_m = [0.35, 1.0, 0.0]\n";
    assert_eq!(until(held, put_down), [None], "its place stays");
    let thing = &job(bag, put_down)[0];
    assert!(thing.is_there(19.9) && !thing.is_there(20.0) && !thing.is_there(25.0));
}

/// Either key alone changes strategies.
#[test]
fn an_event_changes_the_strategies_that_it_names() {
    let strategies = |change: &str| {
        let text = with("stand-relaxed.toml", 15.0, &format!("[[event]]\nat_s = 5\n{change}\n"));
        let scenario = scenario(&text.replace("kind = \"passive\"", "kind = \"active\""));
        let passive = scenario.events[0].strategies.clone().unwrap().into_iter().map(|s| s == Strategy::Passive);
        let passive: Vec<bool> = passive.collect();
        let knee = passive[at(&scenario.model, "knee_angle_r")];
        (passive.iter().filter(|one| **one).count(), knee, passive.len())
    };
    let (passive, knee, all) = strategies("strategy = \"passive\"");
    assert!(passive == all && knee, "{passive} of {all}");
    assert_eq!(strategies("strategy_of = { knee_angle_r = \"passive\" }").0, 1);
    let but_one = strategies("strategy = \"passive\"\nstrategy_of = { knee_angle_r = \"active\" }");
    assert_eq!(but_one, (all - 1, false, all));
}
