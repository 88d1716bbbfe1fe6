//! The scenario reader is total: any bytes give an experiment or an error, never a panic; and an accepted experiment runs
//! without a number that is not finite.

use crate::common;

use std::path::Path;

use common::complaint;
use common::toml::{ODD, hammer_toml, numbers};
use contrapposto::hybrid::Strategy;
use contrapposto::simulation::{Sample, Scenario, ScenarioError, run};
use contrapposto::tasks::{LookAtGoal, Task};
use contrapposto_formats::{InputError, TableRow, csv_header, csv_row, read_scenario};

/// Every scenario of the repository that moves single joints over time, and one with every table such a scenario may have.
fn corpus() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    let mut texts: Vec<String> = paths.iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
    texts.retain(|text| text.contains("[run]") && !text.contains("[[support]]") && !text.contains("[[task]]"));
    assert!(texts.len() >= 10);
    texts.push(FULL.to_owned());
    texts
}

const FULL: &str = r#"format = 1
title = "Every table"
[model]
adult = { sex = "female", stature_m = 1.65, mass_kg = 60, part = "right_arm", lengths_m = { humerus = 0.31 } }
[passive]
elbow_flex_r = { double_exponential = { lower = { torque_nm = 12.67, rate_per_rad = 19.92, angle_deg = 0.5 }, upper = { torque_nm = 9.324, rate_per_rad = 3.811, angle_deg = 150 }, stiffness_nm_per_rad = 0.4, neutral_deg = 73 }, reshape = { zone_deg = 5, end_torque_nm = 20 } }
wrist_flex_r = { coordinate_limit_force = { upper_stiffness_nm_per_deg = 1.5, upper_limit_deg = 60, lower_stiffness_nm_per_deg = 1.2, lower_limit_deg = -50, transition_deg = 8 } }
wrist_dev_r = { table_deg_nm = [[-20, 3.5], [-10, 0.5], [15, -0.6], [30, -4.5]], reshape = true }
[posture]
arm_flex_r_deg = 60
elbow_flex_r_deg = 90
[coordinates]
locked = ["arm_rot_r"]
[[load]]
segment = "hand_r"
mass_kg = 2
[[load]]
segment = "ulna_r"
force_n = [3, -20, 1]
at_m = [0.01, -0.08, 0.02]
fixed_in = "segment"
[strategy]
kind = "passive"
minimum_decrease_ratio = 0.9
[relief]
step_gain = 0.3
max_step_deg = 2
torque_tolerance_nm = 0.05
tables = "total"
[fatigue]
law = "endurance"
curve = "rohmert_general"
critical_level = 0.6
recovery_level = 0.3
start = { elbow_flex_r = { positive = 0.7, negative = 0.1 }, arm_flex_r = { positive = 0.8 } }
[run]
duration_s = 2
step_s = 0.0333
stop_when_settled = false
"#;

/// A body on its feet, with every key of supports, events and strategies.
const WHOLE: &str = r#"format = 1
title = "On both feet"
least_effort = false
[model]
adult = { sex = "female", stature_m = 1.65, mass_kg = 60 }
[posture]
elbow_flex_r_deg = 60
[coordinates]
locked = ["mtp_angle_r", "mtp_angle_l"]
[[load]]
segment = "hand_r"
mass_kg = 2
[[support]]
segment = "calcn_r"
on = "ground"
friction = 0.8
[[support]]
segment = "calcn_l"
on = { normal = [0, 2, 0], point_m = [0.1, 0.01, 0] }
share_max = 0.4
corners_m = [[-0.04, -0.02, -0.03], [-0.04, -0.02, 0.03], [0.12, -0.02, 0.04], [0.12, -0.02, -0.04]]
[[task]]
kind = "center_of_mass"
margin_m = 0.01
above_relief = true
[[task]]
kind = "look_at"
target_m = [2, 1.4, 0]
[[task]]
kind = "point"
segment = "hand_r"
target = "start"
same_priority = true
[strategy]
kind = "passive"
of = { legs = "active", elbow_flex_r = "active" }
[fatigue]
start = { elbow_flex_r = { positive = 0.7 } }
[[event]]
at_s = 0.1
load = [{ segment = "hand_r", mass_kg = 3 }, { segment = "hand_l", force_n = [0, -5, 0] }]
task = 3
target_m = [0.3, 0.9, 0.2]
[[event]]
at_s = 0.05
strategy = "active"
strategy_of = { arms = "passive", hip_adduction_r = "passive" }
[run]
duration_s = 0.2
step_s = 0.05
"#;

