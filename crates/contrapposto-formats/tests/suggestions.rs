//! Every change that is suggested, written into the scenario file by hand and run on its own, gives the time that was promised.

use std::sync::Mutex;

use contrapposto::fatigue::FatigueLaw;
use contrapposto::simulation::{Run, Scenario, Summary};
use contrapposto::suggestions::{
    Advice, BREAK, BREAK_EVERY, Budget, Change, Job, LargestLoad, Suggestion, Trial, Worked, by_promise, changes,
    try_run, with_breaks,
};
use contrapposto::verdict::{Verdict, VerdictKind, how_long};
use contrapposto_formats::read_scenario;

/// An arm that holds a weight before the body.
fn text(target: [f64; 3], kilograms: f64, strategy: &str, seconds: f64) -> String {
    format!(
        r#"
format = 1
title = "a weight held out"
[model]
adult = {{ sex = "male", stature_m = 1.75, mass_kg = 75, part = "right_arm" }}
[posture]
arm_flex_r_deg = 40
elbow_flex_r_deg = 60
[[load]]
segment = "hand_r"
mass_kg = {kilograms}
[[task]]
kind = "point"
segment = "hand_r"
target_m = [{}, {}, {}]
above_relief = true
[[task]]
kind = "effort"
[strategy]
kind = "{strategy}"
[run]
duration_s = {seconds}
step_s = 0.1
"#,
        target[0], target[1], target[2]
    )
}

/// The hand at the start of the body that holds nothing, forward by 0.1 m.
const TARGET: [f64; 3] = [0.45, 1.2, 0.2];
const KILOGRAMS: f64 = 5.0;
/// Longer than anybody holds these weights, s.
const LONG: f64 = 1500.0;

fn read(text: &str) -> Scenario {
    read_scenario("held.toml", text.as_bytes(), None).unwrap()
}

/// The whole run.
fn ran(scenario: &Scenario) -> (Summary, Verdict) {
    let mut run = Run::new(scenario).unwrap();
    while run.next_sample().unwrap().is_some() {}
    let summary = run.summary();
    let verdict = Verdict::of_run(scenario, &summary);
    (summary, verdict)
}

#[test]
fn every_change_gives_the_time_that_a_whole_run_of_the_changed_file_gives() {
    let before = every_change_gives_the_time_of_its_own_run(LONG);
    assert_eq!(before.kind, VerdictKind::HeldUntil, "{}", before.sentence);
}

#[test]
fn every_change_of_a_job_that_holds_without_reserve_gives_the_time_of_its_own_run() {
    let (_, longer) = ran(&read(&text(TARGET, KILOGRAMS, "active", LONG)));
    let before = every_change_gives_the_time_of_its_own_run((0.9 * longer.seconds.unwrap()).round());
    assert_eq!(before.kind, VerdictKind::Holds, "{}", before.sentence);
    assert!(!before.has_reserve(), "{}", before.sentence);
}

