//! `contrapposto assess --repeat` through the real program: sentence, JSON and page of a motion that is repeated, its warnings and refusals.

use crate::support;

use std::fmt::Write;

use support::{json, page, refused, run, write};

/// A forearm that goes up and down once in two seconds.
fn curl(folder: &std::path::Path, frames: u32) -> String {
    let mut text = "time,elbow_flex_r_deg\n".to_owned();
    for i in 0..=frames {
        let turn = 2.0 * std::f64::consts::PI * f64::from(i) / 40.0;
        writeln!(text, "{},{}", 0.05 * f64::from(i), 60.0 - 30.0 * libm::cos(turn)).unwrap();
    }
    write(folder, &format!("curl-{frames}.csv"), &text)
}

/// A lift of two seconds every three seconds: duty cycle, relief and failure of the group that fails first stand in sentence, table, JSON and page, and
/// agree.
#[test]
fn a_repeated_lift_names_who_fails_first_and_when_in_words_json_and_page() {
    let folder = tempfile::tempdir().unwrap();
    let motion = curl(folder.path(), 40);
    let out = folder.path().join("out");
    let call = ["assess", "adult", &motion, "--fixed-root", "--static", "--load", "hand_r 9kg", "--repeat", "8h"];
    let often = json(&[&call[..], &["--every", "3s", "--json", "--out", out.to_str().unwrap()]].concat());
    let verdict = &often["verdict"];
    assert_eq!((&verdict["kind"], &verdict["asked_minutes"]), (&"held_until".into(), &480.0.into()));
    let first = &often["groups"][0];
    let repeated = &first["repeated"];
    let minutes = repeated["fails_after_s"].as_f64().unwrap() / 60.0;
    assert!((minutes - verdict["minutes"].as_f64().unwrap()).abs() < 1e-9);
    assert!(repeated["relief_after_s"].as_f64().unwrap() < 60.0 * minutes);
    assert!((repeated["duty_cycle"].as_f64().unwrap() - 2.0 / 3.0).abs() < 1e-9, "{repeated}");
    let range = verdict["minutes_range"].as_array().unwrap();
    assert!(range[0].as_f64().unwrap() < minutes && range[1].as_f64().is_none_or(|most| most > minutes), "{range:?}");
    assert_eq!(often["repeats"]["cycles"], 9600);
    let lines: Vec<&str> = verdict["lines"].as_array().unwrap().iter().map(|line| line.as_str().unwrap()).collect();
    assert!(
        lines.contains(&"Repeats: the motion of 2.0\u{a0}s, 9600 times in 8.0\u{a0}h, every 3.0\u{a0}s."),
        "{lines:?}"
    );
    assert!(lines.iter().any(|line| line.starts_with("Relief: right shoulder flexion asks for it first")), "{lines:?}");
    let page = page(&out);
    assert_eq!(page["headline"], verdict["sentence"]);
    assert!(page["table"]["columns"].as_array().unwrap().contains(&"Duty cycle".into()));
    let entry = page["list"]["entries"][0]["text"].as_str().unwrap();
    assert!(entry.contains("fails after") && entry.contains("of repeats"), "{entry}");

    let said = run(&[&call[..], &["--every", "3s"]].concat());
    assert!(said.stdout.starts_with("Can be repeated for "), "{}", said.stdout);
    for word in ["duty cycle", "asks for relief", "after "] {
        assert!(said.stdout.contains(word), "{word}: {}", said.stdout);
    }
    // Breaks help, and rarer lifts hold.
    let breaks = json(&[&call[..], &["--every", "3s", "--work", "50min", "--break", "10min", "--json"]].concat());
    assert!(breaks["verdict"]["minutes"].as_f64().unwrap() >= minutes);
    assert_eq!(breaks["repeats"]["work_minutes"], 50.0);
    assert_eq!(breaks["repeats"]["cycles"], 8 * 1000);
    let rarely = json(&[&call[..], &["--every", "2min", "--json"]].concat());
    assert_eq!(rarely["verdict"]["kind"], "holds", "{}", rarely["verdict"]["sentence"]);
    assert!(rarely["verdict"]["sentence"].as_str().unwrap().starts_with("Can be repeated for the 8.0\u{a0}h asked"));
}

#[test]
fn a_motion_whose_ends_do_not_meet_is_told_where_to_cut_it() {
    let folder = tempfile::tempdir().unwrap();
    let call = |motion: &str| run(&["assess", "adult", motion, "--fixed-root", "--static", "--repeat", "10min"]).stderr;
    assert!(!call(&curl(folder.path(), 40)).contains("does not meet"));
    let said = call(&curl(folder.path(), 60));
    assert!(
        said.contains("the end of the motion does not meet its start: right elbow flexion (elbow_flex_r)"),
        "{said}"
    );
    assert!(said.contains("--to 2"), "{said}");
}

#[test]
fn repeats_that_do_not_fit_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let motion = curl(folder.path(), 40);
    let still = write(folder.path(), "still.csv", "time,elbow_flex_r_deg\n0,60\n");
    let call = |motion: &str, more: &[&str]| refused(&[&["assess", "adult", motion, "--fixed-root"], more].concat());
    let (short, long) = (["--repeat", "1s"], ["--repeat", "1h"]);
    for (more, part) in [
        (&short[..], "--repeat is 1 s, less than the motion, which lasts 2.000000 s"),
        (&[&long[..], &["--every", "1s"]].concat(), "--every is 1 s, less than the motion, which lasts 2.000000 s"),
        (&[&long[..], &["--work", "1s", "--break", "1min"]].concat(), "--work is 1 s, less than the motion"),
        (&[&long[..], &["--work", "1min"]].concat(), "--break <TIME>"),
        (&["--every", "5s"], "--repeat <TIME>"),
        (&["--repeat", "2"], "a time above 0 and up to 24h with its unit is accepted"),
    ] {
        let message = call(&motion, more);
        assert!(message.contains(part), "`{part}` is not in\n{message}");
    }
    assert!(call(&still, &long).contains("a motion of one instant has no cycle"));
}
