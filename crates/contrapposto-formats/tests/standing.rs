//! Whole bodies over time, from the scenarios of the repository: the reliefs and their effect.

use std::path::{Path, PathBuf};

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::{Scenario, Summary, run};
use contrapposto_formats::read_scenario;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}

fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(name)).unwrap()
}

fn scenario(text: &str) -> Scenario {
    read_scenario("scenario.toml", text.as_bytes(), None)
        .unwrap_or_else(|error| panic!("{:?}", miette::Report::new(error)))
}

/// A finished run, and where it ended.
struct Ended {
    scenario: Scenario,
    summary: Summary,
}

impl Ended {
    fn of(text: &str) -> Self {
        let scenario = scenario(text);
        let summary = run(&scenario, |_| {}).unwrap();
        Self { scenario, summary }
    }

    fn at(&self, name: &str) -> usize {
        self.scenario.model.coordinates().iter().position(|c| c.name == name).unwrap()
    }

    fn degrees(&self, name: &str) -> f64 {
        self.summary.coordinates[self.at(name)].final_value.to_degrees()
    }

    /// External, passive, active.
    fn torques(&self, name: &str) -> [f64; 3] {
        self.summary.coordinates[self.at(name)].final_torques
    }

    fn share(&self, support: usize) -> f64 {
        self.summary.standing.as_ref().unwrap().contacts[support].share
    }

    fn effort(&self) -> f64 {
        self.summary.standing.as_ref().unwrap().effort
    }

    /// Height of the right hip above the left one, m.
    fn right_hip_above_left(&self) -> f64 {
        let model: &Model = &self.scenario.model;
        let mut kinematics = Kinematics::new(model);
        let values = self.summary.coordinates.iter().map(|c| c.final_value).collect();
        kinematics.update(model, &Posture::new(values)).unwrap();
        let height = |segment: &str| kinematics.placement(model, model.segment(segment).unwrap()).translation.y;
        height("femur_r") - height("femur_l")
    }
}

/// The same with left and right exchanged.
fn mirrored(text: &str) -> String {
    let exchanged = text.replace("_r", "_<").replace("_l", "_r").replace("_<", "_l");
    // Words that only look like sides.
    let restored =
        exchanged.replace("above_lelief", "above_relief").replace("target_l", "target_r").replace("mass_rg", "mass_lg");
    assert_eq!(restored.matches("above_relief").count(), text.matches("above_relief").count());
    restored.replace("target_m = [0.03, 0, 0.055]", "target_m = [0.03, 0, -0.055]")
}

/// The paper's announced next step: who rests one leg ends in contrapposto when relief is passive, and only then.
#[test]
fn the_slouch_comes_out_of_the_passive_strategy_alone() {
    let passive = text("stand-relaxed.toml");
    let active = passive.replace("kind = \"passive\"", "kind = \"active\"");
    assert_ne!(passive, active);
    let [passive, active] = [&passive, &active].map(|text| Ended::of(text));
    for (name, ended) in [("passive", &passive), ("active", &active)] {
        println!(
            "{name}: pelvis list {:.1} deg, right hip {:+.1} mm above left, hip adduction {:.1} deg, passive {:.1}, active {:.1} \
             N m, knee {:.1} deg, share {:.3}, effort {:.4} -> {:.4}",
            ended.degrees("pelvis_list"),
            1e3 * ended.right_hip_above_left(),
            ended.degrees("hip_adduction_r"),
            ended.torques("hip_adduction_r")[1],
            ended.torques("hip_adduction_r")[2],
            ended.degrees("knee_angle_r"),
            ended.share(0),
            ended.summary.effort_at_start.unwrap(),
            ended.effort()
        );
    }
    // Passive: the pelvis hangs in the ligaments of the hip that carries, over a straight knee, for less effort.
    assert!(passive.right_hip_above_left() > 0.02);
    assert!(passive.degrees("hip_adduction_r") > 15.0 && passive.degrees("knee_angle_r") < 5.0);
    let [external, by_ligaments, by_muscles] = passive.torques("hip_adduction_r");
    assert!(by_ligaments.abs() > 0.9 * external.abs() && by_muscles.abs() < 0.1 * external.abs());
    assert!(passive.share(0) > 0.8);
    assert!(passive.effort() < 0.7 * passive.summary.effort_at_start.unwrap());
    assert!(passive.effort() < 0.7 * active.effort());
    // Active: no slouch.
    assert!(active.right_hip_above_left().abs() < 0.01);
    assert!(active.degrees("hip_adduction_r") < 10.0);
    let [_, by_ligaments, by_muscles] = active.torques("hip_adduction_r");
    assert!(by_ligaments.abs() < 0.5 * by_muscles.abs());
}

