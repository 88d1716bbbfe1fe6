//! Runs the real program in a folder of its own.
#![allow(dead_code, reason = "each test uses a part")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says where")]
#![allow(clippy::print_stdout, reason = "tests say what they skip")]

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// What the program answered.
pub(crate) struct Answer {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) told: String,
}

/// Runs `contrapposto`.
pub(crate) fn run(arguments: &[&str]) -> Answer {
    let output = Command::new(env!("CARGO_BIN_EXE_contrapposto")).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Answer { code: output.status.code().unwrap(), out: text(output.stdout), told: text(output.stderr) }
}

/// Runs it, expects exit code 0 and JSON.
pub(crate) fn json(arguments: &[&str]) -> Value {
    let answer = run(arguments);
    assert_eq!(answer.code, 0, "{}", answer.told);
    serde_json::from_str(&answer.out).unwrap_or_else(|error| panic!("{error}: {}", answer.out))
}

/// Runs it, expects exit code 2 and nothing on standard output; what it told, on one line.
pub(crate) fn refused(arguments: &[&str]) -> String {
    let answer = run(arguments);
    assert_eq!(answer.code, 2, "{arguments:?}: {}{}", answer.out, answer.told);
    assert_eq!(answer.out, "", "{arguments:?}");
    assert!(!answer.told.contains("panicked"), "{}", answer.told);
    answer.told
}

/// A file beside the project, if it is on this machine.
pub(crate) fn shared(path: &str) -> Option<PathBuf> {
    let full = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(path);
    if full.exists() {
        return Some(full);
    }
    println!("skipped: shared/{path} is not on this machine");
    None
}

/// The JSON of a file beside the project.
pub(crate) fn vectors(path: &str) -> Option<Value> {
    shared(path).map(|path| serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap())
}

/// Writes a file; its name as an argument.
pub(crate) fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// What the script of a `report.html` reads.
pub(crate) fn page(folder: &Path) -> Value {
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let data = page.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    serde_json::from_str(data).unwrap()
}

/// One of its columns: whole multiples of a step, each as the difference from the one before.
pub(crate) fn column(column: &Value, frames: usize) -> Vec<f64> {
    let by = numbers(&column["by"]);
    let sums = (0..frames).scan(0.0, |sum, i| {
        *sum += by.get(i).unwrap_or(&0.0);
        Some(*sum)
    });
    sums.map(|sum| sum * column["step"].as_f64().unwrap()).collect()
}

/// One of its joints.
pub(crate) fn joint<'a>(page: &'a Value, name: &str) -> &'a Value {
    page["joints"].as_array().unwrap().iter().find(|joint| joint["name"] == name).unwrap()
}

/// The keys of an object.
pub(crate) fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// A pendulum of two links, the second a slide that follows nothing, in OpenSim's axes; `knee` turns about z by `sign`.
pub(crate) fn leg(sign: i32, name: &str) -> String {
    format!(
        r#"<mujoco model="leg"><compiler angle="radian" autolimits="true"/><option gravity="0 -9.81 0"/><worldbody>
        <body name="thigh" pos="0 1 0"><joint name="hip" type="hinge" axis="0 0 1" range="-1 1"/>
        <inertial pos="0 -0.2 0" mass="8" diaginertia="0.1 0.1 0.1"/>
        <body name="shank" pos="0 -0.4 0"><joint name="{name}" type="hinge" axis="0 0 {sign}" range="-2 2"/>
        <inertial pos="0 -0.2 0" mass="4" diaginertia="0.1 0.1 0.1"/></body></body></worldbody></mujoco>"#
    )
}
