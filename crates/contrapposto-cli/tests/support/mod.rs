//! Runs the real program. Nothing here knows what the program should answer.

use std::ffi::OsStr;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// Longest any run may take: a hang becomes a failed test.
const PATIENCE: Duration = Duration::from_secs(120);

/// A call of the program that is being put together.
pub struct Call {
    command: Command,
    input: Option<Vec<u8>>,
}

/// Outputs of a finished call.
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
    pub seconds: f64,
}

impl Run {
    /// Standard error without the lines that tell of progress, which come after ten seconds on a slow or busy machine.
    pub fn notes(&self) -> String {
        let lines = self.stderr.lines().filter(|line| !line.starts_with("progress: "));
        lines.collect::<Vec<_>>().join("\n")
    }
}

/// The program with arguments.
pub fn contrapposto<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Call {
    let mut command = Command::new(env!("CARGO_BIN_EXE_contrapposto"));
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    Call { command, input: None }
}

impl Call {
    pub fn arg(mut self, argument: impl AsRef<OsStr>) -> Self {
        self.command.arg(argument);
        self
    }

    pub fn args<S: AsRef<OsStr>>(mut self, arguments: impl IntoIterator<Item = S>) -> Self {
        self.command.args(arguments);
        self
    }

    pub fn env(mut self, name: &str, value: &str) -> Self {
        self.command.env(name, value);
        self
    }

    /// Runs in this folder.
    pub fn folder(mut self, folder: &Path) -> Self {
        self.command.current_dir(folder);
        self
    }

    pub fn stdin(mut self, input: impl AsRef<[u8]>) -> Self {
        self.input = Some(input.as_ref().to_owned());
        self
    }

    pub fn stdout_to(mut self, to: impl Into<Stdio>) -> Self {
        self.command.stdout(to);
        self
    }

    /// Started, with all three pipes open.
    pub fn spawn(mut self) -> Child {
        self.command.stdin(Stdio::piped()).spawn().unwrap()
    }

    /// Runs to the end. Panics when it takes too long or was killed.
    pub fn run(mut self) -> Run {
        if self.input.is_some() {
            self.command.stdin(Stdio::piped());
        }
        let start = Instant::now();
        let mut child = self.command.spawn().unwrap();
        let feeder = self.input.zip(child.stdin.take()).map(|(input, mut pipe)| {
            // The program may stop reading: that is its right.
            std::thread::spawn(move || drop(pipe.write_all(&input)))
        });
        let (done, finished) = std::sync::mpsc::channel();
        let id = child.id();
        let waiter = std::thread::spawn(move || {
            let output = child.wait_with_output().unwrap();
            let _ = done.send(());
            output
        });
        if finished.recv_timeout(PATIENCE).is_err() {
            let _ = Command::new("kill").args(["-9", &id.to_string()]).status();
            panic!("no end after {PATIENCE:?}");
        }
        let Output { status, stdout, stderr } = waiter.join().unwrap();
        if let Some(feeder) = feeder {
            feeder.join().unwrap();
        }
        let run = Run {
            code: status.code().unwrap_or_else(|| panic!("ended by a signal: {status}")),
            stdout: String::from_utf8(stdout).unwrap(),
            stderr: String::from_utf8(stderr).unwrap(),
            seconds: start.elapsed().as_secs_f64(),
        };
        assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
        run
    }
}

/// Runs it with arguments and nothing else.
pub fn run(arguments: &[&str]) -> Run {
    contrapposto(arguments).run()
}

/// Runs it, expects exit code 0 and JSON.
pub fn json(arguments: &[&str]) -> Value {
    let answer = run(arguments);
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    serde_json::from_str(&answer.stdout).unwrap_or_else(|error| panic!("{error}: {}", answer.stdout))
}

/// Runs it, expects exit code 2 and nothing on standard output; the message on standard error, on one line.
pub fn refused(arguments: &[&str]) -> String {
    let answer = run(arguments);
    assert_eq!(answer.code, 2, "{arguments:?}: {}{}", answer.stdout, answer.stderr);
    assert_eq!(answer.stdout, "", "{arguments:?}");
    answer.stderr
}

/// Path of a file of `../shared`. Panics without it: tests that need it are `#[ignore = "needs ../shared: ..."]`.
pub fn shared(path: &str) -> PathBuf {
    let full = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(path);
    assert!(full.exists(), "{} is missing; this test needs the folder `shared` beside the repository", full.display());
    full
}

/// The JSON of a file of `../shared`.
pub fn vectors(path: &str) -> Value {
    serde_json::from_slice(&std::fs::read(shared(path)).unwrap()).unwrap()
}

/// Writes a file; its name as an argument.
pub fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Data that the script of a `report.html` reads.
pub fn page(folder: &Path) -> Value {
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let data = page.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    serde_json::from_str(data).unwrap()
}

/// One of its columns: whole multiples of a step, each as the difference from the one before.
pub fn column(column: &Value, frames: usize) -> Vec<f64> {
    let by = numbers(&column["by"]);
    let sums = (0..frames).scan(0.0, |sum, i| {
        *sum += by.get(i).unwrap_or(&0.0);
        Some(*sum)
    });
    sums.map(|sum| sum * column["step"].as_f64().unwrap()).collect()
}

/// One of its joints.
pub fn joint<'a>(page: &'a Value, name: &str) -> &'a Value {
    page["joints"].as_array().unwrap().iter().find(|joint| joint["name"] == name).unwrap()
}