#[test]
fn who_stands_ready_is_symmetric() {
    let ended = Ended::of(&text("stand-ready.toml").replace("duration_s = 300", "duration_s = 30"));
    let shares = [ended.share(0), ended.share(1)];
    println!("shares {shares:?}");
    assert!((shares[0] - shares[1]).abs() < 0.1);
    for coordinate in ended.scenario.model.coordinates() {
        if let Some(base) = coordinate.name.strip_suffix("_r") {
            let (right, left) = (ended.degrees(&coordinate.name), ended.degrees(&format!("{base}_l")));
            assert!((right - left).abs() < 2.0, "{base}: {right} and {left} deg");
        }
    }
}

/// Nobody tires, nothing is asked: where effort is least the body stands still, and stays so.
#[test]
fn who_has_nothing_to_do_comes_to_rest() {
    for (name, duration) in [("stand-ready.toml", "duration_s = 300"), ("overhead.toml", "duration_s = 240")] {
        let text = text(name);
        assert!(text.contains(duration), "{name}");
        let scenario = scenario(&text.replace(duration, "duration_s = 20"));
        let (mut before, mut moving, mut last) = (scenario.start.values().to_vec(), 0, 0);
        let mut samples = 0;
        run(&scenario, |sample| {
            let far = before.iter().zip(sample.posture).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            if far > 1e-9 {
                (moving, last) = (moving + 1, samples);
            }
            samples += 1;
            before.copy_from_slice(sample.posture);
        })
        .unwrap();
        println!("{name}: {moving} of {samples} samples in motion, the last one {last}");
        assert!(samples == 601 && last < 90, "{name}: {moving} samples in motion, the last one {last}");
    }
}

#[test]
fn left_and_right_are_mirror_images() {
    let short = text("stand-relaxed.toml").replace("duration_s = 120", "duration_s = 20");
    let [right, left] = [short.clone(), mirrored(&short)].map(|text| Ended::of(&text));
    let mut worst = (0.0_f64, String::new());
    for coordinate in right.scenario.model.coordinates() {
        let name = coordinate.name.as_str();
        let other = match (name.strip_suffix("_r"), name.strip_suffix("_l")) {
            (Some(base), _) => format!("{base}_l"),
            (_, Some(base)) => format!("{base}_r"),
            _ => name.to_owned(),
        };
        // Across the middle, bending, rotation and sideways motion change their sign.
        let turns = ["pelvis_tz", "pelvis_list", "pelvis_rotation"].contains(&name)
            || name.ends_with("_bending")
            || (name.ends_with("_rotation") && !name.contains("hip"));
        let sign = if turns { -1.0 } else { 1.0 };
        let difference = (right.degrees(name) - sign * left.degrees(&other)).abs();
        if difference > worst.0 {
            worst = (difference, name.to_owned());
        }
    }
    println!("worst difference {:.3e} deg, {}", worst.0, worst.1);
    assert!(worst.0 < 0.01, "{worst:?}");
    assert!((right.share(0) - left.share(0)).abs() < 1e-3);
}

/// Frey-Law & Avin 2010, `T = b0 f^b1` s, written down here again (verified rows of the data sheet).
#[test]
fn a_held_joint_fails_when_the_law_says() {
    let ended = Ended::of(
        r#"
format = 1
[model]
adult = { sex = "male", stature_m = 1.741, mass_kg = 73, part = "right_arm" }
[posture]
elbow_flex_r_deg = 90
[coordinates]
free = []
[[load]]
segment = "hand_r"
mass_kg = 8
[strategy]
kind = "active"
[fatigue]
law = "endurance"
[run]
duration_s = 300
"#,
    );
    for (name, b0, b1) in [("elbow_flex_r", 17.98, -2.21), ("arm_flex_r", 14.86, -1.83)] {
        let summary = &ended.summary.coordinates[ended.at(name)];
        let law: f64 = b0 * libm::pow(summary.peak_load, b1);
        let held = summary.exhausted_at[0].unwrap();
        println!("{name}: load {:.4}, held {held:.2} s, the law says {law:.2} s", summary.peak_load);
        assert!((held / law - 1.0).abs() < 0.01, "{held} and {law}");
    }
}

