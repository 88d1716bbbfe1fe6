//! Temporary folders that killed programs left behind.

use std::fs::File;
use std::path::{Path, PathBuf};

use super::manifest::{Entry, MANIFEST, entries};

/// With it begins the name of a temporary folder.
pub(super) const PREFIX: &str = ".contrapposto-";
/// The file in a temporary folder that the program locks which uses it.
pub(super) const LOCK: &str = "lock";
/// The manifest, in a temporary folder, of the set that is being replaced.
pub(super) const REPLACED: &str = "replaced";

/// A temporary folder that no program uses.
pub(super) struct Leftover {
    path: PathBuf,
    /// Files of the sets, the replaced and the new one, between which its program was killed.
    pub(super) files: Vec<Entry>,
}

/// The leftovers in a folder; `own` is in use by this program. The folder is locked.
pub(super) fn leftovers(folder: &Path, own: &Path) -> Vec<Leftover> {
    let Ok(listed) = std::fs::read_dir(folder) else { return vec![] };
    let paths = listed.filter_map(|entry| Some(entry.ok()?.path()));
    let begun = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PREFIX));
    paths.filter(|path| begun(path) && path.file_name() != own.file_name()).filter_map(leftover).collect()
}

fn leftover(path: PathBuf) -> Option<Leftover> {
    if !std::fs::symlink_metadata(&path).is_ok_and(|kind| kind.is_dir()) {
        return None;
    }
    let unused = match File::open(path.join(LOCK)) {
        Ok(lock) => lock.try_lock().is_ok(),
        // Killed before it made the lock, which comes first, or after it removed the lock, which goes last.
        Err(_) => std::fs::read_dir(&path).is_ok_and(|mut files| files.next().is_none()),
    };
    if !unused {
        return None;
    }
    let files = [REPLACED, MANIFEST].iter().filter_map(|name| entries(&path.join(name))).flatten().collect();
    Some(Leftover { path, files })
}

impl Leftover {
    /// Removes it.
    pub(super) fn remove(self) {
        remove_temporary(&self.path);
    }
}

/// Removes a temporary folder; what cannot be removed stays. Its lock goes last: as long as anything else is there, it says whether
/// a program uses the folder.
pub(super) fn remove_temporary(path: &Path) {
    let names = std::fs::read_dir(path).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.file_name()));
    names.filter(|name| name != LOCK).for_each(|name| drop(std::fs::remove_file(path.join(name))));
    let _ = std::fs::remove_file(path.join(LOCK));
    let _ = std::fs::remove_dir(path);
}