/// Target, kilograms and strategy of the weight held out with a change, written by hand.
fn by_hand(
    (target, kilograms, strategy): ([f64; 3], f64, &'static str),
    change: &Change,
) -> ([f64; 3], f64, &'static str) {
    let moved = |by: f64| [target[0], target[1] + by, target[2]];
    match change {
        Change::Targets(by, _) if by.y < -0.05 => (moved(-0.1), kilograms, strategy),
        Change::Targets(by, _) if by.y > 0.05 => (moved(0.1), kilograms, strategy),
        Change::Targets(by, _) => {
            assert!((by.norm() - 0.1).abs() < 1e-12 && by.y.abs() < 1e-12 && by.x < 0.0, "nearer: {by}");
            ([target[0] + by.x, target[1], target[2] + by.z], kilograms, strategy)
        }
        Change::Loads(_) => (target, 0.8 * kilograms, strategy),
        Change::Strategy(_) => (target, kilograms, "passive"),
        Change::Both(two) => two.iter().fold((target, kilograms, strategy), by_hand),
        Change::Joints(_) | Change::OtherFoot | Change::Hand(_) => panic!("an arm has no feet, hazards or tables"),
    }
}

/// Tries every change of the weight held for so long, and two at once where no single one suffices; the verdict without a change.
fn every_change_gives_the_time_of_its_own_run(seconds: f64) -> Verdict {
    let given = (TARGET, KILOGRAMS, "active");
    let text = |(target, kilograms, strategy)| text(target, kilograms, strategy, seconds);
    let scenario = read(&text(given));
    let (summary, before) = ran(&scenario);
    let job = Job::from(&scenario);
    let all = changes(&job, &before.hazards);
    assert_eq!(all.len(), 5, "{all:?}");
    let tried = Mutex::new(vec![]);
    let order = || by_promise(&scenario, &summary, all.clone());
    let budget = Budget { steps: usize::MAX, threads: 2 };
    let advice = Advice::new(
        &before,
        &job,
        order,
        || None,
        budget,
        |change| {
            let trial = try_run(&scenario, change, || true);
            tried.lock().unwrap().push((change.clone(), trial.clone()));
            trial
        },
    );
    let mut promises = vec![];
    for (change, trial) in tried.into_inner().unwrap() {
        let promised = Suggestion::new(&job, &change, &trial.verdict.unwrap());
        let (_, found) = ran(&read(&text(by_hand(given, &change))));
        println!("{}: {:?} {:?}", promised.change, promised.kind, promised.seconds);
        assert_eq!(promised.kind, found.kind, "{}", promised.change);
        assert_eq!(promised.seconds.is_some(), found.seconds.is_some(), "{}", promised.change);
        if let (Some(promised), Some(found)) = (promised.seconds, found.seconds) {
            assert!((promised - found).abs() <= 0.1 + 1e-3 * found, "{change:?}: {promised} s promised, {found} s");
        }
        promises.push(promised);
    }
    let helping = Suggestion::that_help(promises.clone(), &before);
    assert_eq!((&advice.helping, advice.not_tried.len()), (&helping, 0));
    let gains = &advice.gains;
    assert_eq!(gains.columns[0], "What would help");
    assert_eq!((gains.rows.len(), gains.rows[0][0].as_str()), (1 + helping.len(), "as it is"));
    for (one, row) in helping.iter().zip(&gains.rows[1..]) {
        assert!(one.seconds.unwrap() > before.seconds.unwrap() || one.kind > before.kind, "{one:?}");
        let times = [one.seconds.unwrap(), one.least.unwrap()].map(|seconds| beside(seconds, before.asked.unwrap()));
        assert_eq!(
            [row[0].split("; shorter").next().unwrap(), &row[1], &row[2]],
            [one.change.as_str(), &times[0], &times[1]]
        );
    }
    // Two changes at once are tried where no single one lets weaker people reach the time, and told where they help more.
    let single: Vec<&Suggestion> = helping.iter().filter(|one| !one.both).collect();
    let suffices = single.iter().any(|one| one.least.unwrap() >= before.asked.unwrap());
    assert_eq!(promises.iter().filter(|one| one.both).count(), if suffices { 0 } else { 2 });
    for one in helping.iter().filter(|one| one.both) {
        assert!(single.iter().all(|single| single.seconds < one.seconds || single.kind < one.kind), "{one:?}");
    }
    assert_eq!(helping.iter().any(|one| one.both), !suffices, "{helping:?}");
    before
}

/// `6.5 min`, `2.0 min, too short` for a longer job.
fn beside(seconds: f64, asked: f64) -> String {
    let words = how_long(seconds);
    match seconds < asked {
        true if words == how_long(asked) => format!("just under {words}"),
        true => format!("{words}, too short"),
        false => words,
    }
}

/// The advice on a run within so many solver steps, without breaks.
fn advised(scenario: &Scenario, summary: &Summary, verdict: &Verdict, steps: usize, threads: usize) -> Advice {
    let job = Job::from(scenario);
    let order = || by_promise(scenario, summary, changes(&job, &verdict.hazards));
    let trial = |change: &Change| try_run(scenario, change, || true);
    Advice::new(verdict, &job, order, || None, Budget { steps, threads }, trial)
}

#[test]
fn a_budget_that_is_used_up_leaves_the_changes_of_least_promise_which_are_named_the_same_for_any_number_of_threads() {
    let scenario = read(&text(TARGET, KILOGRAMS, "active", LONG));
    let (summary, before) = ran(&scenario);
    let whole = advised(&scenario, &summary, &before, usize::MAX, 1);
    let job = Job::from(&scenario);
    let promised = by_promise(&scenario, &summary, changes(&job, &before.hazards));
    let promised: Vec<String> = promised.iter().map(|change| change.in_words(&job)).collect();
    let single: Vec<&Suggestion> = whole.helping.iter().filter(|one| !one.both).collect();
    let helping: Vec<&String> = single.iter().map(|one| &one.change).collect();
    // A posture near the end of the job tells little apart: the other strategy has the same posture there, and is tried in vain.
    assert_eq!((helping.len(), helping[0]), (3, &promised[0]));
    assert!(promised[..3].contains(helping[1]), "{promised:?}");
    for threads in [1, 2, 3, 8] {
        assert_eq!(advised(&scenario, &summary, &before, usize::MAX, threads), whole, "{threads} threads");
        let one = advised(&scenario, &summary, &before, 1, threads);
        assert_eq!(one, advised(&scenario, &summary, &before, 1, 1), "{threads} threads");
        assert_eq!(one.not_tried.len(), 4, "{:?}", one.not_tried);
        assert_eq!(single[0], &one.helping[0]);
        let end = format!("Not calculated, to keep the answer quick: {}.", one.not_tried.join("; "));
        assert_eq!((one.gains.rows.len(), one.notes.last()), (2, Some(&end)));
        let none = advised(&scenario, &summary, &before, 0, threads);
        assert_eq!((none.helping.len(), none.not_tried.len()), (0, 5));
    }
}

#[test]
fn a_break_a_minute_every_ten_gives_the_time_of_small_steps_of_the_law() {
    let scenario = read(&text(TARGET, 0.17 * KILOGRAMS, "active", LONG));
    let (summary, verdict) = ran(&scenario);
    let promised =
        with_breaks((&Worked::in_run(&scenario, &summary), None), LONG, (0.0, summary.end_time), &verdict).unwrap();
    // The group that fails first without breaks, or is worked hardest: its load and its law in steps of 0.05 s.
    let who = verdict.who.unwrap();
    let groups = scenario.model.coordinates()[who.coordinate].groups.as_ref().unwrap();
    let FatigueLaw::ThreeCompartment(law) = &groups[who.side.index()].fatigue else { panic!("another law") };
    let loads = &summary.coordinates[who.coordinate].loads[who.side.index()];
    let (mut fatigued, mut work, mut time, mut fails) = (0.0, 0.0, 0.0, f64::INFINITY);
    let h = 0.05;
    while time < LONG {
        let rests = time % (BREAK_EVERY + BREAK) >= BREAK_EVERY;
        let load = if rests { 0.0 } else { loads.at(work) };
        let recovery = if rests { law.rest_multiplier * law.recovery_rate } else { law.recovery_rate };
        fatigued += h * (law.fatigue_rate * load - recovery * fatigued);
        time += h;
        work += if rests { 0.0 } else { h };
        if !rests && fatigued >= 1.0 - load {
            fails = time;
            break;
        }
    }
    // Without breaks the group fails before the end, and only after the first break.
    assert!(verdict.seconds.unwrap() > BREAK_EVERY && verdict.kind == VerdictKind::HeldUntil, "{}", verdict.sentence);
    println!(
        "promised {:?} {:?}, by small steps {fails} s; without breaks {:?}",
        promised.kind, promised.seconds, verdict.seconds
    );
    match promised.kind {
        VerdictKind::Holds => {
            assert!(fails.is_infinite() && promised.seconds.is_none_or(|seconds| seconds >= LONG), "{fails}");
        }
        _ => assert!((promised.seconds.unwrap() - fails).abs() < 3.0 + 0.01 * fails, "{:?} {fails}", promised.seconds),
    }
}

/// A man's arm that hangs straight down with a weight in the hand, which no joint but the grip has a lever to carry.
fn carrying(kilograms: f64) -> Scenario {
    read(&format!(
        "format = 1\n[model]\nadult = {{ sex = \"male\", stature_m = 1.7, mass_kg = 70, part = \"right_arm\" }}\n[posture]\n\
         elbow_flex_r_deg = 0\n[coordinates]\nfree = []\n[[load]]\nsegment = \"hand_r\"\n\
         mass_kg = {kilograms}\n[strategy]\nkind = \"active\"\n[run]\nduration_s = 0.2\nstep_s = 0.1\n"
    ))
}

/// The least of what was wanted in kilograms, and the change that the advice praises.
#[test]
fn of_a_weight_that_no_hand_can_hold_less_load_is_suggested_that_a_hand_can_hold_and_nothing_else() {
    // 107.1 lb of grip times 1.58 at a handle.
    let most = 1.58 * 107.122 * 4.448_221_615 / 9.81;
    for (kilograms, share) in [(1.1 * most, 0.8), (1.5 * most, 0.65), (2.6 * most, 0.35), (30.0 * most, 0.03)] {
        let scenario = carrying(kilograms);
        let (summary, before) = ran(&scenario);
        assert_eq!(before.kind, VerdictKind::CannotBeDone, "{}", before.sentence);
        let advice = advised(&scenario, &summary, &before, usize::MAX, 1);
        let changes = changes(&Job::from(&scenario), &before.hazards);
        let loads: Vec<f64> = changes
            .iter()
            .filter_map(|change| if let Change::Loads(share) = change { Some(*share) } else { None })
            .collect();
        assert_eq!(loads.len(), 1);
        assert!((loads[0] - share).abs() < 1e-9, "{kilograms}: {loads:?}");
        let (_, after) = ran(&carrying(loads[0] * kilograms));
        assert!(!after.hands[0].is_too_heavy() && after.kind.is_done(), "{}", after.sentence);
        assert_eq!(advice.helping.len(), 1, "{:?}", advice.helping);
        let words = format!("{:.0}\u{a0}% less load (", 100.0 * (1.0 - share));
        let (change, hands) = (&advice.helping[0].change, advice.helping[0].hands);
        assert!(change.starts_with(&words) && hands == 1, "{change}");
        assert_eq!(advice.gains.rows[1].last().unwrap(), "half or more", "{:?}", advice.gains);
    }
}

#[test]
fn a_weight_that_is_much_for_a_hand_is_helped_by_less_load_where_that_is_much_no_more() {
    let told = 0.5 * 107.122 * 4.448_221_615 / 9.81;
    for (kilograms, helps) in [(1.2 * told, true), (1.3 * told, false)] {
        let scenario = carrying(kilograms);
        let (summary, before) = ran(&scenario);
        assert_eq!((before.kind, before.hands.len()), (VerdictKind::Holds, 1), "{}", before.sentence);
        let advice = advised(&scenario, &summary, &before, usize::MAX, 1);
        let eased = advice.helping.iter().find(|one| one.hands == 0);
        assert_eq!(eased.is_some(), helps, "{:?}", advice.helping);
        let said = advice.gains.rows.iter().any(|row| row.last().is_some_and(|grip| grip == "less than half"));
        assert_eq!(said, helps);
    }
}

/// A heavy box that is lifted from near the floor bends the spine onto its ligaments. No change of 10 cm and no lighter box ends that; a
/// shelf and a straighter back do, in a file that is changed by hand, too.
#[test]
fn the_hazard_of_a_bent_spine_is_ended_by_changes_that_are_tried_for_it_and_their_own_runs_say_so() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/lift-box.toml");
    let text = std::fs::read_to_string(path).unwrap().replace("duration_s = 60", "duration_s = 5");
    let scenario = read(&text);
    let (summary, before) = ran(&scenario);
    let spine = scenario.model.coordinate("lumbar_extension").unwrap();
    assert!(before.hazards.iter().any(|hazard| hazard.coordinate == spine), "{}", before.sentence);
    let job = Job::from(&scenario);
    let of_hazard: Vec<Change> =
        changes(&job, &before.hazards).into_iter().filter(|change| !changes(&job, &[]).contains(change)).collect();
    let words: Vec<String> = of_hazard.iter().map(|change| change.in_words(&job)).collect();
    let height = "right hand and left hand 30 cm higher (height 0.60\u{a0}m instead of 0.30\u{a0}m)";
    let angle = before.hazards.iter().find(|hazard| hazard.coordinate == spine).unwrap().angle.to_degrees();
    let straight = format!("low back bent forward by 30° instead of {:.0}°", angle.abs());
    assert_eq!(words, [height, straight.as_str()]);
    let straight = "[[task]]\nkind = \"posture\"\ncoordinates = [\"lumbar_extension\"]\nvalues = { lumbar_extension_deg = -30 }\n\n\
                    [[task]]\nkind = \"effort\"";
    let by_hand = text.replace("[[task]]\nkind = \"effort\"", straight);
    assert_ne!(by_hand, text);
    let promised = try_run(&scenario, &of_hazard[1], || true).verdict.unwrap();
    let (_, found) = ran(&read(&by_hand));
    assert_eq!((promised.hazards.len(), found.hazards.len()), (0, 0), "{}", found.sentence);
    let (promised, found) = (promised.seconds.unwrap(), found.seconds.unwrap());
    assert!((promised - found).abs() < 1e-3 * found, "{promised} s promised, {found} s");
    // The box and the gaze 30 cm higher.
    let by_hand = text.replace("[0.4, 0.3, 0]", "[0.4, 0.6, 0]").replace("[0.5, 0.3, 0]", "[0.5, 0.6, 0]");
    the_run_by_hand_gives_what_the_change_promises(&scenario, &of_hazard[0], &by_hand);
    let advice = advised(&scenario, &summary, &before, usize::MAX, 2);
    println!("{:?}", advice.gains);
    let ended: Vec<&str> =
        advice.helping.iter().filter(|one| one.hazards == 0).map(|one| one.change.as_str()).collect();
    assert!(words.iter().all(|words| ended.contains(&words.as_str())), "{ended:?}");
    assert_eq!(advice.helping[0].hazards, 0);
}

