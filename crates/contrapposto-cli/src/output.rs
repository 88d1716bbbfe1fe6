//! Results: standard output that survives a closed pipe, notes on standard error, and files that appear whole or not at all.

mod folder;
mod leftover;
mod manifest;
mod result_set;

use std::cell::RefCell;
use std::io::{ErrorKind, Write};
use std::sync::{Mutex, OnceLock, PoisonError};

use contrapposto_formats::escaped_lines;

pub(crate) use self::folder::{Folder, Pending, folder_and_name};
pub(crate) use self::result_set::{ResultSet, page_line, report_line};
use crate::fail::Fail;

/// Writes text to standard output.
pub(crate) fn print(text: &str) -> Result<(), Fail> {
    let mut out = std::io::stdout().lock();
    out.write_all(escaped_lines(text).as_bytes()).and_then(|()| out.flush()).map_err(stdout_failed)
}

/// Amount of notes on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Notes {
    /// None.
    Quiet,
    /// The most important ones, and the number of the others.
    Folded,
    /// All, at once.
    All,
}

/// Notes that are shown of more than that.
const MOST_NOTES: usize = 4;

static NOTES: OnceLock<Notes> = OnceLock::new();
static WAITING: Mutex<Vec<String>> = Mutex::new(vec![]);
static WARNINGS: Mutex<Vec<String>> = Mutex::new(vec![]);

thread_local! {
    /// Kinds and texts of the notes of this thread, while they are kept.
    static KEPT: RefCell<Option<Vec<(String, String)>>> = const { RefCell::new(None) };
}

/// Carries out a job whose notes are kept, not printed; gives the notes, too.
pub(crate) fn keep_notes<T>(job: impl FnOnce() -> T) -> (T, Vec<(String, String)>) {
    KEPT.with_borrow_mut(|kept| *kept = Some(vec![]));
    let result = job();
    (result, KEPT.take().unwrap_or_default())
}

/// Keeps a note where this thread keeps them.
fn keep(kind: &str, text: &str) -> bool {
    let push = |kept: &mut Vec<(String, String)>| kept.push((kind.to_owned(), text.to_owned()));
    KEPT.with_borrow_mut(|kept| kept.as_mut().map(push).is_some())
}

/// Says once, at the start, how many notes standard error gets.
pub(crate) fn show_notes(notes: Notes) {
    let _ = NOTES.set(notes);
}

/// Tells standard error something that is no failure. Notes and warnings wait for [`print_waiting_notes`], so that the answer comes before
/// them; with all notes they appear at once.
pub(crate) fn print_note(kind: &str, text: &str) {
    if keep(kind, text) {
        return;
    }
    match (kind, NOTES.get().copied().unwrap_or(Notes::All)) {
        ("note", Notes::Quiet) => {}
        ("note", Notes::Folded) => wait(&WAITING, text),
        ("warning", Notes::Folded | Notes::Quiet) => wait(&WARNINGS, text),
        // Nothing is left to try when standard error is closed.
        _ => drop(writeln!(std::io::stderr(), "{kind}: {}", escaped_lines(text))),
    }
}

fn wait(list: &Mutex<Vec<String>>, text: &str) {
    let mut waiting = list.lock().unwrap_or_else(PoisonError::into_inner);
    if !waiting.iter().any(|other| other == text) {
        waiting.push(text.to_owned());
    }
}

/// Tells standard error the warnings that wait, and the most important of the notes that wait, in their order, and the number of the others.
pub(crate) fn print_waiting_notes() {
    let [notes, warnings] =
        [&WAITING, &WARNINGS].map(|list| std::mem::take(&mut *list.lock().unwrap_or_else(PoisonError::into_inner)));
    let (shown, folded) = most_important(&notes);
    let mut text: String = warnings.iter().map(|warning| format!("warning: {warning}\n")).collect();
    text += &shown.iter().map(|note| format!("note: {note}\n")).collect::<String>();
    if folded > 0 {
        text += &format!("note: {folded} more notes; --verbose shows all of them\n");
    }
    let _ = std::io::stderr().write_all(escaped_lines(&text).as_bytes());
}

/// The notes to show, in their order, and the number of the others: those about a single coordinate, which begin with its name, and
/// those about parameters of fatigue come last.
fn most_important(notes: &[String]) -> (Vec<&String>, usize) {
    let detail = |note: &str| note.starts_with('`') || note.starts_with("fatigue of ");
    let mut order: Vec<usize> = (0..notes.len()).collect();
    order.sort_by_key(|&i| detail(&notes[i]));
    order.truncate(MOST_NOTES);
    order.sort_unstable();
    (order.iter().map(|&i| &notes[i]).collect(), notes.len() - order.len())
}

/// A JSON file of that name.
pub(crate) fn json_text(name: &str, value: &impl serde::Serialize) -> Result<String, Fail> {
    Ok(serde_json::to_string_pretty(value).map_err(|error| Fail::job(name, error))? + "\n")
}

/// The failure that a failed write to standard output is.
pub(crate) fn stdout_failed(error: std::io::Error) -> Fail {
    match error.kind() {
        ErrorKind::BrokenPipe => Fail::BrokenPipe,
        _ => Fail::job("standard output", error),
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST_NOTES, most_important};

    #[test]
    fn notes_about_single_coordinates_are_folded_first() {
        let notes = ["a", "`q`: b", "fatigue of c", "d", "`p`: e", "f", "g"].map(str::to_owned);
        let (shown, folded) = most_important(&notes);
        assert_eq!((shown, folded), (vec![&notes[0], &notes[3], &notes[5], &notes[6]], 3));
        let few = &notes[..MOST_NOTES];
        assert_eq!(most_important(few).1, 0);
    }
}
