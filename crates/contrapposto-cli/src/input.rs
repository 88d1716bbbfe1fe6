//! Bytes of files that users name: regular files only, and never more than a stated size.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

use crate::fail::Fail;

/// The first bytes of a file that gzip made.
const GZIP: [u8; 2] = [0x1f, 0x8b];
/// The first bytes of a file that zip made.
const ZIP: &[u8] = b"PK\x03\x04";

/// Folders that the user allows scenarios to name files of.
static ALLOWED: OnceLock<Vec<PathBuf>> = OnceLock::new();

/// Says once, at the start, which folders scenarios may name files of beside their own.
pub(crate) fn allow(folders: Vec<PathBuf>) {
    let _ = ALLOWED.set(folders);
}

/// The file that a scenario in `folder` names: beside the scenario, below it, or in a folder that the user allows, wherever names and
/// links lead. Otherwise why it is refused.
pub(crate) fn confined(folder: &Path, name: &str) -> Result<PathBuf, String> {
    let path = folder.join(name);
    // A missing file is reported where it is opened.
    let Ok(real) = path.canonicalize() else { return Ok(path) };
    let mut allowed = std::iter::once(folder).chain(ALLOWED.get().into_iter().flatten().map(PathBuf::as_path));
    if allowed.any(|allowed| allowed.canonicalize().is_ok_and(|allowed| real.starts_with(allowed))) {
        return Ok(path);
    }
    Err("is not in the scenario's folder or below; --allow-path DIR allows the files of DIR, too".to_owned())
}

/// Every file that was read.
static READ: Mutex<Vec<PathBuf>> = Mutex::new(vec![]);

/// Whether this program has read the file.
pub(crate) fn was_read(path: &Path) -> bool {
    let Ok(path) = path.canonicalize() else { return false };
    READ.lock().unwrap_or_else(PoisonError::into_inner).contains(&path)
}

/// Reads a regular file (or standard input for `-`) of `most` bytes at most.
pub(crate) fn read(path: &Path, most: u64) -> Result<Vec<u8>, Fail> {
    let shown = path.display();
    let refuse = |why: String| Fail::Refused(format!("{shown}: {why}"));
    let mut bytes = vec![];
    if path == Path::new("-") {
        read_at_most(std::io::stdin().lock(), most, &mut bytes).map_err(|error| refuse(error.to_string()))?;
    } else {
        let kind = std::fs::metadata(path).map_err(|error| refuse(error.to_string()))?;
        if !kind.is_file() {
            return Err(refuse("is not a regular file".into()));
        }
        if let Ok(place) = path.canonicalize() {
            READ.lock().unwrap_or_else(PoisonError::into_inner).push(place);
        }
        if kind.len() <= most {
            let file = File::open(path).map_err(|error| refuse(error.to_string()))?;
            read_at_most(file, most, &mut bytes).map_err(|error| refuse(error.to_string()))?;
        } else {
            return Err(refuse(format!("is {} bytes long; {most} bytes at most are read", kind.len())));
        }
    }
    if bytes.len() as u64 > most {
        return Err(refuse(format!("is longer than {most} bytes, the most that is read")));
    }
    if bytes.starts_with(&GZIP) {
        return Err(refuse("is compressed (gzip); unpack it first, for example with gunzip".to_owned()));
    }
    if bytes.starts_with(ZIP) {
        return Err(refuse("is compressed (zip); unpack it first".to_owned()));
    }
    Ok(bytes)
}

fn read_at_most(from: impl Read, most: u64, bytes: &mut Vec<u8>) -> std::io::Result<usize> {
    from.take(most + 1).read_to_end(bytes)
}

/// Whether a file is an animation by its name.
pub(crate) fn is_animation(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ["bvh", "glb", "gltf"].iter().any(|known| ending.eq_ignore_ascii_case(known)))
}
