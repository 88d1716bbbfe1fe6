//! Result sets: whatever happens to disk or process, a named file is whole or not there, the manifest tells a whole set from a broken
//! one, nothing of an older set stays, and an interrupted run goes on to the bytes of an unbroken one.

use crate::support;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use serde_json::Value;
use sha2::{Digest, Sha256};
use support::{MANIFEST, Run, assert_numbers, contents, contrapposto, scenarios};

fn simulate(scenario: &Path, out: &Path, arguments: &[&str]) -> Run {
    contrapposto(["simulate"]).arg(scenario).arg("--out").arg(out).args(arguments).run()
}

/// Names of the files in the manifest of a folder, each with the digest of its bytes; none without a manifest.
fn listed(folder: &Path) -> Option<Vec<String>> {
    let text = std::fs::read_to_string(folder.join(MANIFEST)).ok()?;
    let mut names = vec![];
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let (digest, name) = line.split_once("  ").unwrap();
        let bytes = std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let found: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(found, digest, "{name} is not the file of the manifest");
        names.push(name.to_owned());
    }
    names.sort();
    Some(names)
}

/// Temporary folders in a folder.
fn temporary(folder: &Path) -> Vec<PathBuf> {
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    paths.filter(|path| path.file_name().unwrap().to_string_lossy().starts_with(".contrapposto-")).collect()
}

fn names(folder: &Path) -> Vec<String> {
    contents(folder).into_iter().map(|(name, _)| name).collect()
}

/// A joint that is loaded, and from 1 s on is not.
fn unloaded_arm(duration: f64) -> String {
    format!(
        "format = 1\ntitle = \"A load put down\"\n[coordinates]\nfree = [\"elbow_flex_r\"]\n[strategy]\nkind = \"active\"\n\
         [posture]\nelbow_flex_r_deg = 90\n[[load]]\nsegment = \"hand_r\"\nmass_kg = 2\n[[event]]\nat_s = 1\nload = []\n\
         [run]\nduration_s = {duration}\nstep_s = 0.01\n"
    )
}

#[test]
fn a_manifest_names_every_file_of_the_set() {
    let folder = tempfile::tempdir().unwrap();
    let run = contrapposto(["demo", "--figure-8", "--out"]).arg(folder.path()).run();
    assert_eq!(run.code, 0, "{}", run.stderr);
    let mut expected = names(folder.path());
    expected.retain(|name| name != MANIFEST);
    assert_eq!(listed(folder.path()), Some(expected));
    assert_eq!(temporary(folder.path()), Vec::<PathBuf>::new());
}

#[test]
fn a_set_replaces_the_older_one_and_touches_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let reach = scenarios().join("poses/reach-shelf.toml");
    let pose = contrapposto(["pose", "--figures"]).arg(&reach).arg("--out").arg(out).run();
    assert_eq!(pose.code, 0, "{}", pose.stderr);
    assert!(out.join("pose.csv").is_file() && out.join("figures").is_dir());
    std::fs::write(out.join("mine.txt"), "mine").unwrap();
    std::fs::write(out.join("pose.svg"), "changed by hand").unwrap();
    // The start is read from the older set, and stays.
    let start = out.join("pose.json");
    let run = contrapposto(["relax"]).arg(&reach).arg("--start-from").arg(&start).arg("--out").arg(out).run();
    assert_eq!(run.code, 0, "{}", run.stderr);
    let kept = ["mine.txt", "pose.json", "pose.svg"].map(str::to_owned);
    let mut expected = listed(out).unwrap();
    assert!(expected.contains(&"relax.json".to_owned()), "{expected:?}");
    expected.extend(kept);
    expected.push(MANIFEST.to_owned());
    expected.sort();
    assert_eq!(names(out), expected);
    assert!(!out.join("figures").exists());
    assert_eq!(std::fs::read_to_string(out.join("pose.svg")).unwrap(), "changed by hand");
}

