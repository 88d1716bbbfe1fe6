//! Results: standard output that survives a closed pipe, notes on standard error, and files that appear whole or not at all.

use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

use tempfile::NamedTempFile;

use crate::fail::Fail;

/// Writes text to standard output.
pub(crate) fn print(text: &str) -> Result<(), Fail> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(stdout_failed)
}

/// How many notes standard error gets.
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

/// Says once, at the start, how many notes standard error gets.
pub(crate) fn show_notes(notes: Notes) {
    let _ = NOTES.set(notes);
}

/// Tells standard error something that is no failure: a `note` waits for [`print_waiting_notes`], everything else appears at once.
pub(crate) fn print_note(kind: &str, text: &str) {
    match (kind, NOTES.get().copied().unwrap_or(Notes::All)) {
        ("note", Notes::Quiet) => {}
        ("note", Notes::Folded) => {
            let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
            if !waiting.iter().any(|told| told == text) {
                waiting.push(text.to_owned());
            }
        }
        // Nothing is left to try when standard error is closed.
        _ => drop(writeln!(std::io::stderr(), "{kind}: {text}")),
    }
}

/// Tells standard error the most important of the notes that wait, in their order, and the number of the others.
pub(crate) fn print_waiting_notes() {
    let notes = std::mem::take(&mut *WAITING.lock().unwrap_or_else(PoisonError::into_inner));
    let (shown, folded) = most_important(&notes);
    let mut text: String = shown.iter().map(|note| format!("note: {note}\n")).collect();
    if folded > 0 {
        text += &format!("note: {folded} more notes; --verbose shows all of them\n");
    }
    let _ = std::io::stderr().write_all(text.as_bytes());
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

/// A folder into which files are put.
pub(crate) struct Folder {
    path: PathBuf,
}

/// A file that is not visible under its name yet.
pub(crate) struct Pending {
    file: BufWriter<NamedTempFile>,
    path: PathBuf,
}

impl Folder {
    /// The folder, made if it is not there.
    pub(crate) fn open(path: &Path) -> Result<Self, Fail> {
        if path.is_file() {
            return Err(Fail::Refused(format!("--out {}: is a file; give the name of a folder", path.display())));
        }
        std::fs::create_dir_all(path).map_err(|error| Fail::Refused(format!("--out {}: {error}", path.display())))?;
        Ok(Self { path: path.to_owned() })
    }

    /// Begins a file of that name; what stands before a `/` is a folder, made if it is not there.
    pub(crate) fn begin(&self, name: &str) -> Result<Pending, Fail> {
        let path = self.path.join(name);
        if let Some((folder, _)) = name.rsplit_once('/') {
            let folder = self.path.join(folder);
            std::fs::create_dir_all(&folder).map_err(|error| Fail::job(folder.display(), error))?;
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(".contrapposto-");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the user's mask, as all files
        let file = builder.tempfile_in(&self.path).map_err(|error| Fail::job(path.display(), error))?;
        Ok(Pending { file: BufWriter::new(file), path })
    }

    /// Writes whole files, all of them or none.
    pub(crate) fn write<B: AsRef<[u8]>>(&self, files: &[(&str, B)]) -> Result<(), Fail> {
        let pending = |(name, bytes): &(&str, B)| -> Result<Pending, Fail> {
            let mut pending = self.begin(name)?;
            pending.append(bytes.as_ref())?;
            Ok(pending)
        };
        self.commit(files.iter().map(pending).collect::<Result<_, _>>()?)
    }

    /// Makes all files visible: everything is on the disk before the first name changes.
    pub(crate) fn commit(&self, files: Vec<Pending>) -> Result<(), Fail> {
        let mut ready = vec![];
        for pending in files {
            let path = pending.path;
            let failed = |error: std::io::Error| Fail::job(path.display(), error);
            let file = pending.file.into_inner().map_err(|error| failed(error.into_error()))?;
            file.as_file().sync_all().map_err(failed)?;
            ready.push((file, path));
        }
        for (file, path) in ready {
            file.persist(&path).map_err(|error| Fail::job(path.display(), error.error))?;
        }
        // A folder cannot be synced on every system; the files themselves are safe.
        let _ = File::open(&self.path).and_then(|folder| folder.sync_all());
        Ok(())
    }

    /// Removes a file of that name, if there is one.
    pub(crate) fn remove(&self, name: &str) -> Result<(), Fail> {
        let path = self.path.join(name);
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(Fail::job(path.display(), error)),
            _ => Ok(()),
        }
    }

    /// Where a file of that name stands.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }
}

impl Pending {
    /// Adds bytes.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> Result<(), Fail> {
        self.file.write_all(bytes).map_err(|error| Fail::job(self.path.display(), error))
    }
}

/// The folder that a file stands in, and its own name.
pub(crate) fn folder_and_name(path: &Path) -> Result<(PathBuf, String), Fail> {
    let name = path.file_name().and_then(|name| name.to_str());
    let name = name.ok_or_else(|| Fail::Refused(format!("{}: is no name of a file", path.display())))?;
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    Ok((parent.unwrap_or(Path::new(".")).to_owned(), name.to_owned()))
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
