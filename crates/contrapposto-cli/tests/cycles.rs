//! `contrapposto assess` of a motion with cycles: mean and standard deviation of known ones in JSON, page and words, and what has none.

use crate::support;

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

use contrapposto_formats::motion::{Table, read_table};
use serde_json::Value;
use support::{column, json, numbers, page, refused, run, write};

/// Instants of a cycle of 2 s.
const STEPS: usize = 100;

/// An elbow at 60 degrees and the amplitude of the cycle times sin.
fn curls(folder: &Path, name: &str, amplitudes: &[f64]) -> String {
    let mut text = "time,elbow_flex_r_deg\n".to_owned();
    for i in 0..=amplitudes.len() * STEPS {
        let amplitude = amplitudes[(i / STEPS).min(amplitudes.len() - 1)];
        let sine = libm::sin(TAU * (i % STEPS) as f64 / STEPS as f64);
        writeln!(text, "{},{}", 0.02 * i as f64, 60.0 + amplitude * sine).unwrap();
    }
    write(folder, name, &text)
}

/// A column of a table.
fn values(table: &Table, label: &str) -> Vec<f64> {
    let index = table.columns.iter().position(|other| other == label).unwrap();
    table.rows.iter().map(|row| row[index]).collect()
}

/// A call that is refused with this part of a message.
fn refuses(arguments: &[&str], part: &str) {
    let said = refused(arguments);
    assert!(said.contains(part), "`{part}` is not in {said}");
}

/// Mean and standard deviation, a second time.
fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64).sqrt())
}

fn elbow(answer: &Value) -> &Value {
    let all = answer["cycles"]["coordinates"].as_array().unwrap();
    all.iter().find(|curves| curves["coordinate"] == "elbow_flex_r").unwrap()
}

/// Three curls of 20, 30 and 40 degrees: at each percent of the cycle the angle is 60 + 30 sin on the average, with the deviation 10 |sin|; torque
/// and load are those of the tables at the same percent of each cycle. Page and words say the same.
#[test]
fn mean_and_deviation_of_known_cycles_stand_in_json_page_and_words() {
    let folder = tempfile::tempdir().unwrap();
    let motion = curls(folder.path(), "curls.csv", &[20.0, 30.0, 40.0]);
    let out = folder.path().join("out");
    let call = ["assess", "adult", &motion, "--fixed-root", "--static", "--load", "hand_r 5kg", "--cycles"];
    let answer = json(&[&call[..], &["0,2,4,6", "--json", "--out", out.to_str().unwrap()]].concat());
    let curves = elbow(&answer);
    let [angles, deviations] = ["mean", "deviation"].map(|key| numbers(&curves["angle_deg"][key]));
    assert_eq!((angles.len(), deviations.len()), (101, 101));
    for percent in 0..=100 {
        let sine = libm::sin(TAU * percent as f64 / 100.0);
        assert!((angles[percent] - (60.0 + 30.0 * sine)).abs() < 1e-6, "{percent}: {}", angles[percent]);
        assert!((deviations[percent] - 10.0 * sine.abs()).abs() < 1e-6, "{percent}: {}", deviations[percent]);
    }
    let torques = read_table("torques", &std::fs::read(out.join("torques.sto")).unwrap()).unwrap();
    let fatigue = read_table("fatigue", &std::fs::read(out.join("fatigue.sto")).unwrap()).unwrap();
    let load: Vec<f64> = values(&fatigue, "elbow_flex_r.load_positive")
        .iter()
        .zip(values(&fatigue, "elbow_flex_r.load_negative"))
        .map(|(up, down)| up.max(down))
        .collect();
    for (key, table) in [
        ("external_nm", values(&torques, "elbow_flex_r.external_nm")),
        ("active_nm", values(&torques, "elbow_flex_r.active_nm")),
        ("load", load),
    ] {
        let [means, deviations] = ["mean", "deviation"].map(|part| numbers(&curves[key][part]));
        for percent in [0, 10, 25, 60, 75] {
            let of_cycles: Vec<f64> = (0..3).map(|cycle| table[cycle * STEPS + percent]).collect();
            let (mean, deviation) = mean_and_deviation(&of_cycles);
            assert!((means[percent] - mean).abs() < 1e-6 * mean.abs().max(1.0), "{key} {percent}: {mean}");
            assert!(
                (deviations[percent] - deviation).abs() < 1e-6 * mean.abs().max(1.0),
                "{key} {percent}: {deviation}"
            );
        }
    }

    let page = page(&out);
    let said = page["cycles"]["text"].as_str().unwrap();
    assert!(said.starts_with("3 cycles of 2.0\u{a0}s (standard deviation 0.000 s), as --cycles says."), "{said}");
    let joint = page["joints"].as_array().unwrap().iter().position(|joint| joint["name"] == "elbow_flex_r").unwrap();
    let drawn = &page["cycles"]["joints"][joint]["angle"];
    for (key, wanted) in [("mean", &angles), ("deviation", &deviations)] {
        let step = drawn[key]["step"].as_f64().unwrap();
        for (drawn, wanted) in column(&drawn[key], 101).iter().zip(wanted) {
            assert!((drawn - wanted).abs() <= step, "{key}: {drawn} is not {wanted}");
        }
    }
    let said = run(&[&call[..], &["2"]].concat()).stdout;
    assert!(said.contains("3 cycles of 2.0\u{a0}s (standard deviation 0.000 s), as --cycles says;"), "{said}");
    let by_length = json(&[&call[..], &["2", "--json"]].concat());
    assert_eq!(elbow(&by_length)["angle_deg"], curves["angle_deg"]);
    let one = json(&[&call[..], &["5", "--json"]].concat());
    assert_eq!((&one["cycles"]["count"], &one["cycles"]["length_s"]["deviation"]), (&1.into(), &Value::Null));
    assert_eq!(elbow(&one)["load"]["deviation"], Value::Null);
}