#[test]
fn what_a_killed_program_left_is_removed_by_the_next_one() {
    let folder = tempfile::tempdir().unwrap();
    let out = &folder.path().join("out");
    let whole = contrapposto(["demo", "--figure-8", "--out"]).arg(out).run();
    assert_eq!(whole.code, 0, "{}", whole.stderr);
    let before = contents(out);
    // Killed while names changed: the manifest of the old set is in the temporary folder, one of its files is still there.
    let left = out.join(".contrapposto-left00");
    std::fs::create_dir(&left).unwrap();
    File::create(left.join("lock")).unwrap();
    std::fs::write(out.join("older.csv"), "1").unwrap();
    let head = std::fs::read_to_string(out.join(MANIFEST)).unwrap().lines().next().unwrap().to_owned();
    let digest = "6b86b273ff34fce19d6b804eff5a3f5747ada4eaa22f1d49c01e52ddb7875b4b";
    std::fs::write(left.join("replaced"), format!("{head}\n{digest}  older.csv\n{digest}  ../outside.csv\n")).unwrap();
    std::fs::write(folder.path().join("outside.csv"), "1").unwrap();
    std::fs::remove_file(out.join(MANIFEST)).unwrap();
    // A folder whose program still runs stays.
    let used = out.join(".contrapposto-used00");
    std::fs::create_dir(&used).unwrap();
    let lock = File::create(used.join("lock")).unwrap();
    lock.try_lock().unwrap();
    let again = contrapposto(["demo", "--figure-8", "--out"]).arg(out).run();
    assert_eq!(again.code, 0, "{}", again.stderr);
    assert_eq!(temporary(out), [used]);
    assert!(contents(out) == before, "{:?}", names(out));
    let outside = folder.path().join("outside.csv");
    assert!(outside.is_file(), "a name that leads out of the folder is not followed");
    // What only begins like a temporary folder, or holds something else, is not touched.
    for (name, file) in [(".contrapposto-settings", "lock"), (".contrapposto-mine00", "notes.txt")] {
        std::fs::create_dir(out.join(name)).unwrap();
        std::fs::write(out.join(name).join(file), "mine").unwrap();
    }
    assert_eq!(contrapposto(["demo", "--figure-8", "--out"]).arg(out).run().code, 0);
    assert_eq!(temporary(out).len(), 3);
}

/// A result would have the name of a file that the job reads, and nobody's set has that file.
#[test]
fn an_input_is_not_replaced_by_a_result() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let job = out.join("summary.json");
    std::fs::write(&job, unloaded_arm(2.0)).unwrap();
    let before = contents(out);
    let run = simulate(&job, out, &[]);
    assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{}", run.stderr);
    assert!(run.stderr.contains("`summary.json` there is read by this job"), "{}", run.stderr);
    assert!(contents(out) == before && temporary(out).is_empty());
    // A pose of the set itself may be replaced by the next one.
    let reach = scenarios().join("poses/reach-shelf.toml");
    let own = out.join("own");
    assert_eq!(contrapposto(["pose"]).arg(&reach).arg("--out").arg(&own).run().code, 0);
    let start = own.join("pose.json");
    let again = contrapposto(["pose"]).arg(&reach).arg("--start-from").arg(&start).arg("--out").arg(&own).run();
    assert_eq!(again.code, 0, "{}", again.stderr);
    assert!(listed(&own).unwrap().contains(&"pose.json".to_owned()));
}

#[cfg(unix)]
#[test]
fn a_folder_of_results_that_is_a_link_out_is_refused_and_nothing_changes() {
    let folder = tempfile::tempdir().unwrap();
    let (out, other) = (folder.path().join("out"), folder.path().join("other"));
    std::fs::create_dir(&out).unwrap();
    std::fs::create_dir(&other).unwrap();
    std::os::unix::fs::symlink(&other, out.join("figures")).unwrap();
    let reach = scenarios().join("poses/reach-shelf.toml");
    let run = contrapposto(["pose", "--figures"]).arg(&reach).arg("--out").arg(&out).run();
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("link that leads out"), "{}", run.stderr);
    assert!(names(&out).is_empty() && names(&other).is_empty() && temporary(&out).is_empty());
}

#[test]
fn a_manifest_of_someone_else_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(MANIFEST), "00  mine.txt\n").unwrap();
    let run = contrapposto(["demo", "--figure-8", "--out"]).arg(folder.path()).run();
    assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{}", run.stderr);
    assert!(run.stderr.contains("manifest.sha256") && run.stderr.contains("another folder"), "{}", run.stderr);
    assert_eq!(names(folder.path()), [MANIFEST]);
}

