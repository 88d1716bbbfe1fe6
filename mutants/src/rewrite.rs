//! Writes mutants into the copy, and leaves out those that do not compile.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;
use std::process::Command;

use crate::draw::Mutant;

/// Variable that names the mutant of a run, from 0; and the file that takes the numbers of the mutants reached.
pub(crate) const MUTANT: &str = "MUTANT";
pub(crate) const TRACE: &str = "MUTANT_TRACE";

/// Module of each changed crate: `on` is true for the mutant of this run.
const SWITCH: &str = r#"
#[allow(warnings, clippy::all)]
mod mutant {
    use std::sync::LazyLock;
    use std::sync::atomic::{AtomicBool, Ordering};
    static MUTANT: LazyLock<Option<usize>> = LazyLock::new(|| std::env::var("MUTANT").ok()?.parse().ok());
    static TRACE: LazyLock<Option<String>> = LazyLock::new(|| std::env::var("MUTANT_TRACE").ok());
    static REACHED: [AtomicBool; COUNT] = [const { AtomicBool::new(false) }; COUNT];
    pub(crate) fn on(mutant: usize) -> bool {
        if let Some(file) = &*TRACE && !REACHED[mutant].swap(true, Ordering::Relaxed) {
            use std::io::Write;
            let mut file = std::fs::OpenOptions::new().create(true).append(true).open(file).unwrap();
            file.write_all(format!("{mutant}\n").as_bytes()).unwrap();
        }
        *MUTANT == Some(mutant)
    }
}
"#;

/// Most times that mutants which do not compile are replaced by the next ones.
const ROUNDS: usize = 30;

/// The first `count` mutants that compile, written into the copy, where a mutant's number is its place in the list.
pub(crate) fn compiled(root: &Path, folder: &Path, all: Vec<Mutant>, count: usize) -> Result<Vec<Mutant>, String> {
    let mut refused = BTreeSet::new();
    for round in 0..ROUNDS {
        let chosen: Vec<usize> = (0..all.len()).filter(|i| !refused.contains(i)).take(count).collect();
        let written = write(root, folder, &all, &chosen)?;
        let errors = errors(folder)?;
        if errors.is_empty() {
            println!("{} compile; {} others do not and were left out", chosen.len(), refused.len());
            return Ok(chosen.into_iter().map(|i| all[i].clone()).collect());
        }
        println!("round {round}: {} complaints of the compiler", errors.len());
        let before = refused.len();
        for (file, error) in &errors {
            let at: Vec<_> = written.iter().filter(|(f, range, _)| f == file && overlap(range, error)).collect();
            let smallest = at.iter().map(|(_, range, _)| range.len()).min();
            refused.extend(at.iter().filter(|(_, range, _)| Some(range.len()) == smallest).map(|(.., i)| *i));
        }
        if refused.len() == before {
            return Err(format!("no mutant explains the complaints at {errors:?}"));
        }
    }
    Err(format!("mutants still do not compile after {ROUNDS} rounds"))
}

fn overlap(a: &Range<usize>, b: &Range<usize>) -> bool {
    a.start < b.end.max(b.start + 1) && b.start < a.end
}

/// File, bytes in the changed file, and place in the list, of each mutant.
type Written = Vec<(String, Range<usize>, usize)>;

fn write(root: &Path, folder: &Path, all: &[Mutant], chosen: &[usize]) -> Result<Written, String> {
    let mut files: BTreeMap<String, Vec<(usize, usize)>> = BTreeMap::new();
    for source in crate::SOURCES {
        files.insert(format!("{source}/lib.rs"), vec![]);
    }
    for mutant in all {
        // A file whose mutants were all refused is written as it was.
        files.entry(mutant.file.clone()).or_default();
    }
    for (number, &i) in chosen.iter().enumerate() {
        files.entry(all[i].file.clone()).or_default().push((number, i));
    }
    let mut written = vec![];
    for (file, mut mutants) in files {
        let complaint = |error: std::io::Error| format!("{file}: {error}");
        let source = std::fs::read_to_string(root.join(&file)).map_err(complaint)?;
        mutants.sort_by_key(|&(number, i)| (all[i].range.start, usize::MAX - all[i].range.end, number));
        let mut text = Text { source: &source, all, out: String::new(), written: vec![] };
        text.put(0..source.len(), &mutants);
        written.extend(text.written.into_iter().map(|(range, i)| (file.clone(), range, i)));
        let mut out = text.out;
        if file.ends_with("src/lib.rs") {
            out.push_str(&SWITCH.replace("COUNT", &chosen.len().max(1).to_string()));
        }
        let to = folder.join(&file);
        if std::fs::read_to_string(&to).map_err(complaint)? != out {
            std::fs::write(&to, out).map_err(complaint)?;
        }
    }
    Ok(written)
}