/// A hand 10 cm beyond its reach is helped by a lower target; of one that is a metre beyond it, and of two places of one hand, nothing is tried.
#[test]
fn changes_are_tried_for_targets_out_of_reach_only_where_they_move_them_far_enough() {
    let job = |height: f64, more: &str| text([0.1, height, 0.2], 0.1, "active", 1.0) + more;
    let top = |text: &str| {
        let scenario = read(text);
        let (summary, verdict) = ran(&scenario);
        (advised(&scenario, &summary, &verdict, usize::MAX, 1), verdict)
    };
    let (_, far) = top(&job(4.0, ""));
    let reach = 4.0 - far.missed[0].distance;
    let (near, verdict) = top(&job(reach + 0.08, ""));
    assert_eq!(verdict.kind, VerdictKind::NotReached, "{}", verdict.sentence);
    assert!(near.helping.iter().any(|one| one.change.contains("10 cm lower")), "{:?}", near.notes);
    let (advice, _) = top(&job(reach + 1.0, ""));
    let why = "No change was tried: the target is farther away than any of them would move it (30 cm at most).";
    assert_eq!((advice.helping.len(), advice.notes.as_slice()), (0, [why.to_owned()].as_slice()));
    let second = "[[task]]\nkind = \"point\"\nsegment = \"hand_r\"\ntarget_m = [0.3, 1.0, 0.2]\nabove_relief = true\n";
    let two = text(TARGET, 0.1, "active", 1.0).replacen(
        "[[task]]\nkind = \"effort\"",
        &format!("{second}[[task]]\nkind = \"effort\""),
        1,
    );
    let (advice, verdict) = top(&two);
    assert!(verdict.missed[0].contradicts, "{}", verdict.sentence);
    assert_eq!(advice.notes, ["No change was tried: no place of the body meets both targets."]);
}