/// The snapshot of a run that a signal ended after its event; a whole one took `seconds`, when the machine may have been busier than now.
#[cfg(unix)]
fn interrupted(scenario: &Path, out: &Path, seconds: f64, signal: &str) -> Value {
    let mut wait = 0.6 * seconds;
    for _ in 0..40 {
        let _ = std::fs::remove_dir_all(out);
        // No changes are tried, so that the signal meets the run itself.
        let child = contrapposto(["simulate", "--no-suggest"]).arg(scenario).arg("--out").arg(out).spawn();
        std::thread::sleep(Duration::from_secs_f64(wait));
        let _ = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status();
        let done = child.wait_with_output().unwrap().status.success();
        wait *= if done { 0.8 } else { 1.15 };
        let Ok(bytes) = std::fs::read(out.join("snapshot.json")) else { continue };
        let snapshot: Value = serde_json::from_slice(&bytes).unwrap();
        if snapshot["run"]["state"]["next_event"] == 1 {
            return snapshot;
        }
    }
    panic!("no run was ended after its event; one takes {seconds} s");
}

/// An event makes the effort of a single joint unknown; SIGTERM is heard as Ctrl-C is.
#[cfg(unix)]
#[test]
fn a_run_that_is_ended_after_an_event_can_be_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("arm.toml");
    std::fs::write(&scenario, unloaded_arm(3000.0)).unwrap();
    let (unbroken, out) = (folder.path().join("unbroken"), folder.path().join("out"));
    let full = simulate(&scenario, &unbroken, &[]);
    assert_eq!(full.code, 0, "{}", full.stderr);
    let snapshot = interrupted(&scenario, &out, full.seconds, "TERM");
    assert_eq!(snapshot["run"]["state"]["next_event"], 1);
    let rest = simulate(&scenario, &out, &["--resume"]);
    assert_eq!(rest.code, 0, "{}", rest.stderr);
    assert!(contents(&out) == contents(&unbroken), "a resumed run differs from an unbroken one");
}

/// A number in a snapshot, by the keys and places that lead to it.
fn numbers(value: &Value, pointer: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(pointer.to_owned()),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, value)| numbers(value, &format!("{pointer}/{i}"), found));
        }
        Value::Object(map) => map.iter().for_each(|(key, value)| numbers(value, &format!("{pointer}/{key}"), found)),
        _ => {}
    }
}

#[cfg(unix)]
#[test]
fn a_damaged_snapshot_is_refused_or_gone_on_from() {
    const SEED: u128 = 22;
    const DAMAGES: usize = 40;
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("arm.toml");
    std::fs::write(&scenario, unloaded_arm(1000.0)).unwrap();
    let out = folder.path().join("out");
    let full = simulate(&scenario, &out, &[]).seconds;
    let snapshot = interrupted(&scenario, &out, full, "INT");
    let mut places = vec![];
    numbers(&snapshot["run"], "/run", &mut places);
    let mut of_recording = vec![];
    numbers(&snapshot["recording"], "/recording", &mut of_recording);
    let random = &mut Pcg64Mcg::new(SEED);
    places.extend(["/recording/every", "/recording/coordinates", "/recording/supports"].map(str::to_owned));
    places.extend((0..20).map(|_| of_recording[random.random_range(0..of_recording.len())].clone()));
    let values = [Value::from(0), Value::from(-1), Value::from(1e300), Value::from(u64::MAX), Value::Null];
    let mut codes = [0; 3];
    for i in 0..DAMAGES {
        let place = match i {
            0 => "/recording/every".to_owned(),
            _ => places[random.random_range(0..places.len())].clone(),
        };
        let value = if i == 0 { Value::from(0) } else { values[random.random_range(0..values.len())].clone() };
        let mut damaged = snapshot.clone();
        *damaged.pointer_mut(&place).unwrap() = value.clone();
        std::fs::write(out.join("snapshot.json"), serde_json::to_vec(&damaged).unwrap()).unwrap();
        let run = simulate(&scenario, &out, &["--resume", "--no-suggest"]);
        assert!((0..3).contains(&run.code), "seed {SEED}, {place} = {value}: {} {}", run.code, run.stderr);
        codes[run.code as usize] += 1;
    }
    println!("seed {SEED}: {} went on, {} failed, {} were refused", codes[0], codes[1], codes[2]);
    assert!(codes[2] > 0);
}

/// A limit on the size of files stands for a full disk: whatever fits, no named file is cut off.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_old_results_alone() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let demo = |blocks: Option<u32>| {
        let limit = blocks.map_or(String::new(), |blocks| format!("ulimit -f {blocks}; "));
        let script =
            format!("{limit}exec '{}' demo --json --out '{}'", env!("CARGO_BIN_EXE_contrapposto"), out.display());
        Command::new("sh").args(["-c", &script]).output().unwrap()
    };
    assert_eq!(demo(None).status.code(), Some(0));
    let whole = contents(&out);
    for blocks in [0, 1, 8, 30, 60, 120] {
        let output = demo(Some(blocks));
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{blocks} blocks: {error}");
        assert!(error.contains("File too large"), "{error}");
        assert!(contents(&out) == whole, "{blocks} blocks changed something");
    }
    std::fs::remove_dir_all(&out).unwrap();
    assert_eq!(demo(Some(8)).status.code(), Some(1));
    assert!(!out.exists(), "nothing rather than a part");
}

