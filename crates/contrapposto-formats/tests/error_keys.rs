//! An error of the science crate points at the key of the file whose value was refused: line and column of every mapping.

use crate::common;

use common::complaint;
use contrapposto_formats::{InputError, read_pose, read_scenario};

/// Holds an error to the place of `^` in the text, and to a part of its message.
fn assert_points(read: impl Fn(&[u8]) -> Result<(), InputError>, marked: &str, message: &str) {
    let marked = format!("format = 1\n{marked}");
    let at = marked.find('^').unwrap();
    let line = marked[..at].matches('\n').count() + 1;
    let column = at - marked[..at].rfind('\n').unwrap();
    let text = marked.replacen('^', "", 1);
    let error = complaint(&read(text.as_bytes()).unwrap_err());
    let error = error.replace(", columns ", ", column ");
    let place = format!("line {line}, column {column}");
    let points = error.contains(&format!("{place} ")) || error.contains(&format!("{place}:"));
    assert!(points && error.contains(message), "not {place}, `{message}`:\n{text}\n{error}");
}

#[test]
fn refused_numbers_of_a_run_point_at_their_keys() {
    let run = "[run]\nduration_s = 1\n";
    let active = "[strategy]\nkind = \"active\"\n";
    let adult = "[model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 75 }\n";
    let load = "[[load]]\nsegment = \"hand_r\"\n";
    let cases = [
        (format!("{active}minimum_decrease_ratio = ^2\n{run}"), "minimum_decrease_ratio is 2; it must be in 0..1"),
        (format!("{active}{run}[relief]\nstep_gain = ^1\n"), "step_gain is 1; it must be above 0 and below 1"),
        (format!("{active}{run}[relief]\nmax_step_deg = ^0\n"), "max_step_deg is 0; it must be positive"),
        (format!("{active}{run}[relief]\ntorque_tolerance_nm = ^-1\n"), "torque_tolerance_nm is -1"),
        (
            format!("{active}{run}[relief]\neffort_factor = ^0.9\n"),
            "effort_factor is 0.9; it must be finite, at least 1",
        ),
        (format!("{active}{run}[fatigue]\ncritical_level = ^0\n"), "critical_level is 0; it must be above 0"),
        (format!("{active}{run}[fatigue]\nrecovery_level = ^0.7\n"), "recovery_level is 0.7"),
        (format!("{active}[run]\nduration_s = ^-1\n"), "duration_s is -1"),
        (format!("{active}[run]\nduration_s = ^1e9\n"), "ten million at most"),
        (format!("{active}{run}step_s = ^0\n"), "step_s is 0; it must be above 0, at most 60"),
        (format!("{active}{run}[coordinates]\nfree = ^[\"pelvis_tx\"]\n{adult}"), "`pelvis_tx` is free"),
        (format!("{active}{run}{}", adult.replace("1.75", "^3")), "stature (m) of the adult is 3"),
        (format!("{active}{run}{}", adult.replace("75 }", "^5 }")), "mass (kg) of the adult is 5"),
        (
            format!("{active}{run}{}", adult.replace("75 }", "75, lengths_m = { humerus = ^3 } }")),
            "length of `humerus` (m) of the adult is 3",
        ),
        (
            format!("{active}{run}{}", adult.replace("75 }", "75, lengths_m = { ^nose = 0.1 } }")),
            "the adult has no segment `nose` with a length",
        ),
        (format!("{active}{run}{load}mass_kg = ^-1\n"), "mass (kg) of a load is -1"),
        (format!("{active}{run}{load}force_n = ^[1e10, 0, 0]\n"), "force (N) of a load is 10000000000"),
        (format!("{active}{run}{load}mass_kg = 1\nat_m = ^[0, 1e10, 0]\n"), "point (m) of a load is 10000000000"),
    ];
    for (text, message) in cases {
        assert_points(|bytes| read_scenario("f", bytes, None).map(drop), &text, message);
    }
}

#[test]
fn refused_angles_of_a_passive_law_are_in_degrees() {
    let law = "[strategy]\nkind = \"active\"\n[run]\nduration_s = 1\n[passive]\nelbow_flex_r = { coordinate_limit_force = \
               ^{ upper_stiffness_nm_per_deg = 1, upper_limit_deg = 90, lower_stiffness_nm_per_deg = 1, \
               lower_limit_deg = 0, transition_deg = -8 } }\n";
    let read = |bytes: &[u8]| read_scenario("f", bytes, None).map(drop);
    assert_points(read, law, "transition (deg) is -8.000000; it must be positive");
}

#[test]
fn refused_numbers_of_a_task_point_at_their_keys() {
    let point = "kind = \"point\"\nsegment = \"hand_r\"\n";
    let polygon = "[[9e8, 9e8], [1e9, 9e8], [9e8, 1e9]]";
    let cases = [
        (format!("{point}target = \"start\"\nat_m = ^[1e10, 0, 0]\n"), "point (m) is 10000000000"),
        (format!("{point}target_m = ^[1e10, 0, 0]\n"), "target (m) is 10000000000"),
        ("kind = \"look_at\"\ntarget_m = [2, 1, 0]\neye_m = ^[1e10, 0, 0]\n".to_owned(), "eye (m) is 10000000000"),
        (distance("at_m = ^[1e10, 0, 0]", "at_m = [0, 0, 0]", "[0, 1]"), "point (m) is 10000000000"),
        (distance("at_m = [0, 0, 0]", "at_m = ^[1e10, 0, 0]", "[0, 1]"), "point (m) is 10000000000"),
        (distance("at_m = [0, 0, 0]", "at_m = [0, 0, 1]", "^[-1, 1]"), "lower limit (m) is -1"),
        (distance("at_m = [0, 0, 0]", "at_m = [0, 0, 1]", "^[2, 1]"), "upper limit (m) is 1"),
        (
            "kind = \"center_of_mass\"\npolygon_m = [[0, 0], [0, 1], [1, 0]]\nmargin_m = ^1e10\n".to_owned(),
            "margin (m) is 10000000000",
        ),
        (format!("kind = \"center_of_mass\"\npolygon_m = ^{polygon}\n"), "offset of an edge (m) is"),
        (
            "kind = \"posture\"\ncoordinates = [\"elbow_flex_r\"]\nweights = ^{ elbow_flex_r = 0 }\n".to_owned(),
            "it asks for no coordinate (all weights are 0)",
        ),
        ("kind = \"effort\"\ncoordinates = ^[\"pelvis_tx\"]\n".to_owned(), "`pelvis_tx` has no known strength"),
    ];
    for (text, message) in cases {
        assert_points(|bytes| read_pose("f", bytes, None).map(drop), &format!("[[task]]\n{text}"), message);
    }
}

fn distance(a: &str, b: &str, range: &str) -> String {
    format!(
        "kind = \"distance\"\na = {{ segment = \"hand_r\", {a} }}\nb = {{ segment = \"head\", {b} }}\nrange_m = {range}\n"
    )
}