/// Kind, hazards and times of a run of the file that was changed by hand are those of the change.
fn the_run_by_hand_gives_what_the_change_promises(scenario: &Scenario, change: &Change, by_hand: &str) {
    let (promised, found) = (try_run(scenario, change, || true).verdict.unwrap(), ran(&read(by_hand)).1);
    let coordinates =
        |verdict: &Verdict| verdict.hazards.iter().map(|hazard| hazard.coordinate).collect::<Vec<usize>>();
    assert_eq!((promised.kind, coordinates(&promised)), (found.kind, coordinates(&found)), "{}", found.sentence);
    for (promised, found) in [(promised.seconds, found.seconds), (promised.least, found.least)] {
        println!("{change:?}: {promised:?} s promised, {found:?} s");
        assert!(promised == found || (promised.unwrap() - found.unwrap()).abs() < 1e-3 * found.unwrap(), "{change:?}");
    }
}

/// Somebody who pushes stands in stride. The angles of the legs are exchanged in the file.
#[test]
fn feet_that_are_exchanged_give_the_time_of_the_file_with_exchanged_legs() {
    let text = include_str!("../../../scenarios/push.toml").replace("duration_s = 120", "duration_s = 2");
    let mut by_hand = text.clone();
    for joint in ["hip_flexion", "knee_angle", "ankle_angle"] {
        let [right, left] = ["r", "l"].map(|side| format!("{joint}_{side}_deg"));
        by_hand = by_hand.replace(&right, "other").replace(&left, &right).replace("other", &left);
    }
    assert_ne!(by_hand, text);
    let scenario = read(&text);
    let job = Job::from(&scenario);
    assert!(changes(&job, &[]).contains(&Change::OtherFoot));
    let words = "feet exchanged: the left foot ahead instead of the right foot";
    assert_eq!(Change::OtherFoot.in_words(&job), words);
    the_run_by_hand_gives_what_the_change_promises(&scenario, &Change::OtherFoot, &by_hand);
}

