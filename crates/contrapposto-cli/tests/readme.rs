//! The answers that README.md shows are those of the program.

use crate::support;

use std::path::Path;

use support::contrapposto;

/// The README with each line break read as a space, and a space that must not break as a plain one.
fn readme() -> String {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../README.md")).unwrap();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The first lines of `simulate` of a new scenario, changed as the README says.
fn answer(template: &str, change: (&str, &str)) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let job = folder.path().join("job.toml");
    assert_eq!(contrapposto(["new", template, "--out", job.to_str().unwrap()]).run().code, 0);
    let text = std::fs::read_to_string(&job).unwrap();
    assert!(text.contains(change.0), "{text}");
    std::fs::write(&job, text.replace(change.0, change.1)).unwrap();
    let run = contrapposto(["simulate", job.to_str().unwrap()]).folder(folder.path()).run();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is written without --out");
    run.stdout.lines().map(|line| line.replace('\u{a0}', " ")).collect()
}

#[test]
fn answers_of_the_readme_are_those_of_the_program() {
    let readme = readme();
    let overhead = answer("overhead", ("mass_kg = 2", "mass_kg = 2"));
    assert!(readme.contains(&format!("`{}`", overhead[0])), "README.md does not say: {}", overhead[0]);
    let is_row = |line: &&String| line.starts_with(' ');
    let table = overhead.iter().skip_while(|line| !is_row(line)).take_while(is_row);
    let cells = |line: &String| line.split("  ").map(str::trim).map(str::to_owned).collect::<Vec<_>>();
    let row = |line| cells(line).into_iter().filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join(" | ");
    let rows: Vec<String> = table.map(row).collect();
    assert!(rows.len() > 2, "{overhead:?}");
    for row in rows {
        assert!(readme.contains(&format!("| {row} |")), "README.md does not say: {row}");
    }
    let heavy = answer("lift", ("mass_kg = 10", "mass_kg = 60"));
    assert!(heavy[0].starts_with("Cannot be done: "), "{}", heavy[0]);
    assert!(readme.contains(&format!("`{}`", heavy[0])), "README.md does not say: {}", heavy[0]);
}
