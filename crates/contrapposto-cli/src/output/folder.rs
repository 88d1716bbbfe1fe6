//! A folder into which files are put: each is written in a temporary folder inside it, and appears whole under its name.

use std::cell::Cell;
use std::fs::{File, TryLockError};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use tempfile::NamedTempFile;

use super::leftover::{LOCK, PREFIX, leftovers, remove_temporary};
use crate::fail::Fail;

/// Time between two attempts to lock the folder, and their greatest number: other programs rename files meanwhile.
const BETWEEN_TRIES: Duration = Duration::from_millis(50);
const MOST_TRIES: usize = 1200;

/// See the module's text.
pub(crate) struct Folder {
    path: PathBuf,
    /// Whether this program made the folder.
    made: bool,
    temporary: PathBuf,
    /// Names of a set are changing: the temporary folder tells the next program which.
    changing: Cell<bool>,
    /// Leftovers were looked for: once, since a folder of many parts is long to list.
    cleaned: Cell<bool>,
    /// Held while the program lives: tells others that the temporary folder is in use.
    _lock: File,
}

impl Drop for Folder {
    fn drop(&mut self) {
        if self.changing.get() {
            return;
        }
        remove_temporary(&self.temporary);
        if self.made {
            // Only an empty folder is removed: nothing was put into it.
            let _ = std::fs::remove_dir(&self.path);
        }
    }
}

/// A file that is not visible under its name yet.
pub(crate) struct Pending {
    file: BufWriter<NamedTempFile>,
    name: String,
    path: PathBuf,
}

impl Folder {
    /// The folder, made if it is not there; files can be written into it.
    pub(crate) fn open(path: &Path) -> Result<Self, Fail> {
        if path.is_file() {
            return Err(Fail::Refused(format!("--out {}: is a file; give the name of a folder", path.display())));
        }
        let refused = |error: std::io::Error| Fail::Refused(format!("--out {}: {error}", path.display()));
        let made = !path.exists();
        std::fs::create_dir_all(path).map_err(refused)?;
        // No other program takes the temporary folder for a leftover before its lock is held.
        let _alone = lock_folder(path)?;
        let temporary = tempfile::Builder::new().prefix(PREFIX).tempdir_in(path).map_err(refused)?.keep();
        let lock = File::create_new(temporary.join(LOCK)).map_err(refused)?;
        // Where files cannot be locked, leftovers cannot be distinguished from folders in use, and stay.
        let _ = lock.try_lock();
        Ok(Self {
            path: path.to_owned(),
            made,
            temporary,
            changing: Cell::new(false),
            cleaned: Cell::new(false),
            _lock: lock,
        })
    }

    /// Begins a file of that name; what stands before a `/` is a folder.
    pub(crate) fn begin(&self, name: &str) -> Result<Pending, Fail> {
        let path = self.path.join(name);
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the user's mask, as all files
        let file = builder.tempfile_in(&self.temporary).map_err(|error| Fail::job(path.display(), error))?;
        Ok(Pending { file: BufWriter::new(file), name: name.to_owned(), path })
    }

    /// A begun file of these bytes.
    pub(super) fn pending(&self, name: &str, bytes: &[u8]) -> Result<Pending, Fail> {
        let mut pending = self.begin(name)?;
        pending.append(bytes)?;
        Ok(pending)
    }

    /// Writes whole files that belong to no set, all of them or none.
    pub(crate) fn write<B: AsRef<[u8]>>(&self, files: &[(&str, B)]) -> Result<(), Fail> {
        let pending = files.iter().map(|(name, bytes)| self.pending(name, bytes.as_ref()));
        self.commit(pending.collect::<Result<_, _>>()?)
    }

    /// Makes files visible that belong to no set.
    pub(crate) fn commit(&self, files: Vec<Pending>) -> Result<(), Fail> {
        let ready = self.ready(files)?;
        let _alone = lock_folder(&self.path)?;
        for (file, path) in ready {
            file.persist(&path).map_err(|error| Fail::job(path.display(), error.error))?;
        }
        sync_names(&self.path);
        if self.cleaned.replace(true) {
            return Ok(());
        }
        for leftover in leftovers(&self.path, &self.temporary) {
            if leftover.files.is_empty() {
                leftover.remove();
            }
        }
        Ok(())
    }