/// Runs at most a second of it, of a whole body at most four steps (ten where a count of inputs is asked for); every number of every sample must be finite, in memory and as written.
fn assert_sound(mut scenario: Scenario, message: &dyn Fn() -> String) {
    scenario.run.duration = scenario.run.duration.min(1.0);
    let asked = std::env::var_os("CONTRAPPOSTO_MUTATIONS").is_some();
    let steps = match (scenario.has_supports_or_tasks(), asked) {
        (true, true) => 10.0,
        (true, false) => 4.0,
        (false, _) => 40.0,
    };
    scenario.run.step = scenario.run.step.max(scenario.run.duration / steps);
    let columns = csv_header(&scenario.model).split(',').count();
    let mut row = String::new();
    let summary = run(&scenario, |sample: &Sample| {
        row.clear();
        let asked: Vec<_> = sample.decisions.iter().map(|d| d.as_ref().map(|d| (d.case, d.goal))).collect();
        let &Sample { time, posture, external, passive, fatigue, .. } = sample;
        let shown = TableRow { time, posture, external, passive, fatigue, asked: &asked };
        csv_row(&scenario.model, &shown, &mut row);
        assert_eq!(row.trim_end().split(',').count(), columns);
        for (at, cell) in row.trim_end().split(',').enumerate() {
            let number: f64 = if cell.is_empty() { 0.0 } else { cell.parse().unwrap() };
            assert!(number.is_finite(), "column {at}: {cell}\n{}", message());
        }
        assert!(sample.load.iter().all(|load| load.is_finite()), "load\n{}", message());
        for (&value, coordinate) in sample.posture.iter().zip(scenario.model.coordinates()) {
            assert!(value >= coordinate.range.0 && value <= coordinate.range.1, "{}\n{}", coordinate.name, message());
        }
        for (&level, torques) in sample.fatigue.iter().flatten().zip(sample.active.iter().flat_map(|t| [t, t])) {
            assert!((0.0..=1.0).contains(&level) && torques.is_finite(), "fatigue {level}\n{}", message());
        }
    });
    // That a body cannot stand is found out by trying.
    if scenario.has_supports_or_tasks()
        && matches!(summary, Err(ScenarioError::CannotStand { .. } | ScenarioError::Relax(_)))
    {
        return;
    }
    let summary = summary.unwrap_or_else(|error| panic!("{error}\n{}", message()));
    assert!(summary.end_time.is_finite() && summary.samples > 0);
}

fn read_whole(text: &str) -> Result<Scenario, InputError> {
    read_scenario("whole.toml", text.as_bytes(), None)
}

#[test]
fn mutated_scenarios_never_panic() {
    hammer("scenario", 20_000, &corpus());
}

/// Fewer of them: a body on its feet takes a thousand times as long as a joint.
#[test]
fn mutated_whole_bodies_never_panic() {
    hammer("whole body", 1_000, &[WHOLE.to_owned()]);
}

fn hammer(name: &str, usual: usize, texts: &[String]) {
    hammer_toml(name, 20_070_902, usual, texts, |bytes| {
        let message = || String::from_utf8_lossy(bytes).into_owned();
        match read_scenario("mutant.toml", bytes, None) {
            Ok(scenario) => {
                assert_sound(scenario, &message);
                true
            }
            Err(error) => {
                let text = complaint(&error);
                assert!(text.contains("mutant.toml"), "no place: {text}\n{}", message());
                assert!(!text.contains('\u{1b}'), "{text:?}");
                false
            }
        }
    });
}

/// NaN, infinities, the ends of the doubles, negative zero and a subnormal in each number in turn.
#[test]
fn odd_numbers_in_every_field() {
    odd_numbers(FULL, 47);
    odd_numbers(WHOLE, 42);
}

