//! Hands held before the body, as in docs/holding-times.md: the group that fails first, and the class of Miedema et al. 1997.

use contrapposto::simulation::run;
use contrapposto::suggestions::Advice;
use contrapposto_formats::{SummaryText, read_scenario};

/// Knuckles at a height, m, and so far ahead of the ankles; nobody shifts. The first group that gives up, and after how many
/// minutes, if that is within thirty.
fn held(height: f64, ahead: f64) -> Option<(String, f64)> {
    let hand = |side: &str, across: f64| {
        format!(
            "[[task]]\nkind = \"point\"\nsegment = \"hand_{side}\"\nat_m = [0, -0.0866, 0]\n\
            target_m = [{ahead}, {height}, {across}]\nabove_relief = true\n"
        )
    };
    let text = format!(
        "format = 1\nupright = false\n[model]\nadult = {{ sex = \"male\", stature_m = 1.75, mass_kg = 73 }}\n\
        [[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n{}{}[[task]]\nkind = \"effort\"\n\
        [strategy]\nkind = \"active\"\n[fatigue]\nlaw = \"endurance\"\ncritical_level = 1\n\
        [run]\nduration_s = 1801\nstep_s = 1\n",
        hand("r", 0.1),
        hand("l", -0.1)
    );
    let scenario = read_scenario("scenario.toml", text.as_bytes(), None).unwrap();
    let summary = run(&scenario, |_| {}).unwrap();
    let verdict = contrapposto::verdict::Verdict::of_run(&scenario, &summary);
    let text = SummaryText::new(&scenario, &summary, &verdict, &Advice::default(), vec![]);
    println!("{height} m, {ahead} m: {:?}", text.failed_first);
    assert!(text.standing.unwrap().task_errors.iter().take(2).all(|error| *error < 1e-3));
    text.failed_first.map(|failed| (failed.group.unwrap(), failed.at_s / 60.0))
}

/// The published class of arms held out level is 5 to 10 minutes, that of the bench over 10. In the posture of least effort the
/// program holds level arms longer than their class: docs/holding-times.md.
#[test]
fn arms_held_out_level_fail_at_the_shoulder_and_long_before_a_bench() {
    let (group, minutes) = held(1.4315, 0.6401).unwrap();
    assert!(group.starts_with("shoulder"), "{group}");
    assert!((5.0..20.0).contains(&minutes), "{minutes}");
    assert_eq!(held(1.0736, 0.2963), None, "more than 30 minutes");
}
