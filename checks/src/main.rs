//! Names the tests that `cargo test` leaves out, and what each of them needs.
//!
//! `ignored-tests.txt` lists every ignored test of the workspace; a test holds the list to the sources, so that a test that
//! becomes ignored is noticed. Without arguments the program prints a summary for people. `names NEED...` prints the names of
//! the tests with these needs, one per line, for `.ci/run`.

#![allow(clippy::print_stdout, reason = "a program for the terminal")]

use std::collections::BTreeMap;

/// One line a test: `PACKAGE/TARGET TEST needs NEED: why`.
const LIST: &str = include_str!("../ignored-tests.txt");

/// Name, need and reason of a line of the list.
fn parts(line: &str) -> Option<(&str, &str, &str)> {
    let (place, reason) = line.split_once(" needs ")?;
    let (need, why) = reason.split_once(": ")?;
    Some((place.rsplit(' ').next()?, need, why))
}

/// The tests of the list, those with the same need together.
fn summary() -> String {
    let mut needs: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for line in LIST.lines() {
        let Some((_, need, _)) = parts(line) else { continue };
        needs.entry(need).or_default().push(line.split(" needs ").next().unwrap_or(line));
    }
    let mut text = format!("{} tests were left out, because they need more than this folder.\n", LIST.lines().count());
    for (need, tests) in needs {
        text.push_str(&format!("Tests that need {need} ({}):\n  {}\n", tests.len(), tests.join("\n  ")));
    }
    text + "One of them: cargo test --workspace --locked NAME -- --ignored. All whose needs are met: bash .ci/run\n"
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.split_first() {
        Some((verb, needs)) if verb == "names" => {
            let wanted = LIST.lines().filter_map(parts).filter(|(_, need, _)| needs.iter().any(|n| n == need));
            wanted.for_each(|(name, ..)| println!("{name}"));
        }
        _ => print!("{}", summary()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::{Path, PathBuf};

    /// End of the names of the page's tests.
    const TEST_OF_THE_PAGE: &str = ".test.mjs";

    /// Rust files of a folder and of those below it, in order.
    fn sources(folder: &Path) -> Vec<PathBuf> {
        let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        entries.sort();
        let below = |path: PathBuf| if path.is_dir() { sources(&path) } else { vec![path] };
        entries.into_iter().flat_map(below).filter(|path| path.extension().is_some_and(|end| end == "rs")).collect()
    }

    /// The lines of the list for one file.
    fn ignored_in(path: &Path, crates: &Path) -> Vec<String> {
        let text = std::fs::read_to_string(path).unwrap();
        let place = path.strip_prefix(crates).unwrap().with_extension("").display().to_string().replace("/tests/", "/");
        assert!(!text.contains("println!(\"skipped"), "{place}: a test that cannot run is ignored, with a reason");
        let mut found = vec![];
        let mut lines = text.lines().map(str::trim);
        while let Some(line) = lines.find(|line| line.starts_with("#[ignore")) {
            let reason = line.strip_prefix("#[ignore = \"").and_then(|rest| rest.strip_suffix("\"]"));
            let reason = reason.unwrap_or_else(|| panic!("{place}: `{line}` says no reason"));
            let function = lines.find_map(|line| line.strip_prefix("fn ")).unwrap();
            found.push(format!("{place} {} {reason}", function.split('(').next().unwrap()));
        }
        found
    }

    #[test]
    fn the_list_names_every_ignored_test_and_its_need() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let crates = root.join("crates");
        let found: Vec<String> = sources(&crates).iter().flat_map(|path| ignored_in(path, &crates)).collect();
        let expected: Vec<&str> = LIST.lines().collect();
        assert!(found == expected, "checks/ignored-tests.txt should be:\n{}", found.join("\n"));
        assert!(LIST.lines().all(|line| parts(line).is_some()), "a reason reads `needs THING: why`");
    }

    /// A file of tests that the test program of its crate does not name would never run.
    #[test]
    fn test_programs_name_every_file_beside_them() {
        let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
        let mut programs = 0;
        for folder in std::fs::read_dir(crates).unwrap().map(|entry| entry.unwrap().path().join("tests")) {
            let Ok(program) = std::fs::read_to_string(folder.join("main.rs")) else { continue };
            for path in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
                let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
                let is_module = path.extension().is_some_and(|end| end == "rs") || path.join("mod.rs").is_file();
                let named = name == "main" || program.lines().any(|line| line == format!("mod {name};"));
                assert!(!is_module || named, "{}: `mod {name};` is missing", folder.join("main.rs").display());
            }
            programs += 1;
        }
        assert!(programs >= 3, "{programs}");
    }

    /// Names in back quotes that look like those of tests: words joined by underscores, or files of tests of the page.
    fn tests_named_in(line: &str) -> Vec<&str> {
        let quoted = line.split('`').skip(1).step_by(2);
        let plain = |name: &str| name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        quoted.filter(|name| plain(name) && name.contains('_') || name.ends_with(TEST_OF_THE_PAGE)).collect()
    }

    #[test]
    fn the_page_of_promises_names_tests_that_exist() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let page = std::fs::read_to_string(root.join("docs/reliability.md")).unwrap();
        let texts: Vec<String> =
            sources(&root.join("crates")).iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
        let rows: Vec<&str> =
            page.lines().filter(|line| line.starts_with("| ") && line.matches('|').count() == 5).collect();
        let promises = &rows[..rows.iter().position(|row| row.starts_with("| Target")).unwrap()];
        assert!(promises.len() > 15, "{} rows", promises.len());
        for row in &promises[1..] {
            let names = tests_named_in(row.split('|').nth(2).unwrap());
            assert!(!names.is_empty(), "no test holds: {row}");
            for name in names {
                if name.ends_with(TEST_OF_THE_PAGE) {
                    assert!(root.join(name).is_file(), "docs/reliability.md names {name}, which does not exist");
                    continue;
                }
                let function = format!("fn {name}(");
                // The attributes of a test stand in the few lines above it.
                let is_test = |text: &String| {
                    let above = text.split(&function).next().filter(|above| above.len() < text.len());
                    above.is_some_and(|above| above.lines().rev().take(4).any(|line| line.trim() == "#[test]"))
                };
                assert!(texts.iter().any(is_test), "docs/reliability.md names `{name}`, which is no test");
            }
        }
    }
}
