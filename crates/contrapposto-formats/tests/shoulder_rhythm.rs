//! The default task `humerus_r rhythm`: when it is added, what leaves it out or refuses it, and that a body reaches higher by its shoulders.

use contrapposto::equilibria::equilibria;
use contrapposto::posture_solver::Options;
use contrapposto::tasks::Task;
use contrapposto_formats::{RelaxScenario, read_relax, read_scenario};

use crate::common::complaint;

const FEET: &str = "[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n";
/// The options of the program's `relax`.
const OPTIONS: Options = Options { max_step: 0.1, max_steps: 300, ..Options::least_effort() };

fn relax(top: &str, rest: &str) -> RelaxScenario {
    let text = format!("format = 1\n{top}\n{rest}");
    read_relax("a.toml", text.as_bytes(), None).unwrap_or_else(|error| panic!("{}\n{text}", complaint(&error)))
}

/// Number of shoulders that have the task.
fn shoulders(top: &str, rest: &str) -> usize {
    let scenario = relax(top, rest);
    scenario.goals.iter().flat_map(|level| &level.tasks).filter(|task| matches!(task, Task::Height(_))).count()
}

#[test]
fn shoulders_that_may_rise_have_it_unless_the_file_leaves_it_out() {
    assert_eq!(shoulders("", FEET), 2);
    assert_eq!(shoulders("shoulder_rhythm = true", FEET), 2);
    assert_eq!(shoulders("shoulder_rhythm = false", FEET), 0);
    assert_eq!(shoulders("", &format!("{FEET}[coordinates]\nlocked = [\"shoulder_rise_l\"]\n")), 1);
    // Without supports and tasks only what muscles relieve moves.
    let alone = "format = 1\n[strategy]\nkind = \"passive\"\n[run]\nduration_s = 1\n";
    assert!(read_scenario("a.toml", alone.as_bytes(), None).unwrap().tasks.is_empty());
}

#[test]
fn a_body_without_these_shoulders_is_refused_at_the_key() {
    let arm = "format = 1\nshoulder_rhythm = true\n[model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 75, part = \"right_arm\" }\n";
    let text = complaint(&read_relax("a.toml", arm.as_bytes(), None).map(|_| ()).unwrap_err());
    assert!(text.contains("label at line 2, columns 19") && text.contains("no coordinate `shoulder_rise_r`"), "{text}");
}

/// The knuckles above 2.12 m, where they reach without the girdle when the trunk bends aside: the shoulder rises farther than its rhythm asks.
#[test]
fn a_target_above_reach_is_reached_by_the_shoulder() {
    let hand =
        "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\nat_m = [0, -0.0866, 0]\ntarget_m = [0.02, 2.17, 0.18]\n";
    let adult = "[model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 73 }\n";
    let missed = |locked: &str| {
        let scenario = relax("", &format!("{adult}{locked}{FEET}{hand}"));
        let found = equilibria(&scenario.search(), OPTIONS).unwrap();
        let posture = &found.postures[0].relaxed;
        let rise = scenario.model.coordinate("shoulder_rise_r").unwrap();
        (posture.levels[0].length, posture.posture.values()[rise])
    };
    let (free, rise) = missed("");
    let (fixed, _) = missed("[coordinates]\nlocked = [\"shoulder_rise_r\"]\n");
    println!("missed by {free:.4} m with a rise of {rise:.4} m, by {fixed:.4} m without");
    assert!(free < 1e-4 && rise > 0.04 && fixed > 0.02, "{free} {rise} {fixed}");
}