/// Two hands at a box come nearer alike, however far to a side each of them is.
#[test]
fn both_hands_of_a_box_come_nearer_alike() {
    let scenario = read(include_str!("../../../scenarios/lift-box.toml"));
    let job = Job::from(&scenario);
    let nearer = changes(&job, &[]).into_iter().find(|change| change.in_words(&job).contains("nearer")).unwrap();
    let Change::Targets(by, _) = nearer else { panic!("{nearer:?}") };
    // The box is before the middle of the body, and the hands at its two sides.
    assert!((by.x + 0.1).abs() < 1e-6 && by.z.abs() < 1e-6, "{by}");
}

/// The rows of a table of changes: hazards beside the times, which say whether weaker people reach the time that was asked.
#[test]
fn the_table_of_changes_has_hazards_and_the_times_of_weaker_people_beside_the_asked_one() {
    let text = include_str!("../../../scenarios/reach-floor.toml").replace("duration_s = 120", "duration_s = 1");
    let scenario = read(&text);
    let (_, found) = ran(&scenario);
    assert_eq!(found.hazards.len(), 2, "{:?}", found.hazards);
    let job = Job { asked: Some(100.0), ..Job::from(&scenario) };
    let before = Verdict { asked: Some(100.0), least: Some(80.0), seconds: None, ..found };
    let with = |kind: VerdictKind, hazards: usize, seconds: Option<f64>, least: f64| Verdict {
        kind,
        seconds,
        least: Some(least),
        hazards: before.hazards[..hazards].to_vec(),
        ..before.clone()
    };
    let changes = ["A", "B", "C", "D"].map(|how| Change::Targets(nalgebra::Vector3::y(), how));
    let verdicts = [
        with(VerdictKind::Holds, 1, None, f64::INFINITY),
        with(VerdictKind::Holds, 0, Some(200.0), 120.0),
        with(VerdictKind::Holds, 2, Some(300.0), 20.0),
        with(VerdictKind::HeldUntil, 0, Some(60.0), 0.0),
    ];
    let trial = |change: &Change| {
        let place = changes.iter().position(|other| other == change).unwrap();
        Trial { verdict: Some(verdicts[place].clone()), steps: 1 }
    };
    let budget = Budget { steps: usize::MAX, threads: 1 };
    let advice = Advice::new(&before, &job, || changes.to_vec(), || None, budget, trial);
    let rows: Vec<Vec<String>> =
        advice.gains.rows.iter().map(|row| row.iter().map(|cell| cell.replace('\u{a0}', " ")).collect()).collect();
    let says = |i: usize, how: &str, end: &str| rows[i][0].contains(how) && rows[i][0].ends_with(end);
    let [one, both] = [1, 2].map(|count| {
        let named = before.hazards[..count].iter().map(|hazard| hazard.posture_in_words(&scenario.model));
        named.collect::<Vec<_>>().join(", ")
    });
    assert!(one.contains(" by ") && both.starts_with(&one), "{both}");
    assert_eq!(rows[0], ["as it is", "no limit", "80 s, too short", &both]);
    assert!(says(1, " B (", "); shorter for people of mean strength") && says(2, " A (", ")"), "{rows:?}");
    assert_eq!(rows[1][1..], ["3.3 min", "2.0 min", "none"]);
    assert_eq!(rows[2][1..], ["no limit", "no limit", &one]);
    // Neither a shorter time with both hazards nor a worse verdict helps.
    assert_eq!(rows.len(), 3, "{rows:?}");
    // Nor does one that ends every hazard, but takes the asked time from weaker people, who have it without the change.
    let enough = Verdict { least: Some(110.0), ..before.clone() };
    let ends = |least: f64| {
        let trial = |_: &Change| Trial { verdict: Some(with(VerdictKind::Holds, 0, Some(200.0), least)), steps: 1 };
        Advice::new(&enough, &job, || changes[..1].to_vec(), || None, budget, trial).helping.len()
    };
    assert_eq!([ends(101.0), ends(99.0)], [1, 0]);
    // Where only weaker people lack time, one that gives it to them helps, though the mean person has less of what nobody asks for; one
    // that gives them more, but too little, does not.
    let lack = Verdict { hazards: vec![], seconds: Some(300.0), fails_weaker: before.hardest, ..before.clone() };
    let gives = |least: f64| {
        let found = Verdict { hazards: vec![], ..with(VerdictKind::Holds, 0, Some(150.0), least) };
        let trial = |_: &Change| Trial { verdict: Some(found.clone()), steps: 1 };
        Advice::new(&lack, &job, || changes[..1].to_vec(), || None, budget, trial).helping.len()
    };
    assert_eq!([gives(110.0), gives(90.0), gives(81.0)], [1, 0, 0]);
    let weak = Verdict { hazards: vec![], ..with(VerdictKind::HeldUntil, 0, Some(60.0), 0.0) };
    let longer = |_: &Change| Trial { verdict: Some(Verdict { seconds: Some(90.0), ..weak.clone() }), steps: 1 };
    let advice = Advice::new(&weak, &job, || changes[..1].to_vec(), || None, budget, longer);
    assert_eq!(advice.gains.columns.len(), 3, "{:?}", advice.gains);
    let times: Vec<String> = advice.gains.rows.iter().map(|row| row[1..].join("|").replace('\u{a0}', " ")).collect();
    assert_eq!(times, ["60 s, too short|too weak", "90 s, too short|too weak"]);
}