/// A body that holds a heavy tool gives up where the load leaves the least time.
#[test]
fn a_heavy_tool_is_put_down_for_the_group_that_is_weakest_for_it() {
    let text = text("hold-tool.toml")
        .replace("mass_kg = 3", "mass_kg = 10")
        .replace("duration_s = 480", "duration_s = 300")
        .replace("[strategy]", "[fatigue]\ncritical_level = 1 # no relief before the end\n\n[strategy]");
    let scenario = scenario(&text);
    let mut weakest: Option<(f64, String)> = None;
    let summary = run(&scenario, |sample| {
        if sample.time > 0.0 {
            return;
        }
        for (i, coordinate) in scenario.model.coordinates().iter().enumerate() {
            let Some(groups) = &coordinate.groups else { continue };
            let side = usize::from(sample.active[i] < 0.0);
            let time = groups[side].fatigue.time_left(0.0, sample.load[i]);
            if weakest.as_ref().is_none_or(|(least, _)| time < *least) {
                weakest = Some((time, groups[side].name.clone()));
            }
        }
    })
    .unwrap();
    let mut failed: Vec<(f64, String)> = vec![];
    for (coordinate, summary) in scenario.model.coordinates().iter().zip(&summary.coordinates) {
        for (side, time) in summary.exhausted_at.iter().enumerate() {
            failed.extend(time.map(|time| (time, coordinate.groups.as_ref().unwrap()[side].name.clone())));
        }
    }
    failed.sort_by(|a, b| a.0.total_cmp(&b.0));
    println!("expected {weakest:?}; failed {failed:?}");
    assert_eq!(failed[0].1, weakest.unwrap().1);
}

/// A target beyond the edge of the feet: the body leans as far as they hold it, to the last digit, and is not refused.
#[test]
fn a_target_beyond_the_feet_is_approached_as_far_as_they_hold_the_body() {
    for target in ["-1", "-0.3", "1"] {
        let scenario = scenario(&format!(
            "format = 1\n[model]\nadult = {{ sex = \"female\", stature_m = 1.65, mass_kg = 60 }}\n[[support]]\nsegment = \
             \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n[[task]]\nkind = \"center_of_mass\"\ntarget_m = [{target}, 1, 0]\n\
             [[task]]\nkind = \"effort\"\n[strategy]\nkind = \"passive\"\n[run]\nduration_s = 2\n"
        ));
        let weight = scenario.model.mass() * scenario.model.gravity().norm();
        let root = ["pelvis_tx", "pelvis_ty", "pelvis_tz", "pelvis_tilt", "pelvis_list", "pelvis_rotation"];
        let root = root.map(|name| scenario.model.coordinate(name).unwrap());
        let mut center = 0.0;
        let summary = run(&scenario, |sample| {
            assert!(root.iter().all(|&i| sample.external[i].abs() < 1e-8 * weight), "{target}, {} s", sample.time);
            center = sample.standing.unwrap().center_of_mass.x;
        });
        summary.unwrap_or_else(|error| panic!("{target}: {error}"));
        println!("{target}: centre of mass at {center:.3} m");
        assert!(if target == "1" { center > 0.05 } else { center < -0.03 }, "{target}: {center}");
    }
}

