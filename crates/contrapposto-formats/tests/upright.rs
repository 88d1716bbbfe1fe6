//! The default task `head upright`: where it stands, when it is left out, and what refuses it.

use crate::common;

use common::complaint;
use contrapposto::kinematics::Kinematics;
use contrapposto::posture_solver::Engine;
use contrapposto::tasks::{LookAtGoal, Task};
use contrapposto_formats::{RelaxScenario, RunScenario, read_pose, read_relax, read_run, read_scenario};

const FEET: &str = "[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n";
const EFFORT: &str = "[[task]]\nkind = \"effort\"\n";
const RUN: &str = "[strategy]\nkind = \"passive\"\n[run]\nduration_s = 1\n";
/// The hand above the hips.
const HAND: &str = "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.4, 1.2, 0.2]\n";

/// `top` stands at the top level of the file, `rest` below. Arms are left out (`hanging_arms.rs`).
fn relax(top: &str, rest: &str) -> RelaxScenario {
    let text = format!("format = 1\narms_hang = false\nshoulder_rhythm = false\n{top}\n{rest}");
    read_relax("a.toml", text.as_bytes(), None).unwrap_or_else(|error| panic!("{}\n{text}", complaint(&error)))
}

fn labels(top: &str, rest: &str) -> Vec<String> {
    relax(top, rest).labels.into_iter().map(|labels| labels.join(" + ")).collect()
}

#[test]
fn a_scenario_without_a_word_of_head_or_trunk_has_the_head_upright_just_above_effort() {
    assert_eq!(labels("", FEET), ["head upright", "effort"]);
    assert_eq!(labels("", &format!("{FEET}{HAND}{EFFORT}")), ["point hand_r", "head upright", "effort"]);
    let balance = "[[task]]\nkind = \"center_of_mass\"\n";
    assert_eq!(
        labels("", &format!("{FEET}{EFFORT}{balance}")),
        ["head upright", "effort", "center_of_mass"],
        "just above effort, wherever effort stands"
    );
    let scenario = relax("", FEET);
    assert!(scenario.notes.iter().any(|note| note.contains("`upright = false`")), "{:?}", scenario.notes);
    let Task::LookAt(task) = &scenario.goals[0].tasks[0] else { panic!() };
    assert_eq!((task.direction.y, task.goal), (1.0, LookAtGoal::Direction(nalgebra::Vector3::y_axis())));
}

#[test]
fn upright_false_or_a_task_of_head_or_trunk_leaves_it_out() {
    let without = |top: &str, rest: &str| {
        let scenario = relax(top, rest);
        let added = scenario.labels.iter().flatten().any(|label| label == "head upright");
        assert!(!added && scenario.notes.is_empty(), "{top}{rest}: {:?}", scenario.notes);
    };
    without("upright = false", FEET);
    for task in [
        "kind = \"orientation\"\nsegment = \"torso\"\ntarget = \"start\"\n",
        "kind = \"distance\"\na = { segment = \"hand_r\" }\nb = { segment = \"head\" }\ndistance_m = 0.3\n",
        "kind = \"posture\"\n",
        // A hand at work below the hips.
        "kind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.4, 0.1, 0.1]\n",
    ] {
        without("", &format!("{FEET}[[task]]\n{task}"));
    }
    without("", &format!("{FEET}[coordinates]\nlocked = [\"neck_extension\", \"neck_bending\"]\n"));
    without("", &format!("{FEET}[[support]]\nsegment = \"head\"\ncorners_m = [[0, 0.2, 0]]\n"));
    // A gaze of the trunk says where the head is; beside another task of the head the gaze is not all.
    let gaze = "[[task]]\nkind = \"look_at\"\ntarget_m = [2, 1.4, 0]\n";
    without("", &format!("{FEET}{gaze}segment = \"torso\"\n"));
    let point = "[[task]]\nkind = \"point\"\nsegment = \"head\"\ntarget = \"start\"\n";
    assert_eq!(labels("", &format!("{FEET}{gaze}{point}")), ["look_at head", "point head", "effort"]);
    // Told so, it stands beside a task of the trunk, without a note.
    let torso = "[[task]]\nkind = \"orientation\"\nsegment = \"torso\"\ntarget = \"start\"\n";
    assert_eq!(labels("upright = true", &format!("{FEET}{torso}")), ["orientation torso", "head upright", "effort"]);
    assert!(relax("upright = true", FEET).notes.is_empty());
}