/// The keys of an object.
pub fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// A pendulum of two links, the second a slide that follows nothing, in OpenSim's axes; `knee` turns about z by `sign`.
pub fn leg(sign: i32, name: &str) -> String {
    format!(
        r#"<mujoco model="leg"><compiler angle="radian" autolimits="true"/><option gravity="0 -9.81 0"/><worldbody>
        <body name="thigh" pos="0 1 0"><joint name="hip" type="hinge" axis="0 0 1" range="-1 1"/>
        <inertial pos="0 -0.2 0" mass="8" diaginertia="0.1 0.1 0.1"/>
        <body name="shank" pos="0 -0.4 0"><joint name="{name}" type="hinge" axis="0 0 {sign}" range="-2 2"/>
        <inertial pos="0 -0.2 0" mass="4" diaginertia="0.1 0.1 0.1"/></body></body></worldbody></mujoco>"#
    )
}

/// A small body: an arm that is held up by its tasks alone, so that a run takes no time.
pub const ARM: &str = r#"
format = 1
title = "A hand held up"
[model]
adult = { sex = "male", stature_m = 1.74, mass_kg = 73, part = "right_arm" }
[[task]]
kind = "point"
segment = "hand_r"
target_m = [0.3, 1.2, 0.2]
"#;

/// The folder of the scenarios that come with the program.
pub fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").canonicalize().unwrap()
}

/// Names and bytes of all files of a folder, in order, without those of folders in it.
pub fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.file_type().unwrap().is_file())
        .map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap()))
        .collect();
    files.sort();
    files
}

/// The name of a manifest.
pub const MANIFEST: &str = "manifest.sha256";

/// As [`contents`], without the manifest of a result set, which has to be there.
pub fn results(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = contents(folder);
    let manifest = files.iter().position(|(name, _)| name == MANIFEST).expect("a result set has a manifest");
    files.remove(manifest);
    files
}

/// An SVG picture, whole: it begins and ends as one, every tag that opens closes, and nothing in it is a script.
pub fn assert_svg(bytes: &[u8]) {
    let text = std::str::from_utf8(bytes).unwrap();
    let svg = text.find("<svg").unwrap_or_else(|| panic!("no <svg> in {:.200}", text));
    assert!(text[..svg].trim().is_empty() || text.starts_with("<?xml"), "{:.200}", text);
    assert!(text.trim_end().ends_with("</svg>"));
    assert!(
        text.contains("xmlns=\"http://www.w3.org/2000/svg\"") && text.contains("viewBox=") || text.contains("width=")
    );
    for word in ["NaN", "\"inf", "<script", "javascript:", " onload=", " onerror="] {
        assert!(!text.contains(word), "{word} in a picture");
    }
    let stray = text.chars().find(|&c| c.is_control() && !matches!(c, '\n' | '\r' | '\t'));
    assert_eq!(stray, None, "XML has no such character");
    assert_eq!(text.matches('<').count(), text.matches('>').count(), "tags are open");
}

/// A PNG picture, whole: signature, a header with a size that can be seen, and the end.
pub fn assert_png(bytes: &[u8]) {
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n");
    assert_eq!(bytes[12..16], *b"IHDR");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    let (width, height) = (number(16), number(20));
    assert!((200..10_000).contains(&width) && (200..10_000).contains(&height), "{width} x {height}");
    assert_eq!(bytes[bytes.len() - 8..bytes.len() - 4], *b"IEND");
}

/// Keys of numbers that may be unknown, or without a limit.
const MAY_BE_NULL: [&str; 14] = [
    "asked_minutes",
    "center_of_pressure_m",
    "exhausted_s",
    "failed_first",
    "fails_weaker",
    "hardest",
    "last_outcome",
    "least_minutes",
    "load",
    "minutes",
    "minutes_range",
    "name",
    "tired",
    "who",
];

/// Every leaf that is no word, yes or no is a number that is finite; only what may be unknown is null.
pub fn assert_numbers(value: &Value, key: &str) {
    match value {
        Value::Number(number) => assert!(number.as_f64().unwrap().is_finite(), "{key}"),
        Value::Null => assert!(MAY_BE_NULL.contains(&key), "{key} is null"),
        Value::Array(list) => list.iter().for_each(|value| assert_numbers(value, key)),
        Value::Object(map) => map.iter().for_each(|(key, value)| assert_numbers(value, key)),
        _ => {}
    }
}

/// A model file: a body on a hinge about z, pulled by muscles, each so far in front of the hinge (m, negative: behind) and of a greatest force (N).
pub fn hinge_with_muscles(muscles: &[(&str, f64, f64)]) -> String {
    let muscle = |(name, x, force): &(&str, f64, f64)| {
        format!(
            "<Thelen2003Muscle name=\"{name}\"><GeometryPath><PathPointSet><objects>
             <PathPoint name=\"p\"><socket_parent_frame>/ground</socket_parent_frame><location>{x} 0.2 0</location></PathPoint>
             <PathPoint name=\"o\"><socket_parent_frame>/bodyset/b</socket_parent_frame><location>{x} -0.3 0</location></PathPoint>
             </objects></PathPointSet></GeometryPath><max_isometric_force>{force}</max_isometric_force>
             <optimal_fiber_length>0.1</optimal_fiber_length><tendon_slack_length>0.4</tendon_slack_length></Thelen2003Muscle>"
        )
    };
    let muscles: String = muscles.iter().map(muscle).collect();
    format!(
        "<OpenSimDocument Version=\"40500\"><Model name=\"m\">
         <BodySet><objects><Body name=\"b\"><mass>1</mass></Body></objects></BodySet>
         <JointSet><objects><PinJoint name=\"j\"><socket_parent_frame>/ground</socket_parent_frame>
           <socket_child_frame>/bodyset/b</socket_child_frame>
           <coordinates><Coordinate name=\"q\"/></coordinates></PinJoint></objects></JointSet>
         <ForceSet><objects>{muscles}</objects></ForceSet></Model></OpenSimDocument>"
    )
}