#[test]
fn an_output_folder_that_is_none_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "mine").unwrap();
    for out in [file.clone(), file.join("below")] {
        for verb in [
            &["demo", "--figure-8", "--out"][..],
            &["figures", "--only", "1", "--out"],
            &["passive", "elbow_flex_r", "--out"],
        ] {
            let run = contrapposto(verb).arg(&out).run();
            assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{}", run.stderr);
            assert!(run.stderr.contains("--out") && run.stderr.contains(out.to_str().unwrap()), "{}", run.stderr);
        }
    }
    assert_eq!(std::fs::read_to_string(file).unwrap(), "mine");
    // A folder that bears the name of a result is named in the message, and no other file appears.
    let out = folder.path().join("out");
    std::fs::create_dir_all(out.join("summary.json/inside")).unwrap();
    let run = contrapposto(["demo", "--figure-8", "--out"]).arg(&out).run();
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("summary.json"), "{}", run.stderr);
    assert_eq!((names(&out), temporary(&out)), (vec![], vec![]));
}

#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written_is_told() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    std::fs::set_permissions(folder.path(), PermissionsExt::from_mode(0o555)).unwrap();
    let root = File::create(folder.path().join("probe")).is_ok();
    if root {
        println!("running as root: permissions mean nothing; /proc stands in");
    }
    let out = if root { Path::new("/proc/self") } else { folder.path() };
    // An hour of a whole body: the answer comes before the run.
    let run = simulate(&scenarios().join("bus-stop.toml"), out, &[]);
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(
        run.stderr.contains(&format!("--out {}", out.display())) && !out.join("summary.json").exists(),
        "{}",
        run.stderr
    );
}

/// Ctrl-C while changes are tried: the answer of the job and all its files are there, the exit code and a sentence say what is missing.
#[cfg(unix)]
#[test]
fn an_answer_whose_trials_are_interrupted_is_whole_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let (scenario, out) = (scenarios().join("hold-tool.toml"), folder.path().join("out"));
    let alone = simulate(&scenario, &out, &["--no-suggest"]);
    let whole: Value = serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap();
    // The trials would take minutes. A busy machine may still be at the run.
    for share in [1.5, 2.5, 4.0, 6.0] {
        std::fs::remove_dir_all(&out).unwrap();
        let words = ["--suggest-steps", "100000000"];
        let child = contrapposto(["simulate"]).arg(&scenario).arg("--out").arg(&out).args(words).spawn();
        std::thread::sleep(Duration::from_secs_f64(share * alone.seconds));
        let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        let output = child.wait_with_output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{error}");
        if error.contains("interrupted at") {
            continue;
        }
        assert!(error.contains("interrupted while changes of the job were tried; its answer is whole"), "{error}");
        assert!(String::from_utf8_lossy(&output.stdout).contains("Changes of the job were not tried to their end"));
        let summary: Value = serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap();
        assert_eq!((&summary["verdict"], &summary["partial"]), (&whole["verdict"], &Value::from(false)));
        assert!(listed(&out).is_some_and(|files| files.contains(&"report.html".to_owned())));
        assert!(!out.join("snapshot.json").exists());
        return;
    }
    panic!("every run was interrupted before its trials; one takes {} s", alone.seconds);
}

