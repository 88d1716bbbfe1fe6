//! Runs the real program. Nothing here knows what the program should answer.

#![allow(dead_code, unreachable_pub, clippy::unwrap_used)] // each test uses a part

use std::ffi::OsStr;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Longest any run may take: a hang becomes a failed test.
const PATIENCE: Duration = Duration::from_secs(120);

/// A call of the program that is being put together.
pub struct Call {
    command: Command,
    input: Option<Vec<u8>>,
}

/// What a finished call left.
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
    pub seconds: f64,
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

/// The folder of the scenarios that come with the program.
pub fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").canonicalize().unwrap()
}

/// Names and bytes of all files of a folder, in order.
pub fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap()))
        .collect();
    files.sort();
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
