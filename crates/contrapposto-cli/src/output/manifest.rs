//! The manifest of a result set: a line for each file with its SHA-256 digest, as `sha256sum --check` reads it.

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Component, Path};

use sha2::{Digest, Sha256};

/// Name of the manifest's file.
pub(super) const MANIFEST: &str = "manifest.sha256";
/// First line of the manifest, by which the program knows its own manifests.
const HEAD: &str = "# The files of one run of contrapposto. `sha256sum --check` tells whether the set is whole.";
/// Largest manifest that is read, bytes.
const MOST_MANIFEST_BYTES: u64 = 1 << 20;

/// A file of a set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) name: String,
    digest: String,
}

/// The text of a manifest.
pub(super) fn manifest_text<B: AsRef<[u8]>>(files: &[(&str, B)]) -> String {
    let mut text = format!("{HEAD}\n");
    for (name, bytes) in files {
        text += &format!("{}  {name}\n", hexadecimal(&Sha256::digest(bytes)));
    }
    text
}

/// The files that a manifest names; none if there is no manifest of ours under that name.
pub(super) fn entries(path: &Path) -> Option<Vec<Entry>> {
    let mut text = String::new();
    File::open(path).ok()?.take(MOST_MANIFEST_BYTES).read_to_string(&mut text).ok()?;
    let lines = text.strip_prefix(HEAD)?.lines().filter_map(|line| line.split_once("  "));
    let entries = lines.map(|(digest, name)| Entry { name: name.to_owned(), digest: digest.to_owned() });
    Some(entries.filter(|entry| stays_inside(&entry.name)).collect())
}

/// Whether a name leads to a place inside the folder.
fn stays_inside(name: &str) -> bool {
    !name.is_empty() && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

impl Entry {
    /// Whether the file in `folder` is the one that was written: a regular file of the same bytes.
    pub(super) fn is_unchanged(&self, folder: &Path) -> bool {
        let path = folder.join(&self.name);
        let regular = std::fs::symlink_metadata(&path).is_ok_and(|kind| kind.is_file());
        regular && digest(&path).is_ok_and(|digest| digest == self.digest)
    }
}

fn digest(path: &Path) -> std::io::Result<String> {
    let mut hash = Hash(Sha256::new());
    std::io::copy(&mut File::open(path)?, &mut hash)?;
    Ok(hexadecimal(&hash.0.finalize()))
}

struct Hash(Sha256);

impl Write for Hash {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