/// Ctrl-C ends a run with whole files marked as partial; going on gives the bytes of an unbroken run.
#[cfg(unix)]
#[test]
fn an_interrupted_run_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("stand.toml");
    let text = std::fs::read_to_string(scenarios().join("stand-relaxed.toml")).unwrap();
    std::fs::write(&scenario, text.replace("duration_s = 120", "duration_s = 1200")).unwrap();
    let (unbroken, out) = (folder.path().join("unbroken"), folder.path().join("out"));
    let full = simulate(&scenario, &unbroken, &[]);
    assert_eq!(full.code, 0, "{}", full.stderr);
    // The runs that are interrupted try no changes, so that the signal meets the run itself on a quick machine, too.
    let alone = simulate(&scenario, &folder.path().join("alone"), &["--no-suggest"]);
    let mut interrupted = 0;
    let mut snapshot = vec![];
    for share in [0.3, 0.2, 0.15, 0.1, 0.05] {
        let resume = if out.join("snapshot.json").is_file() { vec!["--resume"] } else { vec![] };
        let run = contrapposto(["simulate"]).arg(&scenario).arg("--out").arg(&out).args(["--no-suggest"]).args(resume);
        let child = run.spawn();
        std::thread::sleep(Duration::from_secs_f64(share * alone.seconds));
        let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        let output = child.wait_with_output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        if output.status.success() || output.status.code().is_none() {
            continue; // a quick machine was done before, a busy one did not listen yet
        }
        interrupted += 1;
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(error.contains("interrupted at") && error.contains("--resume"), "{error}");
        let summary: Value = serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap();
        assert_eq!((&summary["partial"], &summary["stopped"]), (&Value::from(true), &Value::from("interrupted")));
        assert_numbers(&summary, "");
        snapshot = std::fs::read(out.join("snapshot.json")).unwrap();
    }
    println!("interrupted {interrupted} times");
    assert!(interrupted > 0);
    std::fs::write(out.join("snapshot.json"), &snapshot).unwrap();
    // Not with another scenario, and not with a torn snapshot.
    let other = folder.path().join("other.toml");
    std::fs::write(&other, text.replace("duration_s = 120", "duration_s = 46")).unwrap();
    let refused = simulate(&other, &out, &["--resume"]);
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("another scenario"), "{}", refused.stderr);
    std::fs::write(out.join("snapshot.json"), &snapshot[..snapshot.len() / 2]).unwrap();
    assert_eq!(simulate(&scenario, &out, &["--resume"]).code, 2);
    std::fs::write(out.join("snapshot.json"), &snapshot).unwrap();
    assert_eq!(simulate(&scenario, &out, &["--resume"]).code, 0);
    assert!(contents(&out) == contents(&unbroken), "a resumed run differs from an unbroken one");
}

/// However early Ctrl-C comes, whoever hears it shows the start, from which the run goes on.
#[cfg(unix)]
#[test]
fn interrupted_at_once_it_shows_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenarios().join("stand-relaxed.toml");
    let mut heard = 0;
    for moment in [0.01, 0.03, 0.1, 0.3, 1.0, 3.0] {
        if heard > 0 && moment > 0.3 {
            break;
        }
        let out = folder.path().join(moment.to_string());
        let child = contrapposto(["simulate"]).arg(&scenario).arg("--out").arg(&out).args(["--no-suggest"]).spawn();
        std::thread::sleep(Duration::from_secs_f64(moment));
        let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        let output = child.wait_with_output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        // Before it listens, the signal ends it as any program; a quick machine was done before.
        let (None | Some(0)) = output.status.code() else {
            heard += 1;
            assert!(output.status.code() == Some(1) && error.contains("interrupted at"), "{error}");
            assert!(out.join("summary.json").is_file() && out.join("snapshot.json").is_file());
            continue;
        };
    }
    println!("heard {heard} times");
    assert!(heard > 0);
}