fn odd_numbers(full: &str, expected: usize) {
    let places = numbers(full.as_bytes());
    assert_eq!(places.len(), expected, "numbers of the scenario");
    let (mut accepted, mut refused) = (0, 0);
    for &(from, to) in &places {
        for odd in ODD {
            let text = format!("{}{odd}{}", &full[..from], &full[to..]);
            let message = || format!("{odd} for {} in\n{text}", &full[from..to]);
            match read_scenario("odd.toml", text.as_bytes(), None) {
                Ok(scenario) => {
                    let finite = odd.parse::<f64>().map_or(true, f64::is_finite);
                    assert!(finite, "accepted {}", message());
                    accepted += 1;
                    assert_sound(scenario, &message);
                }
                Err(error) => {
                    let text = complaint(&error);
                    let line = full[..from].matches('\n').count() + 1;
                    let near = text.contains(&format!("line {line}, column"))
                        || !matches!(odd, "nan" | "inf" | "-inf" | "1e999");
                    assert!(near, "points elsewhere: {text}\n{}", message());
                    refused += 1;
                }
            }
        }
    }
    println!("{} fields x {} values: {accepted} accepted and run, {refused} refused", places.len(), ODD.len());
}

#[test]
fn the_full_scenario_is_read() {
    for text in corpus() {
        let scenario =
            read_scenario("corpus.toml", text.as_bytes(), None).unwrap_or_else(|error| panic!("{}", complaint(&error)));
        assert_sound(scenario, &|| text.clone());
        // Line ends and a byte order mark are the editor's business.
        read_scenario("crlf.toml", text.replace('\n', "\r\n").as_bytes(), None).unwrap();
        read_scenario("bom.toml", format!("\u{feff}{text}").as_bytes(), None).unwrap();
    }
    let by_default = FULL.replacen("minimum_decrease_ratio = 0.9\n", "", 1);
    let by_default = read_scenario("full.toml", by_default.as_bytes(), None).unwrap();
    assert_eq!(by_default.strategy.minimum_decrease_ratio, 0.9);
}

/// Every prefix of a file is a value or a complaint.
#[test]
fn truncated_scenarios_never_panic() {
    let full = corpus().pop().unwrap();
    for end in 0..full.len() {
        if let Err(error) = read_scenario("cut.toml", &full.as_bytes()[..end], None) {
            assert!(complaint(&error).contains("cut.toml"));
        }
    }
}

/// The keys of supports, tasks and events have the meanings that docs/scenario.md gives them.
#[test]
fn a_whole_body_is_read() {
    let scenario = read_whole(WHOLE).unwrap_or_else(|error| panic!("{}", complaint(&error)));
    let model = &scenario.model;
    assert!(scenario.has_supports_or_tasks());
    let [right, left] = [&scenario.supports[0], &scenario.supports[1]];
    assert_eq!((right.segment, right.friction, right.share_max), (model.segment("calcn_r").unwrap(), 0.8, 1.0));
    assert_eq!(right.corners, model.segments()[right.segment].patch);
    assert_eq!((left.friction, left.share_max, left.corners.len(), left.corners[2].x), (0.6, 0.4, 4, 0.12));
    for support in &scenario.supports {
        assert_eq!(support.normal, nalgebra::Vector3::y());
    }
    let tasks: Vec<(usize, bool)> =
        scenario.tasks.iter().map(|task| (task.goal.tasks.len(), task.above_relief)).collect();
    assert_eq!(
        tasks,
        [(1, true), (2, false), (1, false), (1, false), (2, false)],
        "`head level` is added to the gaze, a task for the idle arm, and two for the shoulders"
    );
    // A coordinate's own word, then its region's, then that of the whole body.
    let strategy = |list: &[Strategy], name: &str| list[model.coordinate(name).unwrap()];
    for (name, start, later) in [
        ("elbow_flex_r", Strategy::Active, Strategy::Passive),
        ("arm_flex_l", Strategy::Passive, Strategy::Passive),
        ("knee_angle_r", Strategy::Active, Strategy::Active),
        ("hip_adduction_r", Strategy::Active, Strategy::Passive),
        ("lumbar_extension", Strategy::Passive, Strategy::Active),
    ] {
        assert_eq!(strategy(&scenario.strategies, name), start, "{name}");
        assert_eq!(strategy(scenario.events[0].strategies.as_ref().unwrap(), name), later, "{name}");
    }
    let other = WHOLE.replace("\nof = {", "\nby_region = {");
    assert!(
        other != WHOLE && read_scenario("x.toml", other.as_bytes(), None).unwrap().strategies == scenario.strategies
    );
    // Events stand in the order of time; `task` counts the tasks of the file, of which two share a priority.
    let times: Vec<f64> = scenario.events.iter().map(|event| event.time).collect();
    assert_eq!(times, [0.05, 0.1]);
    let event = &scenario.events[1];
    assert_eq!((event.strategies.is_none(), event.loads.as_ref().unwrap().len()), (true, 2));
    let (place, goal) = &event.tasks[0];
    let before = &scenario.tasks[*place].goal;
    assert_eq!((*place, &goal.tasks[0]), (1, &before.tasks[0]));
    let Task::Point(point) = &goal.tasks[1] else { panic!("{:?}", goal.tasks[1]) };
    assert_eq!(point.target, nalgebra::Vector3::new(0.3, 0.9, 0.2));
    assert_sound(scenario, &|| WHOLE.to_owned());
}

