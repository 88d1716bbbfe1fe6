//! The files of one run as a set: put in place together, named by a manifest, without a file of an older set.
//!
//! While names change there is no manifest, so that a reader can tell a whole set from a broken one; a program that is killed
//! or fails in between leaves both lists of names in its temporary folder, and the next run removes what they name. Names are synced
//! between these steps, as a loss of power may undo any change that was not.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::folder::{Folder, lock_folder, sync_names};
use super::leftover::{REPLACED, leftovers};
use super::manifest::{Entry, MANIFEST, entries, manifest_text};
use crate::fail::Fail;
use crate::input::was_read;

/// See the module's text.
pub(crate) struct ResultSet {
    folder: Folder,
}

impl ResultSet {
    /// A set in that folder, which is made if it is not there; nothing of an older set changes yet. `names`: files of the set that are
    /// known already.
    pub(crate) fn open(path: &Path, names: &[&str]) -> Result<Self, Fail> {
        check(path, names.iter().copied())?;
        Ok(Self { folder: Folder::open(path)? })
    }

    /// Writes the whole set and removes what is left of the older one: files that its manifest names, if nobody has changed them
    /// and this program has not read them.
    pub(crate) fn write<B: AsRef<[u8]>>(&self, files: &[(&str, B)]) -> Result<(), Fail> {
        let pending = files.iter().map(|(name, bytes)| self.folder.pending(name, bytes.as_ref()));
        let pending = pending.collect::<Result<Vec<_>, _>>()?;
        let (path, temporary) = self.folder.paths();
        let [current, new, replaced] = [path.join(MANIFEST), temporary.join(MANIFEST), temporary.join(REPLACED)];
        let failed = |error: std::io::Error| Fail::job(current.display(), error);
        let ready = self.folder.ready(pending)?;
        let _alone = lock_folder(path)?;
        check(path, files.iter().map(|(name, _)| *name))?;
        std::fs::write(&new, manifest_text(files)).map_err(failed)?;
        std::fs::File::open(&new).and_then(|file| file.sync_all()).map_err(failed)?;
        sync_names(temporary);
        self.folder.set_changing(true);
        if current.exists() {
            std::fs::rename(&current, &replaced).map_err(failed)?;
        }
        sync_names(path);
        let mut changed: BTreeSet<PathBuf> =
            ready.iter().filter_map(|(_, place)| Some(place.parent()?.into())).collect();
        for (file, place) in ready {
            file.persist(&place).map_err(|error| Fail::job(place.display(), error.error))?;
        }
        let left = leftovers(path, temporary);
        let older = entries(&replaced).into_iter().flatten().chain(left.iter().flat_map(|left| left.files.clone()));
        for entry in older.filter(|entry| files.iter().all(|(name, _)| *name != entry.name)) {
            discard(path, &entry);
            changed.extend(path.join(&entry.name).parent().map(PathBuf::from));
        }
        changed.insert(path.to_owned());
        changed.iter().for_each(|folder| sync_names(folder));
        std::fs::rename(&new, &current).map_err(failed)?;
        self.folder.set_changing(false);
        sync_names(path);
        left.into_iter().for_each(super::leftover::Leftover::remove);
        Ok(())
    }

    /// Writes a file that belongs to no set.
    pub(crate) fn write_apart(&self, name: &str, bytes: &[u8]) -> Result<(), Fail> {
        self.folder.write(&[(name, bytes)])
    }

    /// Removes a file that belongs to no set, if there is one.
    pub(crate) fn remove(&self, name: &str) -> Result<(), Fail> {
        self.folder.remove(name)
    }

    /// Path of the file of that name.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path(name)
    }
}

/// The line on the terminal that names the page of a set; empty without a set.
pub(crate) fn report_line(folder: Option<&ResultSet>) -> String {
    page_line(folder, "report.html")
}

/// The same for a page of another name.
pub(crate) fn page_line(folder: Option<&ResultSet>, page: &str) -> String {
    folder.map_or(String::new(), |folder| format!("report: {}\n", folder.path(page).display()))
}

/// Refuses a folder whose manifest is not ours, and one in which a file of the set would replace an input of this job. A file of the older
/// set that nobody has changed may be both.
fn check<'a>(path: &Path, mut names: impl Iterator<Item = &'a str>) -> Result<(), Fail> {
    let manifest = path.join(MANIFEST);
    let older = entries(&manifest);
    let refused = |name: &str, why: &str| {
        Err(Fail::Refused(format!("--out {}: `{name}` there {why}; give another folder", path.display())))
    };
    if manifest.exists() && older.is_none() {
        return refused(MANIFEST, "is not of this program");
    }
    let older = older.unwrap_or_default();
    let ours = |name: &str| older.iter().any(|entry| entry.name == name && entry.is_unchanged(path));
    match names.find(|name| was_read(&path.join(name)) && !ours(name)) {
        Some(input) => refused(input, "is read by this job and would be replaced"),
        None => Ok(()),
    }
}

/// Removes a file of an older set, and its folder if that is empty then; what cannot be removed stays.
fn discard(folder: &Path, entry: &Entry) {
    let path = folder.join(&entry.name);
    if !entry.is_unchanged(folder) || was_read(&path) {
        return;
    }
    let _ = std::fs::remove_file(&path);
    if let Some((inner, _)) = entry.name.rsplit_once('/') {
        let _ = std::fs::remove_dir(folder.join(inner));
    }
}
