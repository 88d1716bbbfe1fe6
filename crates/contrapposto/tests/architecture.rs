//! Does the tree still look the way ARCHITECTURE.md says? Modules use only what stands above them; crates only what they
//! list. Guards against import cycles and against a page that has become untrue.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests: helpers outside #[test] functions too")]

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: impl AsRef<Path>) -> String {
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.as_ref().display()))
}

/// The text between `<!-- name -->` and `<!-- /name -->`.
fn section(page: &str, name: &str) -> String {
    let (_, rest) = page.split_once(&format!("<!-- {name} -->")).expect("opening marker");
    rest.split_once(&format!("<!-- /{name} -->")).expect("closing marker").0.to_owned()
}

fn first_code(line: &str) -> Option<String> {
    line.split('`').nth(1).map(str::to_owned)
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = vec![];
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn modules_use_only_those_above() {
    let list = section(&read(root().join("ARCHITECTURE.md")), "modules");
    let order: Vec<String> = list.lines().filter_map(first_code).collect();
    let src = root().join("crates/contrapposto/src");
    let mut seen = std::collections::BTreeSet::new();
    for path in sources(&src) {
        let relative = path.strip_prefix(&src).unwrap();
        let module = relative.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs").to_owned();
        if module == "lib" {
            continue;
        }
        let place = order.iter().position(|m| *m == module);
        let place = place.unwrap_or_else(|| panic!("module `{module}` is not listed in ARCHITECTURE.md"));
        seen.insert(module.clone());
        let text = read(&path);
        for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//")) {
            for used in line.split("crate::").skip(1) {
                let name: String = used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let Some(other) = order.iter().position(|m| *m == name) else { continue };
                let at = format!("{}:{}", relative.display(), number + 1);
                assert!(other <= place, "{at}: `{module}` uses `{name}`, which stands below it in ARCHITECTURE.md");
            }
        }
    }
    assert_eq!(seen.len(), order.len(), "ARCHITECTURE.md lists a module that is not there: {order:?} against {seen:?}");
}

#[test]
fn crates_depend_on_what_they_list() {
    let list = section(&read(root().join("ARCHITECTURE.md")), "crates");
    let rows: Vec<&str> = list.lines().filter(|line| line.starts_with("| `")).collect();
    let folders = std::fs::read_dir(root().join("crates")).unwrap().count();
    assert_eq!(rows.len(), folders, "one row a crate");
    for row in rows {
        let cells: Vec<&str> = row.split('|').collect();
        let name = first_code(cells[1]).unwrap();
        let listed: Vec<String> = cells[2].split('`').skip(1).step_by(2).map(str::to_owned).collect();
        let manifest = read(root().join("crates").join(&name).join("Cargo.toml"));
        let dependencies = manifest.split_once("[dependencies]").map_or("", |(_, rest)| rest);
        let dependencies = dependencies.split("\n[").next().unwrap();
        let mut used: Vec<String> = dependencies
            .lines()
            .filter_map(|line| line.split(['.', ' ', '=']).next())
            .filter(|name| root().join("crates").join(name).join("Cargo.toml").exists() && !name.is_empty())
            .map(str::to_owned)
            .collect();
        used.sort();
        assert_eq!(used, listed, "{name}: its manifest and ARCHITECTURE.md differ");
    }
}
