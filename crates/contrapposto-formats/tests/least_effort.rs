//! A job that names no effort has it all the same.

use contrapposto::simulation::{Run, Scenario};
use contrapposto::tasks::Task;
use contrapposto::verdict::{Verdict, VerdictKind};
use contrapposto_formats::{RunScenario, read_pose, read_run};

const STANDS: &str = "format = 1\ntitle = \"Carries a bag\"\n";
const BODY: &str = "[model]\nadult = { sex = \"female\", stature_m = 1.65, mass_kg = 62 }\n[[support]]\nsegment = \"calcn_r\"\n\
    [[support]]\nsegment = \"calcn_l\"\n[[bag]]\non = \"right_hand\"\nmass_kg = 5\n";
const RUN: &str = "[strategy]\nkind = \"active\"\n[run]\nduration_s = 60\nstep_s = 1\n";

fn job(key: &str, more: &str) -> RunScenario {
    let text = format!("{STANDS}{key}{BODY}{more}{RUN}");
    read_run("job.toml", text.as_bytes(), None).unwrap_or_else(|error| panic!("{:?}", miette::Report::new(error)))
}

/// The places of effort among the tasks, counted from the last one.
fn efforts(scenario: &Scenario) -> Vec<usize> {
    let is_effort = |task: &Task| matches!(task, Task::Effort(_));
    let levels = scenario.tasks.iter().rev().enumerate();
    levels.filter(|(_, level)| level.goal.tasks.iter().any(is_effort)).map(|(i, _)| i).collect()
}

fn said(job: &RunScenario) -> bool {
    job.notes.iter().any(|note| note.contains("`least_effort = false` leaves it out"))
}

#[test]
fn effort_is_the_last_task_of_a_run_that_names_none() {
    let with = job("", "");
    assert!(efforts(&with.scenario) == [0] && said(&with), "{:?}", with.notes);
    let without = job("least_effort = false\n", "");
    assert!(efforts(&without.scenario).is_empty() && !said(&without));
    let asked = job("least_effort = true\n", "");
    assert!(efforts(&asked.scenario) == [0] && !said(&asked));
    let own = "[[task]]\nkind = \"effort\"\n[[task]]\nkind = \"posture\"\n";
    let own = job("", own);
    assert!(efforts(&own.scenario) == [1] && !said(&own), "its own effort stays where it is");
    // The added task is not counted among those of the file.
    let gaze = "[[task]]\nkind = \"point\"\nsegment = \"hand_l\"\ntarget_m = [0.3, 1.0, -0.2]\n[[event]]\nat_s = 30\ntask = 2\ntarget_m = [0, 0, 0]\n";
    let text = format!("{STANDS}{BODY}{gaze}{RUN}");
    let error = read_run("job.toml", text.as_bytes(), None).unwrap_err().to_string();
    assert!(error.contains("there is no task 2; the scenario has 1 of them"), "{error}");
}

#[test]
fn a_pose_and_a_body_without_supports_get_no_effort() {
    let pose = read_pose("pose.toml", format!("{STANDS}{BODY}").as_bytes(), None).unwrap();
    let is_effort = |task: &Task| matches!(task, Task::Effort(_));
    assert!(!pose.goals.iter().flat_map(|goal| &goal.tasks).any(is_effort));
    let arm = "format = 1\ntitle = \"a\"\n[model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 73 }\n";
    let arm = read_run("arm.toml", format!("{arm}{RUN}").as_bytes(), None).unwrap();
    assert!(efforts(&arm.scenario).is_empty());
}

/// With the straight elbows of the start the extensors would press against the ligaments until they fail, as no person's do.
#[test]
fn who_carries_a_bag_does_not_press_the_own_elbow_straight() {
    let verdict = |scenario: &Scenario| {
        let mut run = Run::new(scenario).unwrap();
        while run.next_sample().unwrap().is_some() {}
        Verdict::of_run(scenario, &run.summary())
    };
    let group = |verdict: &Verdict, model: &contrapposto::model::Model| {
        verdict.hardest.map(|who| model.coordinates()[who.coordinate].name.clone()).unwrap_or_default()
    };
    let (kept, eased) = (job("least_effort = false\n", "").scenario, job("", "").scenario);
    let (stiff, loose) = (verdict(&kept), verdict(&eased));
    assert!(group(&stiff, &kept.model).starts_with("elbow_flex"), "{}", stiff.sentence);
    assert!(
        loose.kind == VerdictKind::Holds && !group(&loose, &eased.model).starts_with("elbow"),
        "{}",
        loose.sentence
    );
}

/// The search for the start leaves the legs as the file has them; with an easier trunk and easier arms they rest in another posture.
#[test]
fn a_run_begins_where_its_whole_body_rests() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/push.toml")).unwrap();
    let text = text.replace("duration_s = 120", "duration_s = 5");
    let pushes = read_run("push.toml", text.as_bytes(), None).unwrap();
    let mut run = Run::new(&pushes.scenario).unwrap();
    while run.next_sample().unwrap().is_some() {}
    let summary = run.summary();
    let (start, end) = (summary.effort_at_start.unwrap(), summary.standing.unwrap().effort);
    assert!(end > 0.98 * start && start < 0.2, "{start} at the start, {end} after 5 s");
}

/// A woman on one foot and a fifth of the other, who misses a task (random world 894). Her toes, which have no part in it, once
/// worked at a third of their strength: steps of the solver had come to rest before effort was least.
#[test]
fn at_a_start_that_misses_a_task_toes_that_have_no_part_in_it_do_not_work() {
    let text = "format = 1\ntitle = \"reaches\"\n[model]\nadult = { sex = \"female\", stature_m = 1.720, mass_kg = 95.2 }\n\
        [posture]\nhip_flexion_r_deg = 2.51\nknee_angle_r_deg = 5.03\nankle_angle_r_deg = 2.51\narm_flex_r_deg = 67.9\n\
        elbow_flex_r_deg = 68.0\nhip_flexion_l_deg = 2.51\nknee_angle_l_deg = 5.03\nankle_angle_l_deg = 2.51\narm_flex_l_deg = 5.3\n\
        elbow_flex_l_deg = 99.2\n[[support]]\nsegment = \"calcn_r\"\nfriction = 0.55\n[[support]]\nsegment = \"calcn_l\"\n\
        share_max = 0.2\n[[task]]\nkind = \"orientation\"\nsegment = \"head\"\ntarget = \"start\"\n[[task]]\nkind = \"point\"\n\
        segment = \"hand_r\"\ntarget_m = [0.592, 0.812, 0.024]\nabove_relief = true\n[[task]]\nkind = \"orientation\"\n\
        segment = \"torso\"\ntarget = \"start\"\n[[task]]\nkind = \"effort\"\n";
    let job = read_run("job.toml", format!("{text}{RUN}").as_bytes(), None).unwrap().scenario;
    let mut run = Run::new(&job).unwrap();
    let sample = run.next_sample().unwrap().unwrap();
    let toes = ["mtp_angle_r", "mtp_angle_l"].map(|toes| sample.load[job.model.coordinate(toes).unwrap()]);
    let errors = &sample.standing.unwrap().errors;
    println!("toes at {toes:?} of their strength, errors {errors:?}");
    assert!(errors.iter().any(|error| *error > 0.01) && toes.iter().all(|share| *share < 1e-3));
}