struct Text<'a> {
    source: &'a str,
    all: &'a [Mutant],
    out: String,
    written: Vec<(Range<usize>, usize)>,
}

impl Text<'_> {
    /// Puts bytes of the source with these mutants, outer ones before inner ones. A mutant replaces the text as it was: only one is on.
    fn put(&mut self, range: Range<usize>, mutants: &[(usize, usize)]) {
        let (mut at, mut next) = (range.start, 0);
        while let Some(&(number, i)) = mutants.get(next) {
            let mutant = &self.all[i];
            self.out.push_str(&self.source[at..mutant.range.start]);
            let start = self.out.len();
            if mutant.range.is_empty() {
                self.out.push_str(&format!(" if crate::mutant::on({number}) {{ return {}; }} ", mutant.text));
                (at, next) = (mutant.range.end, next + 1);
            } else {
                self.out.push_str(&format!("(if crate::mutant::on({number}) {{ {} }} else {{ ", mutant.text));
                let inside = mutants[next + 1..].iter().take_while(|(_, j)| self.all[*j].range.end <= mutant.range.end);
                let inner = next + 1 + inside.count();
                self.put(mutant.range.clone(), &mutants[next + 1..inner]);
                self.out.push_str(" })");
                (at, next) = (mutant.range.end, inner);
            }
            self.written.push((start..self.out.len(), i));
        }
        self.out.push_str(&self.source[at..range.end]);
    }
}

/// Command of cargo in the copy: warnings are not refused there, and its build is its own.
pub(crate) fn cargo(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new("cargo");
    command.current_dir(folder).args(arguments).args(["--locked", "--message-format=json"]);
    command.args(["-p", "hierarchical-least-squares", "-p", "contrapposto", "-p", "contrapposto-formats"]);
    command.env("RUSTFLAGS", "--cap-lints=warn").env("CARGO_TARGET_DIR", folder.join("target"));
    command.env("CARGO_PROFILE_DEV_DEBUG", "0").env("CARGO_INCREMENTAL", "0");
    command
}

/// Messages of cargo, one a line.
pub(crate) fn messages(command: &mut Command) -> Result<Vec<serde_json::Value>, String> {
    let output = command.output().map_err(|error| format!("cargo: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let messages: Vec<_> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    if messages.is_empty() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(messages)
}

/// File and bytes of each error of the compiler.
fn errors(folder: &Path) -> Result<Vec<(String, Range<usize>)>, String> {
    let mut errors = vec![];
    for message in messages(&mut cargo(folder, &["check"]))? {
        let message = &message["message"];
        if message["level"] != "error" {
            continue;
        }
        for span in message["spans"].as_array().into_iter().flatten().filter(|span| span["is_primary"] == true) {
            let byte = |key: &str| span[key].as_u64().unwrap_or(0) as usize;
            let file = span["file_name"].as_str().unwrap_or("").to_owned();
            errors.push((file, byte("byte_start")..byte("byte_end")));
        }
    }
    Ok(errors)
}

#[cfg(test)]
mod tests {
    use super::Text;
    use crate::draw::of_source;

    #[test]
    fn a_mutant_inside_another_is_written_into_the_branch_without_it() {
        let source = "fn f(a: i64) -> i64 { a + -a }";
        let all = of_source("a.rs".into(), source).unwrap();
        let place = |text: &str| all.iter().position(|mutant| mutant.text == text).unwrap();
        let mut mutants = [(0, place("Default::default()")), (1, place("a - -a")), (2, place("a"))];
        mutants.sort_by_key(|&(_, i)| (all[i].range.start, usize::MAX - all[i].range.end));
        let mut text = Text { source, all: &all, out: String::new(), written: vec![] };
        text.put(0..source.len(), &mutants);
        let expected = "fn f(a: i64) -> i64 { if crate::mutant::on(0) { return Default::default(); }  \
                        (if crate::mutant::on(1) { a - -a } else { a + (if crate::mutant::on(2) { a } else { -a }) }) }";
        assert_eq!(text.out, expected);
    }
}
