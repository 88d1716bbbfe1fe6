//! Holds the tree to ARCHITECTURE.md and to the rules of the house: modules use only modules above them, crates only the crates
//! that they list, no file of a crate uses another one that uses it back, files and functions stay short, a constant's name has
//! one meaning in a crate, and documentation opens with a statement about a thing with a name.

mod docs;
mod graph;
mod measures;
mod sources;
mod tolerances;

use std::collections::{BTreeMap, BTreeSet};

use sources::{Source, crates, read, root, sources as sources_of};

/// Most lines of a file without its unit tests.
const FILE_LINES: usize = 400;
/// Most lines of a function.
const FUNCTION_LINES: usize = 60;
/// Deepest nesting of blocks in a function.
const NESTING: usize = 4;

fn assert_none(found: &[String], rule: &str) {
    assert!(found.is_empty(), "{rule}:\n{}", found.join("\n"));
}

/// The text between `<!-- name -->` and `<!-- /name -->`.
fn section(page: &str, name: &str) -> String {
    let (_, rest) = page.split_once(&format!("<!-- {name} -->")).expect("opening marker");
    rest.split_once(&format!("<!-- /{name} -->")).expect("closing marker").0.to_owned()
}

fn first_code(line: &str) -> Option<String> {
    line.split('`').nth(1).map(str::to_owned)
}

fn science() -> Vec<Source> {
    sources_of(&root().join("crates/contrapposto")).into_iter().map(|(source, _)| source).collect()
}

#[test]
fn modules_use_only_modules_above_them() {
    let list = section(&read(root().join("ARCHITECTURE.md")), "modules");
    let order: Vec<String> = list.lines().filter_map(first_code).collect();
    let place = |module: &str| {
        let place = order.iter().position(|listed| listed == module);
        place.unwrap_or_else(|| panic!("module `{module}` is not listed in ARCHITECTURE.md"))
    };
    let sources = science();
    let mut seen = BTreeSet::new();
    let mut wrong = vec![];
    for (module, used) in graph::uses(&sources) {
        let Some(room) = module.first() else { continue };
        seen.insert(room.clone());
        for used in used.iter().filter_map(|used| used.first()) {
            if place(used) > place(room) {
                wrong.push(format!("{}: `{room}` uses `{used}`, which stands below it", module.join("/")));
            }
        }
    }
    assert_none(&wrong, "modules use only modules above them in ARCHITECTURE.md");
    assert_eq!(seen.len(), order.len(), "ARCHITECTURE.md lists a module that is not there: {order:?} against {seen:?}");
}

#[test]
fn no_circle_of_files_in_any_crate() {
    let mut found = vec![];
    for (name, folder) in crates() {
        let sources: Vec<Source> = sources_of(&folder).into_iter().map(|(source, _)| source).collect();
        let mut graph = graph::uses(&sources);
        while let Some(circle) = graph::circle(&graph) {
            let files: Vec<String> = circle.iter().map(|module| module.join("::")).collect();
            found.push(format!("{name}: {}", files.join(" -> ")));
            graph.get_mut(circle.last().unwrap()).unwrap().remove(&circle[0]);
        }
    }
    assert_none(&found, "circles of files");
}

#[test]
fn files_and_functions_are_short() {
    let mut found = vec![];
    for folder in crates().values() {
        for (source, file) in sources_of(folder) {
            let lines = source.lines_without_tests(&file);
            if lines > FILE_LINES {
                found.push(format!("{}: more than {FILE_LINES} lines", source.name));
            }
            for function in measures::functions(&source.items) {
                let place = format!("{}: fn {}", source.name, function.name);
                if function.lines > FUNCTION_LINES {
                    found.push(format!("{place}: more than {FUNCTION_LINES} lines"));
                }
                if function.depth > NESTING {
                    found.push(format!("{place}: nested deeper than {NESTING}"));
                }
            }
        }
    }
    assert_none(&found, "files and functions");
}

#[test]
fn a_constant_has_one_meaning_in_its_crate() {
    let mut found = vec![];
    for (name, folder) in crates() {
        let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for (source, _) in sources_of(&folder) {
            for item in &source.items {
                if let syn::Item::Const(constant) = item {
                    places.entry(constant.ident.to_string()).or_default().push(source.module.join("::"));
                }
            }
        }
        let twice = places.into_iter().filter(|(constant, places)| constant != "_" && places.len() > 1);
        found.extend(twice.map(|(constant, places)| format!("{name}: {constant} in {}", places.join(", "))));
    }
    assert_none(&found, "constants of one name");
}

#[test]
fn every_file_begins_with_module_documentation() {
    let mut found = vec![];
    for folder in crates().values() {
        for (source, _) in sources_of(folder) {
            if source.text.lines().next().is_some_and(|first| !first.starts_with("//!")) {
                found.push(source.name);
            }
        }
    }
    assert_none(&found, "files without module documentation");
}

#[test]
fn documentation_opens_with_a_statement_about_a_thing_with_a_name() {
    let mut found = vec![];
    for path in docs::all_files() {
        let name = path.strip_prefix(root()).unwrap().display().to_string();
        found.extend(docs::faults(&read(&path)).into_iter().map(|line| format!("{name}: {line}")));
    }
    assert_none(&found, "questions, and first sentences without a subject, in documentation");
}

#[test]
fn crates_depend_on_what_they_list() {
    let list = section(&read(root().join("ARCHITECTURE.md")), "crates");
    let rows: Vec<&str> = list.lines().filter(|line| line.starts_with("| `")).collect();
    let folders = crates().len();
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
            .filter(|name| crates().contains_key(*name))
            .map(str::to_owned)
            .collect();
        used.sort();
        assert_eq!(used, listed, "{name}: its manifest and ARCHITECTURE.md differ");
    }
}

#[test]
fn the_page_of_tolerances_agrees_with_the_sources() {
    let path = root().join("docs/tolerances.md");
    let page = tolerances::page();
    if std::env::var_os("CONTRAPPOSTO_WRITE_DOCS").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    assert!(read(&path) == page, "docs/tolerances.md differs from the sources; the page says how to write it anew");
    let undocumented: Vec<String> = page.lines().filter(|line| line.ends_with("|  |")).map(str::to_owned).collect();
    assert_none(&undocumented, "constants without documentation");
}