/// A gaze leaves the roll of the head free: the eyes are level all the same, whatever the trunk does.
#[test]
fn a_gaze_keeps_the_eyes_level() {
    let gaze = "[[task]]\nkind = \"look_at\"\ntarget_m = [1.5, 1.2, 0.6]\n";
    assert_eq!(labels("", &format!("{FEET}{gaze}{EFFORT}")), ["look_at head", "head level", "effort"]);
    assert_eq!(labels("upright = false", &format!("{FEET}{gaze}{EFFORT}")), ["look_at head", "effort"]);
    assert_eq!(labels("upright = true", &format!("{FEET}{gaze}{EFFORT}")), ["look_at head", "head upright", "effort"]);
    // On the work of a hand, or far from it.
    let at = |x: &str| labels("", &format!("{FEET}{HAND}{}", gaze.replace("[1.5, 1.2, 0.6]", x)));
    assert_eq!(at("[0.5, 1.3, 0.2]"), ["point hand_r", "look_at head", "effort"]);
    assert_eq!(at("[0.9, 1.3, 0.2]"), ["point hand_r", "look_at head", "head level", "effort"]);
    let bent = "[posture]\nlumbar_bending_deg = 15\nneck_bending_deg = -20\nneck_rotation_deg = 20\n";
    let tilt = |top: &str| {
        let text = format!("format = 1\n{top}\n{FEET}{gaze}{bent}");
        let scenario = read_pose("a.toml", text.as_bytes(), None).unwrap();
        let model = &scenario.model;
        let mut engine = Engine::new(model, scenario.goals.clone(), &scenario.loads, scenario.options).unwrap();
        let pose = engine.solve(&scenario.start).unwrap();
        let mut kinematics = Kinematics::new(model);
        kinematics.update(model, &pose.posture).unwrap();
        let head = model.segment("head").unwrap();
        let across = kinematics.direction(model, head, nalgebra::Vector3::z());
        let ahead = kinematics.direction(model, head, nalgebra::Vector3::x());
        let eye = kinematics.station(model, head, nalgebra::Vector3::new(0.1, 0.1, 0.0));
        let line = (nalgebra::Vector3::new(1.5, 1.2, 0.6) - eye).normalize();
        (libm::asin(across.y).to_degrees(), ahead.angle(&line).to_degrees())
    };
    let ((level, miss), (free, _)) = (tilt(""), tilt("upright = false"));
    assert!(level.abs() < 1e-3 && free.abs() > 2.0, "{level} and {free} deg");
    assert!(miss < 5.0, "the gaze comes first: {miss} deg");
}

/// Without supports a coordinate finds relief on its own, and stays so.
#[test]
fn a_body_without_supports_has_no_task_added() {
    let scenario = read_scenario("a.toml", format!("format = 1\n{RUN}").as_bytes(), None).unwrap();
    assert!(!scenario.has_supports_or_tasks());
}

#[test]
fn an_event_still_names_the_tasks_of_the_file() {
    let event = "[[event]]\nat_s = 0.5\ntask = 2\ntarget_m = [0.5, 1.3, 0.3]\n";
    // Effort first, so that the added tasks (of the head, of the left arm, of the shoulders) stand above the one that the event names.
    let text = format!("format = 1\n{FEET}{EFFORT}{HAND}{RUN}{event}");
    let RunScenario { scenario, notes, .. } = read_run("a.toml", text.as_bytes(), None).unwrap();
    let kinds: Vec<&str> = scenario.tasks.iter().map(|task| task.goal.tasks[0].kind()).collect();
    assert_eq!((kinds, notes.len()), (vec!["look_at", "bounds", "height", "effort", "point"], 2));
    let (level, goal) = &scenario.events[0].tasks[0];
    let Task::Point(point) = &goal.tasks[0] else { panic!() };
    assert_eq!((*level, point.target.y), (4, 1.3));
    let error = read_scenario("a.toml", text.replace("task = 2", "task = 3").as_bytes(), None).unwrap_err();
    assert!(complaint(&error).contains("there is no task 3; the scenario has 2 of them"), "{}", complaint(&error));
}

#[test]
fn wrong_values_are_refused_where_they_stand() {
    let refused = |text: &str| complaint(&read_relax("a.toml", text.as_bytes(), None).map(|_| ()).unwrap_err());
    let text = refused(&format!("format = 1\nupright = \"no\"\n{FEET}"));
    assert!(text.contains("label at line 2, columns 11") && text.contains("expected a boolean"), "{text}");
    let robot = contrapposto_formats::urdf::read(
        include_bytes!("models/arm.urdf"),
        "arm.urdf",
        &contrapposto_formats::urdf::Options::default(),
    );
    let text = "format = 1\nupright = true\n[model]\nfile = \"arm.urdf\"\n";
    let error = read_relax("a.toml", text.as_bytes(), Some(robot.unwrap().model().unwrap().model)).map(|_| ());
    let text = complaint(&error.unwrap_err());
    assert!(text.contains("label at line 2, columns 11") && text.contains("no segment `head`"), "{text}");
    assert!(text.contains("leave it out"), "{text}");
}

/// The trunk is bent and turned at the start; the neck brings the head back.
#[test]
fn a_pose_brings_the_head_upright() {
    let bent = "[posture]\nlumbar_extension_deg = -30\nlumbar_bending_deg = 10\nthoracic_rotation_deg = 15\n";
    let text = format!("format = 1\n{FEET}{bent}");
    let scenario = read_pose("a.toml", text.as_bytes(), None).unwrap();
    let mut engine = Engine::new(&scenario.model, scenario.goals.clone(), &scenario.loads, scenario.options).unwrap();
    let pose = engine.solve(&scenario.start).unwrap();
    let head = scenario.model.segment("head").unwrap();
    let mut kinematics = Kinematics::new(&scenario.model);
    let mut up = |posture| {
        kinematics.update(&scenario.model, posture).unwrap();
        kinematics.direction(&scenario.model, head, nalgebra::Vector3::y()).y
    };
    assert!(up(&scenario.start) < 0.9, "the head is bent at the start");
    assert!(up(&pose.posture) > 1.0 - 1e-12);
}
