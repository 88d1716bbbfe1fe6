//! The default task `humerus_l hangs`: which arms have it, when it is left out, what refuses it, and that arms in runs and searches do hang.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::Scenario;
use contrapposto::tasks::Task;
use contrapposto_formats::{RelaxScenario, read_relax};

use crate::common::complaint;
use crate::common::runs::{courses, searches};

const FEET: &str = "[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n";
/// The hand above the hips.
const HAND: &str = "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.4, 1.2, 0.2]\n";
const RHYTHM: &str = "humerus_r rhythm + humerus_l rhythm";
const EFFORT: &str = "[[task]]\nkind = \"effort\"\n";
/// Greatest angle between a hanging upper arm and the vertical, rad (McAtamney & Corlett 1993).
const NEUTRAL: f64 = 20.0 * std::f64::consts::PI / 180.0;
/// Error of that angle in a posture that meets the task, rad.
const MET: f64 = 1e-3;

/// `top` stands at the top level of the file, `rest` below.
fn relax(top: &str, rest: &str) -> RelaxScenario {
    let text = format!("format = 1\n{top}\n{rest}");
    read_relax("a.toml", text.as_bytes(), None).unwrap_or_else(|error| panic!("{}\n{text}", complaint(&error)))
}

fn labels(top: &str, rest: &str) -> Vec<String> {
    relax(top, rest).labels.into_iter().map(|labels| labels.join(" + ")).collect()
}

/// The arms that the task concerns.
fn hanging(top: &str, rest: &str) -> Vec<String> {
    let labels = relax(top, rest).labels.into_iter().flatten();
    labels.filter_map(|label| Some(label.strip_suffix(" hangs")?.to_owned())).collect()
}

#[test]
fn arms_without_work_hang_just_above_effort() {
    assert_eq!(labels("", FEET), ["head upright", "humerus_r hangs + humerus_l hangs", RHYTHM, "effort"]);
    let with_hand = format!("{FEET}{HAND}{EFFORT}");
    assert_eq!(labels("", &with_hand), ["point hand_r", "head upright", "humerus_l hangs", RHYTHM, "effort"]);
    let scenario = relax("", &with_hand);
    assert!(scenario.notes.iter().any(|note| note.contains("`arms_hang = false`")), "{:?}", scenario.notes);
    assert!(!relax("arms_hang = true", &with_hand).notes.iter().any(|note| note.contains("arms_hang")));
}

#[test]
fn arms_that_something_names_are_left_out() {
    let both = ["humerus_r", "humerus_l"];
    assert_eq!(hanging("", FEET), both);
    assert_eq!(hanging("arms_hang = true", FEET), both);
    let may_rest = "[[table]]\nheight_m = 0.72\nedge_m = 0.3\nmay_carry = [\"left_hand\"]\n";
    assert_eq!(hanging("", &format!("{FEET}{may_rest}")), both, "a hand that may be put down hangs until then");
    let none: [&str; 0] = [];
    assert_eq!(hanging("arms_hang = false", FEET), none);
    for (names_the_left_arm, why) in [
        ("[[load]]\nsegment = \"hand_l\"\nmass_kg = 6\n", "a load"),
        ("[[task]]\nkind = \"look_at\"\nsegment = \"humerus_l\"\ntarget_direction = [0, -1, 0.2]\n", "a direction"),
        ("[[task]]\nkind = \"orientation\"\nsegment = \"radius_l\"\ntarget = \"start\"\n", "an orientation"),
        ("[[task]]\nkind = \"posture\"\ncoordinates = [\"elbow_flex_l\"]\n", "a posture of the elbow"),
        ("[coordinates]\nlocked = [\"arm_flex_l\", \"arm_add_l\"]\n", "a locked shoulder"),
        ("[posture]\narm_flex_l_deg = 100\n", "an arm that is raised at the start"),
        ("[[bag]]\non = \"left_hand\"\nmass_kg = 3\n", "a bag"),
    ] {
        assert_eq!(hanging("", &format!("{FEET}{names_the_left_arm}")), ["humerus_r"], "{why}");
    }
    assert_eq!(hanging("", &format!("{FEET}[[task]]\nkind = \"posture\"\n")), none, "a posture of the whole body");
}