/// Cycles that are nearly alike are found without an option.
#[test]
fn cycles_are_found_where_the_angles_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let motion = curls(folder.path(), "curls.csv", &[29.0, 30.0, 31.0, 30.0, 30.0]);
    let call = ["assess", "adult", &motion, "--fixed-root", "--static", "--json"];
    let found = json(&call);
    assert_eq!(found["cycles"]["count"], 5, "{}", found["cycles"]["sentence"]);
    for (bound, wanted) in numbers(&found["cycles"]["bounds_s"]).iter().zip([0.0, 2.0, 4.0, 6.0, 8.0, 10.0]) {
        assert!((bound - wanted).abs() < 0.01, "{bound} is not {wanted}");
    }
    let sentence = found["cycles"]["sentence"].as_str().unwrap();
    assert!(sentence.ends_with("found where the angles come back to those of the start"), "{sentence}");
    let deviation = numbers(&elbow(&found)["angle_deg"]["deviation"])[25];
    assert!((deviation - 0.5f64.sqrt()).abs() < 0.05, "{deviation}");
    assert_eq!(json(&[&call[..], &["--cycles", "none"]].concat())["cycles"], Value::Null);
    assert_eq!(json(&[&call[..], &["--cycles", "find"]].concat())["cycles"], found["cycles"]);
}

/// A motion that does not come back has no curves, and the reason is said; asked for, it is an error.
#[test]
fn motions_without_cycles_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let lift = write(folder.path(), "lift.csv", "time,elbow_flex_r_deg\n0,10\n1,30\n2,60\n3,90\n4,110\n5,120\n");
    let call = ["assess", "adult", &lift, "--fixed-root", "--static"];
    let said = run(&call);
    assert!(said.stdout.contains("\nno cycles are found: the angles do not return to"), "{}", said.stdout);
    let answer = json(&[&call[..], &["--json"]].concat());
    assert_eq!(answer["cycles"], Value::Null);
    assert!(answer["no_cycles"].as_str().unwrap().contains("--cycles 1.2 gives their length in s"), "{answer}");
    refuses(&[&call[..], &["--cycles", "find"]].concat(), "lift.csv: no cycles are found: the angles do not return to");
    refuses(
        &[&call[..], &["--cycles", "6"]].concat(),
        "--cycles: 6 s is no length of a cycle of a motion from 0 s to 5 s",
    );
    refuses(
        &[&call[..], &["--cycles", "1,3,7"]].concat(),
        "--cycles: 7 s lies outside of the motion, which goes from 0 s to 5 s",
    );
    for wrong in ["3,1", "0", "-1", "NaN", "one", "1,inf", ""] {
        refuses(&[&call[..], &["--cycles", wrong]].concat(), "rising times in s, such as 0.62,1.74,2.85, are accepted");
    }
    let hold = write(folder.path(), "hold.csv", "time,elbow_flex_r_deg\n0,90\n1,90\n2,90\n");
    let call = ["assess", "adult", &hold, "--fixed-root", "--static"];
    assert!(!run(&call).stdout.contains("cycles"), "a hold has no cycles, and nothing is said of them");
    refuses(
        &[&call[..], &["--cycles", "find"]].concat(),
        "no cycles are found: all angles together move by less than a degree",
    );
}
