//! Runs tests alone: first without a mutant, then each mutant against the tests that reach it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use crate::draw::Mutant;
use crate::rewrite::{MUTANT, TRACE, cargo, messages};

/// A test that takes longer alone has no part.
pub(crate) const LONGEST: Duration = Duration::from_secs(10);
/// A mutant's run that takes this many times as long, and this much longer, hangs: the test has noticed it.
const HANGS: (u32, Duration) = (5, Duration::from_secs(10));
/// No further test is tried after this time with one mutant.
const MOST: Duration = Duration::from_secs(180);
/// Runs beside each other.
const WORKERS: usize = 2;

/// A test, and what its run without a mutant told.
struct Test {
    program: PathBuf,
    folder: PathBuf,
    name: String,
    time: Duration,
    reached: BTreeSet<usize>,
}

enum End {
    Passed,
    Failed,
    TooLong,
}

/// Tries the mutants of these numbers and prints who noticed each.
pub(crate) fn judge(folder: &Path, mutants: &[Mutant], only: &[usize]) -> Result<(), String> {
    let found = tests(folder)?;
    let (tests, left_out) = without_mutant(folder, found);
    println!("{} tests take part; left out, as they fail in the copy or take over {LONGEST:?}:", tests.len());
    left_out.iter().for_each(|name| println!("  {name}"));
    let ends = in_turn(only.len(), |i| {
        let number = only[i];
        let end = noticed(&tests, number);
        let (kind, by) = match &end {
            Noticed::By(test) => ("noticed", format!(" by {test}")),
            Noticed::Hangs(test) => ("noticed", format!(": {test} hangs")),
            Noticed::Not(0) => ("not reached", String::new()),
            Noticed::Not(count) => ("survived", format!(" {count} tests")),
        };
        let Mutant { file, line, what, .. } = &mutants[number];
        let line = format!("{number} {kind}{by}: {file}:{line}: {}", what.replace('\n', " "));
        eprintln!("\r{line}");
        (kind, line)
    });
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for (kind, line) in ends {
        *counts.entry(kind).or_default() += 1;
        println!("{line}");
    }
    println!("{counts:?}");
    Ok(())
}

/// All tests of the copy that are not ignored.
fn tests(folder: &Path) -> Result<Vec<Test>, String> {
    let mut tests = vec![];
    for message in messages(&mut cargo(folder, &["test", "--no-run", "--lib", "--tests"]))? {
        let Some(program) = message["executable"].as_str().filter(|_| message["profile"]["test"] == true) else {
            continue;
        };
        let manifest = PathBuf::from(message["manifest_path"].as_str().unwrap_or(""));
        let list = Command::new(program).args(["--list", "--format", "terse"]).output();
        let ignored = Command::new(program).args(["--list", "--format", "terse", "--ignored"]).output();
        let (Ok(list), Ok(ignored)) = (list, ignored) else { return Err(format!("{program} does not run")) };
        let ignored = String::from_utf8_lossy(&ignored.stdout).into_owned();
        let ignored: BTreeSet<&str> = ignored.lines().collect();
        for name in String::from_utf8_lossy(&list.stdout).lines().filter(|name| !ignored.contains(name)) {
            let Some(name) = name.strip_suffix(": test") else { continue };
            tests.push(Test {
                program: program.into(),
                folder: manifest.parent().unwrap_or(folder).into(),
                name: name.to_owned(),
                time: Duration::ZERO,
                reached: BTreeSet::new(),
            });
        }
    }
    if tests.is_empty() { Err("the copy has no tests that compile".into()) } else { Ok(tests) }
}

/// The tests that pass in time, the fastest first, and the names of the others.
fn without_mutant(folder: &Path, mut tests: Vec<Test>) -> (Vec<Test>, Vec<String>) {
    let ends = in_turn(tests.len(), |i| {
        let trace = folder.join(format!("trace-{i}"));
        let _ = std::fs::remove_file(&trace);
        let start = Instant::now();
        let mut end = run(&tests[i], (TRACE, &trace.display().to_string()), LONGEST);
        if matches!(end, End::Failed) {
            // Notes allocate, which tests of allocation notice.
            end = run(&tests[i], (MUTANT, "none"), LONGEST);
        }
        let reached = std::fs::read_to_string(&trace).unwrap_or_default();
        let _ = std::fs::remove_file(&trace);
        (end, start.elapsed(), reached.lines().filter_map(|line| line.parse().ok()).collect())
    });
    let mut left_out = vec![];
    let mut ends = ends.into_iter();
    tests.retain_mut(|test| {
        let Some((end, time, reached)) = ends.next() else { return false };
        (test.time, test.reached) = (time, reached);
        let passed = matches!(end, End::Passed);
        if !passed {
            left_out.push(test.name.clone());
        }
        passed
    });
    tests.sort_by_key(|test| test.time);
    (tests, left_out)
}

enum Noticed {
    By(String),
    Hangs(String),
    /// Not by any of so many tests that reach it.
    Not(usize),
}

fn noticed(tests: &[Test], number: usize) -> Noticed {
    let (mut count, start) = (0, Instant::now());
    for test in tests.iter().filter(|test| test.reached.contains(&number)).take_while(|_| start.elapsed() < MOST) {
        match run(test, (MUTANT, &number.to_string()), test.time * HANGS.0 + HANGS.1) {
            End::Passed => count += 1,
            End::Failed => return Noticed::By(test.name.clone()),
            End::TooLong => return Noticed::Hangs(test.name.clone()),
        }
    }
    Noticed::Not(count)
}

/// Runs a test alone with a variable of the environment.
fn run(test: &Test, (key, value): (&str, &str), longest: Duration) -> End {
    let child = Command::new(&test.program)
        .args(["--exact", &test.name, "--test-threads=1"])
        .current_dir(&test.folder)
        .env_remove(MUTANT)
        .env(key, value)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    let Ok(mut child) = child else { return End::Failed };
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return if status.success() { End::Passed } else { End::Failed },
            Ok(None) if start.elapsed() < longest => std::thread::sleep(Duration::from_millis(5)),
            _ => {
                let _ = child.kill();
                let _ = child.wait();
                return End::TooLong;
            }
        }
    }
}

/// `of(0), of(1), ...`, computed beside each other, in order. Progress goes to stderr.
fn in_turn<T: Send>(count: usize, of: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(BTreeMap::new()));
    std::thread::scope(|scope| {
        for _ in 0..WORKERS {
            scope.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    if i >= count {
                        return;
                    }
                    let value = of(i);
                    if let Ok(mut done) = done.lock() {
                        done.insert(i, value);
                        eprint!("\r{} of {count} ", done.len());
                    }
                }
            });
        }
    });
    eprintln!();
    done.into_inner().map(|done| done.into_values().collect()).unwrap_or_default()
}