#[test]
fn wrong_values_are_refused_where_they_stand() {
    let refused = |text: &str| complaint(&read_relax("a.toml", text.as_bytes(), None).map(|_| ()).unwrap_err());
    let text = refused(&format!("format = 1\narms_hang = \"no\"\n{FEET}"));
    assert!(text.contains("label at line 2, columns 13") && text.contains("expected a boolean"), "{text}");
    let robot = contrapposto_formats::urdf::read(
        include_bytes!("models/arm.urdf"),
        "arm.urdf",
        &contrapposto_formats::urdf::Options::default(),
    );
    let text = "format = 1\narms_hang = true\n[model]\nfile = \"arm.urdf\"\n";
    let error = read_relax("a.toml", text.as_bytes(), Some(robot.unwrap().model().unwrap().model)).map(|_| ());
    let text = complaint(&error.unwrap_err());
    assert!(text.contains("label at line 2, columns 13") && text.contains("no segment `humerus_r`"), "{text}");
}

/// The angle between the line from shoulder to elbow and the vertical, rad.
fn angle(model: &Model, values: &[f64], upper_arm: usize) -> f64 {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(values.to_vec())).unwrap();
    let forearm = model.segments().iter().position(|segment| segment.parent == Some(upper_arm)).unwrap();
    let place = |segment| kinematics.placement(model, segment).translation.vector;
    (place(forearm) - place(upper_arm)).angle(&model.gravity())
}

/// Whether the hand of an upper arm may rest.
fn may_rest(scenario: &Scenario, upper_arm: usize) -> bool {
    let parent = |segment: &usize| scenario.model.segments()[*segment].parent;
    let mut hands = scenario.rests.iter().map(|rest| scenario.supports[rest.support].segment);
    hands.any(|hand| std::iter::successors(Some(hand), parent).any(|segment| segment == upper_arm))
}

/// The upper arms that are asked to hang.
fn upper_arms<'a>(model: &'a Model, tasks: impl Iterator<Item = &'a Task>) -> Vec<usize> {
    let hangs = tasks.filter(|task| task.hangs(model));
    hangs.map(|task| if let Task::Bounds(task) = task { task.segment } else { unreachable!() }).collect()
}

/// At the start and at the end of every run and in all answers of searches: upper arms within 20 degrees of the vertical. Reliefs go before it, so
/// an arm may swing out by 10 degrees more between. An arm whose hand may rest is looked at until something is put down.
#[test]
fn idle_arms_hang_in_runs_and_answers() {
    let (mut of_runs, mut of_answers) = (0, 0);
    for course in courses() {
        let model = &course.scenario.model;
        for arm in upper_arms(model, course.scenario.tasks.iter().flat_map(|task| &task.goal.tasks)) {
            let may_rest = may_rest(&course.scenario, arm);
            let hangs = course.postures.iter().filter(|kept| !(may_rest && kept.put_down));
            let angles: Vec<f64> = hangs.map(|kept| angle(model, &kept.values, arm)).collect();
            let greatest = angles.iter().copied().fold(0.0, f64::max);
            let [first, greatest, last] = [angles[0], greatest, angles[angles.len() - 1]].map(f64::to_degrees);
            let name = format!("{}, {}", course.name, model.segments()[arm].name);
            println!("{name}: {first:.1} deg at the start, at most {greatest:.1}, {last:.1} at the end");
            let neutral = (NEUTRAL + MET).to_degrees();
            assert!(
                first < neutral && last < neutral && greatest < neutral + 10.0,
                "{name}: {first}, {greatest}, {last} deg"
            );
            of_runs += 1;
        }
    }
    for (name, scenario, found) in searches() {
        let model = &scenario.model;
        for arm in upper_arms(model, scenario.goals.iter().flat_map(|level| &level.tasks)) {
            for (i, posture) in found.postures.iter().enumerate() {
                let angle = angle(model, posture.relaxed.posture.values(), arm);
                let name = format!("{name}, answer {}, {}", i + 1, model.segments()[arm].name);
                println!("{name}: {:.1} deg", angle.to_degrees());
                assert!(angle < NEUTRAL + MET, "{name}: {} deg", angle.to_degrees());
                of_answers += 1;
            }
        }
    }
    assert!(of_runs >= 8 && of_answers >= 8, "{of_runs} of runs, {of_answers} of answers");
}