/// A second event finds the targets where the first one left them.
#[test]
fn events_follow_one_another() {
    let move_gaze = "[[event]]\nat_s = 0.15\ntask = 2\ntarget_m = [1, 1, 1]\n[run]";
    let scenario = read_whole(&WHOLE.replace("[run]", move_gaze)).unwrap();
    let goal = &scenario.events[2].tasks[0].1;
    let (Task::LookAt(look), Task::Point(point)) = (&goal.tasks[0], &goal.tasks[1]) else { panic!("{goal:?}") };
    assert_eq!((look.goal, point.target.x), (LookAtGoal::Place([1.0; 3].into()), 0.3));
}

/// An event at the very end happens; one after the last whole step does not, and is refused.
#[test]
fn an_event_is_not_passed_over() {
    let at = |time: &str, run: &str| {
        let text = WHOLE.replace("at_s = 0.1\n", &format!("at_s = {time}\n"));
        read_whole(&text.replace("duration_s = 0.2\nstep_s = 0.05", run)).map_err(|error| complaint(&error))
    };
    let scenario = at("0.2", "duration_s = 0.2\nstep_s = 0.05").unwrap();
    let (mut weight, mut end) = (0.0, 0.0);
    run(&scenario, |sample| {
        weight = sample.standing.unwrap().contacts.iter().map(|contact| contact.force.y).sum();
        end = sample.time;
    })
    .unwrap();
    let gravity = scenario.model.gravity().norm();
    assert!((weight - gravity * (scenario.model.mass() + 3.0) - 5.0).abs() < 1e-6, "{weight} N at {end} s");
    // A thirtieth three hundred times is ten seconds.
    assert!(at("10", "duration_s = 10").is_ok());
    let text = at("9.99", "duration_s = 10\nstep_s = 0.3").unwrap_err();
    assert!(text.contains("it is at 9.99 s, the last step of the run at 9.9 s"), "{text}");
}

