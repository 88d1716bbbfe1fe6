//! Temporary folders that killed programs left behind.

use std::fs::File;
use std::path::{Path, PathBuf};

use super::manifest::{Entry, MANIFEST, entries};

/// First part of the name of every temporary folder; [`SUFFIX`] letters and digits follow.
pub(super) const PREFIX: &str = ".contrapposto-";
const SUFFIX: usize = 6;
/// First part of the name of every file that is being written there.
const WRITTEN: &str = ".tmp";
/// The file that a program keeps locked while it uses its temporary folder.
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
    let named = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()?.strip_prefix(PREFIX));
        name.is_some_and(|suffix| suffix.len() == SUFFIX)
    };
    paths.filter(|path| named(path) && path.file_name() != own.file_name()).filter_map(leftover).collect()
}

fn leftover(path: PathBuf) -> Option<Leftover> {
    if !std::fs::symlink_metadata(&path).is_ok_and(|kind| kind.is_dir()) {
        return None;
    }
    let ours = |name: &str| [LOCK, REPLACED, MANIFEST].contains(&name) || name.starts_with(WRITTEN);
    let mut names = std::fs::read_dir(&path).ok()?.filter_map(|entry| Some(entry.ok()?.file_name()));
    let all_ours = names.all(|name| name.to_str().is_some_and(ours));
    // A program that was killed before it made the lock, or after it removed it, left an empty folder.
    let in_use = File::open(path.join(LOCK)).is_ok_and(|lock| lock.try_lock().is_err());
    if in_use || !all_ours {
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
