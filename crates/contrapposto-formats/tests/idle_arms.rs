//! Arms that move no support and have no task hang: at the start of every run of `scenarios/`, and in every posture that `relax` gives.

use std::path::{Path, PathBuf};

use contrapposto::contact::Support;
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::run;
use contrapposto::statics::{Load, LoadKind};
use contrapposto::tasks::Task;
use contrapposto_formats::read_scenario;

use crate::common::runs::searches;

/// The scenarios of the adult.
fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.is_file() && !std::fs::read_to_string(file).unwrap().contains("file ="));
    files.sort();
    files
}

/// Height of the hand above the shoulder of its side, m, for the arms without support and task of their own that bear nothing but weights.
fn idle_arms<'a>(
    model: &Model,
    posture: &Posture,
    (supports, loads): (&[Support], &[Load]),
    tasks: impl Iterator<Item = &'a Task> + Clone,
) -> Vec<(&'static str, f64)> {
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, posture).unwrap();
    let height = |name: &str| kinematics.placement(model, model.segment(name).unwrap()).translation.vector.y;
    let mut found = vec![];
    for (arm, segments) in [
        ("right", ["hand_r", "radius_r", "ulna_r", "humerus_r"]),
        ("left", ["hand_l", "radius_l", "ulna_l", "humerus_l"]),
    ] {
        let is_of_arm = |segment: usize| segments.contains(&&*model.segments()[segment].name);
        let mut work = tasks.clone().filter(|task| !task.hangs(model) && !matches!(task, Task::Height(_)));
        let tasked = work.any(|task| segments.iter().any(|name| task.label(model).contains(name)));
        let carries = supports.iter().any(|support| is_of_arm(support.segment));
        let pulled = loads.iter().any(|load| is_of_arm(load.segment) && !matches!(load.kind, LoadKind::Weight(_)));
        if !tasked && !carries && !pulled {
            found.push((arm, height(segments[0]) - height(segments[3])));
        }
    }
    found
}

#[test]
fn idle_arms_hang_at_the_start_of_every_run() {
    let mut arms = 0;
    for file in files() {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let mut scenario = read_scenario(&name, &std::fs::read(&file).unwrap(), None).unwrap();
        if scenario.supports.is_empty() {
            continue;
        }
        scenario.run.duration = 0.05;
        scenario.events.clear();
        let tasks: Vec<Task> = scenario.tasks.iter().flat_map(|task| task.goal.tasks.clone()).collect();
        let mut first = None;
        run(&scenario, |sample| {
            first.get_or_insert_with(|| Posture::new(sample.posture.to_vec()));
        })
        .unwrap();
        let held = (&scenario.supports[..], &scenario.loads[..]);
        for (arm, above) in idle_arms(&scenario.model, &first.unwrap(), held, tasks.iter()) {
            println!("{name}: {arm} hand {above:+.2} m above the shoulder");
            assert!(above < 0.0, "{name}: the {arm} hand is {above} m above the shoulder");
            arms += 1;
        }
    }
    assert!(arms >= 8, "{arms}");
}

/// In every answer, also with a bag in the hand: arms balanced upright need little torque.
#[test]
fn arms_without_a_task_hang_in_every_answer_of_relax() {
    for name in ["bus-stop", "reach-floor", "hold-tool", "overhead", "screw-overhead", "stand-relaxed"] {
        let (_, scenario, found) = searches().iter().find(|(file, ..)| *file == format!("{name}.toml")).unwrap();
        let tasks: Vec<Task> = scenario.goals.iter().flat_map(|level| level.tasks.clone()).collect();
        for (i, posture) in found.postures.iter().enumerate() {
            let held = (&scenario.supports[..], &scenario.loads[..]);
            let arms = idle_arms(&scenario.model, &posture.relaxed.posture, held, tasks.iter());
            assert!(!arms.is_empty(), "{name}");
            for (arm, above) in arms {
                println!("{name}, answer {}: {arm} hand {above:+.2} m above the shoulder", i + 1);
                assert!(above < 0.0, "{name}, answer {}: the {arm} hand is {above} m above the shoulder", i + 1);
            }
        }
    }
}
