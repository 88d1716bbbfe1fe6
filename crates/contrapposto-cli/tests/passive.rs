//! `contrapposto passive` through the real program: the curves with their sources, the numbers of one, its pictures, and wrong names.

use crate::support;

use support::{assert_png, assert_svg, contents, contrapposto, json, numbers, refused, run};

/// Each coordinate of the adult, by table and by JSON; those with a curve have its status and source.
#[test]
fn every_curve_is_listed_with_status_and_source() {
    let listed = json(&["passive", "--list", "--json"]);
    let text = run(&["passive", "--list"]);
    assert_eq!(text.code, 0, "{}", text.stderr);
    let mut curves = 0;
    for row in listed.as_array().unwrap() {
        let coordinate = row["coordinate"].as_str().unwrap();
        let line = text.stdout.lines().find(|line| line.split_whitespace().next() == Some(coordinate)).unwrap();
        if row["curve"].is_null() {
            assert!(coordinate.starts_with("pelvis_") || coordinate.starts_with("shoulder_rise"), "{coordinate}");
            assert!(row["source"].is_null() && line.contains("none"), "{line}");
            continue;
        }
        let [curve, status, source] = ["curve", "status", "source"].map(|key| row[key].as_str().unwrap());
        assert!(line.contains(curve) && line.contains(status), "{line}");
        assert!(!source.is_empty() && text.stdout.contains(source), "{coordinate}: {source}");
        curves += 1;
    }
    assert!(curves >= 30, "{curves}");
}

/// The words have the numbers of the JSON, and two pictures lie in the folder.
#[test]
fn a_curve_is_drawn_with_its_limits_and_its_source() {
    for name in ["knee_angle_r", "elbow_neutral"] {
        let folder = tempfile::tempdir().unwrap();
        let curve = json(&["passive", name, "--json"]);
        let said = contrapposto(["passive", name, "--out"]).arg(folder.path()).run();
        assert_eq!(said.code, 0, "{}", said.stderr);
        let [angles, torques] = ["angle_deg", "torque_nm"].map(|key| numbers(&curve[key]));
        let last = angles.len() - 1;
        let range = format!("range    {:.1} .. {:.1} deg", angles[0], angles[last]);
        let ends = format!("passive torque {:.2} .. {:.2} N m", torques[0], torques[last]);
        assert!(said.stdout.contains(&range) && said.stdout.contains(&ends), "{}", said.stdout);
        for key in ["curve", "status", "source", "note"] {
            assert!(said.stdout.contains(curve[key].as_str().unwrap()), "{key}: {}", said.stdout);
        }
        // A torque that falls with the angle, flattest where the words say.
        let slopes = numbers(&curve["slope_nm_per_rad"]);
        assert!(slopes.iter().all(|slope| *slope <= 0.0), "{name}");
        let flattest = numbers(&curve["flattest_deg"]);
        let within = |angle: f64| (flattest[0] - 0.5..=flattest[1] + 0.5).contains(&angle);
        let greatest = slopes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let at = angles[slopes.iter().position(|slope| *slope == greatest).unwrap()];
        assert!(within(at), "{name}: flattest at {at} deg, said {flattest:?}");
        let files = contents(folder.path());
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, [format!("passive-{name}.png"), format!("passive-{name}.svg")]);
        assert_png(&files[0].1);
        assert_svg(&files[1].1);
    }
}

#[test]
fn a_wrong_name_is_refused_with_the_nearest_one() {
    let message = refused(&["passive", "elbow_flx_r"]);
    assert!(
        message.contains("there is no coordinate or curve `elbow_flx_r`; did you mean `elbow_flex_r`?"),
        "{message}"
    );
    assert!(message.contains("curves: hip_flexion"), "{message}");
}