/// Replacement of a line of the whole body's scenario; the place that the message names, and a part of the message.
#[test]
fn mistakes_are_refused_where_they_stand() {
    let cases: &[(&str, &str, &str, &str)] = &[
        ("segment = \"calcn_r\"", "segment = \"calcn\"", "column 11", "did you mean `calcn_"),
        ("segment = \"calcn_l\"", "segment = \"femur_l\"", "column 6", "m above its plane and tilted by 180 degrees"),
        ("segment = \"calcn_r\"", "segment = \"head\"", "column 11", "add `corners_m = [[x, y, z], ...]`"),
        ("segment = \"calcn_l\"", "segment = \"calcn_r\"", "column 11", "a support already"),
        ("friction = 0.8", "friction = -1", "column 12", "it must lie in 0..10"),
        ("friction = 0.8", "fricton = 1", "column 1", "did you mean `friction`"),
        ("share_max = 0.4", "share_max = 1.1", "column 13", "it must lie in 0..1"),
        ("on = \"ground\"", "on = \"flor\"", "column 6", "neither the floor nor the ground nor a plane"),
        (
            "on = { normal = [0, 2, 0], point_m = [0.1, 0.01, 0] }",
            "on = { normal = [0, 0, 0] }",
            "column 6",
            "has no length",
        ),
        (
            "on = { normal = [0, 2, 0], point_m = [0.1, 0.01, 0] }",
            "on = { normal = [0, 1, 0], point_m = [0, 0.45, 0] }",
            "column 6",
            "a support stays where it is at the start",
        ),
        ("point_m = [0.1, 0.01, 0]", "point_m = [0.1, 1e308, 0]", "column 6", "too large"),
        (
            "of = { legs = \"active\", elbow_flex_r = \"active\" }",
            "of = { leg = \"active\" }",
            "column 8",
            "did you mean `legs`",
        ),
        (
            "of = { legs = \"active\"",
            "of = { legs = \"relaxed\"",
            "column 15",
            "did you mean `passive`|there are: active, passive",
        ),
        ("at_s = 0.1", "at_s = -0.1", "column 8", "must not be negative"),
        (
            "at_s = 0.1",
            "at_s = 0.21",
            "column 8",
            "event 1 would never happen: it is at 0.21 s, the last step of the run at 0.2 s",
        ),
        ("at_s = 0.05", "at_s = 1e300", "column 8", "event 2 would never happen: it is at 1e300 s"),
        ("at_s = 0.1", "at_s = nan", "column 8", "`nan` is not a finite number"),
        ("at_s = 0.1", "", "column 1", "`at_s` is missing"),
        ("strategy = \"active\"", "strategy = \"ready\"", "column 12", "unknown value `ready`"),
        ("strategy_of = { arms", "strategy_of = { armes", "column 17", "did you mean `arms`"),
        ("mass_kg = 3 }", "mass_kg = -3 }", "column 41", "mass (kg) of a load is -3"),
        ("load = [{ segment = \"hand_r\"", "load = [{ segment = \"hand_rr\"", "column 21", "did you mean `hand_r`"),
        ("force_n = [0, -5, 0]", "force = [0, -5, 0]", "column 68", "unknown key `force`"),
        ("task = 3", "task = 4", "column 8", "there is no task 4; the scenario has 3 of them"),
        ("task = 3", "task = 0", "column 8", "1 is the first"),
        ("task = 3", "task = 1", "column 8", "task 1 (center_of_mass) has no place as its target"),
        ("task = 3\n", "", "column 12", "which task is meant?"),
        ("target_m = [0.3, 0.9, 0.2]", "", "column 8", "a new target is missing"),
        ("target_m = [0.3, 0.9, 0.2]", "target_m = [0.3, 1e10, 0.2]", "column 12", "target (m) is 10000000000"),
        ("target_m = [0.3, 0.9, 0.2]", "target_m = [0.3, 0.9]", "column 12", "2 numbers are given; 3 are due"),
        (
            "at_s = 0.05\nstrategy = \"active\"\nstrategy_of = { arms = \"passive\", hip_adduction_r = \"passive\" }\n",
            "at_s = 0.05\n",
            "column 1",
            "nothing changes",
        ),
    ];
    let mut wrong = vec![];
    for (old, new, column, part) in cases {
        assert!(WHOLE.contains(old), "{old}");
        let changed = WHOLE.replacen(old, new, 1);
        let text = read_whole(&changed).map_or_else(|error| complaint(&error), |_| "accepted".to_owned());
        let text = text.replace(", columns ", ", column ");
        // Messages on missing keys, and on contradictions of two lines, name a neighbouring line.
        let line = WHOLE[..WHOLE.find(old).unwrap()].matches('\n').count() + 1;
        let here = |line: usize| text.contains(&format!("label at line {line}, {column}"));
        if !(line - 1..=line + 1).any(here) || !part.split('|').any(|part| text.contains(part)) {
            wrong.push(format!("`{part}` at line {line}, {column} is not in\n{text}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n----\n"));
    println!("{} mistakes", cases.len());
}

/// A free coordinate without a passive curve is refused where it is freed, but not where a whole body moves it.
#[test]
fn a_single_joint_needs_a_curve() {
    let lines =
        "format = 1\n[coordinates]\nfree = [\"pelvis_tx\"]\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 0\n";
    let text = complaint(&read_whole(lines).unwrap_err());
    assert!(text.contains("`pelvis_tx` is free") && text.contains("line 3, column"), "{text}");
    read_whole(&format!("{lines}[[task]]\nkind = \"posture\"\n")).unwrap();
}