/// Number of runs that must have been killed: a few, or as many as `CONTRAPPOSTO_KILLS` says. Five hundred of each kind:
///
/// ```text
/// CONTRAPPOSTO_KILLS=500 cargo test -p contrapposto-cli kill -- --nocapture
/// ```
fn kills() -> u32 {
    std::env::var("CONTRAPPOSTO_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(12)
}

/// Starts run after run and kills each at a moment of its own until enough were killed before they were done. `seconds`: what a
/// whole run takes. `start` gets the number of the run; `look` sees what each left behind, and whether it was done.
fn killed_over_and_over(
    mut seconds: f64,
    start: impl Fn(u32) -> support::Call,
    mut look: impl FnMut(u32, bool),
) -> u32 {
    let (mut killed, mut runs) = (0, 0);
    while killed < kills() {
        let mut child = start(runs).spawn();
        // Golden-ratio steps over a little more than a whole run, most of them near its end, where files appear.
        let share = (f64::from(runs) * 0.618_034).fract();
        let moment = if runs.is_multiple_of(3) { share } else { 0.7 + 0.5 * share };
        std::thread::sleep(Duration::from_secs_f64(seconds * moment));
        let _ = child.kill();
        let done = child.wait().unwrap().success();
        look(runs, done);
        killed += u32::from(!done);
        // Machines are busy at times.
        seconds *= if done { 0.93 } else { 1.03 };
        runs += 1;
        assert!(runs < 20 * kills() + 100, "{killed} of {runs} runs were killed in time");
    }
    runs
}

/// Killed at any moment, a file is whole, the old one or the new one, and a set with a manifest is whole, too.
#[test]
fn a_kill_leaves_no_half_written_file_and_no_mixed_set_with_a_manifest() {
    let folder = tempfile::tempdir().unwrap();
    let one = scenarios().join("figure-08.toml");
    let two = folder.path().join("other.toml");
    let text = std::fs::read_to_string(&one).unwrap();
    std::fs::write(&two, text.replace("elbow_flex_r_deg = 20", "elbow_flex_r_deg = 35")).unwrap();
    let (whole_one, whole_two) = (folder.path().join("one"), folder.path().join("two"));
    let full = simulate(&one, &whole_one, &[]).seconds;
    simulate(&two, &whole_two, &[]);
    let (whole_one, whole_two) = (contents(&whole_one), contents(&whole_two));
    assert!(whole_one != whole_two);
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    let (mut whole, mut broken) = (0, 0);
    let start = |run: u32| {
        let scenario = if run.is_multiple_of(2) { &one } else { &two };
        contrapposto(["simulate"]).arg(scenario).arg("--out").arg(&out)
    };
    let runs = killed_over_and_over(full, start, |run, _| {
        let found = contents(&out);
        for file in &found {
            assert!(whole_one.contains(file) || whole_two.contains(file), "{} is torn, run {run}", file.0);
        }
        if listed(&out).is_some() {
            assert!(found == whole_one || found == whole_two, "the set is mixed, run {run}");
            whole += 1;
        } else {
            broken += usize::from(!found.is_empty());
        }
    });
    println!(
        "{runs} runs, {} killed in time, {whole} whole sets seen, {broken} broken ones; a run takes {full:.2} s",
        kills()
    );
    // Running again finishes as if nothing had happened.
    assert_eq!(simulate(&one, &out, &[]).code, 0);
    assert!(contents(&out) == whole_one);
    assert_eq!(temporary(&out), Vec::<PathBuf>::new());
}

/// Killed at any moment while it goes on from where it was left, a run can be taken up again, to the bytes of an unbroken one.
#[cfg(unix)]
#[test]
fn a_killed_run_is_taken_up_again() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenarios().join("stand-relaxed.toml");
    let (unbroken, out) = (folder.path().join("unbroken"), folder.path().join("out"));
    let full = simulate(&scenario, &unbroken, &[]).seconds;
    let unbroken = contents(&unbroken);
    let left = out.join("snapshot.json");
    let mut wait = 0.5 * full;
    for _ in 0..100 {
        // No changes are tried, so that the signal meets the run itself.
        let child = contrapposto(["simulate", "--no-suggest"]).arg(&scenario).arg("--out").arg(&out).spawn();
        std::thread::sleep(Duration::from_secs_f64(wait));
        let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        let done = child.wait_with_output().unwrap().status.success();
        wait *= if done { 0.9 } else { 1.05 };
        // Left on its way, not at its very start.
        let snapshot = std::fs::read_to_string(&left).unwrap_or_default();
        if snapshot.contains("\"samples\":") && !snapshot.contains("\"samples\":0") {
            break;
        }
    }
    let (snapshot, partial) = (std::fs::read(&left).unwrap(), contents(&out));
    let rest = simulate(&scenario, &out, &["--resume"]).seconds;
    std::fs::write(&left, &snapshot).unwrap();
    let start = |_| contrapposto(["simulate", "--resume"]).arg(&scenario).arg("--out").arg(&out);
    let (mut finished, mut taken_up) = (0, 0);
    let runs = killed_over_and_over(rest, start, |run, done| {
        for (name, bytes) in contents(&out) {
            let is = |files: &[(String, Vec<u8>)]| files.contains(&(name.clone(), bytes.clone()));
            assert!(is(&partial) || is(&unbroken), "{name} is torn, run {run}");
        }
        if done {
            finished += 1;
            assert!(contents(&out) == unbroken, "run {run} came to something else");
        } else {
            taken_up += 1;
        }
        if !left.is_file() {
            std::fs::write(&left, &snapshot).unwrap();
        }
    });
    println!("{runs} runs, {taken_up} killed in time, {finished} came to the end; one takes {rest:.2} s");
    assert_eq!(simulate(&scenario, &out, &["--resume"]).code, 0);
    assert!(contents(&out) == unbroken, "a killed run, taken up again, differs from an unbroken one");
}