/// The advice on a job of 300 s with these times of the mean person and of weaker people, s, with one change that leads to others.
fn advice_on([seconds, least]: [f64; 2], change: &Change, with: [f64; 2]) -> Advice {
    let scenario = read(&text(TARGET, KILOGRAMS, "active", 300.0));
    let (_, found) = ran(&read(&text(TARGET, 0.1, "active", 0.2)));
    let verdict = |[seconds, least]: [f64; 2]| Verdict {
        kind: if seconds < 300.0 { VerdictKind::HeldUntil } else { VerdictKind::Holds },
        asked: Some(300.0),
        seconds: Some(seconds),
        least: Some(least),
        fails_weaker: found.hardest.filter(|_| least < 300.0),
        ..found.clone()
    };
    let before = verdict([seconds, least]);
    let trial = |_: &Change| Trial { verdict: Some(verdict(with)), steps: 1 };
    Advice::new(&before, &Job::from(&scenario), || vec![change.clone()], || None, budget(ALL, 1), trial)
}

/// The change is listed with the end of its name, or not at all; and what is said below the table.
#[test]
fn a_change_is_listed_where_it_gives_time_to_those_who_lack_it_and_says_whose_time_it_shortens() {
    let nearer = &Change::Targets(nalgebra::Vector3::x(), "nearer");
    let row = |before, change: &Change, with| {
        let advice = advice_on(before, change, with);
        let end = |row: &Vec<String>| row[0].split(';').nth(1).unwrap_or_default().to_owned();
        (advice.gains.rows.get(1).map(end), advice.notes.first().cloned().unwrap_or_default())
    };
    let listed = |end: &str| (Some(end.to_owned()), String::new());
    // Only weaker people lack time: theirs counts, and the mean person's may be shorter, which is said.
    assert_eq!(row([600.0, 222.0], nearer, [540.0, 320.0]), listed(" shorter for people of mean strength"));
    assert_eq!(row([600.0, 222.0], nearer, [700.0, 320.0]), listed(""));
    let lacking = "No single change that was tried suffices for weaker people.";
    assert_eq!(row([600.0, 222.0], nearer, [700.0, 290.0]), (Some(String::new()), lacking.to_owned()));
    // A job with reserve, and one that no change helps, have the table of times, too.
    let reserve = advice_on([600.0, 310.0], nearer, [900.0, 400.0]);
    assert_eq!((reserve.gains.columns[0].as_str(), reserve.gains.rows.len()), ("The job", 1));
    assert_eq!(reserve.gains.rows[0], ["as it is", "10\u{a0}min", "5.2\u{a0}min"]);
    assert_eq!(advice_on([600.0, 222.0], nearer, [600.0, 222.0]).gains.rows[0][2], "3.7\u{a0}min, too short");
    for with in [[900.0, 222.0], [900.0, 200.0], [600.0, 225.0], [290.0, 280.0]] {
        let (listed, note) = row([600.0, 222.0], nearer, with);
        assert!(
            listed.is_none() && note.starts_with("The one change that was tried does not help: "),
            "{with:?} {note}"
        );
    }
    // The mean person lacks it, too.
    assert_eq!(row([280.0, 150.0], nearer, [400.0, 310.0]), listed(""));
    let note = (Some(" shorter for weaker people".to_owned()), lacking.to_owned());
    assert_eq!(row([280.0, 150.0], nearer, [400.0, 140.0]), note);
    let mean = "No single change that was tried suffices for people of mean strength.";
    assert_eq!(row([200.0, 150.0], nearer, [250.0, 160.0]), (Some(String::new()), mean.to_owned()));
    assert_eq!(row([200.0, 150.0], nearer, [190.0, 180.0]).0, None);
    // Less load with which somebody holds out for less time has led to another posture, and is no advice.
    let lighter = &Change::Loads(0.8);
    assert_eq!(row([600.0, 222.0], lighter, [540.0, 320.0]).0, None);
    assert_eq!(row([280.0, 150.0], lighter, [400.0, 140.0]).0, None);
    assert_eq!(row([600.0, 222.0], lighter, [700.0, 320.0]), listed(""));
}

