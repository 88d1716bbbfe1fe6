//! `contrapposto relax`: a scenario in, the different postures of least effort out.

use crate::support;

use std::path::{Path, PathBuf};

use support::{ARM, Run, column, contrapposto, joint, json, page, scenarios};

use serde_json::Value;

fn relax(scenario: &Path, more: &[&str]) -> Run {
    contrapposto(["relax"]).arg(scenario).args(more).run()
}

fn standing() -> PathBuf {
    scenarios().join("stand-relaxed-feet-fixed.toml")
}

fn written(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("scenario.toml");
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn one_leg_rests_by_a_slouch_or_level() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let text = format!("arms_hang = false\n{}", std::fs::read_to_string(standing()).unwrap());
    let run = relax(&written(folder.path(), &text), &["--json", "--figures", "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("[strategy], [relief], [fatigue], [run] are ignored"), "{}", run.stderr);
    let text = std::fs::read_to_string(out.join("relax.json")).unwrap();
    assert_eq!(run.stdout, text);
    let found: Value = serde_json::from_str(&text).unwrap();
    let postures = found["postures"].as_array().unwrap();
    // The search may find a third way, on a bent knee, of about 2.5 times the effort.
    assert!((2..=3).contains(&postures.len()), "{}", postures.len());
    let names: Vec<String> = (1..=postures.len()).map(|number| format!("posture {number}")).collect();
    let hips: Vec<f64> =
        postures.iter().map(|p| p["coordinates"]["hip_adduction_r"].as_f64().unwrap().to_degrees()).collect();
    let efforts: Vec<f64> = postures.iter().map(|p| p["effort"].as_f64().unwrap()).collect();
    println!("hips {hips:?} deg, efforts {efforts:?}");
    assert!(hips[0] > 18.0 && hips[1] < 8.0 && efforts[0] < 0.7 * efforts[1]);
    assert!(efforts[2..].iter().all(|effort| *effort > 1.5 * efforts[1]));
    // Stored efforts, which a better search may lower.
    assert!(efforts[0] < 0.04274223482932177 * (1.0 + 1e-6) && efforts[1] < 0.06332232232210147 * (1.0 + 1e-6));
    // The page shows them, as they stand in relax.json, to choose between.
    let page = page(&out);
    assert_eq!(page["names"], serde_json::json!(names));
    let hip = joint(&page, "hip_adduction_r");
    let angles = column(&hip["angle"], names.len());
    let hanging = &postures[0]["hanging"][0];
    assert_eq!(hanging["coordinate"], "hip_adduction_r");
    // Both are angles about the axis of adduction, which differ from the coordinate where the hip is flexed and turned.
    assert!((angles[0] - hanging["value"].as_f64().unwrap().to_degrees()).abs() < 0.011, "{angles:?}");
    assert!(angles.iter().zip(&hips).all(|(shown, found)| (shown - found).abs() < 1.0), "{angles:?} {hips:?}");
    assert_eq!(page["joints"][page["main"].as_u64().unwrap() as usize]["name"], "hip_adduction_r");
    for (key, torque) in [("external", "external_nm"), ("passive", "passive_nm")] {
        assert!((column(&hip[key], names.len())[0] - hanging[torque].as_f64().unwrap()).abs() < 0.006, "{key}");
    }
    assert_eq!(hip["balance"].as_array().unwrap().len(), names.len(), "a curve for each");
    let share = column(&page["supports"][0]["share"], names.len())[0];
    assert!((share - postures[0]["supports"][0]["share"].as_f64().unwrap()).abs() < 6e-4);
    let page_entries = page["list"]["entries"].as_array().unwrap();
    assert!(page_entries[0]["text"].as_str().unwrap().contains("right hip adduction at 23.3°"), "{}", page_entries[0]);
    assert_eq!((page_entries.len(), &page_entries[1]["frame"]), (names.len(), &serde_json::json!(1)));
    for (entry, posture) in page_entries.iter().zip(postures) {
        let ends = if posture["fails_first"].is_null() { "no limit by muscles." } else { "fails." };
        assert!(entry["text"].as_str().unwrap().ends_with(ends), "{entry}");
    }
    let first = &postures[0]["hanging"][0];
    assert_eq!(first["coordinate"], "hip_adduction_r");
    assert!(first["passive_nm"].as_f64().unwrap() < -30.0 && first["share"].as_f64().unwrap() > 0.9);
    for posture in postures {
        assert_eq!(posture["held_by"], "attention");
        let unstable = posture["unstable"].as_array().unwrap();
        assert!(!unstable.is_empty() && unstable.iter().all(|way| !way["joints"].as_array().unwrap().is_empty()));
        let shares = posture["supports"].as_array().unwrap().iter().map(|s| s["share"].as_f64().unwrap());
        assert!((shares.sum::<f64>() - 1.0).abs() < 1e-8);
        let tasks = posture["tasks"].as_array().unwrap();
        assert!(tasks.len() == 4 && tasks.iter().all(|task| task["error"].as_f64().unwrap() < 1e-5));
        for key in found["coordinate_order"].as_array().unwrap() {
            assert!(posture["coordinates"][key.as_str().unwrap()].is_f64());
        }
    }
    // Files: one row a posture, one row a posture and coordinate, torques that add up to nothing.
    let mot = std::fs::read_to_string(out.join("postures.mot")).unwrap();
    assert_eq!(mot.lines().skip_while(|line| !line.starts_with("time")).count(), 1 + names.len());
    let csv = std::fs::read_to_string(out.join("relax.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + names.len() * found["coordinate_order"].as_array().unwrap().len());
    for row in csv.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let torques: f64 = cells[4..7].iter().map(|cell| cell.parse::<f64>().unwrap()).sum();
        assert!(cells.len() == 8 && torques.abs() < 1e-9, "{row}");
    }
    // A panel for each posture; the adduction of the carrying hip is among the five joints that work hardest.
    let files = found["files"].as_array().unwrap().iter().map(|name| name.as_str().unwrap());
    let of_hip: Vec<&str> = files.filter(|name| name.ends_with("-hip_adduction_r.svg")).collect();
    assert_eq!(of_hip.len(), 1);
    let chart = std::fs::read_to_string(out.join(of_hip[0])).unwrap();
    for words in ["right hip adduction, posture 1", "right hip adduction, posture 2", ">external<", ">active<"] {
        assert!(chart.contains(words), "{words}");
    }
    assert!(!chart.contains(">start<") && !chart.contains(">goal<"));
    assert_eq!(found["files"].as_array().unwrap().len(), 8 + 2 * 5);
    for name in found["files"].as_array().unwrap() {
        assert!(std::fs::metadata(out.join(name.as_str().unwrap())).unwrap().len() > 1000, "{name}");
    }
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 8 + 2, "eight files, their manifest, a folder of figures");
}

#[test]
fn an_arm_without_supports_reaches_and_rests() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = written(folder.path(), ARM);
    let run = relax(&scenario, &[]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("no task is of kind `effort`"), "{}", run.stderr);
    assert!(run.stdout.contains("\nA hand held up\n") && run.stdout.contains("posture 1:"), "{}", run.stdout);
    assert!(run.stdout.contains("held by") && run.stdout.contains("starts"));
    // Nothing was written beside the scenario.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    // The same twice, to the byte.
    let again = relax(&scenario, &["--json"]);
    assert_eq!(again.stdout, relax(&scenario, &["--json"]).stdout);
    let found: Value = serde_json::from_str(&again.stdout).unwrap();
    let least = found["postures"][0]["effort"].as_f64().unwrap();
    assert!(found["postures"].as_array().unwrap().iter().all(|p| p["effort"].as_f64().unwrap() >= least));
    assert!(found["postures"][0]["tasks"][0]["error"].as_f64().unwrap() < 1e-5);
    assert_eq!(found["files"].as_array().unwrap().len(), 0);
}

/// Every group says how long it can hold its load, by the curves of Frey-Law & Avin 2010 (written down here again); a run that holds
/// the posture until the second gives up names the first, and its time.
#[test]
fn a_posture_says_how_long_it_can_be_held() {
    let folder = tempfile::tempdir().unwrap();
    let held = "[fatigue]\nlaw = \"endurance\"\n[[load]]\nsegment = \"hand_r\"\nmass_kg = 3\n";
    let run = relax(&written(folder.path(), &format!("{ARM}{held}")), &["--json"]);
    assert!(run.code == 0 && !run.stderr.contains("ignored by"), "{}", run.stderr);
    let found: Value = serde_json::from_str(&run.stdout).unwrap();
    let posture = &found["postures"][0];
    let mut times = vec![];
    for group in posture["groups"].as_array().unwrap() {
        let (b0, b1) = match group["coordinate"].as_str().unwrap() {
            "elbow_flex_r" => (17.98, -2.21),
            name if name.starts_with("arm_") => (14.86, -1.83),
            _ => (33.55, -1.61),
        };
        let law = b0 * libm::pow(group["relative_load"].as_f64().unwrap(), b1);
        assert!((group["endurance_s"].as_f64().unwrap() / law - 1.0).abs() < 1e-12, "{group}");
        times.push(law);
    }
    times.sort_by(f64::total_cmp);
    let least = times[0];
    let first = &posture["fails_first"];
    assert!((first["endurance_s"].as_f64().unwrap() / least - 1.0).abs() < 1e-12);

    let degrees = |(name, value): (&String, &Value)| format!("{name}_deg = {}\n", value.as_f64().unwrap().to_degrees());
    let start: String = posture["coordinates"].as_object().unwrap().iter().map(degrees).collect();
    let body = ARM.split("[[task]]").next().unwrap();
    let text = format!(
        "{body}{held}[posture]\n{start}[coordinates]\nfree = []\n[strategy]\nkind = \"active\"\n\
        [run]\nduration_s = {}\nstep_s = 0.5\n",
        times[1].ceil()
    );
    let scenario = written(folder.path(), &text);
    let out = folder.path().join("out");
    let summary = json(&["simulate", scenario.to_str().unwrap(), "--json", "--out", out.to_str().unwrap()]);
    let failed = &summary["failed_first"];
    println!("predicted {least:.2} s, {first}; held {failed}");
    assert_eq!((&failed["coordinate"], &failed["group"]), (&first["coordinate"], &first["group"]));
    assert!((failed["at_s"].as_f64().unwrap() - least).abs() < 0.51);
}

#[test]
fn what_is_wrong_is_shown_where_it_stands() {
    let folder = tempfile::tempdir().unwrap();
    let good = std::fs::read_to_string(standing()).unwrap();
    for (from, to, message) in [
        ("segment = \"calcn_r\"", "segment = \"calcn_rr\"", "did you mean `calcn_r`"),
        ("share_max = 0.15", "share_max = 1.5", "share_max is 1.5; it must lie in 0..1"),
        ("elbow_flex_r_deg = 20", "elbow_flex_r_deg = 200", "`elbow_flex_r` "),
        ("kind = \"effort\"", "kind = \"effrot\"", "unknown"),
    ] {
        let line = good[..good.find(from).unwrap()].matches('\n').count() + 1;
        let place = format!("scenario.toml:{line}:");
        let scenario = written(folder.path(), &good.replacen(from, to, 1));
        let out = folder.path().join("out");
        let run = relax(&scenario, &["--out", out.to_str().unwrap()]);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{to}");
        assert!(run.stderr.contains(message) && run.stderr.contains(&place), "{to}: {}", run.stderr);
        assert!(!out.exists(), "{to}: nothing is written for a file that is refused");
    }
    let floating = written(folder.path(), "format = 1\ntitle = \"Floating\"\n[[task]]\nkind = \"effort\"\n");
    let run = relax(&floating, &[]);
    assert_eq!(run.code, 2);
    assert!(
        run.stderr.contains("a free root and no support") && run.stderr.contains("add a [[support]]"),
        "{}",
        run.stderr
    );
    assert_eq!(relax(Path::new("no-such-file.toml"), &[]).code, 2);
}

/// On ice that slopes by 24 degrees nobody stands: the reason is a number, exit code 1, and the answer is all that is written.
#[test]
fn a_body_that_cannot_stand_says_by_how_much() {
    let folder = tempfile::tempdir().unwrap();
    let ice = "on = { normal = [0.45, 1, 0] }\nfriction = 0\n";
    let text = format!(
        "format = 1\ntitle = \"Ice\"\n[[support]]\nsegment = \"calcn_r\"\n{ice}[[support]]\nsegment = \"calcn_l\"\n{ice}"
    );
    let scenario = written(folder.path(), &text);
    let out = folder.path().join("out");
    let run = relax(&scenario, &["--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(
        run.stdout.starts_with("Cannot stand: the supports do not hold the body") && run.stdout.contains(" N and ")
    );
    assert!(run.stdout.contains("with more friction they would hold it"), "{}", run.stdout);
    let names: Vec<_> = support::results(&out).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["relax.json"]);
    let answer: Value = serde_json::from_slice(&std::fs::read(out.join("relax.json")).unwrap()).unwrap();
    assert_eq!(answer["verdict"]["kind"], "cannot_stand");
}

/// Stiff as a board with 40 kg held out in front: the reason is a distance, forward.
#[test]
fn a_body_that_leans_too_far_says_how_far_and_where() {
    let folder = tempfile::tempdir().unwrap();
    let hands = "[[load]]\nsegment = \"hand_r\"\nmass_kg = 20\n[[load]]\nsegment = \"hand_l\"\nmass_kg = 20\n";
    let feet = "[[support]]\nsegment = \"calcn_r\"\n[[support]]\nsegment = \"calcn_l\"\n";
    let text = format!(
        "format = 1\ntitle = \"A board\"\n[posture]\narm_flex_r_deg = 90\narm_flex_l_deg = 90\n\
        [coordinates]\nfree = [\"wrist_flex_r\"]\n{hands}{feet}"
    );
    let run = relax(&written(folder.path(), &text), &[]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stdout.contains(" m beyond the supports, toward x +0."), "{}", run.stdout);
}