    /// Puts the bytes of all files on the disk, makes their folders, and looks whether every name is free for a file; no name has
    /// changed yet.
    pub(super) fn ready(&self, files: Vec<Pending>) -> Result<Vec<(NamedTempFile, PathBuf)>, Fail> {
        let mut ready = vec![];
        for pending in files {
            let path = pending.path;
            let failed = |error: std::io::Error| Fail::job(path.display(), error);
            if let Some((folder, _)) = pending.name.rsplit_once('/') {
                let folder = self.path.join(folder);
                std::fs::create_dir_all(&folder).map_err(failed)?;
                if !folder.canonicalize().map_err(failed)?.starts_with(self.path.canonicalize().map_err(failed)?) {
                    return Err(Fail::job(folder.display(), "is a link that leads out of the folder of the results"));
                }
            }
            if path.is_dir() {
                return Err(Fail::job(path.display(), "is a folder; the results need a file of that name"));
            }
            let file = pending.file.into_inner().map_err(|error| failed(error.into_error()))?;
            file.as_file().sync_all().map_err(failed)?;
            ready.push((file, path));
        }
        Ok(ready)
    }

    /// Removes a file of that name, if there is one.
    pub(crate) fn remove(&self, name: &str) -> Result<(), Fail> {
        let path = self.path.join(name);
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Fail::job(path.display(), error)),
            _ => Ok(()),
        }
    }

    /// Path of the file of that name.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Says that names of a set begin to change, or that all have changed. After a failure in between, the temporary folder stays.
    pub(super) fn set_changing(&self, changing: bool) {
        self.changing.set(changing);
    }

    /// The folder itself, and the temporary one inside it.
    pub(super) fn paths(&self) -> (&Path, &Path) {
        (&self.path, &self.temporary)
    }
}

impl Pending {
    /// Adds bytes.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> Result<(), Fail> {
        self.file.write_all(bytes).map_err(|error| Fail::job(self.path.display(), error))
    }
}

/// Puts changed names of a folder on the disk. A folder cannot be synced on every system; the files themselves are safe.
pub(super) fn sync_names(folder: &Path) {
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

/// Locks a folder against other programs that put files in place, until the result is dropped; none where folders cannot be locked.
pub(super) fn lock_folder(path: &Path) -> Result<Option<File>, Fail> {
    let Ok(folder) = File::open(path) else { return Ok(None) };
    for _ in 0..MOST_TRIES {
        match folder.try_lock() {
            Ok(()) => return Ok(Some(folder)),
            Err(TryLockError::Error(_)) => return Ok(None),
            Err(TryLockError::WouldBlock) => std::thread::sleep(BETWEEN_TRIES),
        }
    }
    let seconds = (BETWEEN_TRIES * MOST_TRIES as u32).as_secs();
    Err(Fail::job(
        path.display(),
        format!("another program has kept this folder locked for {seconds} s; try again later"),
    ))
}

/// The folder that a file stands in, and its own name.
pub(crate) fn folder_and_name(path: &Path) -> Result<(PathBuf, String), Fail> {
    let name = path.file_name().and_then(|name| name.to_str());
    let name = name.ok_or_else(|| {
        Fail::Refused(format!("{}: the name of a file to write has to be text in UTF-8", path.display()))
    })?;
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    Ok((parent.unwrap_or(Path::new(".")).to_owned(), name.to_owned()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::{Folder, leftovers};

    #[test]
    fn a_failure_while_names_change_leaves_the_temporary_folder_for_the_next_program() {
        let target = tempfile::tempdir().unwrap();
        let path = target.path();
        drop(Folder::open(path).ok().unwrap());
        assert_eq!(std::fs::read_dir(path).unwrap().count(), 0);
        let folder = Folder::open(path).ok().unwrap();
        folder.set_changing(true);
        assert_eq!(leftovers(path, path).len(), 0, "the folder is in use");
        drop(folder);
        assert_eq!(leftovers(path, path).len(), 1);
    }
}