/// The load, the place and the strategy that a change starts from stand beside those that it leads to.
#[test]
fn a_change_names_the_value_that_it_starts_from() {
    let scenario = read(&text(TARGET, KILOGRAMS, "active", LONG));
    let job = Job::from(&scenario);
    let words: Vec<String> =
        changes(&job, &[]).iter().map(|change| change.in_words(&job).replace('\u{a0}', " ")).collect();
    assert_eq!(words[0], "right hand 10 cm lower (height 1.10 m instead of 1.20 m)");
    assert_eq!(words[1], "right hand 10 cm higher (height 1.30 m instead of 1.20 m)");
    // From the centre of mass: 10 cm less of what there was.
    let level = words[2].strip_prefix("right hand 10 cm nearer (horizontal distance from the middle of the body ");
    let level = level.unwrap().strip_suffix(")").unwrap();
    let metres: Vec<f64> = level.split(" instead of ").map(|far| far.trim_end_matches(" m").parse().unwrap()).collect();
    assert!((metres[1] - metres[0] - 0.1).abs() < 0.011, "{level}");
    assert_eq!(words[3], "20 % less load (4 kg instead of 5 kg)");
    assert_eq!(words[4], "tired joints left to lean on ligaments instead of moving back to the middle of their range");
}

/// Two hands that come 10 cm nearer are told by their middle: the distance of each hand falls by less.
#[test]
fn two_hands_that_come_nearer_are_told_by_their_middle() {
    let scenario = read(include_str!("../../../scenarios/lift-box.toml"));
    let job = Job::from(&scenario);
    let words = changes(&job, &[]).into_iter().map(|change| change.in_words(&job).replace('\u{a0}', " "));
    let nearer = words.into_iter().find(|words| words.contains("10 cm nearer")).unwrap();
    let (_, level) = nearer.split_once("horizontal distance of their middle from the middle of the body ").unwrap();
    let level = level.strip_suffix(")").unwrap();
    let metres: Vec<f64> = level.split(" instead of ").map(|far| far.trim_end_matches(" m").parse().unwrap()).collect();
    assert!((metres[1] - metres[0] - 0.1).abs() < 0.011, "{nearer}");
}