/// The resting foot goes elsewhere once, is in the air for a second without carrying anything, and the body needs a fraction of the effort.
#[test]
fn a_free_resting_foot_is_put_elsewhere_when_the_hip_that_carries_is_tired() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/stand-relaxed.toml"));
    let text = text.unwrap().replace("duration_s = 120", "duration_s = 15");
    let scenario = scenario(&text);
    let foot = scenario.supports[1].segment;
    let mut kinematics = Kinematics::new(&scenario.model);
    let (mut aloft, mut highest, mut floor) = (0, 0.0f64, None);
    let summary = run(&scenario, |sample| {
        let contacts = &sample.standing.unwrap().contacts;
        kinematics.update(&scenario.model, &Posture::new(sample.posture.to_vec())).unwrap();
        let corners = scenario.supports[1].corners.iter();
        let lowest = corners.map(|at| kinematics.station(&scenario.model, foot, *at).y).fold(f64::INFINITY, f64::min);
        let floor = *floor.get_or_insert(lowest);
        if lowest > floor + 1e-3 {
            aloft += 1;
            assert_eq!(contacts[1].share, 0.0, "at {} s the foot is in the air and carries", sample.time);
        }
        highest = highest.max(lowest - floor);
        assert!(lowest > floor - 1e-3, "at {} s the foot is {} m below the floor", sample.time, floor - lowest);
    })
    .unwrap();
    let [step] = &summary.foot_steps[..] else { panic!("{:?}", summary.foot_steps) };
    println!("{step:?}, {aloft} samples in the air, {highest:.3} m high at most");
    assert_eq!(step.support, 1);
    let (relieved, _) = step.relieves.unwrap();
    assert_eq!(scenario.model.coordinates()[relieved].name, "hip_adduction_r");
    assert!(step.effort.1 < 0.3 * step.effort.0, "{:?}", step.effort);
    assert!((20..=45).contains(&aloft) && (0.02..0.05).contains(&highest), "{aloft} samples, {highest} m");
    let end = summary.standing.unwrap();
    assert!(end.effort < 0.01 && end.contacts[1].share > 0.0 && end.contacts[1].share <= 0.15 + 1e-9);
}

/// A body on one support cannot lift that support: the run goes on.
#[test]
fn the_only_support_stays_though_its_place_is_free() {
    let text = text("stand-relaxed.toml");
    let (before, rest) = text.split_once("[[support]]\nsegment = \"calcn_l\"").unwrap();
    let (_, after) = rest.split_once("[[task]]").unwrap();
    let before = before.replace("segment = \"calcn_r\"", "segment = \"calcn_r\"\nplace = \"free\"");
    let text = format!("{before}[[task]]{after}").replace("duration_s = 120", "duration_s = 5");
    let summary = run(&scenario(&text), |_| {}).unwrap();
    assert!(summary.foot_steps.is_empty() && summary.end_time > 4.9, "{:?}", summary.foot_steps);
}

/// With the active strategy the level posture is the goal: the foot stays.
#[test]
fn a_free_resting_foot_stays_with_the_active_strategy() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/stand-relaxed.toml"));
    let text = text.unwrap().replace("duration_s = 120", "duration_s = 15").replace("\"passive\"", "\"active\"");
    let summary = run(&scenario(&text), |_| {}).unwrap();
    assert!(summary.foot_steps.is_empty(), "{:?}", summary.foot_steps);
}

#[test]
fn a_place_that_no_support_can_take_is_refused_where_it_stands_with_its_limits() {
    let text =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/stand-relaxed.toml")).unwrap();
    for (place, message) in [
        ("\"nowhere\"", "place is \"start\", \"free\", or { corners_m = [[x, y, z], ...], turn_deg = [-10, 40] }"),
        ("{ turn_deg = [10, 40] }", "turn_deg is 10..40; it must hold 0 and lie in -90..90"),
        ("{ corners_m = [[0, 0, 0], [1, 0, 0]] }", "corners_m has 2 corners; a region has three or more"),
        ("{ corners_m = [[0, 0, 0], [1e12, 0, 0], [0, 0, 1]] }", "a corner of the region is at 1e12 m; 1e9 at most"),
    ] {
        let text = text.replace("place = \"free\"", &format!("place = {place}"));
        let error = read_scenario("job.toml", text.as_bytes(), None).unwrap_err();
        let labels = miette::Diagnostic::labels(&error).unwrap();
        let at: Vec<usize> = labels.map(|label| label.offset()).collect();
        assert!(error.to_string().contains(message) && at == [text.find(place).unwrap()], "{error} at {at:?}");
    }
}
