//! Finds doc comments whose first sentence is no statement about a thing with a name.

use std::path::PathBuf;

use super::sources::{crates, files, root};

/// First words of a question, of a clause without a subject, or of a sentence whose subject is a pronoun.
const NO_SUBJECT: [&str; 14] = [
    "What", "Whatever", "Which", "Why", "Who", "Whoever", "Whose", "How", "When", "Where", "It", "Its", "They", "Their",
];

/// The Rust files of the repository: sources, tests, benches and examples of all crates, checks, fuzz targets and the tool of the mutants.
pub(super) fn all_files() -> Vec<PathBuf> {
    let parts = ["src", "tests", "benches", "examples"];
    let of_crates = crates().into_values().flat_map(|folder| parts.map(|part| folder.join(part)));
    let others = ["checks/src", "fuzz/src", "fuzz/targets", "mutants/src"].map(|folder| root().join(folder));
    of_crates.chain(others).filter(|folder| folder.is_dir()).flat_map(|folder| files(&folder)).collect()
}

/// Lines of doc comments that begin with a word of [`NO_SUBJECT`] where the comment begins, or hold a question.
pub(super) fn faults(text: &str) -> Vec<&str> {
    let (mut found, mut above, mut code) = (vec![], None, false);
    for line in text.lines().map(str::trim_start) {
        let mark = ["//!", "///"].into_iter().find(|mark| line.starts_with(mark));
        let begins = mark != above;
        above = mark;
        let Some(words) = mark.and_then(|mark| line.strip_prefix(mark)) else { continue };
        code ^= words.trim_start().starts_with("```");
        let first = words.trim_start().split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
        let question = (words.ends_with('?') || words.contains("? ")) && !words.contains("`?`");
        if !code && (question || begins && NO_SUBJECT.contains(&first)) {
            found.push(line);
        }
    }
    found
}

#[test]
fn a_comment_that_begins_with_a_question_word_or_pronoun_is_found_and_a_statement_is_not() {
    for fault in ["/// Why a task was refused.", "//! What holds?", "    /// Its name.", "/// How.", "/// Is it on?"] {
        assert_eq!(faults(fault), [fault.trim_start()]);
    }
    let text =
        "/// The reason.\n/// Where it is, m.\nfn f() {}\n/// Whether `x` is inside.\n/// ```\n/// x?\n/// ```\n";
    assert_eq!(faults(text), Vec::<&str>::new());
}