const ALL: usize = usize::MAX;

fn budget(steps: usize, threads: usize) -> Budget {
    Budget { steps, threads }
}

/// The largest loads: each holds for the time asked when it is run on its own, 5 % more does not; two threads find the same.
#[test]
fn the_largest_load_holds_on_its_own_and_five_percent_more_does_not() {
    for (kilograms, weight_text) in [(KILOGRAMS, "5 kg"), (1.0, "1 kg")] {
        let scenario = read(&text(TARGET, kilograms, "active", 120.0));
        let (job, tried) = (Job::from(&scenario), std::sync::atomic::AtomicUsize::new(0));
        let find = |threads, steps| {
            LargestLoad::find(&job, budget(steps, threads), |change| {
                tried.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                try_run(&scenario, change, || true)
            })
        };
        let largest = find(1, ALL).unwrap();
        assert_eq!(find(2, ALL).as_ref(), Some(&largest));
        // A budget that ends after the first pair of loads: what is told then is a lower bound, or nothing.
        let cut = find(1, 1);
        assert_eq!(find(2, 1), cut);
        assert!(cut.as_ref().is_none_or(|cut| cut.is_cut[0] && cut.mean.unwrap() <= largest.mean.unwrap()));
        assert_eq!(cut.is_some_and(|cut| cut.in_words().starts_with("at least")), kilograms < 2.0);
        let words = largest.in_words().replace('\u{a0}', " ");
        println!("{words}; {} runs", tried.into_inner());
        assert!(words.contains(&format!("(the job has {weight_text}) can be held for the 2.0 min asked")), "{words}");
        let (mean, weaker) = (largest.mean.unwrap() * kilograms, largest.weaker.unwrap() * kilograms);
        assert!(weaker < 0.9 * mean, "{weaker} {mean}");
        assert!((20.0 * mean).fract().min(1.0 - (20.0 * mean).fract()) < 1e-9, "two digits: {mean}");
        let run = |mass: f64| ran(&read(&text(TARGET, mass, "active", 120.0))).1;
        let lasts = |verdict: &Verdict| verdict.kind == VerdictKind::Holds && verdict.least.unwrap() >= 120.0;
        assert_eq!(run(mean).kind, VerdictKind::Holds);
        assert_ne!(run(1.05 * mean).kind, VerdictKind::Holds);
        assert!(lasts(&run(weaker)) && !lasts(&run(1.05 * weaker)));
    }
    let bare = text(TARGET, 1.0, "active", 120.0).replace("[[load]]\nsegment = \"hand_r\"\nmass_kg = 1\n", "");
    let bare = read(&bare);
    assert!(LargestLoad::find(&Job::from(&bare), budget(ALL, 1), |change| try_run(&bare, change, || true)).is_none());
}

/// Beside the mean person's time with breaks stands that of weaker people: the same law with the load over 1 - cv, and the published laws.
#[test]
fn a_break_gives_weaker_people_more_time_than_they_have_without_and_less_than_the_mean_person_has() {
    let scenario = read(&text(TARGET, 0.17 * KILOGRAMS, "active", LONG));
    let (summary, verdict) = ran(&scenario);
    let breaks = |end: f64| {
        with_breaks((&Worked::in_run(&scenario, &summary), None), end, (0.0, summary.end_time), &verdict).unwrap()
    };
    let (with, without) = (breaks(LONG).least.unwrap(), verdict.least.unwrap());
    println!("weaker people: {without} s without breaks, {with} s with them; mean {:?}", breaks(LONG).seconds);
    assert!(with >= without * 0.999, "{with} {without}");
    assert!(with <= breaks(LONG).seconds.unwrap_or(f64::INFINITY), "{with}");
}
